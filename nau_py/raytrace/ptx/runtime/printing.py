"""Text that compiled programs print: C's format strings and their values, read from memory.

``printf`` (*CUDA C++ Programming Guide*, "Formatted Output") stores values one after the other,
each aligned to its size, floats as doubles. ``rtPrintf`` of OptiX 6 stores words with their types.
"""

from __future__ import annotations

import ctypes
import re
import struct
from collections.abc import Iterator

PrintedTexts = list[tuple[int, str]]
"""Launch indices and texts."""
CALLBACK = ctypes.CFUNCTYPE(
    None, ctypes.c_uint64, ctypes.c_uint64, ctypes.c_uint64, ctypes.c_uint32
)
_SPEC = re.compile(
    r"%(?P<flags>[-+ #0]*)(?P<width>\d*)(?P<precision>\.\d*)?"
    r"(?P<size>hh|h|ll|l|z)?(?P<kind>[a-zA-Z%])"
)
_MOST = 1 << 16
"""Longest text in bytes: a text without a final zero is cut."""
_TYPES = {0: "<i", 1: "<q", 2: "<f", 3: "<d"}


def _read_string(address: int) -> str:
    if not address:
        return "(null)"
    found = bytearray()
    while len(found) < _MOST and (byte := ctypes.c_ubyte.from_address(address + len(found)).value):
        found.append(byte)
    return found.decode("utf-8", "replace")


def _read_values(address: int, kinds: list[str]) -> Iterator[int | float]:
    at = address
    for kind in kinds:
        size = struct.calcsize(kind)
        at = -(-at // size) * size
        yield struct.unpack(kind, ctypes.string_at(at, size))[0]
        at += size


def _read_typed(address: int, count: int) -> Iterator[int | float]:
    at = address
    for _ in range(count):
        kind = _TYPES.get(struct.unpack("<I", ctypes.string_at(at, 4))[0], "<i")
        size = struct.calcsize(kind)
        yield struct.unpack(kind, ctypes.string_at(at + 4, size))[0]
        at += 4 + size


def _value_kind(spec: re.Match[str]) -> str:
    if spec["kind"] in "eEfFgGaA":
        return "<d"
    wide = spec["size"] in ("l", "ll", "z") or spec["kind"] in "sp"
    return "<q" if wide else "<i"


def _format_value(spec: re.Match[str], value: int | float) -> str:
    kind, layout = spec["kind"], f"%{spec['flags']}{spec['width']}{spec['precision'] or ''}"
    whole = int(value) if value == value and abs(value) != float("inf") else 0
    if kind == "s":
        return (layout + "s") % _read_string(whole)
    if kind == "p":
        return (layout + "s") % f"0x{whole & (1 << 64) - 1:x}"
    if kind in "uoxX":
        bits = 64 if spec["size"] in ("l", "ll", "z") else 32
        return (layout + ("d" if kind == "u" else kind)) % (whole & (1 << bits) - 1)
    if kind in "aA":
        return float(value).hex()
    if kind in "diceEfFgG":
        return (layout + kind) % (chr(whole & 255) if kind == "c" else value)
    return spec[0]


def format_text(form: int, values: int, typed: bool) -> str:
    """Format the string at address ``form`` with the values at another address.

    ``typed``: the values are words with their types (OptiX 6).
    """
    text = _read_string(form)
    specs = [spec for spec in _SPEC.finditer(text) if spec["kind"] != "%"]
    if typed:
        found = _read_typed(values, len(specs))
    else:
        found = _read_values(values, [_value_kind(spec) for spec in specs])
    return _SPEC.sub(lambda s: "%" if s["kind"] == "%" else _format_value(s, next(found)), text)
