"""The rules, one family a file."""


def families() -> None:
    """Import every family, so that its rules are registered."""
    from nau_py.lint.rules import (  # noqa: F401
        accuracy,
        dataflow,
        files,
        names,
        numerics,
        passes,
        raytrace,
        references,
        running,
        syntax,
        values,
    )
