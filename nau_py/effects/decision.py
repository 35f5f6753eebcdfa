"""Decide for each effect if it is simulated, with the reason and the bound of the error."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from nau_py.effects.analysis import RAY_KINDS, Cause
from nau_py.model.effects import EFFECTS

EXACT = "exact"
"""Bound of a decision that changes no bit of the picture."""
UNKNOWN = "not bounded"
"""Bound of an effect that is called for, and left out because the user requests that."""
NO_CAUSE = "nothing calls for it"


@dataclass(frozen=True, slots=True)
class Decision:
    """Decision on one effect. ``bound``: limit of the difference from a picture with the effect."""

    effect: str
    causes: tuple[Cause, ...]
    simulated: bool
    reason: str
    bound: str

    @property
    def called_for(self) -> bool:
        return bool(self.causes)

    @property
    def kind(self) -> str:
        """Kind of ray that the effect consists of; empty for none."""
        return self.effect if self.effect in RAY_KINDS else ""


def decide_effects(
    requested: frozenset[str] | None,
    causes_of: Mapping[str, list[Cause]],
    negligible: float,
    source: str,
) -> list[Decision]:
    """Decide on each effect: simulate those that the scene calls for (``requested`` None), or
    exactly those that are requested.

    ``causes_of``: by effect, from ``find_causes``. ``negligible``: weight at which specular chains
    end. ``source``: option or element of the request, for the reasons.
    """
    found = []
    for effect in EFFECTS:
        causes = tuple(causes_of[effect])
        simulated = bool(causes) if requested is None else effect in requested
        reason = ""
        if not simulated:
            reason = f"{source} leaves it out" if causes else NO_CAUSE
        if simulated and negligible > 0 and any(c.chain for c in causes):
            bound = f"chains end at {negligible:g} of the radiance"
        elif simulated or not causes:
            bound = EXACT
        else:
            bound = UNKNOWN
        found.append(Decision(effect, causes, simulated, reason, bound))
    return found
