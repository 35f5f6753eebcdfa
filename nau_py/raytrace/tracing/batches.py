"""What programs are given: batches of hits, of missed rays, and the launch itself.

Arrays are float32; the first axis is the batch. Positions and directions are in world space.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from nau_py.model.attributes.color import COLOR
from nau_py.raytrace.kernels.path import hit_arrays as kernel
from nau_py.raytrace.tracing.arrays import F32, Mask
from nau_py.raytrace.tracing.random import uniform
from nau_py.raytrace.tracing.ray_texture import WHITE, RayTexture

if TYPE_CHECKING:
    from nau_py.raytrace.tracing.thread_tracer import Tracer

I32 = NDArray[np.int32]


@dataclass(frozen=True, slots=True)
class RayMaterial:
    """A material at a hit: colours (RGBA, or one number for SHININESS) and textures by unit."""

    name: str
    colours: dict[str, tuple[float, ...]]
    textures: dict[int, RayTexture]
    variables: dict[str, NDArray[Any]] = field(default_factory=dict)

    def colour(self, name: str) -> tuple[float, ...]:
        """The values of a COLOR attribute; its default where the material has none."""
        found = self.colours.get(name)
        return found if found is not None else tuple(float(v) for v in COLOR.default(name))


@dataclass(frozen=True, slots=True)
class RayLight:
    """A light of the pass: its attribute values by Nau's names."""

    name: str
    values: dict[str, tuple[Any, ...]]

    def vector(self, name: str) -> F32:
        """The first three components of an attribute, float32 (3,)."""
        return np.array(self.values[name][:3], np.float32)


@dataclass(slots=True)
class Rays:
    """A batch of rays. ``pixel`` uint32 and ``sample`` uint32 (n,) key the random numbers.

    ``origin`` is relative to the centre of the scene, which is zero unless it lies far off.
    """

    tracer: Tracer
    origin: F32
    direction: F32
    pixel: NDArray[np.uint32]
    sample: NDArray[np.uint32]
    depth: int
    ray_type: str

    def __len__(self) -> int:
        return len(self.origin)

    @property
    def lights(self) -> list[RayLight]:
        return self.tracer.scene.lights

    @property
    def variables(self) -> dict[str, NDArray[Any]]:
        """Values of the pass's global parameters, by name."""
        return self.tracer.scene.variables

    @property
    def clear_color(self) -> F32:
        """The clear colour of the render target, float32 (4,)."""
        return self.tracer.scene.clear_color

    def random(self, dimension: int) -> F32:
        """Numbers in [0, 1), float32 (n,), that depend on pixel, sample, depth and dimension."""
        return uniform(
            self.tracer.scene.settings.seed, self.pixel, self.sample, dimension + 1024 * self.depth
        )


class Hits:
    """A batch of hits on one material."""

    def __init__(
        self, rays: Rays, triangle: I32, u: F32, v: F32, t: F32, material: RayMaterial
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
    def lights(self) -> list[RayLight]:
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
        """A vertex attribute (``normal``, ``uv``, ``tangent``), interpolated, (n, 4); zero where
        the mesh has none."""
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
        """Shading normals turned towards where the ray came from, (n, 3)."""
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
        """A colour of the material (DIFFUSE, SPECULAR, AMBIENT, EMISSION), float32 (3,)."""
        return np.array(self.material.colour(name)[:3], np.float32)

    @property
    def shininess(self) -> float:
        return float(self.material.colour("SHININESS")[0])

    def has_texture(self, unit: int = 0) -> bool:
        return unit in self.material.textures

    def texture(self, unit: int = 0) -> F32:
        """Texture values, RGBA (n, 4); white where the material has no such texture."""
        found = self.material.textures.get(unit)
        return np.tile(WHITE, (len(self), 1)) if found is None else found.sample(self.uv)

    def random(self, dimension: int) -> F32:
        """See :meth:`Rays.random`."""
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
        """Send rays of ``ray_type`` from the hits along ``direction`` (3,) or (n, 3).

        Returns what they bring, RGBA (n, 4). ``kind`` is how the report counts them (default:
        the ray type's name). Rays longer than MAX_DEPTH bring 0; a miss without a miss program
        brings ``initial``. ``where``, bool (n,): only these hits send one, the others get 0.
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
            return tracer.trace(rays, limit, kind, initial)
        result[chosen] = tracer.trace(rays, limit, kind, initial)
        return result


@dataclass(slots=True)
class Launch:
    """A batch of samples for a ray generation program.

    ``x`` ``y``: pixel columns and rows, row 0 at the bottom; ``sample``: 0 … ``samples`` - 1.
    """

    tracer: Tracer
    x: I32
    y: I32
    pixel: NDArray[np.uint32]
    sample: NDArray[np.uint32]
    samples: int
    camera_rays: Callable[[F32, F32], tuple[F32, F32]]
    """(x, y) on the image plane in pixels to origins and unit directions, float32 (n, 3)."""

    def __len__(self) -> int:
        return len(self.x)

    @property
    def variables(self) -> dict[str, NDArray[Any]]:
        return self.tracer.scene.variables

    @property
    def ray_types(self) -> list[str]:
        return self.tracer.scene.ray_types

    def input(self, name: str) -> NDArray[Any]:
        """The values of an input buffer at the pixels, (n, channels)."""
        return np.asarray(self.tracer.scene.inputs[name][self.y, self.x])

    def random(self, dimension: int) -> F32:
        """Numbers in [0, 1), float32 (n,)."""
        return uniform(self.tracer.scene.settings.seed, self.pixel, self.sample, dimension)

    def trace(
        self,
        ray_type: str,
        origin: F32,
        direction: F32,
        tmax: F32 | None = None,
        kind: str | None = None,
        initial: float = 0.0,
    ) -> F32:
        """Send primary rays; see :meth:`Hits.trace`. float32 (n, 3) arrays, unit directions."""
        local = np.asarray(origin, np.float32)
        centre = self.tracer.scene.geometry.centre
        if centre.any():
            local = (np.asarray(origin, np.float64) - centre).astype(np.float32)
        rays = Rays(
            self.tracer,
            local,
            np.asarray(direction, np.float32),
            self.pixel,
            self.sample,
            1,
            ray_type,
        )
        return self.tracer.trace(rays, tmax, kind or "primary", initial)
