"""Models to text: clean XML or YAML."""

from __future__ import annotations

from nau_py.formats.bind import make_element
from nau_py.formats.yaml import to_yaml
from nau_py.model.attributes import Registry
from nau_py.model.library import MaterialLibrary
from nau_py.model.node import Node
from nau_py.syntax.xml import format_xml
from nau_py.syntax.yaml import format_yaml


def format_node(node: Node, registry: Registry, style: str) -> str:
    """Write a project file or library in ``style`` (``xml`` or ``yaml``)."""
    tag = "materialLib" if isinstance(node, MaterialLibrary) else "project"
    element = make_element(node, tag, registry)
    if style == "yaml":
        return format_yaml(to_yaml(element, type(node), registry))
    return format_xml(element)
