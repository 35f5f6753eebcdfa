"""What compiled programs and their runtime share: places, as offsets in bytes.

A *frame* is what one program runs with: the launch, the ray, the hit, the payload. It lies on the
stack of whoever calls the program. ``runtime.ll`` is filled in with the same places, by name.
"""

from __future__ import annotations

from string import Template

from nau_py.raytrace.ptx.compiler.literals import llvm_type
from nau_py.raytrace.ptx.compiler.writer import FRAME, FunctionWriter

Places = dict[str, tuple[int, str]]
"""Name to offset and type."""
_BYTES = {"u32": 4, "f32": 4, "u64": 8}


def _laid(*fields: str) -> Places:
    """Fields ``name type`` one after the other, each at a multiple of its size."""
    found: Places = {}
    at = 0
    for field in fields:
        name, type_ = field.split()
        size = _BYTES[type_]
        at = -(-at // size) * size
        found[name] = (at, type_)
        at += size
    return found


def _bytes(places: Places) -> int:
    offset, type_ = list(places.values())[-1]
    return -(-(offset + _BYTES[type_]) // 16) * 16


PLACES = _laid(
    "launch u64", "payload u64", "record u64", "attributes u64", "query u64",
    "primitive u32", "u f32", "v f32",
    "origin_x f32", "origin_y f32", "origin_z f32",
    "direction_x f32", "direction_y f32", "direction_z f32",
    "ray_type u32", "tmin f32", "tmax f32",
    "time f32", "flags u32", "mask u32", "hit_kind u32", "depth u32", "status u32",
    "index_x u32", "index_y u32", "index_z u32", "group u32", "code u32",
)  # fmt: skip
"""Of a frame. ``record``: the address of the record's data; ``attributes``: of what an intersection
program tells of its hit, 0 for triangles; ``origin_x`` to ``tmax`` are a ``Ray`` of OptiX 6."""
FRAME_BYTES = _bytes(PLACES)
IGNORE, TERMINATE = 1, 2
"""Bits of ``status`` that any-hit programs set."""
BUFFER_INDEX, NO_CALLABLE = 0x3FD, -10
"""Codes of the runtime's own exceptions: RT_EXCEPTION_BUFFER_INDEX_OUT_OF_BOUNDS, and ours."""
DETAILS = 8
"""Words that a thrown exception has."""
PRINTED = 64
"""Words of the arguments of an OptiX 6 ``rtPrintf``."""
LAUNCH = _laid(
    "scene u64", "hit_records u64", "miss_records u64", "rays u64", "raygen_record u64",
    "mark u64", "exception u64", "indices u64", "callables u64", "first_thrown u64", "format u64",
    "width u32", "height u32", "layers u32", "max_depth u32", "hit_count u32", "miss_count u32",
    "record_bytes u32", "attribute_bytes u32", "types u32", "callable_count u32", "flush u32",
    "overflow u32", "thrown u32", "code u32", "thrown_count u32", "first_code u32",
    *(f"detail_{i} u32" for i in range(DETAILS)),
    *(f"printed_{i} u32" for i in range(PRINTED)),
)  # fmt: skip
"""Of a part of a launch. ``rays``: the address of its counters; ``mark``: of the launch index that
is worked at; ``indices``: of the launch indices that are selected, 0 for all; ``flush``: denormals
are zero; ``overflow``: the code of rays that go too deep; ``thrown``: an exception is on its way
out; ``format``: of text that is being printed."""
LAUNCH_BYTES = _bytes(LAUNCH)
QUERY = _laid(
    "instance u32", "instance_primitive u32", "caller u64", "payload u64", "candidate u64",
    "committed u64", "offset u32", "stride u32", "flags u32", "ended u32", "accepted u32",
    "best f32", "nearest f32", "kind u32", "hit_kind u32",
)  # fmt: skip
"""Of a ray on its way through Embree, behind its ``RTCRayQueryContext``: ``candidate`` and
``committed`` are attributes, ``nearest`` is the distance of a candidate, ``best`` of the hit."""
QUERY_BYTES = _bytes(QUERY)
RECORD = _laid("closest u64", "any u64", "intersect u64", "spare u64")
"""A record begins with its programs, as long as OptiX's header; data follow."""
RECORD_HEADER = 32
EMBREE = {
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
"""Of Embree's ``RTCRayHit`` (rtcore_ray.h)."""


def fill_in(text: str) -> str:
    """A text of LLVM's language with ``$frame_depth`` and the like as numbers."""
    numbers = {f"frame_{name}": offset for name, (offset, _) in PLACES.items()}
    numbers |= {f"launch_{name}": offset for name, (offset, _) in LAUNCH.items()}
    numbers |= {f"query_{name}": offset for name, (offset, _) in QUERY.items()}
    numbers |= {f"record_{name}": offset for name, (offset, _) in RECORD.items()}
    numbers |= EMBREE
    numbers |= {"FRAME": FRAME_BYTES, "QUERY": QUERY_BYTES, "HEADER": RECORD_HEADER}
    numbers |= {"BUFFER_INDEX": BUFFER_INDEX, "NO_CALLABLE": NO_CALLABLE}
    numbers |= {"IGNORE": IGNORE, "TERMINATE": TERMINATE, "PRINTED": PRINTED}
    return Template(text).substitute({k: str(v) for k, v in numbers.items()})


def place(w: FunctionWriter, base: str, offset: int) -> str:
    return w.value(f"getelementptr i8, ptr {base}, i64 {offset}")


def read(w: FunctionWriter, name: str) -> tuple[str, str]:
    """A value of the frame, and its type."""
    offset, type_ = PLACES[name]
    return w.value(f"load {llvm_type(type_)}, ptr {place(w, FRAME, offset)}"), type_


def address(w: FunctionWriter, name: str) -> str:
    """What an address in the frame points to."""
    return w.value(f"inttoptr i64 {read(w, name)[0]} to ptr")


def launched(w: FunctionWriter, name: str) -> tuple[str, str]:
    """A value of the launch, and its type."""
    offset, type_ = LAUNCH[name]
    return w.value(f"load {llvm_type(type_)}, ptr {place(w, address(w, 'launch'), offset)}"), type_


def unwind(w: FunctionWriter) -> None:
    """Leave the function where an exception was thrown in what it called."""
    thrown, _ = launched(w, "thrown")
    out, on = w.label("thrown"), w.label("kept")
    test = w.value(f"icmp ne i32 {thrown}, 0")
    w.jump(f'br i1 {test}, label %"{out}", label %"{on}"')
    w.block(out)
    w.jump("ret void")
    w.block(on)


def leave(w: FunctionWriter, bit: int) -> None:
    """End an any-hit program that ignores its hit or ends its ray."""
    status, _ = read(w, "status")
    value = w.value(f"or i32 {status}, {bit}")
    w.emit(f"store i32 {value}, ptr {place(w, FRAME, PLACES['status'][0])}")
    w.jump("ret void")


def throw(w: FunctionWriter, code: str, details: list[str]) -> None:
    """End the work at this launch index: its exception program follows."""
    launch = address(w, "launch")
    for name, value in [("code", code), *((f"detail_{i}", d) for i, d in enumerate(details))]:
        w.emit(f"store i32 {value}, ptr {place(w, launch, LAUNCH[name][0])}")
    w.emit(f"store i32 1, ptr {place(w, launch, LAUNCH['thrown'][0])}")
    w.jump("ret void")


def trace(w: FunctionWriter, values: dict[str, str], payload: str) -> None:
    """Send a ray. ``values``: those of :data:`TRACED`."""
    listed = ", ".join(f"{llvm_type(type_)} {values[name]}" for name, type_ in TRACED.items())
    w.emit(f"call void @nau.trace(ptr {FRAME}, {listed}, ptr {payload})")
    unwind(w)


TRACED = {
    "handle": "u64", "origin_x": "f32", "origin_y": "f32", "origin_z": "f32",
    "direction_x": "f32", "direction_y": "f32", "direction_z": "f32", "tmin": "f32", "tmax": "f32",
    "time": "f32", "mask": "u32", "flags": "u32", "offset": "u32", "stride": "u32", "miss": "u32",
}  # fmt: skip
"""What a ray has, in the order of the runtime's ``nau.trace``."""
