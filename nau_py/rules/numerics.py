"""Q: quantities: numbers that give no picture, or not the expected one."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite

from nau_py.diagnostics.catalogue import ERROR, WARNING, rule
from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.diagnostics.location import Location
from nau_py.model.attributes import BUILT_IN
from nau_py.model.linked import Project
from nau_py.model.node import Configured, Setting
from nau_py.model.values import DataType
from nau_py.rules.registry import LintContext, check

Q001 = rule(
    "Q001",
    ERROR,
    "Near plane not in front of the eye",
    "A perspective projection divides by the distance of the near plane.",
    "<projection TYPE='PERSPECTIVE' NEAR='0' …/>",
    "<projection TYPE='PERSPECTIVE' NEAR='0.1' …/>",
)
Q002 = rule(
    "Q002",
    WARNING,
    "Light without area",
    "The shape has no size: the light is a point light, with hard shadows.",
    "<SHAPE value='SPHERE'/><RADIUS value='0'/>",
    "<SHAPE value='SPHERE'/><RADIUS value='0.5'/>",
)
Q003 = rule(
    "Q003",
    ERROR,
    "Colour or number that is not finite",
    "Colours and numbers of lights and materials must be finite.",
    "<DIFFUSE r='nan' g='1' b='1'/>",
    "<DIFFUSE r='0.5' g='1' b='1'/>",
)
Q004 = rule(
    "Q004",
    WARNING,
    "Negative value",
    "Colours of materials and lights, absorption and shininess must not be negative: a negative "
    "one removes light, or amplifies it along a ray.",
    "<ABSORPTION r='-1' g='0' b='0'/>",
    "<ABSORPTION r='1' g='0' b='0'/>",
)
Q005 = rule(
    "Q005",
    ERROR,
    "Material emits more light than it receives",
    "DIFFUSE and FLUORESCENCE of a band are fractions of the light that arrives in that band; "
    "their sum is at most 1.",
    "<DIFFUSE b='0.8' …/><FLUORESCENCE_BLUE r='0.5' …/>",
    "<DIFFUSE b='0.4' …/><FLUORESCENCE_BLUE r='0.5' …/>",
)
Q006 = rule(
    "Q006",
    ERROR,
    "Impossible lens",
    "The radius of a lens must not be negative, and its focus distance must be greater than 0.",
    "<APERTURE value='-1'/>",
    "<APERTURE value='0.05'/>",
)

BANDS = ("RED", "GREEN", "BLUE")
TOLERANCE = 1e-6


def _setting(nodes: list[Configured | None], name: str) -> tuple[Setting | None, Location | None]:
    """Return the last setting called ``name`` among ``nodes``, and its position."""
    found: Setting | None = None
    where: Location | None = None
    for node in nodes:
        if node is not None and name in node.settings:
            found, where = node.settings[name], node.settings[name].location
    return found, where


def _numbers(project: Project, setting: Setting) -> list[float]:
    return [project.number(p) for p in setting.parts]


@check
def check_cameras(context: LintContext) -> Iterator[Diagnostic]:
    """Check near planes and lenses."""
    project = context.project
    for camera in project.assets.cameras:
        nodes: list[Configured | None] = [camera, camera.projection]
        kind, _ = _setting(nodes, "TYPE")
        near, where = _setting(nodes, "NEAR")
        ortho = kind is not None and kind.parts[0] == "ORTHO"
        if near is not None and where is not None and not ortho:
            value = _numbers(project, near)[0]
            if not value > 0:
                yield Q001.at(
                    where,
                    f"NEAR of camera '{camera.name}' is {value:g}; it must be greater than 0",
                )
        for name, least in (("APERTURE", -1e-300), ("FOCUS_DISTANCE", 0.0)):
            setting, where = _setting(nodes, name)
            if setting is None or where is None:
                continue
            value = _numbers(project, setting)[0]
            if not (value > least and isfinite(value)):
                bound = "at least 0" if name == "APERTURE" else "greater than 0"
                yield Q006.at(
                    where, f"{name} of camera '{camera.name}' is {value:g}; it must be {bound}"
                )


@check
def check_lights(context: LintContext) -> Iterator[Diagnostic]:
    """Check the colours and areas of lights."""
    project = context.project
    for light in project.assets.lights:
        label = f"light '{light.name}'"
        yield from _sound(project, light, label, ("COLOR", "AMBIENT"))
        shape = str(project.value(light, "LIGHT", "SHAPE")[0])
        where = light.settings["SHAPE"].location if "SHAPE" in light.settings else light.location
        if shape in ("SPHERE", "DISC"):
            radius = float(project.value(light, "LIGHT", "RADIUS")[0])
            if not radius > 0:
                yield Q002.at(
                    where,
                    f"{label}: a {shape} of RADIUS {radius:g} has no area; it acts as a point",
                )
        if shape == "RECTANGLE":
            u, v = (
                [float(x) for x in project.value(light, "LIGHT", name)[:3]]
                for name in ("EDGE_U", "EDGE_V")
            )
            cross = (
                u[1] * v[2] - u[2] * v[1],
                u[2] * v[0] - u[0] * v[2],
                u[0] * v[1] - u[1] * v[0],
            )
            if not any(cross):
                yield Q002.at(where, f"{label}: EDGE_U and EDGE_V of its RECTANGLE span no area")


@check
def check_materials(context: LintContext) -> Iterator[Diagnostic]:
    """Check the colours of library materials, and the energy of fluorescence."""
    project = context.project
    names = [a.name for a in BUILT_IN["COLOR"] if a.type is not DataType.INT]
    for library in project.libraries:
        for material in library.materials:
            if material.color is None:
                continue
            label = f"material '{material.name}'"
            yield from _sound(project, material.color, label, names)
            yield from _fluorescence(project, material.color, label)


def _sound(
    project: Project, node: Configured, label: str, names: list[str] | tuple[str, ...]
) -> Iterator[Diagnostic]:
    for name in names:
        setting = node.settings.get(name)
        if setting is None:
            continue
        values = _numbers(project, setting)
        if not all(isfinite(v) for v in values):
            listed = ", ".join(f"{v:g}" for v in values)
            yield Q003.at(setting.location, f"{label}: {name} is {listed}; numbers are expected")
        elif any(v < 0 for v in values):
            least = min(values)
            yield Q004.at(setting.location, f"{label}: {name} has the negative value {least:g}")


def _fluorescence(project: Project, node: Configured, label: str) -> Iterator[Diagnostic]:
    diffuse = [float(v) for v in project.value(node, "COLOR", "DIFFUSE")]
    for index, band in enumerate(BANDS):
        name = f"FLUORESCENCE_{band}"
        if name not in node.settings:
            continue
        emitted = [float(v) for v in project.value(node, "COLOR", name)[:3]]
        total = diffuse[index] + sum(emitted)
        if total > 1 + TOLERANCE:
            yield Q005.at(
                node.settings[name].location,
                f"{label}: of {band.lower()} light it reflects {diffuse[index]:g} and re-emits "
                f"{sum(emitted):g}, together {total:g}; at most 1 is possible",
            )
