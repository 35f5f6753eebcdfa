"""The surface at a hit: position, normals, texture coordinates; and where rays leave it.

The bounded spawn point of NVIDIA's *self-intersection-avoidance* (2023): the position from
barycentrics, moved along the face normal by a bound of its rounding error, then outward by a float.
"""

from __future__ import annotations

from typing import Any

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.memory import f32, i8, i32
from nau_py.raytrace.kernels.core.tables import texture_at
from nau_py.raytrace.kernels.core.vec import cross, dot, normalize
from nau_py.raytrace.kernels.geometry.texture import RGBA, filter_alpha, filter_texture

C0 = 2.0**-24
"""Factor of the base vertex in the object-space error."""
C1 = 3.0 * 2.0**-24
"""Factor of the triangle's extent, and of the position in the world-space error."""
OUTWARD = 1.5 * 2.0**-24
"""More than float32 rounds by, relative: the origin lies beyond the bound after rounding, too."""


@inner
def load_corner(scene: Any, triangle: int, k: int) -> V3:
    at = 3 * i32(scene.triangles, 3 * triangle + k)
    return f32(scene.vertices, at), f32(scene.vertices, at + 1), f32(scene.vertices, at + 2)


@inner
def locate_point(scene: Any, triangle: int, u: float, v: float) -> tuple[V3, V3, float]:
    """Position, unit face normal as wound, and error bound along it (a distance)."""
    a, b, c = (
        load_corner(scene, triangle, 0),
        load_corner(scene, triangle, 1),
        load_corner(scene, triangle, 2),
    )
    e1 = (b[0] - a[0], b[1] - a[1], b[2] - a[2])
    e2 = (c[0] - a[0], c[1] - a[1], c[2] - a[2])
    p = (
        a[0] + (u * e1[0] + v * e2[0]),
        a[1] + (u * e1[1] + v * e2[1]),
        a[2] + (u * e1[2] + v * e2[2]),
    )
    n = normalize(cross(e1, e2))
    extent = 0.0
    bound = 0.0
    for k in range(3):
        one, two = abs(e1[k]), abs(e2[k])
        extent = max(extent, one + two + abs(one - two))
    for k in range(3):
        bound += (C0 * abs(a[k]) + C1 * extent + C1 * abs(p[k])) * abs(n[k])
    return p, n, bound


@inner
def _move_outward(value: float, offset: float) -> float:
    if offset > 0.0:
        return value + offset + OUTWARD * abs(value)
    if offset < 0.0:
        return value + offset - OUTWARD * abs(value)
    return value


@inner
def offset_origin(position: V3, normal: V3, bound: float, direction: V3) -> V3:
    """Return the origin of a ray that leaves along ``direction``: on its side of the face."""
    step = bound if dot(normal, direction) >= 0.0 else -bound
    return (
        _move_outward(position[0], normal[0] * step),
        _move_outward(position[1], normal[1] * step),
        _move_outward(position[2], normal[2] * step),
    )


@inner
def interpolate_attribute(values: int, scene: Any, triangle: int, u: float, v: float) -> V3:
    """Interpolate the first three components of the vertex attribute at address ``values``."""
    a = 4 * i32(scene.triangles, 3 * triangle)
    b = 4 * i32(scene.triangles, 3 * triangle + 1)
    c = 4 * i32(scene.triangles, 3 * triangle + 2)
    w = 1.0 - u - v
    return (
        f32(values, a) * w + f32(values, b) * u + f32(values, c) * v,
        f32(values, a + 1) * w + f32(values, b + 1) * u + f32(values, c + 1) * v,
        f32(values, a + 2) * w + f32(values, b + 2) * u + f32(values, c + 2) * v,
    )


@inner
def interpolate_normal(scene: Any, triangle: int, u: float, v: float, face: V3) -> V3:
    """Return the interpolated unit normal; the face normal where the vertices give none."""
    if scene.normals_count == 0:
        return face
    if i8(scene.smooth, triangle) == 0:
        at = 4 * i32(scene.triangles, 3 * triangle)
        n = (f32(scene.normals, at), f32(scene.normals, at + 1), f32(scene.normals, at + 2))
        return normalize(n) if dot(n, n) >= 1e-12 else face
    n = interpolate_attribute(scene.normals, scene, triangle, u, v)
    if dot(n, n) < 1e-12:
        return face
    return normalize(n)


@inner
def face_forward(n: V3, direction: V3) -> V3:
    """``n`` turned towards where a ray along ``direction`` comes from."""
    if dot(n, direction) > 0.0:
        return (-n[0], -n[1], -n[2])
    return n


@inner
def interpolate_uv(scene: Any, triangle: int, u: float, v: float) -> tuple[float, float]:
    """texCoord0 at a hit; zero where the mesh has none."""
    if scene.uvs_count == 0:
        return 0.0, 0.0
    a = 4 * i32(scene.triangles, 3 * triangle)
    b = 4 * i32(scene.triangles, 3 * triangle + 1)
    c = 4 * i32(scene.triangles, 3 * triangle + 2)
    w = 1.0 - u - v
    return (
        f32(scene.uvs, a) * w + f32(scene.uvs, b) * u + f32(scene.uvs, c) * v,
        f32(scene.uvs, a + 1) * w + f32(scene.uvs, b + 1) * u + f32(scene.uvs, c + 1) * v,
    )


@inner
def evaluate_texture(scene: Any, material: Any, triangle: int, u: float, v: float) -> RGBA:
    """Return the texture of unit 0 at a hit; white if the material has none."""
    if material.texture < 0:
        return 1.0, 1.0, 1.0, 1.0
    s, t = interpolate_uv(scene, triangle, u, v)
    return filter_texture(texture_at(scene.textures, material.texture), scene.texels, s, t)


@inner
def evaluate_alpha(scene: Any, material: Any, triangle: int, u: float, v: float) -> float:
    """Return the last component of ``evaluate_texture``."""
    if material.texture < 0:
        return 1.0
    s, t = interpolate_uv(scene, triangle, u, v)
    return filter_alpha(texture_at(scene.textures, material.texture), scene.texels, s, t)


@inner
def lift_point(scene: Any, triangle: int, u: float, v: float, position: V3, side: float) -> V3:
    """Return the origin of shadow rays of a smooth surface: on the patch that the normals suggest.

    Hanika, *Hacking the Shadow Terminator*, Ray Tracing Gems II, 2021. ``side``: 1 where the
    surface is seen from its front, else -1.
    """
    if scene.normals_count == 0 or i8(scene.smooth, triangle) == 0:
        return position
    out = (0.0, 0.0, 0.0)
    for k in range(3):
        weight = 1.0 - u - v if k == 0 else (u if k == 1 else v)
        p = load_corner(scene, triangle, k)
        at = 4 * i32(scene.triangles, 3 * triangle + k)
        x, y, z = f32(scene.normals, at), f32(scene.normals, at + 1), f32(scene.normals, at + 2)
        n3 = normalize((x * side, y * side, z * side))
        below = min(0.0, dot((position[0] - p[0], position[1] - p[1], position[2] - p[2]), n3))
        out = (
            out[0] - weight * below * n3[0],
            out[1] - weight * below * n3[1],
            out[2] - weight * below * n3[2],
        )
    return position[0] + out[0], position[1] + out[1], position[2] + out[2]


@inner
def keep_above(direction: V3, geometric: V3) -> V3:
    """Return ``direction``, turned back over the face if an interpolated normal sent it below."""
    below = dot(direction, geometric)
    if below >= 0.0:
        return direction
    return (
        direction[0] - 2.0 * below * geometric[0],
        direction[1] - 2.0 * below * geometric[1],
        direction[2] - 2.0 * below * geometric[2],
    )
