"""Memory layout of frames, launches, queries and records, as offsets in bytes.

A *frame* is the state that one program runs with: launch, ray, hit and payload. It is on the stack
of the program's caller. Compiled programs and ``runtime.ll`` use the same offsets:
:func:`fill_in` writes them into that text.
"""

from __future__ import annotations

from string import Template

Offsets = dict[str, tuple[int, str]]
"""Offset and type of each field, by name."""
_BYTES = {"u32": 4, "f32": 4, "u64": 8}


def _lay_out(*fields: str) -> Offsets:
    """Place fields ``name type`` one after the other, each at a multiple of its size."""
    found: Offsets = {}
    at = 0
    for field in fields:
        name, type_ = field.split()
        size = _BYTES[type_]
        at = -(-at // size) * size
        found[name] = (at, type_)
        at += size
    return found


def _size_of(fields: Offsets) -> int:
    """Return the size of a layout in bytes, a multiple of 16."""
    offset, type_ = list(fields.values())[-1]
    return -(-(offset + _BYTES[type_]) // 16) * 16


FRAME_FIELDS = _lay_out(
    "launch u64", "payload u64", "record u64", "attributes u64", "query u64",
    "primitive u32", "u f32", "v f32",
    "origin_x f32", "origin_y f32", "origin_z f32",
    "direction_x f32", "direction_y f32", "direction_z f32",
    "ray_type u32", "tmin f32", "tmax f32",
    "time f32", "flags u32", "mask u32", "hit_kind u32", "depth u32", "status u32",
    "index_x u32", "index_y u32", "index_z u32", "group u32", "code u32",
)  # fmt: skip
"""Fields of a frame. ``record``: address of the record's data; ``attributes``: address of the hit's
attributes, 0 for triangles; ``origin_x`` to ``tmax`` are a ``Ray`` of OptiX 6."""
FRAME_BYTES = _size_of(FRAME_FIELDS)
IGNORE, TERMINATE = 1, 2
"""Bits of ``status`` that any-hit programs set."""
BUFFER_INDEX, NO_CALLABLE = 0x3FD, -10
"""Codes of the runtime's exceptions: RT_EXCEPTION_BUFFER_INDEX_OUT_OF_BOUNDS, and one of ours."""
DETAILS = 8
"""Words of data of an exception."""
PRINTED = 64
"""Words of the arguments of an OptiX 6 ``rtPrintf``."""
LAUNCH_FIELDS = _lay_out(
    "scene u64", "hit_records u64", "miss_records u64", "rays u64", "raygen_record u64",
    "mark u64", "exception u64", "indices u64", "callables u64", "first_thrown u64", "format u64",
    "width u32", "height u32", "layers u32", "max_depth u32", "hit_count u32", "miss_count u32",
    "record_bytes u32", "attribute_bytes u32", "types u32", "callable_count u32", "flush u32",
    "overflow u32", "thrown u32", "code u32", "thrown_count u32", "first_code u32",
    *(f"detail_{i} u32" for i in range(DETAILS)),
    *(f"printed_{i} u32" for i in range(PRINTED)),
)  # fmt: skip
"""Fields of a part of a launch. Addresses: ``rays`` of the ray counters, ``mark`` of the launch
index in work, ``indices`` of the selected launch indices (0: all), ``format`` of text that is being
printed. ``flush``: denormals are zero; ``overflow``: exception code of rays above the greatest
depth; ``thrown``: 1 while an exception ends the program."""
LAUNCH_BYTES = _size_of(LAUNCH_FIELDS)
QUERY_FIELDS = _lay_out(
    "instance u32", "instance_primitive u32", "caller u64", "payload u64", "candidate u64",
    "committed u64", "offset u32", "stride u32", "flags u32", "ended u32", "accepted u32",
    "best f32", "nearest f32", "kind u32", "hit_kind u32",
)  # fmt: skip
"""Fields of a ray query, behind Embree's ``RTCRayQueryContext``. Addresses of attributes:
``candidate`` and ``committed``; distances: ``nearest`` of the candidate, ``best`` of the hit."""
QUERY_BYTES = _size_of(QUERY_FIELDS)
RECORD_FIELDS = _lay_out("closest u64", "any u64", "intersect u64", "spare u64")
"""Fields of a record's header: its programs. The header has the size of OptiX's; data follow."""
RECORD_HEADER = 32
EMBREE_OFFSETS = {
    "ray_tmin": 12,
    "ray_direction": 16,
    "ray_tmax": 32,
    "hit": 48,
    "hit_u": 60,
    "hit_v": 64,
    "hit_primitive": 68,
    "hit_geometry": 72,
    "hit_instance": 76,
}
"""Offsets in Embree's ``RTCRayHit`` (rtcore_ray.h)."""


def fill_in(text: str) -> str:
    """Replace names like ``$frame_depth`` in a text of LLVM's language by their offsets."""
    numbers = {f"frame_{name}": offset for name, (offset, _) in FRAME_FIELDS.items()}
    numbers |= {f"launch_{name}": offset for name, (offset, _) in LAUNCH_FIELDS.items()}
    numbers |= {f"query_{name}": offset for name, (offset, _) in QUERY_FIELDS.items()}
    numbers |= {f"record_{name}": offset for name, (offset, _) in RECORD_FIELDS.items()}
    numbers |= EMBREE_OFFSETS
    numbers |= {"FRAME": FRAME_BYTES, "QUERY": QUERY_BYTES, "HEADER": RECORD_HEADER}
    numbers |= {"BUFFER_INDEX": BUFFER_INDEX, "NO_CALLABLE": NO_CALLABLE}
    numbers |= {"IGNORE": IGNORE, "TERMINATE": TERMINATE, "PRINTED": PRINTED}
    return Template(text).substitute({k: str(v) for k, v in numbers.items()})


TRACE_ARGUMENTS = {
    "handle": "u64", "origin_x": "f32", "origin_y": "f32", "origin_z": "f32",
    "direction_x": "f32", "direction_y": "f32", "direction_z": "f32", "tmin": "f32", "tmax": "f32",
    "time": "f32", "mask": "u32", "flags": "u32", "offset": "u32", "stride": "u32", "miss": "u32",
}  # fmt: skip
"""Arguments of the runtime's ``nau.trace``, in order, with their types."""
