"""Find the effects that the scene of a pass calls for. Nothing is rendered: an effect that is found
is possible; only a frame shows if it is in view.

The facts of built-in programs are those of their descriptions
(:mod:`nau_py.raytrace.programs.builtin`).
"""

from __future__ import annotations

from dataclasses import dataclass

from nau_py.diagnostics.location import Location
from nau_py.effects.facts import MaterialFacts, PassFacts, ProgramFacts
from nau_py.model.effects import EFFECTS
from nau_py.raytrace.programs.catalogue import BUILTIN_PROGRAMS
from nau_py.raytrace.programs.description import AlphaTest, BuiltInProgram, Effect, LightUse

RAY_KINDS = ("shadow", "reflection", "refraction", "occlusion", "indirect")
"""Effects that are a kind of ray of the same name."""


@dataclass(frozen=True, slots=True)
class Cause:
    """Part of a scene that calls for an effect: a material, a light or a camera."""

    what: str
    location: Location
    material: str = ""
    """Name of the material; empty for lights and cameras."""
    chain: bool = False
    """A built-in specular program sends the rays: their chains end at a small weight."""


class Causes:
    """The causes of each effect, in the order in which they are found."""

    def __init__(self) -> None:
        self.found: dict[str, list[Cause]] = {name: [] for name in EFFECTS}

    def add(self, effect: str, cause: Cause) -> None:
        """Add a cause, unless one with the same words is there."""
        if not any(known.what == cause.what for known in self.found[effect]):
            self.found[effect].append(cause)


def description_of(program: ProgramFacts) -> BuiltInProgram | None:
    """Return the description of a built-in program; None for a program of a file."""
    return BUILTIN_PROGRAMS.get(program.proc)


def alpha_test_of(program: ProgramFacts) -> AlphaTest | None:
    """Return the alpha test of a built-in any-hit program, or None."""
    found = description_of(program)
    return found.alpha if found else None


def ignores_hits(material: MaterialFacts, program: ProgramFacts) -> bool:
    """Test if a built-in any-hit program can ignore a hit on the material by its alpha, or let a
    part of the light pass. Interpolated alpha is never below the least of the texels."""
    test = alpha_test_of(program)
    if test is None:
        return False
    alpha = material.alpha if test.uses_diffuse else material.texture_alpha
    return alpha < 1.0 if test.above is None else alpha <= test.above


def has_alpha_test(material: MaterialFacts) -> bool:
    """Test if a built-in any-hit program of the material depends on alpha."""
    return any(alpha_test_of(p) for p in material.any_hit)


def find_opaque_materials(facts: PassFacts) -> frozenset[int]:
    """Return the indices of the materials whose built-in any-hit programs accept every hit: running
    them changes nothing."""
    return frozenset(
        k
        for k, m in enumerate(facts.materials)
        if has_alpha_test(m) and not any(ignores_hits(m, p) for p in m.any_hit)
    )


def find_causes(facts: PassFacts) -> dict[str, list[Cause]]:
    """Return the causes of each effect; an empty list for an effect that nothing calls for."""
    causes = Causes()
    specular: list[Cause] = []
    emitting = any(m.strength("EMISSION") > 0 for m in facts.materials)
    for material, program in facts.programs:
        name = f"material '{material.name}'" if material else program.label
        own = material.name if material else ""
        for kind in program.sends & set(RAY_KINDS):
            words = f"{name} by {program.label}" if material else name
            causes.add(kind, Cause(words, program.location, own))
        if material is None:
            continue
        if ignores_hits(material, program) or (program in material.any_hit and not program.proc):
            causes.add("transparency", Cause(name, program.location, own))
        description = description_of(program)
        if description is None:
            continue
        for effect in description.effects:
            if _is_called_for(effect, material, facts):
                causes.add(effect.name, Cause(name, program.location, own, effect.chain))
                if effect.chain:
                    specular.append(Cause(name, program.location, own))
        _add_lights(causes, facts, program, description.lights, emitting)
    if causes.found["indirect"] and emitting:
        for cause in specular:
            causes.add("caustics", cause)
    generation = description_of(facts.generate) if facts.generate else None
    if generation and facts.aperture > 0 and facts.camera_location is not None:
        for effect in generation.effects:
            causes.add(effect.name, Cause(f"camera '{facts.camera}'", facts.camera_location))
    return causes.found


def _is_called_for(effect: Effect, material: MaterialFacts, facts: PassFacts) -> bool:
    if effect.recursive and facts.max_depth <= 1:
        return False
    return not effect.attributes or any(material.strength(a) > 0 for a in effect.attributes)


def _add_lights(
    causes: Causes, facts: PassFacts, program: ProgramFacts, use: LightUse, emitting: bool
) -> None:
    """Add shadows and penumbrae of the lights that a program samples."""
    if use is LightUse.NONE:
        return
    first = use is LightUse.FIRST
    shadows = not first or any(t.lower() == "shadow" for t in facts.ray_types)
    for light in facts.lights[:1] if first else facts.lights:
        cause = Cause(f"light '{light.name}'", light.location)
        if shadows:
            causes.add("shadow", cause)
        if light.has_area:
            causes.add("penumbra", cause)
    if use is LightUse.EMITTERS and emitting and facts.max_depth > 1:
        causes.add("shadow", Cause("emissive triangles", program.location))
