"""Effects that a launch simulates, as the kernels know them."""

from __future__ import annotations

from dataclasses import dataclass

from nau_py.raytrace.kernels.core.tables import KINDS

NEGLIGIBLE = 1e-4
"""Weight below which specular chains end: for surfaces up to 19 times as bright as white, the error
is below half a step of an 8-bit display."""


@dataclass(frozen=True, slots=True)
class SimulatedEffects:
    """Effects that a launch simulates.

    ``skipped``: kinds of rays that are not sent. ``opaque``: materials, by index, whose any-hit
    programs accept every hit, so that they need not run. The flags switch any-hit programs
    (``transparency``), several points of a light (``penumbra``), lamps that a diffuse surface sees
    through mirrors or glass (``caustics``), re-radiation (``fluorescence``) and the ``lens``.
    ``negligible``: weight below which specular chains end.
    """

    skipped: frozenset[str] = frozenset()
    opaque: frozenset[int] = frozenset()
    transparency: bool = True
    penumbra: bool = True
    caustics: bool = True
    fluorescence: bool = True
    lens: bool = True
    negligible: float = NEGLIGIBLE

    @property
    def skipped_bits(self) -> int:
        """One bit for each skipped kind of ray."""
        return sum(1 << code for code, name in enumerate(KINDS) if name in self.skipped)
