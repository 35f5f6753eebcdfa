"""The rules, one family a file, and those of plug-ins."""

from nau_py.plugins import RULES as PLUGINS
from nau_py.plugins import loaded


def load_rules() -> None:
    """Import every family, so that its rules are registered."""
    from nau_py.rules import (  # noqa: F401
        accuracy,
        dataflow,
        files,
        names,
        numerics,
        passes,
        plugins,
        raytrace,
        references,
        running,
        syntax,
        values,
    )

    loaded(PLUGINS)
