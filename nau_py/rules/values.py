"""V and S: values, enums, ranges, required attributes, unknown elements and attributes."""

from __future__ import annotations

from collections.abc import Iterator

from nau_py.diagnostics.catalogue import ERROR, WARNING, rule
from nau_py.diagnostics.diagnostic import Change, Diagnostic, Fix, Part
from nau_py.diagnostics.location import Location
from nau_py.diagnostics.suggest import find_near, format_names, suggest_fix, suggest_name
from nau_py.model.attribute import Attribute
from nau_py.model.linked import Project
from nau_py.model.node import Node, Setting
from nau_py.model.passes import Pass
from nau_py.model.physics import PhysicsMaterial
from nau_py.model.raytrace import VERTEX_ATTRIBUTES
from nau_py.model.scene import BufferGeometry
from nau_py.model.schema import schema_of
from nau_py.model.texture import Texture
from nau_py.model.walk import walk_nodes
from nau_py.rules.registry import LintContext, check
from nau_py.syntax.element import Element

V005 = rule(
    "V005",
    ERROR,
    "Unknown enum value",
    "The text is not one of the values that the attribute takes; letter case counts.",
    "<DEPTH_FUNC value='LESSEQUAL'/>",
    "<DEPTH_FUNC value='LEQUAL'/>",
)
V006 = rule(
    "V006",
    ERROR,
    "Out of range",
    "The number is outside the range of the attribute.",
    "<COLOR r='2' g='1' b='1'/>",
    "<COLOR r='1' g='1' b='1'/>",
)
V007 = rule(
    "V007",
    ERROR,
    "Undefined constant",
    "The text is no number, and the project has no constant or alias of that name.",
    "<SIZE width='shadow' height='512'/>",
    "<constant name='shadow' value='512'/> … <SIZE width='shadow' height='512'/>",
)
S001 = rule(
    "S001",
    ERROR,
    "Unknown element",
    "Nothing reads an element of that name here.",
    "<DEPTH_TESTS value='true'/>",
    "<DEPTH_TEST value='true'/>",
)
S002 = rule(
    "S002",
    ERROR,
    "Unknown attribute",
    "Nothing reads an attribute of that name here, and Nau rejects it.",
    "<project name='P' widht='512'>",
    "<project name='P' width='512'>",
)
S003 = rule(
    "S003",
    WARNING,
    "Ignored",
    "Nau reads the file but never uses this; it has no effect.",
    "<pipeline name='P' default='true'>",
    "<pipelines default='P'>",
)
S004 = rule(
    "S004",
    ERROR,
    "Missing attribute",
    "The element needs the attribute.",
    "<light/>",
    "<light name='Sun'/>",
)
S005 = rule(
    "S005",
    ERROR,
    "No pipeline",
    "A project without <pipelines> has nothing to run.",
    "<project name='P'></project>",
    "<project name='P'><pipelines><pipeline name='A'/></pipelines></project>",
)

_STRICT = {"project", "scenes", "preProcess", "postProcess"}
"""Elements whose unknown attributes Nau rejects; elsewhere it ignores them."""
_IGNORED_CHILDREN = {
    "assets": {"stringAliases", "events"},
}
_LENIENT = {"material", "materialLib", "materiallib", "sensor", "interface", "window", "pipeline"}
"""Elements whose unknown children Nau ignores."""
_STRUCTURAL = {
    "testScript",
    "preProcess",
    "postProcess",
    "mode",
    "scene",
    "scenes",
    "lights",
    "viewport",
    "viewports",
    "renderTarget",
    "materialMaps",
    "injectionMaps",
    "texture",
    "material",
    "materials",
    "rays",
    "hits",
    "rayCount",
    "rtRayTypes",
    "rtVertexAttributes",
    "rtEntryPoint",
    "rtDefaultMaterial",
    "preScript",
    "postScript",
    "rtGlobalParams",
    "rtMaterialMap",
}


@check
def check_unknown_names(context: LintContext) -> Iterator[Diagnostic]:
    """Report attributes and elements that the class of a node does not declare."""
    for node in walk_nodes(context.project):
        attributes = schema_of(type(node)).names(context.project.registry)
        for key, value in node.unknown_attributes.items():
            if key in attributes:
                continue  # its value did not convert: V001 reports it
            strict = node.tag in _STRICT
            known = (
                f"; <{node.tag}> takes {format_names(attributes)}{suggest_name(key, attributes)}"
            )
            message = f"attribute '{key}' (='{value}') of <{node.tag}> is unknown"
            where = node.where(key)
            fixes = suggest_fix(where, key, attributes, Part.ATTRIBUTE)
            if strict:
                yield S002.at(where, message + known, fixes=fixes)
            else:
                fixes += _remove(where, key, safe=find_near(key, attributes) is None)
                yield S003.at(where, message + " and ignored" + known, fixes=fixes)
        for tag, listed in node.unknown_children.items():
            for child in listed:
                yield from _unknown_child(context.project, node, tag, child)
        for wrapper, element in node.partial.items():
            yield from _left_over(context.project, node, wrapper, element)


def _remove(where: Location, key: str, safe: bool) -> tuple[Fix, ...]:
    """Make the fix that removes an ignored attribute. It is safe if the name is no misspelling."""
    return (Fix(f"Remove '{key}'", (Change(where, Part.ATTRIBUTE, key, ""),), safe),)


def _unknown_child(project: Project, node: Node, tag: str, child: Element) -> Iterator[Diagnostic]:
    schema = schema_of(type(node))
    tags = schema.tags(project.registry)
    if tag in tags or schema.setting(tag, project.registry) is not None:
        return  # repeated or unreadable: X004, V001, V003 or V004 report it
    if isinstance(node, Pass) and tag in project.registry["PASS"]:
        return  # a parameter of another pass class: P007
    written = child.source_tag
    ignored = _IGNORED_CHILDREN.get(node.tag, set())
    from_file = isinstance(node, Texture) and node.filename is not None
    if (
        from_file
        or tag in ignored
        or (node.tag in _LENIENT and not isinstance(node, PhysicsMaterial))
        or (node.tag == "pass" and tag in _STRUCTURAL)
    ):
        yield S003.at(child.location, f"element <{written}> of <{node.tag}> is ignored")
        return
    if isinstance(node, BufferGeometry) and tag in (*VERTEX_ATTRIBUTES, "index"):
        return
    known = f"<{node.tag}> takes {format_names(tags, 40)}{suggest_name(written, tags)}"
    message = f"element <{written}> of <{node.tag}> is unknown; {known}"
    fixes = suggest_fix(child.location, written, tags, Part.ELEMENT)
    yield S001.at(child.location, message, fixes=fixes)


def _left_over(
    project: Project, node: Node, wrapper: str, element: Element
) -> Iterator[Diagnostic]:
    inside = list(schema_of(type(node)).by_tag[wrapper].classes)
    name = element.source_tag
    for key, value in element.attributes.items():
        message = f"attribute '{key}' (='{value}') of <{name}> is unknown and ignored"
        where = element.where(key)
        yield S003.at(where, message, fixes=_remove(where, key, safe=True))
    for child in element.children:
        known = f"<{name}> takes {format_names(inside)}{suggest_name(child.source_tag, inside)}"
        message = f"element <{child.source_tag}> of <{name}> is unknown; {known}"
        fixes = suggest_fix(child.location, child.source_tag, inside, Part.ELEMENT)
        yield S001.at(child.location, message, fixes=fixes)


@check
def check_attribute_values(context: LintContext) -> Iterator[Diagnostic]:
    """Check required attributes, and values of enumerated ones."""
    for node in walk_nodes(context.project):
        for attribute in schema_of(type(node)).attributes:
            key, value = attribute.name, attribute.of(node)
            if value is None:
                if attribute.required and key not in node.unknown_attributes:
                    yield S004.at(node.location, f"<{node.tag}> needs the attribute '{key}'")
            elif attribute.values and value not in attribute.values:
                known = list(attribute.values)
                yield V005.at(
                    node.where(key),
                    f"attribute '{key}' of <{node.tag}> is '{value}'; it takes "
                    f"{format_names(known, 20)}{suggest_name(str(value), known)}",
                    fixes=suggest_fix(node.where(key), str(value), known),
                )
            elif isinstance(value, str) and attribute.constant:
                yield from _constant(
                    context.project, value, f"'{key}' of <{node.tag}>", node.where(key)
                )


def _constant(project: Project, name: str, what: str, where: Location) -> Iterator[Diagnostic]:
    known = list(project.constants)
    if name not in known:
        yield V007.at(
            where,
            f"{what} is '{name}': no number, and no constant of that name; the project defines "
            f"{format_names(known)}{suggest_name(name, known)}",
            fixes=suggest_fix(where, name, known),
        )


@check
def check_settings(context: LintContext) -> Iterator[Diagnostic]:
    """Check enums, ranges and constants of child tags and inline attributes."""
    for node in walk_nodes(context.project):
        schema = schema_of(type(node))
        for part in [*schema.settings, *schema.inline]:
            for tag, setting in part.of(node).items():
                attribute = part.known(context.project.registry).get(tag)
                if attribute is not None:
                    yield from _setting(context.project, node, tag, setting, attribute)


def _setting(
    project: Project, node: Node, tag: str, setting: Setting, attribute: Attribute
) -> Iterator[Diagnostic]:
    what = f"<{tag}> of <{node.tag}>"
    where = setting.location
    for key, value in setting.extra.items():
        yield S003.at(where, f"attribute '{key}' (='{value}') of {what} is unknown and ignored")
    if attribute.values and setting.parts[0] not in attribute.values:
        known = list(attribute.values)
        yield V005.at(
            where,
            f"{what} is '{setting.parts[0]}'; it takes {format_names(known, 40)}"
            f"{suggest_name(str(setting.parts[0]), known)}",
            fixes=suggest_fix(where, str(setting.parts[0]), known),
        )
    if not attribute.type.is_number:
        return
    low, high = attribute.minimum, attribute.maximum
    for part in setting.parts:
        if isinstance(part, str):
            yield from _constant(project, part, what, where)
            continue
        if (low is not None and part < low) or (high is not None and part > high):
            yield V006.at(where, f"{what} is {part:g}; it must be {_limits(low, high)}")


def _limits(low: float | None, high: float | None) -> str:
    """Return the legal numbers in words. One of the bounds is given."""
    if low is None:
        return f"at most {high:g}"
    return f"at least {low:g}" if high is None else f"from {low:g} to {high:g}"


@check
def check_pipelines_exist(context: LintContext) -> Iterator[Diagnostic]:
    """Check that a project has a pipeline to run."""
    project = context.project
    if project.file.name is not None and not project.pipelines:
        yield S005.at(project.file.location, f"project '{project.name}' has no pipeline to run")
