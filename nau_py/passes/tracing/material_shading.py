"""The built-in program ``material``: shades hits with the GLSL program of their material."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from nau_py.raster.hits import HitShading
from nau_py.raytrace.tracing.hit_batch import Hits
from nau_py.raytrace.tracing.main_thread import MainThread
from nau_py.scene.mesh import F32, SceneObject

if TYPE_CHECKING:
    from nau_py.raster.draw_context import DrawContext
    from nau_py.scene.mapping import PassMaterials


class MaterialShading:
    """A closest-hit program that draws on the main thread, which owns OpenGL."""

    def __init__(
        self, objects: list[SceneObject], materials: PassMaterials, main_thread: MainThread
    ) -> None:
        self._objects = objects
        self._materials = materials
        self._main_thread = main_thread
        self._shading = HitShading()
        self.context: DrawContext | None = None
        """Context of the frame; set before rays are traced."""

    def forget(self) -> None:
        """Make the programs again at the next hit, since their sources have changed."""
        self._shading = HitShading()

    def __call__(self, hits: Hits) -> F32:
        """Return the colours of hits, RGBA float32 (n, 4)."""
        colours: Any = self._main_thread.call(self._shade, hits)
        return np.asarray(colours, np.float32)

    def _shade(self, hits: Hits) -> F32:
        material, context = self._materials[hits.material.name], self.context
        assert material is not None
        assert context is not None
        geometry = hits.rays.tracer.scene.geometry
        origin = (hits.rays.origin + geometry.centre).astype(np.float32)
        position = np.ones((len(hits), 4))
        position[:, :3] = hits.position
        normal = np.zeros((len(hits), 4))
        normal[:, :3] = hits.attribute("normal")[:, :3]
        attributes = {"texCoord0": hits.attribute("uv"), "tangent": hits.attribute("tangent")}
        result = np.zeros((len(hits), 4), np.float32)
        items = geometry.item[hits.triangle]
        for item in np.unique(items):
            chosen = items == item
            model = self._objects[item].matrix
            inverse = np.linalg.inv(model)
            own = {name: values[chosen] for name, values in attributes.items()}
            own["position"] = (position[chosen] @ inverse.T).astype(np.float32)
            linear = np.eye(4)
            linear[:3, :3] = model[:3, :3]
            own["normal"] = (normal[chosen] @ linear).astype(np.float32)
            result[chosen] = self._shading.shade(
                context, material, model, own, origin[chosen], hits.direction[chosen]
            )
        result[:, 3] = 1.0
        return result
