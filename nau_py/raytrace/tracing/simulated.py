"""Which effects a launch simulates, in the engine's terms."""

from __future__ import annotations

from dataclasses import dataclass

from nau_py.raytrace.kernels.core.tables import KINDS

NEGLIGIBLE = 1e-4
"""Weight below which specular chains end: of what is up to 19 times as bright as white, less than
half a step of an 8-bit display is left out."""


@dataclass(frozen=True, slots=True)
class Simulated:
    """``skipped``: kinds of rays that are not sent. ``opaque``: materials, by index, whose any-hit
    programs accept every hit, so that none is asked. The rest: whether any-hit programs, several
    points of a light, lamps met by way of mirrors or glass after a diffuse surface, re-radiation
    and the lens count; ``negligible``: weight below which specular chains end."""

    skipped: frozenset[str] = frozenset()
    opaque: frozenset[int] = frozenset()
    transparency: bool = True
    penumbra: bool = True
    caustics: bool = True
    fluorescence: bool = True
    lens: bool = True
    negligible: float = NEGLIGIBLE

    @property
    def bits(self) -> int:
        """A bit for each skipped kind."""
        return sum(1 << code for code, name in enumerate(KINDS) if name in self.skipped)
