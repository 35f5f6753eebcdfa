"""The element ``<accuracy>``: knobs to vary, with their values.

A knob has a short name (:data:`KNOBS`), or the name of the number that it changes:
``PASS/ATTRIBUTE`` for an attribute of a pass, ``PASS/SELECTOR/ATTRIBUTE`` for one of a selector of
a mask pass.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from nau_py.model.node import Attr, Items, Node
from nau_py.model.values import DataType

UINT = DataType.UINT


class Knob(Node):
    """A setting that trades accuracy for time, and the values to measure."""

    name: Annotated[str | None, Attr(doc="Short name, or path of a number.", required=True)] = None
    values: Annotated[str | None, Attr(doc="Values, cheapest first.", required=True)] = None


class Accuracy(Node):
    """Defaults of `nau-cost` for this project."""

    pipeline: Annotated[
        str | None, Attr(doc="Pipeline; default the project's.", ref="pipeline")
    ] = None
    reference: Annotated[int | None, Attr(UINT, "Samples a pixel of the reference.")] = None
    runs: Annotated[int | None, Attr(UINT, "Runs of each setting, a seed each; default 5.")] = None
    combine: Annotated[
        str | None,
        Attr(doc="Each knob by itself (default), or every combination.", values=("each", "all")),
    ] = None
    knobs: Annotated[list[Knob], Items(Knob, "knob")] = Field(default_factory=list)


@dataclass(frozen=True, slots=True)
class KnobKind:
    """A knob with a short name. ``attribute``: the attribute of the raytrace pass that it sets.
    ``words``: its values, cheapest first, if they are not numbers."""

    doc: str
    attribute: str = ""
    words: tuple[str, ...] = ()
    low: float = 0.0
    high: float = float("inf")


MASKS = ("none", "project", "all")
FILTERS = ("nearest", "linear")
FORMATS = ("8-bit", "half", "float")
KNOBS: dict[str, KnobKind] = {
    "spp": KnobKind("Samples a pixel.", "RAYS_PER_PIXEL"),
    "depth": KnobKind("Longest chain of rays.", "MAX_DEPTH"),
    "light-samples": KnobKind("Shadow rays a sample and area light.", "LIGHT_SAMPLES"),
    "target-error": KnobKind(
        "Estimated error at which pixels stop; spp is the most.", "TARGET_ERROR"
    ),
    "mask": KnobKind("Trace no pixel, those of the project's mask, or all.", words=MASKS),
    "scale": KnobKind("Size of the picture that is rendered and then enlarged.", low=0.01, high=1),
    "filter": KnobKind("Filter of the materials' textures.", words=FILTERS),
    "format": KnobKind("Texels of the traced target and of the window.", words=FORMATS),
}
