"""Files to models and back, in three steps.

1. :mod:`nau_py.syntax` makes a tree of elements of XML text; :mod:`nau_py.formats.yaml` makes the
same tree of YAML. 2. :mod:`nau_py.formats.upgrade` renames elements of old dialects. 3.
:mod:`nau_py.formats.bind` makes nodes of elements, by the description of each class
(:mod:`nau_py.model.schema`). Parts that no class declares are kept, for lint to report.
"""

from nau_py.formats.load import load_project

__all__ = ["load_project"]
