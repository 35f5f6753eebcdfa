"""Programs of OptiX 3 to 6: variables by name, and the calls of that device interface.

A variable of such a program is looked up by its name in what it runs for: a material's geometry
(closest hit, any hit, intersection) or the context (ray generation, miss, exception). Here both are
*records* of one layout, so a variable is a place in the record of the frame. Names, sizes and
semantics are what ``rtDeclareVariable`` leaves in a module (OptiX 3 to 6, ``optix_device.h``).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from nau_py.raytrace.ptx.compiler.data import initial_bytes
from nau_py.raytrace.ptx.compiler.module import PtxModule, PtxVariable
from nau_py.raytrace.ptx.compiler.reader import split_call
from nau_py.raytrace.ptx.compiler.writer import FRAME, FunctionWriter
from nau_py.raytrace.ptx.runtime.layout import (
    IGNORE,
    LAUNCH,
    PLACES,
    TERMINATE,
    TRACED,
    address,
    launched,
    leave,
    place,
    read,
    throw,
    trace,
    unwind,
)

PLAIN, BUFFER, TEXTURE = "variable", "buffer", "texture"
BUFFER_BYTES = 40
"""Address, width, height, depth (64 bits each), bytes of an element."""
_INTERNAL = re.compile(r"_ZN\d+rti_internal_(typeinfo|semantic)(\d+)(\w+)E$")
_FRAME = {
    "rtCurrentRay": ("frame", PLACES["origin_x"][0]),
    "rtLaunchIndex": ("frame", PLACES["index_x"][0]),
    "rtLaunchDim": ("launch", LAUNCH["width"][0]),
    "rtPayload": ("payload", 0),
    "rtIntersectionDistance": ("frame", PLACES["tmax"][0]),
}
"""Semantics to the base and the offset of what they mean."""
_ATTRIBUTE = "attribute "
STACK_OVERFLOW = 0x3FC
"""RT_EXCEPTION_STACK_OVERFLOW."""


@dataclass(frozen=True, slots=True)
class DeclaredVariable:
    """A variable: bytes, and the semantic that binds it, empty where its name does."""

    kind: str
    size: int
    semantic: str = ""


def declared(module: PtxModule) -> dict[str, DeclaredVariable]:
    """The variables of a module by name; empty for a module of OptiX 7."""
    if not is_old(module):
        return {}
    facts: dict[str, dict[str, bytes]] = {}
    for variable in module.variables:
        found = _INTERNAL.match(variable.name)
        if found is not None:
            name = found[3][: int(found[2])]
            facts.setdefault(name, {})[found[1]] = initial_bytes(variable) or b""
    return {
        v.name: made
        for v in module.variables
        if (made := _declared(v, facts.get(v.name))) is not None
    }


def _declared(variable: PtxVariable, facts: dict[str, bytes] | None) -> DeclaredVariable | None:
    if facts is not None:
        size = int.from_bytes(facts.get("typeinfo", b"")[4:8], "little") or variable.size
        semantic = facts.get("semantic", b"").split(b"\0")[0].decode("latin-1")
        return DeclaredVariable(PLAIN, size, semantic)
    if variable.type == "texref":
        return DeclaredVariable(TEXTURE, 8)
    if variable.type == "b8" and variable.length == 1 and not variable.value:
        inner = variable.name.startswith("_ZN") and "rti_internal" in variable.name
        return None if inner else DeclaredVariable(BUFFER, BUFFER_BYTES)
    return None


def is_old(module: PtxModule) -> bool:
    """Whether a module is of OptiX 3 to 6."""
    named = any(_INTERNAL.match(variable.name) for variable in module.variables)
    return named or calls(module, "_rt_")


def calls(module: PtxModule, prefix: str) -> bool:
    """Whether a module calls anything whose name begins so."""
    return any(
        split_call(instruction.operands)[1].startswith(prefix)
        for function in module.functions.values()
        for instruction in function.body or []
        if instruction.opcode.startswith("call")
    )


@dataclass(slots=True)
class RecordLayout:
    """Where the variables of all modules of a pass lie: ``offsets`` in a record, ``attributes`` in
    what intersection programs tell of a hit; both by name."""

    variables: dict[str, DeclaredVariable] = field(default_factory=dict)
    offsets: dict[str, int] = field(default_factory=dict)
    attributes: dict[str, int] = field(default_factory=dict)
    sizes: dict[str, int] = field(default_factory=dict)
    """Of attributes, in bytes."""
    record_bytes: int = 0
    attribute_bytes: int = 0

    def add(self, module: PtxModule) -> list[str]:
        """Take in a module's variables; what of them differs from those of others."""
        wrong = []
        for name, variable in declared(module).items():
            if variable.semantic in _FRAME:
                continue
            if variable.semantic.startswith(_ATTRIBUTE):
                attribute = variable.semantic.removeprefix(_ATTRIBUTE)
                if self.sizes.setdefault(attribute, variable.size) != variable.size:
                    wrong.append(
                        f"attribute '{attribute}' has {variable.size} bytes, elsewhere in the pass "
                        f"{self.sizes[attribute]}"
                    )
                elif attribute not in self.attributes:
                    self.attributes[attribute] = self.attribute_bytes
                    self.attribute_bytes += -(-variable.size // 16) * 16
                continue
            other = self.variables.setdefault(name, variable)
            if other != variable:
                wrong.append(
                    f"'{name}' is a {variable.kind} of {variable.size} bytes, in another "
                    f"file of the pass a {other.kind} of {other.size} bytes"
                )
            elif name not in self.offsets:
                self.offsets[name] = self.record_bytes
                self.record_bytes += -(-variable.size // 16) * 16
        return wrong

    def bindings(self, module: PtxModule) -> dict[str, tuple[str, int]]:
        """Base and offset of each variable of a module."""
        found = {}
        for name, variable in declared(module).items():
            if variable.semantic in _FRAME:
                found[name] = _FRAME[variable.semantic]
            elif variable.semantic.startswith(_ATTRIBUTE):
                at = self.attributes[variable.semantic.removeprefix(_ATTRIBUTE)]
                found[name] = ("attributes", at)
            else:
                found[name] = ("record", self.offsets[name])
        return found


def bound(w: FunctionWriter, base: str, offset: int) -> str:
    """The address of a variable."""
    return place(w, FRAME if base == "frame" else address(w, base), offset)


_TRACES = {
    "_rt_trace": ("tmin", "tmax"),
    "_rt_trace_with_time": ("tmin", "tmax", "time"),
    "_rt_trace_mask_flags": ("tmin", "tmax", "mask", "flags"),
    "_rt_trace_time_mask_flags": ("tmin", "tmax", "time", "mask", "flags"),
}
_READS = {
    "_rt_get_primitive_index": ("primitive",),
    "_rt_get_exception_code": ("code",),
    "_rt_get_ray_flags": ("flags",),
    "_rt_get_ray_mask": ("mask",),
    "_rt_get_triangle_barycentrics": ("u", "v"),
    "_rt_get_lowest_group_child_index": ("group",),
}
_CONSTANT = {
    "_rt_get_entry_point_index": "0",
    "_rt_print_active": "1",
    "_rt_is_triangle_hit": "0",
    "_rt_is_triangle_hit_back_face": "0",
    "_rt_is_triangle_hit_front_face": "0",
}
"""One entry point; triangles are hit by the project's own intersection program."""
_OTHERS = (
    "_rt_buffer_get",
    "_rt_buffer_get_size",
    "_rt_potential_intersection",
    "_rt_report_intersection",
    "_rt_ignore_intersection",
    "_rt_terminate_ray",
    "_rt_transform_tuple",
    "_rt_get_transform",
    "_rt_throw",
    "_rt_print_start",
    "_rt_print_write32",
)


def _short(name: str) -> str:
    return name.removesuffix("_64")


def known(name: str) -> bool:
    """Whether a call is one of these."""
    short = _short(name)
    return any(short in names for names in (_TRACES, _READS, _CONSTANT, _OTHERS))


def call(w: FunctionWriter, name: str, returns: list[str], takes: list[str]) -> None:
    """One call. ``returns``: registers, ``takes``: operands."""
    short = _short(name)
    if short in _TRACES:
        _trace(w, _TRACES[short], takes)
    elif short in _READS:
        for register, what in zip(returns, _READS[short]):
            w.write(register, *read(w, what))
    elif short in _CONSTANT:
        w.write(returns[0], _CONSTANT[short], "u32")
    elif short == "_rt_buffer_get":
        _element(w, returns, takes)
    elif short == "_rt_buffer_get_size":
        buffer = w.value(f"inttoptr i64 {w.read(takes[0], 'u64')} to ptr")
        for axis, register in enumerate(returns[:3]):
            size = w.value(f"load i64, ptr {place(w, buffer, 8 + 8 * axis)}")
            w.write(register, size, "u64")
        for register in returns[3:]:
            w.write(register, "0", "u64")
    elif short == "_rt_potential_intersection":
        distance = w.read(takes[0], "f32")
        asked = w.value(f"call i32 @nau.potential(ptr {FRAME}, float {distance})")
        w.write(returns[0], asked, "u32")
    elif short == "_rt_report_intersection":
        taken = w.value(f"call i32 @nau.report(ptr {FRAME})")
        unwind(w)
        w.write(returns[0], taken, "u32")
    elif short in ("_rt_ignore_intersection", "_rt_terminate_ray"):
        leave(w, IGNORE if "ignore" in short else TERMINATE)
    elif short == "_rt_transform_tuple":  # no transforms: object space is world space
        for register, operand in zip(returns, takes[1:]):
            w.write(register, w.read(operand, "f32"), "f32")
    elif short == "_rt_get_transform":
        for index, register in enumerate(returns):
            w.write(register, "1.0" if index % 5 == 0 else "0.0", "f32")
    elif short == "_rt_throw":
        throw(w, w.read(takes[0], "u32"), [])
    elif short == "_rt_print_start":
        text = w.read(takes[0], "u64")
        w.emit(f"call void @nau.print_start(ptr {FRAME}, i64 {text})")
        w.write(returns[0], "4", "u32")
    else:
        value, at = w.read(takes[0], "u32"), w.read(takes[1], "u32")
        w.emit(f"call void @nau.print_write(ptr {FRAME}, i32 {value}, i32 {at})")


def _trace(w: FunctionWriter, limits: tuple[str, ...], takes: list[str]) -> None:
    """``trace(object, origin, direction, ray type, tmin, tmax …, payload, its bytes)``."""
    names = [*list(TRACED)[:7], "offset", *limits]
    if len(takes) < len(names) + 1:
        raise w.fail("a trace call has too few arguments")
    values = {"time": "0.0", "mask": "255", "flags": "0"}
    values |= {name: w.read(operand, TRACED[name]) for name, operand in zip(names, takes)}
    values["stride"], _ = launched(w, "types")
    values["miss"] = values["offset"]
    payload = w.value(f"inttoptr i64 {w.read(takes[len(names)], 'u64')} to ptr")
    trace(w, values, payload)


def _element(w: FunctionWriter, returns: list[str], takes: list[str]) -> None:
    """``(address) = buffer_get(buffer, dimensions, bytes, i, j, k, l)``."""
    buffer, size = w.read(takes[0], "u64"), w.read(takes[2], "u32")
    at = ", ".join(f"i64 {w.read(operand, 'u64')}" for operand in takes[3:6])
    found = w.value(f"call i64 @nau.element(ptr {FRAME}, i64 {buffer}, i32 {size}, {at})")
    unwind(w)
    w.write(returns[0], found, "u64")
