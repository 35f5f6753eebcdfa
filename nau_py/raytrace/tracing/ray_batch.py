"""Batches of rays and of camera samples: arguments of miss and ray generation programs.

Arrays are float32; the first axis is the batch. Positions and directions are in world space.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.tracing.materials import TracedLight
from nau_py.raytrace.tracing.random import sample_uniform
from nau_py.raytrace.tracing.scene_tables import TracedScene
from nau_py.scene.mesh import F32

I32 = NDArray[np.int32]


class RaySender(Protocol):
    """The tracer of a thread, as batches need it to send rays on."""

    scene: TracedScene

    def trace_batch(self, rays: Rays, tmax: F32 | None, kind: str | None, initial: float) -> F32:
        """Trace a batch of rays and return their radiance, RGBA float32 (n, 4)."""
        ...


@dataclass(slots=True)
class Rays:
    """A batch of rays. ``pixel`` uint32 and ``sample`` uint32 (n,) key the random numbers.

    ``origin`` is relative to the centre of the scene, which is zero unless the scene is far from
    the world's origin.
    """

    tracer: RaySender
    origin: F32
    direction: F32
    pixel: NDArray[np.uint32]
    sample: NDArray[np.uint32]
    depth: int
    ray_type: str

    def __len__(self) -> int:
        return len(self.origin)

    @property
    def lights(self) -> list[TracedLight]:
        """Lights of the pass, by light index."""
        return self.tracer.scene.lights

    @property
    def variables(self) -> dict[str, NDArray[Any]]:
        """Values of the pass's global parameters, by name."""
        return self.tracer.scene.variables

    @property
    def clear_color(self) -> F32:
        """Clear colour of the render target, float32 (4,)."""
        return self.tracer.scene.clear_color

    def random(self, dimension: int) -> F32:
        """Return numbers in [0, 1), float32 (n,), keyed by pixel, sample, depth and dimension."""
        return sample_uniform(
            self.tracer.scene.settings.seed, self.pixel, self.sample, dimension + 1024 * self.depth
        )


@dataclass(slots=True)
class SampleBatch:
    """A batch of samples for a ray generation program (its argument ``launch``).

    ``x`` ``y``: pixel columns and rows, row 0 at the bottom; ``sample``: 0 … ``samples`` - 1.
    """

    tracer: RaySender
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
        """Values of the pass's global parameters, by name."""
        return self.tracer.scene.variables

    @property
    def ray_types(self) -> list[str]:
        """Ray types of the pass, by index."""
        return self.tracer.scene.ray_types

    def input(self, name: str) -> NDArray[Any]:
        """Return the values of an input texture at the pixels, (n, channels)."""
        return np.asarray(self.tracer.scene.inputs[name][self.y, self.x])

    def random(self, dimension: int) -> F32:
        """Return numbers in [0, 1), float32 (n,), keyed by pixel, sample and dimension."""
        return sample_uniform(self.tracer.scene.settings.seed, self.pixel, self.sample, dimension)

    def trace(
        self,
        ray_type: str,
        origin: F32,
        direction: F32,
        tmax: F32 | None = None,
        kind: str | None = None,
        initial: float = 0.0,
    ) -> F32:
        """Trace primary rays; see :meth:`Hits.trace`. float32 (n, 3) arrays, unit directions."""
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
        return self.tracer.trace_batch(rays, tmax, kind or "primary", initial)
