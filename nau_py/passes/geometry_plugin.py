"""Class ``geometryPI`` of Nau's sample plug-in: a pass with geometry of its own."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from nau_py.model.passes import Pass
from nau_py.passes.default import DefaultClass
from nau_py.passes.drawing import begin_drawing, draw_scenes
from nau_py.passes.frame import FrameContext
from nau_py.passes.registry import register_pass
from nau_py.passes.report import PassReport
from nau_py.scene.mesh import Group, Mesh, SceneObject, pad4
from nau_py.scene.readers.model_material import PRIMITIVE_MATERIAL


@lru_cache(maxsize=1)
def _plane() -> SceneObject:
    """Return the square -1..1 in the plane y = 0, with positions only."""
    corners = np.array([[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]], np.float32)
    faces = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
    mesh = Mesh({"position": pad4(corners, 1.0)}, [Group(PRIMITIVE_MATERIAL, faces)])
    return SceneObject("my_plane", mesh)


BLACK = (0.0, 0.0, 0.0, 0.0)


@register_pass("geometryPI")
class GeometryPluginClass(DefaultClass):
    """Draws its scenes and a plane, with depth clamping, as Nau's sample plug-in does.

    As in the plug-in, the window is cleared to black, since the viewport is set later, and the
    lights of the pass are not set: shaders see the default light.
    """

    def execute(self, pass_: Pass, frame: FrameContext) -> PassReport:
        pass_ = pass_.model_copy(update={"lights": []})
        camera = frame.world.camera(pass_.camera_name)
        view = begin_drawing(pass_, frame, camera, window_clear=BLACK)
        draw_scenes(pass_, frame, view, [_plane()], depth_clamp=True)
        return PassReport(pixels=view.pixels)
