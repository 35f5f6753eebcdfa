"""What the data of a pass calls for. Nothing is rendered: an effect that is called for here is
possible; whether it is in view, a frame tells."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from nau_py.diagnostics.location import Location
from nau_py.effects.facts import MaterialFacts, PassFacts, ProgramFacts
from nau_py.model.effects import EFFECTS

ALPHA_THRESHOLD = 0.25
"""Alpha up to which ``alpha_test`` ignores a hit."""
LIT = ("lambert", "phong", "blinn_phong", "direct", "path", "fluorescent")
PATHS = ("path", "fluorescent")
SPECULAR = ("mirror", "glossy", "dielectric")
ALPHA = ("alpha_test", "stochastic_alpha", "transparency")
RAY_KINDS = ("shadow", "reflection", "refraction", "occlusion", "indirect")
"""Effects that are a kind of ray of the same name."""


@dataclass(frozen=True, slots=True)
class Cause:
    """What calls for an effect. ``material``: its name, empty for lights and cameras."""

    what: str
    location: Location
    material: str = ""
    chain: bool = False
    """Whether a built-in specular program sends the rays: their chains end at a small weight."""


def asks_alpha(material: MaterialFacts, program: ProgramFacts) -> bool:
    """Whether a built-in any-hit program can ignore a hit on the material, or let a part through.

    ``alpha_test`` does where alpha is at most 0.25, the others where it is below 1. Interpolated
    alpha is never below the least of the texels.
    """
    if program.proc == "alpha_test":
        return material.texture_alpha <= ALPHA_THRESHOLD
    return program.proc in ALPHA and material.alpha < 1.0


def opaque(facts: PassFacts) -> frozenset[int]:
    """Materials, by index, whose built-in any-hit programs accept every hit: asking them changes
    nothing."""
    return frozenset(
        k
        for k, m in enumerate(facts.materials)
        if any(p.proc in ALPHA for p in m.any_hit) and not any(asks_alpha(m, p) for p in m.any_hit)
    )


def called_for(facts: PassFacts) -> dict[str, list[Cause]]:
    """For each effect, what calls for it; an empty list where nothing does."""
    found: dict[str, list[Cause]] = {name: [] for name in EFFECTS}

    def add(
        effect: str, what: str, where: Location, material: str = "", chain: bool = False
    ) -> None:
        if not any(c.what == what for c in found[effect]):
            found[effect].append(Cause(what, where, material, chain))

    specular: list[tuple[MaterialFacts, ProgramFacts]] = []
    emitting = [m for m in facts.materials if m.strength("EMISSION") > 0]
    for material, program in facts.programs:
        name = f"material '{material.name}'" if material else program.label
        own = material.name if material else ""
        for kind in program.sends & set(RAY_KINDS):
            add(kind, f"{name} by {program.label}" if material else name, program.location, own)
        if material is None:
            continue
        if program.proc in SPECULAR:
            shows = program.proc == "dielectric" or material.strength("SPECULAR") > 0
            if shows:
                add("reflection", name, program.location, own, chain=True)
                specular.append((material, program))
            if program.proc == "dielectric":
                add("refraction", name, program.location, own, chain=True)
        if asks_alpha(material, program) or (program in material.any_hit and not program.proc):
            add("transparency", name, program.location, own)
        if program.proc == "ambient_occlusion":
            add("occlusion", name, program.location, own)
        if program.proc in LIT:
            _lit(facts, program, add, bool(emitting))
        if program.proc in PATHS and facts.max_depth > 1:
            add("indirect", name, program.location, own)
            matrix = [f"FLUORESCENCE_{band}" for band in ("RED", "GREEN", "BLUE")]
            if program.proc == "fluorescent" and any(material.strength(a) > 0 for a in matrix):
                add("fluorescence", name, program.location, own)
    if found["indirect"] and emitting:
        for material, program in specular:
            add("caustics", f"material '{material.name}'", program.location, material.name)
    generates = facts.generate is not None and facts.generate.proc == "thin_lens"
    if generates and facts.aperture > 0 and facts.camera_location is not None:
        add("depth_of_field", f"camera '{facts.camera}'", facts.camera_location)
    return found


def _lit(
    facts: PassFacts,
    program: ProgramFacts,
    add: Callable[[str, str, Location], None],
    emitting: bool,
) -> None:
    """Shadows and penumbrae of the lights that a lit program looks at."""
    simple = program.proc in ("lambert", "phong", "blinn_phong")
    shadows = any(t.lower() == "shadow" for t in facts.ray_types) or not simple
    for light in facts.lights[:1] if simple else facts.lights:
        if shadows:
            add("shadow", f"light '{light.name}'", light.location)
        if light.has_area:
            add("penumbra", f"light '{light.name}'", light.location)
    if program.proc in PATHS and emitting and facts.max_depth > 1:
        add("shadow", "emissive triangles", program.location)
