"""Controls of the viewer: values of cameras, lights, materials, passes and the interface."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from math import isfinite
from typing import Any

from nau_py.model.attribute import Attribute
from nau_py.model.linked import Project
from nau_py.model.mask import MaskPass
from nau_py.model.node import Configured, Node
from nau_py.model.pipeline import Pipeline
from nau_py.model.raytrace import RaytracePass
from nau_py.model.schema import schema_of
from nau_py.model.values import Scalar
from nau_py.run.parameters import parameters

Values = dict[str, tuple[Scalar, ...]]
"""Key of a control to its value."""
_CAMERA = ("POSITION", "VIEW", "LOOK_AT_POINT", "UP", "FOV", "NEAR", "FAR", "APERTURE")
_CAMERA_ALSO = ("FOCUS_DISTANCE", "LEFT", "RIGHT", "BOTTOM", "TOP")
_TRACE = ("RAYS_PER_PIXEL", "MAX_DEPTH", "SAMPLER", "TARGET_ERROR", "LIGHT_SAMPLES")
COLOURS = ("DIFFUSE", "SPECULAR", "EMISSION", "AMBIENT", "SHININESS")
_TYPES = ("RENDERER", "PASS", "CAMERA", "LIGHT", "VIEWPORT", "COLOR")
"""Object types whose attributes can be changed while a project runs."""
_RANGE = re.compile(r"\b(min|max|step)\s*=\s*(-?[\d.eE+-]+)")


@dataclass(frozen=True, slots=True)
class Control:
    """One thing to change. ``key``: ``TYPE|object|attribute``. ``kind``: number, whole, flag,
    choice, vector or colour. ``saved``: whether a file of the project can hold it."""

    key: str
    group: str
    label: str
    kind: str
    value: tuple[Scalar, ...]
    minimum: float | None = None
    maximum: float | None = None
    choices: tuple[str, ...] = ()
    saved: bool = True
    doc: str = ""

    def data(self) -> dict[str, Any]:
        return asdict(self)


def key_of(type_: str, context: str, component: str) -> str:
    return f"{type_}|{context}|{component}"


def parts_of(key: str) -> tuple[str, str, str]:
    """(type, object, attribute) of a key."""
    type_, _, rest = key.partition("|")
    context, _, component = rest.rpartition("|")
    return type_, context, component


def controls(project: Project, pipeline: Pipeline) -> list[Control]:
    """List the controls of a project while ``pipeline`` is shown, the interface first."""
    found: dict[str, Control] = {}
    for control in (
        *_interface(project),
        *_passes(project, pipeline),
        *_cameras(project),
        *_lights(project),
        *_materials(project),
    ):
        found.setdefault(control.key, control)
    return list(found.values())


def _control(
    attribute: Attribute, key: str, group: str, value: tuple[Scalar, ...], label: str = ""
) -> Control | None:
    kind = _kind(attribute)
    if kind is None or attribute.readonly:
        return None
    return Control(
        key,
        group,
        label or attribute.name,
        kind,
        value,
        attribute.minimum,
        attribute.maximum,
        attribute.values,
        doc=attribute.doc,
    )


def _kind(attribute: Attribute) -> str | None:
    type_ = attribute.type
    if attribute.values:
        return "choice"
    if type_.is_boolean and type_.components == 1:
        return "flag"
    if not type_.is_number:
        return None
    if type_.components > 1:
        return "colour" if attribute.keys == "rgba" else "vector"
    return "whole" if type_.is_integer else "number"


def _own(project: Project, type_: str) -> list[str]:
    """Attributes that the project itself adds to a type."""
    return [a.name or "" for a in project.assets.attributes if a.type == type_]


def _of_node(
    project: Project, node: Configured, type_: str, group: str, context: str, names: list[str]
) -> Iterator[Control]:
    set_ = project.registry[type_]
    for name in dict.fromkeys(names):
        attribute = set_.get(name)
        if attribute is not None:
            value = project.value(node, type_, name)
            made = _control(attribute, key_of(type_, context, name), group, value)
            if made is not None and len(made.value) == attribute.type.components:
                yield made


def _cameras(project: Project) -> Iterator[Control]:
    own = _own(project, "CAMERA")
    for camera in project.assets.cameras:
        inline = camera.projection.settings if camera.projection else {}
        given = [*camera.settings, *inline]
        pose = "LOOK_AT_POINT" if "LOOK_AT_POINT" in given else "VIEW"
        hidden = {"LOOK_AT_POINT", "VIEW"} - {pose}
        names = [n for n in (*_CAMERA, *[g for g in given if g in _CAMERA_ALSO]) if n not in hidden]
        group, name = f"Camera {camera.name}", camera.name or ""
        where = camera.projection
        if where is not None:
            settled = [n for n in names if n in where.settings]
            yield from _of_node(project, where, "CAMERA", group, name, settled)
            names = [n for n in names if n not in settled]
        yield from _of_node(project, camera, "CAMERA", group, name, [*names, *own])


def _lights(project: Project) -> Iterator[Control]:
    shown = [a.name for a in project.registry["LIGHT"] if a.name != "ENABLED"]
    for light in project.assets.lights:
        name = light.name or ""
        yield from _of_node(project, light, "LIGHT", f"Light {name}", name, shown)


def _materials(project: Project) -> Iterator[Control]:
    own = _own(project, "COLOR")
    for library in project.libraries[1:]:
        for material in library.materials:
            if material.color is not None:
                names = [*COLOURS, *material.color.settings, *own]
                context = f"{library.name}::{material.name}"
                group = f"Material {context}"
                yield from _of_node(project, material.color, "COLOR", group, context, names)


def model_material(
    project: Project, name: str, colours: dict[str, tuple[float, ...]]
) -> list[Control]:
    """List the controls of a material of a model: no file of the project can hold them."""
    found = []
    for component in COLOURS:
        attribute = project.registry["COLOR"].get(component)
        if attribute is None or component not in colours:
            continue
        key = key_of("COLOR", name, component)
        group = f"Material {name.partition('::')[2]} (of a model)"
        made = _control(attribute, key, group, tuple(colours[component]))
        if made is not None:
            found.append(Control(**made.data() | {"saved": False}))
    return found


def _passes(project: Project, pipeline: Pipeline) -> Iterator[Control]:
    own = _own(project, "PASS")
    for pass_ in pipeline.passes:
        context, group = f"{pipeline.name}#{pass_.name}", f"Pass {pass_.name}"
        if isinstance(pass_, RaytracePass):
            given = [n for n in pass_.settings if n != "ACCUMULATE"]
            names = [*_TRACE, *given, *own]
            yield from _of_node(project, pass_, "PASS", group, context, names)
        elif own:
            yield from _of_node(project, pass_, "PASS", group, context, own)
        if isinstance(pass_, MaskPass):
            yield from _selectors(pass_, group)


def _selectors(pass_: MaskPass, group: str) -> Iterator[Control]:
    for index, node in enumerate(pass_.all_selectors()):
        for attribute in schema_of(type(node)).attributes:
            value, name = attribute.of(node), attribute.name
            if isinstance(value, int | float):
                kind = "whole" if attribute.type.is_integer else "number"
                key = key_of("MASK", f"{pass_.name}#{index}", name)
                label = f"{name} ({node.tag} {index + 1})"
                yield Control(key, group, label, kind, (value,), doc=attribute.doc)


def _interface(project: Project) -> Iterator[Control]:
    for parameter in parameters(project):
        node, attribute = parameter.node, parameter.attribute
        type_, context = node.type or "", node.context or "CURRENT"
        if type_ not in _TYPES or (type_, context) == ("CAMERA", "CURRENT"):
            continue
        value = _interface_value(project, type_, context, attribute)
        key = key_of(type_, context, attribute.name)
        made = _control(attribute, key, "Interface", value, parameter.name)
        if made is None:
            continue
        limits = {k: float(v) for k, v in _RANGE.findall(node.def_ or "")}
        changes: dict[str, Any] = {"saved": home(project, key) is not None}
        if node.mode == "COLOR":
            changes["kind"] = "colour"
        for word, name in (("min", "minimum"), ("max", "maximum")):
            if word in limits:
                changes[name] = limits[word]
        yield Control(**made.data() | changes)


def _interface_value(
    project: Project, type_: str, context: str, attribute: Attribute
) -> tuple[Scalar, ...]:
    found = home(project, key_of(type_, context, attribute.name))
    if isinstance(found, Configured):
        return project.value(found, type_, attribute.name)
    default = project.default(type_, attribute.name)
    return default or (0.0,) * attribute.type.components


def home(project: Project, key: str) -> Node | None:
    """Return the node whose file holds the value of a control; None if no file does."""
    type_, context, component = parts_of(key)
    if type_ == "CAMERA":
        camera = next((c for c in project.assets.cameras if c.name == context), None)
        inline = camera.projection if camera is not None else None
        return inline if inline is not None and component in inline.settings else camera
    if type_ == "LIGHT":
        named = [n for n in project.assets.lights if n.name == context]
        given = [n for n in named if component in n.settings]  # of one name, the last one counts
        return given[-1] if given else next(iter(named), None)
    if type_ == "VIEWPORT":
        return next((v for v in project.assets.viewports if v.name == context), None)
    if type_ == "COLOR":
        found = project.material(*context.partition("::")[::2])
        return found[1].color if found is not None else None
    if type_ == "PASS":
        pipeline, _, name = context.partition("#")
        passes = (project.pipeline(pipeline) or Pipeline()).passes
        return next((p for p in passes if p.name == name), None)
    if type_ == "MASK":
        return _selector(project, context)
    own = project.assets.attributes  # of the other types, the default of a user attribute
    return next((a for a in own if (a.type, a.name) == (type_, component)), None)


def _selector(project: Project, context: str) -> Node | None:
    name, _, index = context.rpartition("#")
    for pipeline in project.pipelines:
        for pass_ in pipeline.passes:
            if isinstance(pass_, MaskPass) and pass_.name == name:
                listed = pass_.all_selectors()
                if index.isdigit() and int(index) < len(listed):
                    return listed[int(index)]
    return None


def check_value(control: Control, parts: Any) -> tuple[Scalar, ...]:
    """Return a value that a control can take. Raises :class:`ValueError` with the legal ones."""
    listed = list(parts) if isinstance(parts, list | tuple) else [parts]
    if len(listed) != len(control.value):
        raise ValueError(f"{control.label} takes {len(control.value)} values, not {len(listed)}")
    if control.kind == "choice":
        if listed[0] not in control.choices:
            raise ValueError(f"{control.label} is one of {', '.join(control.choices)}")
        return (str(listed[0]),)
    if control.kind == "flag":
        return (bool(listed[0]),)
    found: list[Scalar] = []
    for part in listed:
        number = float(part)
        if not isfinite(number):
            raise ValueError(f"{control.label}: {part} is not finite")
        low, high = control.minimum, control.maximum
        if (low is not None and number < low) or (high is not None and number > high):
            least = "" if low is None else f" from {low:g}"
            most = "" if high is None else f" to {high:g}"
            raise ValueError(f"{control.label} is {number:g}; legal is{least}{most}")
        found.append(int(number) if control.kind == "whole" else number)
    return tuple(found)
