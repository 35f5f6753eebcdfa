"""State of one pass while it draws."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from nau_py.model.passes import Pass
from nau_py.raster.resources import Resources
from nau_py.scene.camera import CameraState
from nau_py.scene.lights import LightState
from nau_py.scene.material import RenderMaterial
from nau_py.scene.mesh import F64
from nau_py.scene.viewport import Rect
from nau_py.scene.world import World


@dataclass(slots=True)
class DrawContext:
    """State that uniform sources can refer to while one pass draws."""

    world: World
    resources: Resources
    pass_: Pass
    frame: int
    timer_ms: float
    camera: CameraState
    rect: Rect
    lights: list[LightState]
    projection: F64
    view: F64
    target: str | None = None
    material: RenderMaterial | None = None
    model: F64 = field(default_factory=lambda: np.eye(4))
    instances: int = 0
    pipeline: str = ""
    indirect: str | None = None
    """Buffer of draw commands, if the pass names one."""
