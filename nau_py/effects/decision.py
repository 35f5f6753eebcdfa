"""What is simulated and what is left out, each with its reason and its bound."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from nau_py.effects.analysis import RAY_KINDS, Cause
from nau_py.model.effects import EFFECTS

EXACT = "exact"
"""The bound of what changes no bit of the picture."""
UNKNOWN = "not bounded"
"""That of an effect that is called for and left out at the user's word."""
NO_CAUSE = "nothing calls for it"


@dataclass(frozen=True, slots=True)
class Decision:
    """About one effect. ``bound``: how much the picture can differ from one with the effect."""

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
        """The kind of ray that the effect is, empty for none."""
        return self.effect if self.effect in RAY_KINDS else ""


def decide(
    wanted: frozenset[str] | None,
    calls: Mapping[str, list[Cause]],
    negligible: float,
    said: str,
) -> list[Decision]:
    """A decision for each effect: what the scene calls for (``wanted`` None), or exactly those
    that are wanted. ``negligible``: weight at which specular chains end. ``said``: who wants them,
    for the reasons."""
    found = []
    for effect in EFFECTS:
        causes = tuple(calls[effect])
        simulated = bool(causes) if wanted is None else effect in wanted
        reason = ""
        if not simulated:
            reason = f"{said} leaves it out" if causes else NO_CAUSE
        if simulated and negligible > 0 and any(c.chain for c in causes):
            bound = f"chains end at {negligible:g} of the radiance"
        elif simulated or not causes:
            bound = EXACT
        else:
            bound = UNKNOWN
        found.append(Decision(effect, causes, simulated, reason, bound))
    return found
