"""The data that kernels read: records of materials, textures, lights, of the scene, of a tile."""

from __future__ import annotations

import numpy as np

from nau_py.raytrace.kernels.core.layout import RecordLayout
from nau_py.raytrace.kernels.core.memory import (
    field_reader,
    field_writer,
    record_copier,
    record_reader,
)

MEDIA = 4
"""Dielectrics that a path can be inside of at once."""

MATERIAL = RecordLayout(
    [
        ("diffuse", "f4", 4),
        ("specular", "f4", 3),
        ("emission", "f4", 3),
        ("shininess", "f4"),
        ("texture", "i4"),
    ]
)
"""Nau's attributes that several programs read; programs add a field for each of their own
attributes. ``texture``: of unit 0, or -1."""
material_at = record_reader(MATERIAL)
diffuse_of = field_reader(MATERIAL, "diffuse")
specular_of = field_reader(MATERIAL, "specular")
emission_of = field_reader(MATERIAL, "emission")

TEXTURE = np.dtype(
    [
        ("offset", "i8"),
        ("width", "i4"),
        ("height", "i4"),
        ("wrap_s", "i4"),
        ("wrap_t", "i4"),
        ("nearest", "i4"),
        ("border", "f4", 4),
    ],
    align=True,
)
texture_at = record_reader(TEXTURE)
border_of = field_reader(TEXTURE, "border")

LIGHT = np.dtype(
    [
        ("shape", "i4"),
        ("position", "f8", 3),
        ("direction", "f8", 3),
        ("colour", "f8", 3),
        ("attenuation", "f8", 3),
        ("spot", "f8", 3),
        ("cutoff", "f8"),
        ("exponent", "f8"),
        ("edge_u", "f8", 3),
        ("edge_v", "f8", 3),
        ("radius", "f8"),
    ],
    align=True,
)
"""World space less the scene's centre. ``spot`` is the unit axis, ``cutoff`` its cosine (-1: no
spot). ``edge_u`` and ``edge_v`` span a rectangle about ``position``, or are a disc's half axes."""
light_at = record_reader(LIGHT)
position_of = field_reader(LIGHT, "position")
direction_of = field_reader(LIGHT, "direction")
colour_of = field_reader(LIGHT, "colour")
attenuation_of = field_reader(LIGHT, "attenuation")
spot_of = field_reader(LIGHT, "spot")
edge_u_of = field_reader(LIGHT, "edge_u")
edge_v_of = field_reader(LIGHT, "edge_v")

SHAPES = ("DIRECTIONAL", "POINT", "SPOT", "RECTANGLE", "DISC", "SPHERE")
DIRECTIONAL, POINT, SPOT, RECTANGLE, DISC, SPHERE = range(6)

ARRAYS: dict[str, str | RecordLayout | np.dtype[np.void]] = {
    "vertices": "f4",
    "triangles": "i4",
    "owner": "i4",
    "normals": "f4",
    "uvs": "f4",
    "smooth": "i1",
    "materials": MATERIAL,
    "textures": TEXTURE,
    "texels": "u1",
    "lights": LIGHT,
    "emitters": "i4",
    "emitter_cdf": "f8",
    "emitter_pdf": "f8",
    "closest": "i1",
    "any_hit": "i1",
    "miss": "i1",
    "has_any_hit": "i1",
    "visibility": "i1",
    "deferred_shadows": "i1",
}
"""The arrays of a scene. Triangles, vertices (3 a row), attributes (4 a row) and materials as in
RayGeometry; ``smooth``: triangles whose normals differ; ``emitter_pdf``: density over area by
triangle; ``closest`` and ``any_hit``: codes of programs by ray type and material; the rest by ray
type: ``miss`` codes; ``has_any_hit``: NOTHING, DECIDED, PARTIAL or PYTHON; ``visibility`` where
there is no closest-hit program; ``deferred_shadows`` where a Python program decides on the
visibility."""

NOTHING, DECIDED, PARTIAL, PYTHON = range(4)
"""Any-hit programs of a ray type: none; only such as stop a ray or let it pass, which Embree runs
while it traces; some that let a part of the light pass; some written in Python."""

SCENE = RecordLayout(
    [
        *((name, "u8") for name in ARRAYS),
        *((f"{name}_count", "i8") for name in ARRAYS),
        ("standing", "u8"),
        ("moving", "u8"),
        ("first_moving", "i4"),
        ("seed", "u4"),
        ("max_depth", "i4"),
        ("shadow_type", "i4"),
        ("light_samples", "i4"),
        ("material_count", "i4"),
        ("asks_python", "i4"),
        ("skipped", "i4"),
        ("caustics", "i4"),
        ("negligible", "f8"),
        ("occlusion_distance", "f8"),
        ("background", "f4", 4),
    ]
)
"""Addresses and lengths of the arrays, Embree's scenes (0 for none; triangle ``first_moving``
begins the second), and the settings of the pass. ``shadow_type``: index of the ray type of
shadow rays, -1 for none. ``asks_python``: 1 if any program is written in Python. ``skipped``: a bit
for each kind of ray that is not sent. ``caustics``: 1 if lamps count that are met by way of a
mirror or glass after a diffuse surface. ``negligible``: weight below which specular chains end.
Positions are world space less the centre."""
background_of = field_reader(SCENE, "background")


def add_array(name: str, dtype: str) -> None:
    """Add an array to the scene: kernels read its address as ``scene.name``."""
    ARRAYS[name] = dtype
    SCENE.add((name, "u8"))
    SCENE.add((f"{name}_count", "i8"))


PATH = np.dtype(
    [
        ("origin", "f4", 3),
        ("direction", "f4", 3),
        ("weight", "f4", 4),
        ("tmax", "f4"),
        ("travelled", "f4"),
        ("pdf", "f4"),
        ("initial", "f4"),
        ("u", "f4"),
        ("v", "f4"),
        ("t", "f4"),
        ("triangle", "i4"),
        ("index", "i4"),
        ("pixel", "u4"),
        ("sample", "u4"),
        ("depth", "i4"),
        ("layers", "i4"),
        ("media", "i4", MEDIA),
        ("band", "i4"),
        ("kind", "i4"),
        ("status", "i2"),
        ("scattered", "i2"),
    ],
    align=True,
)
"""A ray under way, and the state of its hit.

``weight`` (RGB and alpha) multiplies the radiance of the ray, for result ``index``. ``pdf``:
density over solid angle with which the direction was chosen, 0 where light sampling does
not share it.
``initial``: the radiance of a miss without a program. ``travelled``: distance before the present
origin, past ignored hits. ``media``: indices of the materials that the origin is inside of, -1 for
none. ``band``: the colour band that is followed after a fluorescent surface, -1 for all.
``scattered``: 1 if it has left a diffuse surface.
"""
path_at, copy_path = record_reader(PATH), record_copier(PATH)
origin_of, set_origin = field_reader(PATH, "origin"), field_writer(PATH, "origin")
heading_of, set_heading = field_reader(PATH, "direction"), field_writer(PATH, "direction")
weight_of, set_weight = field_reader(PATH, "weight"), field_writer(PATH, "weight")
media_of, set_media = field_reader(PATH, "media"), field_writer(PATH, "media")

TILE = np.dtype(
    [
        ("ray", "u8"),
        ("packet", "u8"),
        ("valid", "u8"),
        ("query", "u8"),
        ("lanes", "u8"),
        ("seen", "u8"),
        ("counts", "u8"),
        ("radiance", "u8"),
        ("work", "u8"),
        ("stack", "u8"),
        ("shadows", "u8"),
        ("deferred", "u8"),
        ("viewed", "u8"),
        ("capacity", "i8"),
        ("next", "i8"),
        ("waiting", "i8"),
        ("top", "i8"),
        ("pending", "i8"),
        ("shift", "i8"),
    ],
    align=True,
)
"""The memory of one thread: addresses of Embree's single ray, of its packet, of the packet's
int32 mask of valid lanes and of the QUERY; of the paths in the lanes (int64) and the visibility
that they find (float32); of the counters, the results (4 float32 a row), the LANES paths of a
packet, those that wait (``top`` of them), shadow rays (``pending`` of them), and paths that Python
must answer (``waiting`` of ``capacity``, and one slot for what is too much); ``viewed``: int32 a
material, 1 where a primary ray met it; ``next``: the path of the queue to follow. Samples of the
same pixel >> ``shift`` are traced together."""

LANES = 16
"""Rays, and paths, of a packet."""

SHADOW_RAY = np.dtype(
    [
        ("origin", "f4", 3),
        ("direction", "f4", 3),
        ("light", "f4", 3),
        ("tmax", "f4"),
        ("index", "i4"),
        ("pixel", "u4"),
        ("sample", "u4"),
        ("depth", "i4"),
        ("source", "i4"),
    ],
    align=True,
)
"""A ray to a light: ``light`` is added to result ``index`` as far as the ray gets through;
``source``: the light's number, that of the emissive triangles comes after the last light's."""
shadow_at = record_reader(SHADOW_RAY)
ray_origin_of, set_ray_origin = (
    field_reader(SHADOW_RAY, "origin"),
    field_writer(SHADOW_RAY, "origin"),
)
ray_heading_of, set_ray_heading = (
    field_reader(SHADOW_RAY, "direction"),
    field_writer(SHADOW_RAY, "direction"),
)
light_of, set_light = field_reader(SHADOW_RAY, "light"), field_writer(SHADOW_RAY, "light")
SHADOWS = 512
"""Shadow rays that are collected before they are traced."""

QUERY = np.dtype(
    [
        ("flags", "i4"),
        ("features", "i4"),
        ("context", "u8"),
        ("filter", "u8"),
        ("callback", "u8"),
        ("width", "f8"),
        ("instance", "i4"),
        ("instance_primitive", "i4"),
        ("scene", "u8"),
        ("counts", "u8"),
        ("ray_type", "i8"),
        ("first", "i8"),
        ("pixel", "u4", LANES),
        ("sample", "u4", LANES),
        ("depth", "i4", LANES),
        ("ignored", "f4", LANES),
    ],
    align=True,
)
"""RTCIntersectArguments (and RTCOccludedArguments) of rtcore_common.h, then, from ``instance`` on,
an RTCRayQueryContext with what any-hit programs need: addresses of the SCENE and the counters, the
ray type, the scene's ``first`` triangle in Embree's scene, whose rays are in the lanes, and how far
the last hit was that each ignored."""

TRACE, SHADE, HIT, CANDIDATE, MISSED, OCCLUSION = range(6)
"""Status: to be traced; accepted hit to be shaded; and the events that Python programs handle: a
closest hit, an any hit, a miss, the visibility of a light (``weight`` is then its contribution)."""

KINDS = (
    "primary",
    "shadow",
    "reflection",
    "refraction",
    "occlusion",
    "indirect",
    "continuation",
)
PRIMARY, SHADOW, REFLECTION, REFRACTION, AMBIENT, INDIRECT, CONTINUATION, OTHER = range(8)
NONFINITE, CUT, IN_EMBREE, SKIPPED, COUNTERS = 8, 9, 10, 11, 19
"""Slots of the counters (int64): rays by kind, rays not finite, rays cut by the layer limit, cycles
that rays took, and from SKIPPED on by kind rays that were not sent."""

STACK = 256
"""Paths that wait while other parts of the same samples are followed."""
