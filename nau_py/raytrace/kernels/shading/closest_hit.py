"""The surface that closest-hit programs shade, and the call of the program of a material."""

from __future__ import annotations

from typing import Any, NamedTuple

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.kernel_tables import CLOSEST_HIT_KERNELS
from nau_py.raytrace.kernels.core.memory import i32
from nau_py.raytrace.kernels.core.tables import diffuse_of, heading_of, material_at
from nau_py.raytrace.kernels.core.vec import dot, multiply
from nau_py.raytrace.kernels.geometry.surface import (
    evaluate_texture,
    face_forward,
    interpolate_normal,
    lift_point,
    locate_point,
    offset_origin,
)
from nau_py.raytrace.kernels.shading.radiance import take_rgb

_run_program = CLOSEST_HIT_KERNELS.run


class SurfaceHit(NamedTuple):
    """A hit of a path: the surface, and the path's direction there."""

    material: Any
    """Record of MATERIAL."""
    owner: int
    """Index of the material."""
    triangle: int
    u: float
    v: float
    """Barycentric coordinates of the second and third vertex."""
    position: V3
    face: V3
    """Unit face normal as wound."""
    bound: float
    """Error bound of the position along ``face``, a distance."""
    normal: V3
    """Interpolated unit normal on the side of the path."""
    direction: V3
    """Unit direction of the path that arrives."""


@inner
def evaluate_material(scene: Any, tile: Any, ray_type: int, code: int, path: Any) -> bool:
    """Run the built-in closest-hit program ``code`` at the hit of ``path``.

    Return True if the path continues.
    """
    triangle = int(path.triangle)
    owner = i32(scene.owner, triangle)
    material = material_at(scene.materials, owner)
    u, v = float(path.u), float(path.v)
    d = heading_of(path)
    p, face, bound = locate_point(scene, triangle, u, v)
    normal = face_forward(interpolate_normal(scene, triangle, u, v, face), d)
    hit = SurfaceHit(material, owner, triangle, u, v, p, face, bound, normal, d)
    return bool(_run_program(code, scene, tile, ray_type, path, hit))


@inner
def evaluate_colour(scene: Any, hit: Any) -> V3:
    """Return the texture of unit 0 at a hit, RGB; white if the material has none."""
    return take_rgb(evaluate_texture(scene, hit.material, hit.triangle, hit.u, hit.v))


@inner
def evaluate_albedo(scene: Any, hit: Any) -> V3:
    """Return DIFFUSE times the texture of unit 0, RGB."""
    colour = evaluate_colour(scene, hit)
    return multiply(take_rgb(diffuse_of(hit.material)), colour)


@inner
def shadow_origin(scene: Any, hit: Any) -> V3:
    """Return the origin of shadow rays: on the path's side of the surface that the normals show."""
    geometric = face_forward(hit.face, hit.direction)
    side = 1.0 if dot(hit.face, hit.direction) < 0.0 else -1.0
    lifted = lift_point(scene, hit.triangle, hit.u, hit.v, hit.position, side)
    return offset_origin(lifted, geometric, hit.bound, geometric)
