"""Conversion of old dialects: the ``optix*`` elements, old user attributes, old clears.

Works on elements, before binding. Positions and written tags are kept for messages.
"""

from __future__ import annotations

from nau_py.diagnostics.problem import Problem, ProblemKind
from nau_py.syntax.element import Element

_KINDS = {"Closest_Hit": "CLOSEST_HIT", "Any_Hit": "ANY_HIT", "Miss": "MISS"}
_WRAPPERS = {
    "optixVertexAttributes": "rtVertexAttributes",
    "optixMaterialAttributes": "rtMaterialParams",
    "optixGlobalAttributes": "rtGlobalParams",
    "optixInput": "rtInput",
    "optixOutput": "rtOutput",
    "optixGeometryProgram": "rtGeometryProgram",
}


def upgrade_dialect(root: Element, problems: list[Problem]) -> Element:
    """Replace old elements in the tree of ``root``, in place; each kind is reported once a pass."""
    for element in root.walk():
        if element.tag == "pass":
            _upgrade_pass(element, problems)
        elif element.tag == "attributes":
            for child in element.children:
                _upgrade_user_attribute(child, problems)
    return root


def _legacy(element: Element, detail: str, problems: list[Problem]) -> None:
    problems.append(
        Problem(ProblemKind.LEGACY, element.location, element.source_tag, detail=detail)
    )


def _rename(element: Element, tag: str) -> Element:
    element.written = element.source_tag
    element.tag = tag
    return element


def _move(element: Element, old: str, new: str) -> None:
    """Rename an attribute, keeping its place and position."""
    element.attributes = {new if k == old else k: v for k, v in element.attributes.items()}
    if old in element.attribute_locations:
        element.attribute_locations[new] = element.attribute_locations.pop(old)


def _upgrade_user_attribute(element: Element, problems: list[Problem]) -> None:
    if element.tag != "attribute" or "context" not in element.attributes:
        return
    if "data" in element.attributes or "type" not in element.attributes:
        return
    _legacy(element, "context= and type= are read as type= and data=", problems)
    _move(element, "type", "data")
    _move(element, "context", "type")


def _upgrade_pass(element: Element, problems: list[Problem]) -> None:
    if element.attributes.get("class") == "optix":
        element.attributes["class"] = "raytrace"
    children: list[Element] = []
    for child in element.children:
        if child.tag == "color" and set(child.attributes) <= {"clear", "enable"}:
            children += _old_clear(child, problems)
        elif child.tag.startswith("optix"):
            children.append(_upgrade_optix(child))
        else:
            children.append(child)
    element.children = children


def _old_clear(element: Element, problems: list[Problem]) -> list[Element]:
    _legacy(element, "clear= and enable= are read as COLOR_CLEAR and COLOR_ENABLE", problems)
    made = []
    for key, tag in (("clear", "COLOR_CLEAR"), ("enable", "COLOR_ENABLE")):
        if key in element.attributes:
            where = {"value": element.where(key)}
            made.append(
                Element(
                    tag, {"value": element.attributes[key]}, [], element.location, where, "color"
                )
            )
    return made


def _upgrade_optix(element: Element) -> Element:
    if element.tag in _WRAPPERS:
        _rename(element, _WRAPPERS[element.tag])
        for child in element.children:
            if child.tag == "valueof":
                _rename(child, "param")
                _move(child, "optixVar", "name")
            elif child.tag == "optixProgram":
                _rename(child, "rtProgram")
    elif element.tag == "optixEntryPoint":
        _rename(element, "rtEntryPoint")
        for child in element.children:
            kind = {"RayGen": "rayGen", "Exception": "exception"}.get(
                child.attributes.get("type", "")
            )
            if child.tag == "optixProgram" and kind:
                _rename(child, kind)
                del child.attributes["type"]
    elif element.tag == "optixDefaultMaterial":
        _by_ray_type(_rename(element, "rtDefaultMaterial"))
    elif element.tag == "optixMaterialMap":
        _rename(element, "rtMaterialMap")
        for child in element.children:
            if child.tag == "optixMap":
                _by_ray_type(_rename(child, "rtMap"))
    return element


def _by_ray_type(element: Element) -> None:
    """Group ``optixProgram ray=…`` children into ``rayType`` elements, in order of first use."""
    groups: dict[str, Element] = {}
    children: list[Element] = []
    for child in element.children:
        ray = child.attributes.get("ray")
        if child.tag != "optixProgram" or ray is None:
            children.append(child)
            continue
        group = groups.get(ray)
        if group is None:
            where = {"name": child.where("ray")}
            group = Element("rayType", {"name": ray}, [], child.location, where, child.tag)
            groups[ray] = group
            children.append(group)
        del child.attributes["ray"]
        kind = child.attributes.get("type", "")
        child.attributes["type"] = _KINDS.get(kind, kind)
        group.children.append(_rename(child, "rtProgram"))
    element.children = children
