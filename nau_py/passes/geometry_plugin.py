"""Class ``geometryPI`` of Nau's sample plug-in: a pass that brings geometry of its own."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from nau_py.model.passes import Pass
from nau_py.passes.default import DefaultClass
from nau_py.scene.mesh import Group, Mesh, SceneObject, pad4
from nau_py.scene.readers.model_material import PRIMITIVE_MATERIAL

if TYPE_CHECKING:
    from nau_py.passes.frame import FrameContext, PassRecord


@lru_cache(maxsize=1)
def _plane() -> SceneObject:
    """The square -1..1 in the plane y = 0: positions only."""
    corners = np.array([[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]], np.float32)
    faces = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
    mesh = Mesh({"position": pad4(corners, 1.0)}, [Group(PRIMITIVE_MATERIAL, faces)])
    return SceneObject("my_plane", mesh)


BLACK = (0.0, 0.0, 0.0, 0.0)


class GeometryPluginClass(DefaultClass):
    """Draws its scenes and a plane, with depth clamping.

    As in the plug-in, the window is cleared before the viewport is set, so in black, and the lights
    of the pass are not set: shaders see the default light.
    """

    def execute(self, pass_: Pass, frame: FrameContext, record: PassRecord) -> None:
        from nau_py.passes.drawing import begin, draw_scenes
        from nau_py.raster.gl import GL

        frame.camera = frame.world.camera(pass_.camera_name)
        pass_ = pass_.model_copy(update={"lights": []})
        target = begin(pass_, frame, uses_camera=True, window_clear=BLACK)
        GL.glEnable(GL.GL_DEPTH_CLAMP)
        draw_scenes(pass_, frame, target, record, [_plane()])
        GL.glDisable(GL.GL_DEPTH_CLAMP)
