"""The programs of ``file="builtin"``, written as a user would write them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from nau_py.raytrace.hits import Hits, Launch, Rays
from nau_py.raytrace.random import stratified
from nau_py.raytrace.vectors import F32, Mask, dot, reflect

AMBIENT_FACTOR = np.float32(0.3)
ALPHA_THRESHOLD = np.float32(0.25)


def pinhole(launch: Launch) -> F32:
    """One ray of the first ray type through each sample, stratified over the pixel."""
    dx, dy = stratified(launch.tracer.seed, launch.pixel, launch.sample, launch.samples, 0)
    origin, direction = launch.camera_rays(
        launch.x.astype(np.float32) + dx, launch.y.astype(np.float32) + dy
    )
    return launch.trace(launch.ray_types[0], origin, direction)


def lambert(hits: Hits) -> F32:
    """Nau's default look (nau-format.md, 8.5) with shadows: see BUILTIN_PROGRAMS."""
    texel = hits.texture(0)[:, :3]
    diffuse = hits.color("DIFFUSE")
    light = hits.lights[0] if hits.lights else None
    lit = np.zeros((len(hits), 3), np.float32)
    if light is not None:
        to_light = -light.vector("NORMALIZED_DIRECTION")
        wide = np.broadcast_to(to_light, (len(hits), 3))
        cosine = np.maximum(dot(hits.facing_normal, wide), np.float32(0))
        seen = np.ones(len(hits), np.float32)
        shadow = next((t for t in hits.rays.tracer.ray_types if t.lower() == "shadow"), None)
        if shadow is not None:
            seen = hits.trace(shadow, wide, kind="shadow", initial=1.0)[:, 0]
        lit = diffuse * light.vector("COLOR") * (cosine * seen)[:, None]
    rest = diffuse * AMBIENT_FACTOR
    if hits.has_texture(0):
        rest = np.full(3, AMBIENT_FACTOR, np.float32)
    return np.asarray((lit + rest + hits.color("EMISSION")) * texel, np.float32)


def emission(hits: Hits) -> F32:
    """The EMISSION colour."""
    return hits.color("EMISSION")


def mirror(hits: Hits) -> F32:
    """SPECULAR times what the mirror direction sees."""
    direction = np.asarray(reflect(hits.direction, hits.facing_normal), np.float32)
    seen = hits.trace(hits.rays.ray_type, direction, kind="reflection")
    return np.asarray(seen[:, :3] * hits.color("SPECULAR"), np.float32)


def alpha_test(hits: Hits) -> Mask:
    """Accepts hits where the texture of unit 0 has alpha above 0.25."""
    return np.asarray(hits.texture(0)[:, 3] > ALPHA_THRESHOLD)


def background(rays: Rays) -> F32:
    """The clear colour of the render target."""
    return rays.clear_color


def unoccluded(rays: Rays) -> F32:
    """1: nothing was in the way."""
    return np.ones((len(rays), 4), np.float32)


def magenta(launch: Launch) -> F32:
    """Paints failed samples magenta."""
    return np.array([1.0, 0.0, 1.0, 1.0], np.float32)


FUNCTIONS: dict[str, Callable[[Any], Any]] = {
    f.__name__: f
    for f in (pinhole, lambert, emission, mirror, alpha_test, background, unoccluded, magenta)
}
