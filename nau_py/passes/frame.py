"""Session, frame and view that passes execute with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeVar

from nau_py.model.linked import Project
from nau_py.model.passes import Pass
from nau_py.passes.report import PassRecord
from nau_py.passes.state import PassState, PassStates
from nau_py.scene.viewport import Rect

if TYPE_CHECKING:
    from nau_py.raster.resources import Resources
    from nau_py.raster.targets import Target
    from nau_py.scene.camera import CameraState
    from nau_py.scene.lights import LightState
    from nau_py.scene.mapping import PassMaterials
    from nau_py.scene.world import World


@dataclass(slots=True)
class RunOptions:
    """Options of a run that the project does not have.

    ``samples`` overrides RAYS_PER_PIXEL; ``threads`` of 0 means one a core, ``tile`` (rays) of 0
    a size that suits the programs; ``check_numerics`` makes any value that is not finite an error.
    ``mask``: ``project``, or ``none`` or ``all`` to write 0 or 1 into the mask of the raytrace
    pass. ``texture_filter``: ``NEAREST`` or ``LINEAR`` for image textures whose filter the project
    does not set. ``window_format``: the window's texel format; ``RGBA32F`` neither rounds nor
    clamps colours. ``effects``: ``auto``, ``all``, ``none`` or a list, instead of the project's.
    ``programs``: ``py`` for the Python files beside compiled programs.
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


P = TypeVar("P", bound=Pass)
S = TypeVar("S", bound=PassState)
Progress = Callable[[str, int, int], None]
"""``progress(pass name, done, total)`` while a pass works."""


def no_progress(name: str, done: int, total: int) -> None:
    """Ignore the progress of a pass."""


@dataclass(frozen=True, slots=True)
class View:
    """Camera, target and rectangle of the target (pixels) that a pass draws with."""

    camera: CameraState
    target: Target
    rect: Rect

    @property
    def pixels(self) -> int:
        """Number of pixels in the rectangle."""
        return max(int(self.rect.width), 0) * max(int(self.rect.height), 0)


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
    view: View = field(init=False)
    """The view of the pass that drew last, which passes without a camera or viewport of their own
    inherit, as in Nau."""

    def __post_init__(self) -> None:
        self.reset_view()

    def reset_view(self) -> None:
        """Make the default camera and the whole window current, as a frame begins."""
        window = self.resources.window
        rect = Rect(0.0, 0.0, float(window.width), float(window.height))
        self.view = View(self.world.camera(None), window, rect)

    def start_pipeline(self, pipeline: str, index: int) -> None:
        """Go on with another pipeline, of which frame ``index`` is number 0."""
        self.pipeline, self.first_frame = pipeline, index
        self.materials.clear()  # both are kept by the names of passes, unique in a pipeline only
        self.states.close()

    def state(self, pass_: P, factory: Callable[[P, Session], S]) -> S:
        """Return the state that a pass keeps from frame to frame; ``factory`` makes it once."""
        return self.states.get(pass_.name or "", factory, lambda: factory(pass_, self))

    def pass_materials(self, pass_: Pass) -> PassMaterials:
        """Return the material mapping of a pass, made once."""
        key = pass_.name or ""
        if key not in self.materials:
            self.materials[key] = self.world.materials.for_pass(
                pass_, self.pipeline, self.options.texture_filter
            )
        return self.materials[key]


@dataclass(frozen=True, slots=True)
class FrameContext:
    """The frame that passes execute in.

    ``number``: frames since the session began. ``timer_ms``: simulated time. ``records``: of the
    passes of this frame so far.
    """

    session: Session
    number: int
    timer_ms: float
    records: tuple[PassRecord, ...] = ()

    @property
    def index(self) -> int:
        """Frames since the pipeline began, or as scripts have set FRAME_COUNT."""
        return self.number - self.session.first_frame

    @property
    def project(self) -> Project:
        return self.session.project

    @property
    def world(self) -> World:
        return self.session.world

    def lights(self, pass_: Pass) -> list[LightState]:
        """Return the lights of a pass, by light index."""
        return [self.world.light(light.name or "") for light in pass_.lights]
