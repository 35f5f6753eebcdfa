"""Batches of hits on one material: arguments of closest-hit and any-hit programs.

Arrays are float32; the first axis is the batch. Positions and directions are in world space.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.path import hit_arrays as kernel
from nau_py.raytrace.tracing.arrays import F32, Mask
from nau_py.raytrace.tracing.materials import TracedLight, TracedMaterial
from nau_py.raytrace.tracing.ray_batch import I32, Rays
from nau_py.raytrace.tracing.ray_texture import WHITE


class Hits:
    """A batch of hits on one material."""

    def __init__(
        self, rays: Rays, triangle: I32, u: F32, v: F32, t: F32, material: TracedMaterial
    ) -> None:
        self.rays = rays
        self.triangle, self.u, self.v, self.t = triangle, u, v, t
        self.material = material
        self._geometry = rays.tracer.scene.geometry

    def __len__(self) -> int:
        return len(self.triangle)

    @property
    def depth(self) -> int:
        """1 for primary rays, 2 for the rays that their hits send, and so on."""
        return self.rays.depth

    @property
    def direction(self) -> F32:
        """Unit directions of the arriving rays, (n, 3)."""
        return self.rays.direction

    @property
    def lights(self) -> list[TracedLight]:
        """Lights of the pass, by light index."""
        return self.rays.lights

    @property
    def variables(self) -> dict[str, NDArray[Any]]:
        """Values of the pass's global parameters and of the material's, by name."""
        return self.rays.variables | self.material.variables

    @property
    def _scene(self) -> NDArray[Any]:
        return self.rays.tracer.scene.tables.record

    @cached_property
    def _surface(self) -> tuple[F32, F32, F32]:
        position, face = np.empty((2, len(self), 3), np.float32)
        bound = np.empty(len(self), np.float32)
        kernel.compute_surface_points(
            self._scene, self.triangle, self.u, self.v, position, face, bound
        )
        return position, face, bound

    @cached_property
    def position(self) -> F32:
        """Hit points from barycentrics, world space, (n, 3)."""
        centre = self._geometry.centre
        if not centre.any():
            return self._surface[0]
        return (self._surface[0] + centre).astype(np.float32)

    @property
    def face_normal(self) -> F32:
        """Unit normals of the triangles, as wound, (n, 3)."""
        return self._surface[1]

    def _interpolate(self, values: F32 | None, components: int) -> F32:
        result = np.zeros((len(self), components), np.float32)
        if values is not None:
            kept = np.ascontiguousarray(values)  # lives as long as its address is used
            kernel.interpolate_attributes(
                self._scene, kept.ctypes.data, self.triangle, self.u, self.v, result
            )
        return result

    def attribute(self, name: str) -> F32:
        """Return a vertex attribute (``normal``, ``uv``, ``tangent``), interpolated, (n, 4); zero
        where the mesh has none."""
        values: F32 | None = getattr(self._geometry, name)
        result = self._interpolate(values, 3)
        return np.hstack([result, np.zeros((len(self), 1), np.float32)])

    @cached_property
    def normal(self) -> F32:
        """Unit shading normals, (n, 3): the face normal where a vertex has none."""
        result = np.empty((len(self), 3), np.float32)
        face = self.face_normal
        kernel.compute_shading_normals(self._scene, self.triangle, self.u, self.v, face, result)
        return result

    @cached_property
    def facing_normal(self) -> F32:
        """Shading normals turned towards the origin of the ray, (n, 3)."""
        result = np.empty((len(self), 3), np.float32)
        kernel.orient_normals(self.normal, self.direction, result)
        return result

    @cached_property
    def uv(self) -> F32:
        """texCoord0, (n, 2); zero where the mesh has none."""
        return self._interpolate(self._geometry.uv, 2)

    @cached_property
    def tangent(self) -> F32:
        """Tangents, (n, 3); zero where the mesh has none."""
        return self._interpolate(self._geometry.tangent, 3)

    def color(self, name: str) -> F32:
        """Return a colour of the material (DIFFUSE, SPECULAR, AMBIENT, EMISSION), float32 (3,)."""
        return np.array(self.material.colour(name)[:3], np.float32)

    @property
    def shininess(self) -> float:
        """Exponent SHININESS of the material."""
        return float(self.material.colour("SHININESS")[0])

    def has_texture(self, unit: int = 0) -> bool:
        """Test if the material has a texture in ``unit``."""
        return unit in self.material.textures

    def texture(self, unit: int = 0) -> F32:
        """Return texture values, RGBA (n, 4); white if the material has no such texture."""
        found = self.material.textures.get(unit)
        return np.tile(WHITE, (len(self), 1)) if found is None else found.sample(self.uv)

    def random(self, dimension: int) -> F32:
        """Return numbers in [0, 1); see :meth:`Rays.random`."""
        return self.rays.random(dimension)

    def trace(
        self,
        ray_type: str,
        direction: F32,
        tmax: F32 | float | None = None,
        kind: str | None = None,
        initial: float = 0.0,
        where: Mask | None = None,
    ) -> F32:
        """Trace rays of ``ray_type`` from the hits along ``direction`` (3,) or (n, 3).

        Return their radiance, RGBA (n, 4). ``kind`` is the kind that the report counts them as
        (default: the ray type's name). A ray deeper than MAX_DEPTH returns 0; a miss without a miss
        program returns ``initial``. ``where``, bool (n,): only these hits send a ray, the others
        get 0. Raises ValueError for an array of another shape.
        """
        result = np.zeros((len(self), 4), np.float32)
        if where is not None and np.shape(where) != (len(self),):
            raise ValueError(f"where has shape {np.shape(where)}, not ({len(self)},)")
        chosen = np.arange(len(self)) if where is None else np.flatnonzero(where)
        if not len(chosen):
            return result
        wide = np.ascontiguousarray(np.atleast_2d(direction), np.float32)
        if wide.shape not in ((1, 3), (len(self), 3)):
            raise ValueError(f"directions have shape {wide.shape}, not (3,) or ({len(self)}, 3)")
        origin, unit = np.empty((2, len(chosen), 3), np.float32)
        kernel.spawn_chosen_rays(chosen, *self._surface, wide, origin, unit)
        pixel, sample = self.rays.pixel, self.rays.sample
        limit = tmax if tmax is None else np.broadcast_to(np.asarray(tmax, "f4"), len(self))
        if len(chosen) < len(self):
            pixel, sample = pixel[chosen], sample[chosen]
            limit = limit if limit is None else limit[chosen]
        tracer = self.rays.tracer
        rays = Rays(tracer, origin, unit, pixel, sample, self.depth + 1, ray_type)
        if len(chosen) == len(self):
            return tracer.trace_batch(rays, limit, kind, initial)
        result[chosen] = tracer.trace_batch(rays, limit, kind, initial)
        return result
