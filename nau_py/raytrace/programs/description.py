"""Description of a built-in ray program, from which all other rooms derive their facts of it.

Nothing here loads the engine: lint and the editor read descriptions.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, Final

from nau_py.model.attribute import Attribute

RAY_GENERATION: Final = "ray generation"
CLOSEST_HIT: Final = "CLOSEST_HIT"
ANY_HIT: Final = "ANY_HIT"
MISS: Final = "MISS"
EXCEPTION: Final = "exception"
KINDS: Final = (RAY_GENERATION, CLOSEST_HIT, ANY_HIT, MISS, EXCEPTION)
"""Kinds of ray programs, as projects name them."""


@dataclass(frozen=True, slots=True)
class Effect:
    """An effect of light that a program simulates, and the scenes that call for it.

    ``attributes``: of the material (of the camera for a ray generation program); the effect is
    called for if one of them is above 0. Without attributes, it is always called for.
    """

    name: str
    """A key of :data:`nau_py.model.effects.EFFECTS`."""
    attributes: tuple[str, ...] = ()
    recursive: bool = False
    """Called for only if the pass follows paths to a depth above 1."""
    chain: bool = False
    """Bound of the error: specular chains end at a small weight. Else the effect is exact."""
    zeroes_attributes: bool = False
    """To leave the effect out is to take the attributes for 0."""


class LightUse(Enum):
    """Lights that a program samples, with shadow rays."""

    NONE = 0
    FIRST = 1
    """The first light of the pass; shadow rays only if the pass has a ray type called Shadow."""
    ALL = 2
    EMITTERS = 3
    """All lights of the pass and, on paths, the emissive triangles."""


@dataclass(frozen=True, slots=True)
class AlphaTest:
    """Alpha for which an any-hit program accepts every hit, so that it need not run."""

    above: float | None = None
    """Accepts hits whose alpha is above this; None: only alpha 1."""
    uses_diffuse: bool = True
    """The alpha is that of the texture times that of DIFFUSE; False: of the texture alone."""


@dataclass(frozen=True, slots=True)
class BuiltInProgram:
    """A program with ``file="builtin"``."""

    name: str
    kind: str
    doc: str
    kernel: Callable[..., Any] | None = None
    """Compiled function; parameters as for its kind (:mod:`nau_py.raytrace.kernels.core.
    kernel_tables`). None for a program that is no kernel."""
    function: Callable[[Any], Any] | None = None
    """Function of a batch of rays, for a program written in Python. A program without kernel and
    function is made by the pass."""
    attributes: tuple[Attribute, ...] = ()
    """Attributes that the program adds to COLOR. Kernels read each from the field of MATERIAL with
    its name in lower case: a colour as three numbers, a FLOAT or INT as one."""
    tables: Mapping[str, Callable[[], Any]] = field(default_factory=dict)
    """Arrays of float64 that the kernel reads at ``scene.NAME``, by name. Each is computed once, if
    a material has the program."""
    effects: tuple[Effect, ...] = ()
    lights: LightUse = LightUse.NONE
    alpha: AlphaTest | None = None
    """For an any-hit program that depends on alpha."""
    partial: bool = False
    """An any-hit program lets a part of the light pass."""
    geometric: bool = False
    """An any-hit program is a matter of geometry: it runs with any choice of effects."""
    without_effects: str = ""
    """Program of this kind that runs if the effects of this one are left out."""
