"""What a pass executes on: the frame, and the record of what the pass cost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from nau_py.model.linked import Project
from nau_py.model.passes import Pass
from nau_py.passes.state import PassState, PassStates
from nau_py.scene.camera import CameraState
from nau_py.scene.lights import LightState
from nau_py.scene.mapping import PassMaterials
from nau_py.scene.viewport import Rect
from nau_py.scene.world import World

if TYPE_CHECKING:
    from nau_py.raster.resources import Resources


@dataclass(slots=True)
class RunOptions:
    """What the user asks of a run, beside the project.

    ``samples`` overrides RAYS_PER_PIXEL; ``threads`` of 0 means one a core, ``tile`` (rays) of 0
    a size that suits the programs; ``check_numerics``
    makes any value that is not finite an error. ``mask``: ``project``, or ``none`` or ``all`` to
    write 0 or 1 into the mask of the raytrace pass. ``texture_filter``: ``NEAREST`` or ``LINEAR``
    for image textures whose filter the project leaves open. ``window_format``: the window's texel
    format; ``RGBA32F`` keeps what 8 bits would round and clamp. ``effects``: ``auto``, ``all``,
    ``none`` or a list, in the place of the project's. ``programs``: ``py`` for
    the Python files beside compiled programs.
    """

    samples: int | None = None
    seed: int = 0
    threads: int = 0
    allow_programs: tuple[str, ...] = ()
    no_programs: bool = False
    tile: int = 0
    check_numerics: bool = False
    mask: str = "project"
    texture_filter: str = ""
    window_format: str = "RGBA"
    effects: str | None = None
    programs: str = ""


@dataclass(slots=True)
class PassRecord:
    """What a pass did. ``rays`` counts rays by kind; ``avoided`` the primary rays not traced.
    ``stages``: milliseconds by stage, where a pass has several. ``taken`` and ``error``: samples
    and estimated standard error of each pixel of a raytrace pass's target, (h, w), row 0 at the
    bottom; the error is infinite where one sample tells nothing, 0 where nothing was traced."""

    name: str
    pass_class: str
    status: str = "run"
    reason: str = ""
    ms: float = 0.0
    pixels: int = 0
    rays: dict[str, int] = field(default_factory=dict)
    avoided: int = 0
    est_error: float | None = None
    nonfinite: int = 0
    blame: str = ""
    """Where the first value that is not finite came from."""
    notes: list[str] = field(default_factory=list)
    stages: dict[str, float] = field(default_factory=dict)
    taken: NDArray[np.int32] | None = None
    error: NDArray[np.float32] | None = None
    effects: list[dict[str, Any]] = field(default_factory=list)
    """What a raytrace pass simulates and leaves out, for the report."""


P = TypeVar("P", bound=Pass)
S = TypeVar("S", bound=PassState)
Progress = Callable[[str, int, int], None]
"""``progress(pass name, done, total)`` while a pass works."""


def no_progress(name: str, done: int, total: int) -> None:
    """Say nothing."""


@dataclass(slots=True)
class Session:
    """State that lasts from frame to frame: world, GPU resources, camera viewports, and the state
    of each pass."""

    project: Project
    pipeline: str
    world: World
    resources: Resources
    options: RunOptions
    camera_rects: dict[str, Rect] = field(default_factory=dict)
    materials: dict[str, PassMaterials] = field(default_factory=dict)
    states: PassStates = field(default_factory=PassStates)
    progress: Progress = no_progress
    first_frame: int = 0
    """The frame that counts as 0: scripts may set FRAME_COUNT."""

    def turn_to(self, pipeline: str, index: int) -> None:
        """Go on with another pipeline, of which frame ``index`` is number 0."""
        self.pipeline, self.first_frame = pipeline, index
        self.materials.clear()  # both are kept by the names of passes, unique in a pipeline only
        self.states.close()

    def state(self, pass_: P, factory: Callable[[P, Session], S]) -> S:
        """Return the state that a pass keeps from frame to frame; ``factory`` makes it once."""
        return self.states.get(pass_.name or "", factory, lambda: factory(pass_, self))

    def pass_materials(self, pass_: Pass) -> PassMaterials:
        """The material mapping of a pass, made once."""
        key = pass_.name or ""
        if key not in self.materials:
            self.materials[key] = self.world.materials.for_pass(
                pass_, self.pipeline, self.options.texture_filter
            )
        return self.materials[key]


@dataclass(slots=True)
class FrameContext:
    """One frame in the making."""

    session: Session
    index: int
    timer_ms: float
    camera: CameraState
    rect: Rect
    records: list[PassRecord] = field(default_factory=list)
    """Of the passes of this frame so far."""

    @property
    def project(self) -> Project:
        return self.session.project

    @property
    def world(self) -> World:
        return self.session.world

    def lights(self, pass_: Pass) -> list[LightState]:
        """The lights of a pass, by light index."""
        return [self.world.light(light.name or "") for light in pass_.lights]
