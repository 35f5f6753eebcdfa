"""R: references to undefined names."""

from __future__ import annotations

from collections.abc import Iterator

from nau_py.diagnostics.catalogue import ERROR, NOTE, WARNING, Rule, rule
from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.diagnostics.location import Location
from nau_py.diagnostics.suggest import format_names, suggest_fix, suggest_name
from nau_py.model.attributes import OBJECT_TYPES
from nau_py.model.library import DEFAULT_LIBRARY
from nau_py.model.linked import Project
from nau_py.model.maps import match_pattern
from nau_py.model.material import ValueOf
from nau_py.model.node import Node
from nau_py.model.passes import Pass, TargetReference
from nau_py.model.raytrace import RayVariable
from nau_py.model.references import (
    CONTEXTS,
    PLAIN_KINDS,
    list_known_names,
    list_pass_libraries,
    qualify_reference,
    walk_owned_nodes,
)
from nau_py.model.schema import AttributeField, schema_of
from nau_py.model.walk import walk_nodes
from nau_py.rules.registry import LintContext, check


def _reference(number: int, kind: str, bad: str, good: str) -> Rule:
    return rule(
        f"R{number:03}",
        ERROR,
        f"Undefined {kind}",
        f"The {kind} that is named is defined nowhere in the project or its libraries.",
        bad,
        good,
    )


RULES_BY_KIND: dict[str, Rule] = {
    kind: _reference(number, kind, bad, good)
    for number, (kind, bad, good) in enumerate(
        [
            ("scene", "<scene name='Plasa'/>", "<scene name='Plaza'/>"),
            ("camera", "<camera name='Eey'/>", "<camera name='Eye'/>"),
            ("light", "<light name='Son'/>", "<light name='Sun'/>"),
            ("viewport", "<viewport name='Windw'/>", "<viewport name='Window'/>"),
            ("library", "fromLibrary='Hybird'", "fromLibrary='Hybrid'"),
            ("material", "toMaterial='flat' (not in the library)", "toMaterial='lit'"),
            ("shader", "<shader name='phnog'>", "<shader name='phong'>"),
            ("state", "<state name='blnd'/>", "<state name='blend'/>"),
            ("texture", "<texture name='colour' UNIT='0'/>", "<texture name='color' UNIT='0'/>"),
            ("render target", "<renderTarget name='rast' …/>", "<renderTarget name='raster' …/>"),
            ("buffer", "<buffer name='ray'/>", "<buffer name='rays'/>"),
            ("texture array", "textureArray='Lib::arr'", "textureArray='Lib::array'"),
            ("pipeline", "<pipelines default='Rast'>", "<pipelines default='Raster'>"),
            ("pass", "<renderTarget sameas='pas1'/>", "<renderTarget sameas='pass1'/>"),
            ("object type", "type='CAMRA'", "type='CAMERA'"),
        ],
        start=1,
    )
}
R016 = rule(
    "R016",
    ERROR,
    "Undefined component",
    "The object type has no such attribute, and no user attribute adds it.",
    "type='LIGHT' component='COLOUR'",
    "type='LIGHT' component='COLOR'",
)
R017 = rule(
    "R017",
    ERROR,
    "Undefined context object",
    "A named context must be an object of the type.",
    "type='CAMERA' context='Eey'",
    "type='CAMERA' context='Eye'",
)
R018 = rule(
    "R018",
    WARNING,
    "Pattern matches no material",
    "The map has no effect: no material of the default library has such a name.",
    "<map toMaterial='Glas*'>",
    "<map toMaterial='Glass*'>",
)
R019 = rule(
    "R019",
    NOTE,
    "sameas of a pass that draws into the window",
    "The pass has no render target, so this one draws into the window too, as in Nau.",
    "<renderTarget sameas='toWindow'/>",
    "<renderTarget sameas='toTarget'/>",
)


class _Names:
    """Known names by kind, computed once a run."""

    def __init__(self, project: Project) -> None:
        self._project = project
        self._found: dict[str, list[str]] = {}

    def of(self, kind: str) -> list[str]:
        if kind not in self._found:
            self._found[kind] = list_known_names(self._project, kind)
        return self._found[kind]


@check
def check_references(context: LintContext) -> Iterator[Diagnostic]:
    """Check every attribute that names something."""
    names = _Names(context.project)
    for node, library in walk_owned_nodes(context.project):
        schema = schema_of(type(node))
        for attribute in schema.attributes:
            value = attribute.of(node)
            if attribute.ref and isinstance(value, str):
                yield from _attribute(context, names, node, library, attribute, value)
        for part in schema.settings:
            for tag, setting in part.of(node).items():
                found = part.known(context.project.registry).get(tag)
                if found is not None and found.reference:
                    yield from _name(
                        names,
                        found.reference,
                        str(setting.parts[0]),
                        setting.location,
                        f"<{tag}> of <{node.tag}>",
                    )


def _name(names: _Names, kind: str, value: str, where: Location, what: str) -> Iterator[Diagnostic]:
    known = names.of(kind)
    if value not in known:
        yield RULES_BY_KIND[kind].at(
            where,
            f"{what} names the {kind} '{value}', which is undefined; there is "
            f"{format_names(known)}{suggest_name(value, known)}",
            fixes=suggest_fix(where, value, known),
        )


def _attribute(
    context: LintContext,
    names: _Names,
    node: Node,
    library: str,
    attribute: AttributeField,
    value: str,
) -> Iterator[Diagnostic]:
    key = attribute.name
    where, what = node.where(key), f"attribute '{key}' of <{node.tag}>"
    kind = attribute.ref
    if kind in PLAIN_KINDS:
        yield from _name(names, kind, value, where, what)
        return
    given = getattr(node, attribute.library) if attribute.library else None
    if "::" not in value and given is not None and given not in names.of("library"):
        return  # the library is what is undefined
    buffers = names.of("buffer") if kind == "buffer" else ()
    qualified = qualify_reference(node, attribute, library, value, buffers)
    if kind == "material" and qualified.split("::")[0] in list_pass_libraries(context.project):
        return
    known = names.of(kind)
    if qualified in known:
        return
    if (
        kind == "material"
        and qualified.startswith(f"{DEFAULT_LIBRARY}::")
        and (context.materials is None or value in context.materials)
    ):
        return
    home = qualified.split("::")[0]
    local = [k.split("::", 1)[1] for k in known if k.startswith(f"{home}::")]
    short = qualified.split("::", 1)[1]
    yield RULES_BY_KIND[kind].at(
        where,
        f"{what} names the {kind} '{short}' of library '{home}', which is undefined; "
        f"it has {format_names(local)}{suggest_name(short, local)}",
        fixes=suggest_fix(where, short, local),
    )


@check
def check_components(context: LintContext) -> Iterator[Diagnostic]:
    """Check types, components and named contexts of uniform and program values."""
    project = context.project
    names = _Names(project)
    for node in walk_nodes(project):
        if not isinstance(node, ValueOf | RayVariable) or node.type is None:
            continue
        set_ = project.registry.get(node.type)
        if set_ is None or node.type not in OBJECT_TYPES:
            continue
        if node.component is not None and node.component not in set_:
            known = [a.name for a in set_]
            yield R016.at(
                node.where("component"),
                f"{node.type} has no component '{node.component}'; it has "
                f"{format_names(known, 40)}{suggest_name(node.component, known)}",
                fixes=suggest_fix(node.where("component"), node.component, known),
            )
        kind = CONTEXTS.get(node.type)
        object_name = node.context
        if not project.file.tag:
            continue  # a library alone: the project that loads it defines cameras and lights
        if kind and object_name not in (None, "CURRENT") and object_name not in names.of(kind):
            known = names.of(kind)
            yield R017.at(
                node.where("context"),
                f"context '{object_name}' is no {kind} of the project; there is "
                f"{format_names(known)}{suggest_name(str(object_name), known)}",
                fixes=suggest_fix(node.where("context"), str(object_name), known),
            )


@check
def check_patterns(context: LintContext) -> Iterator[Diagnostic]:
    """Report maps whose pattern matches no material, if the materials of models are known."""
    if context.materials is None:
        return
    known = sorted(context.materials)
    for pipeline in context.project.pipelines:
        for pass_ in pipeline.passes:
            listed = [(m, "toMaterial", m.toMaterial) for m in pass_.injectionMaps]
            maps: list[tuple[Node, str, str | None]] = [
                *listed,
                *((m, "fromMaterial", m.fromMaterial) for m in pass_.materialMaps),
            ]
            for node, key, pattern in maps:
                if pattern and not any(match_pattern(pattern, name) for name in known):
                    own = [k for k in known if not k.startswith("__")]
                    yield R018.at(
                        node.where(key),
                        f"'{pattern}' of pass '{pass_.name}' matches no material; there is "
                        f"{format_names(own, 30)}{suggest_name(pattern.rstrip('*'), own)}",
                        fixes=suggest_fix(node.where(key), pattern.rstrip("*"), own),
                    )


@check
def check_same_targets(context: LintContext) -> Iterator[Diagnostic]:
    """Report ``sameas`` of a pass without a render target."""
    by_name: dict[str | None, Pass] = {}
    for pipeline in context.project.pipelines:
        for pass_ in pipeline.passes:
            target: TargetReference | None = pass_.renderTarget
            if target is not None and target.sameas in by_name:
                other = by_name[target.sameas]
                if other.renderTarget is None:
                    yield R019.at(
                        target.where("sameas"),
                        f"pass '{other.name}', named by pass '{pass_.name}', has no render target",
                    )
            by_name[pass_.name] = pass_
