"""Effects on demand in a raytrace pass: those that its scene calls for, and their report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from nau_py.effects.analysis import (
    description_of,
    find_causes,
    find_opaque_materials,
    has_alpha_test,
)
from nau_py.effects.decision import Decision, decide_effects
from nau_py.effects.facts import (
    LightFacts,
    MaterialFacts,
    PassFacts,
    ProgramFacts,
    find_sent_kinds,
)
from nau_py.model.effects import ALL, AUTO, parse_effects
from nau_py.model.linked import Project
from nau_py.model.raytrace import BUILTIN, Program, RayMaterial, RaytracePass
from nau_py.passes.frame import FrameContext
from nau_py.raytrace.programs.catalogue import EFFECT_ATTRIBUTES
from nau_py.raytrace.programs.description import ANY_HIT, CLOSEST_HIT, MISS
from nau_py.raytrace.programs.neighbours import list_imported_functions
from nau_py.raytrace.programs.source import stand_in
from nau_py.raytrace.tracing.counts import RayCounts
from nau_py.raytrace.tracing.materials import TracedMaterial
from nau_py.raytrace.tracing.simulated import NEGLIGIBLE, SimulatedEffects
from nau_py.scene.camera import CameraState
from nau_py.scene.lights import LightState


def _describe_program(project: Project, node: Program, built_in: bool = True) -> ProgramFacts:
    """Return the facts of a program; the source of a project's program is read, not run."""
    proc = node.proc or ""
    if node.file == BUILTIN:
        return ProgramFacts(proc, node.location, proc if built_in else "")
    path = stand_in(project.folder, node.file or "")
    sends: frozenset[str] = frozenset()
    if path is not None:
        functions = [(path, proc), *list_imported_functions(path)]
        sends = sends.union(*(find_sent_kinds(file, name) for file, name in functions))
    return ProgramFacts(f"'{proc}' of {node.file}", node.location, "", sends)


def collect_facts(
    pass_: RaytracePass,
    project: Project,
    entries: Sequence[RayMaterial | None],
    materials: Sequence[TracedMaterial],
    lights: Sequence[LightState],
    camera: CameraState,
    max_depth: int,
) -> PassFacts:
    """Return the facts of a pass in a frame. ``entries``: the programs of each of ``materials``."""
    found = []
    for entry, material in zip(entries, materials):
        programs: dict[str, tuple[ProgramFacts, ...]] = {}
        for kind in (CLOSEST_HIT, ANY_HIT):
            nodes = [entry.program(t, kind) for t in pass_.ray_types] if entry else []
            programs[kind] = tuple(_describe_program(project, n) for n in nodes if n is not None)
        texture = material.textures.get(0)
        found.append(
            MaterialFacts(
                material.name,
                programs[CLOSEST_HIT],
                tuple(p for p in programs[ANY_HIT] if not _is_geometric(p)),
                {name: material.colour(name) for name in EFFECT_ATTRIBUTES},
                texture.least_alpha if texture is not None else 1.0,
            )
        )
    default = pass_.rtDefaultMaterial
    misses = [default.program(t, MISS) for t in pass_.ray_types] if default else []
    entry_point = pass_.rtEntryPoint
    generate = entry_point.rayGen if entry_point else None
    own = next((n for n in project.assets.cameras if n.name == camera.name), None)
    places = {n.name: n.location for n in project.assets.lights}
    return PassFacts(
        tuple(found),
        tuple(LightFacts(s.name, places.get(s.name, pass_.location), _has_area(s)) for s in lights),
        camera.name,
        own.location if own is not None else pass_.location,
        float(camera.values["APERTURE"]),
        _describe_program(project, generate) if generate is not None else None,
        tuple(_describe_program(project, n, built_in=False) for n in misses if n is not None),
        tuple(pass_.ray_types),
        max_depth,
    )


def _is_geometric(program: ProgramFacts) -> bool:
    """Test if a built-in any-hit program is a matter of geometry, not of an effect."""
    description = description_of(program)
    return description is not None and description.geometric


def _has_area(light: LightState) -> bool:
    """Test if a light has an area, so that its shadows have penumbras."""
    shape = str(light.values["SHAPE"][0])
    if shape == "RECTANGLE":
        u, v = light.vector("EDGE_U"), light.vector("EDGE_V")
        return bool(abs(u).sum() > 0 and abs(v).sum() > 0)
    return shape in ("DISC", "SPHERE") and float(light.values["RADIUS"][0]) > 0


@dataclass(frozen=True, slots=True)
class EffectChoice:
    """Effects of a pass in a frame: the facts of the scene, a decision for each effect, and the
    settings that the kernels get."""

    facts: PassFacts
    decisions: list[Decision]
    simulated: SimulatedEffects


def choose_effects(
    pass_: RaytracePass,
    frame: FrameContext,
    entries: Sequence[RayMaterial | None],
    materials: Sequence[TracedMaterial],
    lights: Sequence[LightState],
    camera: CameraState,
    max_depth: int,
) -> EffectChoice:
    """Choose the effects to simulate: by the run's option, else by the project, else those that the
    scene calls for. ``entries``: nodes with the programs of each of ``materials``."""
    facts = collect_facts(pass_, frame.project, entries, materials, lights, camera, max_depth)
    node = frame.project.file.effects
    text, source = frame.session.options.effects, "--effects"
    if text is None:
        text, source = (node.simulate if node else None) or AUTO, "<effects>"
    everything = text.strip() == ALL
    negligible = 0.0 if everything else NEGLIGIBLE
    chosen = parse_effects(text)
    found = decide_effects(chosen, find_causes(facts), negligible, source)
    left = set() if chosen is None else {d.effect for d in found if not d.simulated}
    simulated = SimulatedEffects(
        skipped=frozenset(d.kind for d in found if d.kind and d.effect in left),
        opaque=frozenset() if everything else find_opaque_materials(facts),
        transparency="transparency" not in left,
        penumbra="penumbra" not in left,
        caustics="caustics" not in left,
        fluorescence="fluorescence" not in left,
        lens="depth_of_field" not in left,
        negligible=negligible,
    )
    return EffectChoice(facts, found, simulated)


def report_effects(
    choice: EffectChoice, counts: RayCounts, stages: Mapping[str, float]
) -> tuple[dict[str, Any], ...]:
    """Return the entries of the report (docs/report.md), one for each effect.

    ``ms_saved`` of rays that were not sent is estimated from the mean time of a ray of this pass.
    """
    facts, opaque_count = choice.facts, len(choice.simulated.opaque)
    seen = {facts.materials[k].name for k in counts.viewed if k < len(facts.materials)}
    sampling = sum(stages.get(name, 0.0) for name in ("trace", "shade"))
    each = sampling / max(sum(counts.rays.values()), 1)
    found = []
    for d in choice.decisions:
        kind = "continuation" if d.effect == "transparency" else d.kind
        saved = counts.skipped.get(d.kind, 0) if d.kind else 0
        data: dict[str, Any] = {
            "effect": d.effect,
            "called_for": d.called_for,
            "by": [{"what": c.what, "where": str(c.location)} for c in d.causes],
            "in_view": any(c.material in seen or not c.material for c in d.causes),
            "status": "simulated" if d.simulated else "left_out",
            "bound": d.bound,
            "rays": counts.rays.get(kind, 0) if kind else 0,
            "rays_saved": saved,
            "ms_saved": round(saved * each, 3),
        }
        if d.reason:
            data["reason"] = d.reason
        if d.effect == "transparency" and d.simulated and opaque_count:
            asked = sum(1 for m in facts.materials if has_alpha_test(m))
            data["note"] = (
                f"any-hit programs of {opaque_count} of {asked} materials are not asked: "
                "nothing of them is transparent (exact)"
            )
        found.append(data)
    return tuple(found)
