"""The effects of light that a project simulates (its ``<effects>``, ``--effects``)."""

from __future__ import annotations

import re
from typing import Annotated

from nau_py.diagnostics.suggest import format_names, suggest_name
from nau_py.model.node import Attr, Node

EFFECTS: dict[str, str] = {
    "reflection": "Rays to what mirrors, glossy and glass surfaces show.",
    "refraction": "Rays through glass.",
    "transparency": "Any-hit programs: alpha tests and alpha that lets light through.",
    "shadow": "Rays to lights.",
    "penumbra": "Several points of a light with an area; without it, its middle.",
    "occlusion": "Rays that find how open the sky is.",
    "indirect": "Light that comes by way of other surfaces.",
    "caustics": "Light that glass or mirrors throw onto surfaces.",
    "depth_of_field": "Points of a lens; without it, a pinhole.",
    "fluorescence": "Light that comes back in other bands.",
}
"""Every effect, and the part of the simulation that it is."""
AUTO, ALL, NONE = "auto", "all", "none"


class Effects(Node):
    """Effects that are simulated."""

    simulate: Annotated[
        str | None,
        Attr(
            doc="`auto` (what the scene calls for), `all`, `none`, or exactly those listed.",
            required=True,
        ),
    ] = None


def parse_effects(text: str) -> frozenset[str] | None:
    """Return the effects that a list names; None for ``auto``. Raises ValueError."""
    names = re.split(r"[\s,]+", text.strip())
    if names == [AUTO]:
        return None
    if names == [ALL]:
        return frozenset(EFFECTS)
    if names == [NONE]:
        return frozenset()
    for name in names:
        if name not in EFFECTS:
            known = [*EFFECTS, AUTO, ALL, NONE]
            raise ValueError(
                f"there is no effect '{name}'; there is {format_names(known, 13)}"
                f"{suggest_name(name, known)}"
            )
    return frozenset(names)
