"""``ambient_occlusion``: diffuse surfaces by the part of the sky that they see."""

from __future__ import annotations

from typing import Any

import numpy as np

from nau_py.raytrace.kernels.core.jit import inner
from nau_py.raytrace.kernels.core.sampling import sample_2d, sample_hemisphere
from nau_py.raytrace.kernels.core.tables import AMBIENT, SKIPPED
from nau_py.raytrace.kernels.core.vec import dot, from_frame, make_frame, scale
from nau_py.raytrace.kernels.geometry.surface import face_forward, offset_origin
from nau_py.raytrace.kernels.intersect.counters import check_ray, increment_counter, is_skipped
from nau_py.raytrace.kernels.intersect.visibility import shadow_ray_type, trace_visibility
from nau_py.raytrace.kernels.shading.closest_hit import evaluate_albedo
from nau_py.raytrace.kernels.shading.radiance import add_radiance
from nau_py.raytrace.kernels.shading.scatter import FIRST, hit_dimension
from nau_py.raytrace.programs.description import CLOSEST_HIT, BuiltInProgram, Effect


@inner
def shade_ambient_occlusion(scene: Any, tile: Any, ray_type: int, path: Any, hit: Any) -> bool:
    """Add the albedo times the cosine-weighted visibility of the sky within the pass's
    OCCLUSION_DISTANCE."""
    albedo = evaluate_albedo(scene, hit)
    samples = max(int(scene.light_samples), 1)
    s, t = make_frame(hit.normal)
    geometric = face_forward(hit.face, hit.direction)
    visible = 0.0
    for k in range(samples):
        number = np.uint32(path.sample * samples + k)
        x, y = sample_2d(scene.seed, path.pixel, number, hit_dimension(path, FIRST))
        d = sample_hemisphere(x, y)
        to = from_frame(s, t, hit.normal, d[0], d[1], d[2])
        if not dot(geometric, to) > 0.0:
            continue
        origin = offset_origin(hit.position, hit.face, hit.bound, to)
        if not check_ray(tile, origin, to):
            continue
        if is_skipped(scene, AMBIENT):
            increment_counter(tile, SKIPPED + AMBIENT)
            visible += 1.0
            continue
        increment_counter(tile, AMBIENT)
        visible += trace_visibility(
            scene, tile, shadow_ray_type(scene, ray_type), origin, to,
            float(scene.occlusion_distance), path.pixel, path.sample, int(path.depth),
        )  # fmt: skip
    add_radiance(tile, path, scale(albedo, visible / samples), 1.0)
    return False


PROGRAM = BuiltInProgram(
    "ambient_occlusion",
    CLOSEST_HIT,
    "DIFFUSE times texture, times the part of the sky that is open within OCCLUSION_DISTANCE.",
    shade_ambient_occlusion,
    effects=(Effect("occlusion"),),
)
