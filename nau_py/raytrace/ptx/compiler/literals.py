"""LLVM's spelling of PTX types and constants (PTX ISA, 4.5 and 5.2)."""

from __future__ import annotations

import re
import struct

from nau_py.raytrace.ptx.compiler.module import SIZES

WHOLE_NUMBER = re.compile(r"-?(0[xX][0-9A-Fa-f]+|0[bB][01]+|0[0-7]*|[1-9]\d*)U?$")
_HEX_FLOAT = re.compile(r"0[fF]([0-9A-Fa-f]{8})$")
_HEX_DOUBLE = re.compile(r"0[dD]([0-9A-Fa-f]{16})$")


def llvm_type(type_: str) -> str:
    """Return LLVM's type of a PTX type. Integers have no sign in LLVM."""
    if type_ == "pred":
        return "i1"
    if type_ in ("f32", "f64"):
        return "float" if type_ == "f32" else "double"
    return f"i{8 * SIZES[type_]}"


def is_float(type_: str) -> bool:
    return type_ in ("f32", "f64")


def is_signed(type_: str) -> bool:
    return type_.startswith("s")


def float_text(value: float, type_: str) -> str:
    """Write a float constant as LLVM does: the bits of the double."""
    if type_ == "f32":
        value = struct.unpack("<f", struct.pack("<f", value))[0] if abs(value) < 3.5e38 else value
    return f"0x{struct.unpack('<Q', struct.pack('<d', value))[0]:016X}"


def single_text(bits: int) -> str:
    """Write a float32 of the given bits. A NaN keeps its payload."""
    exponent, fraction, sign = bits >> 23 & 0xFF, bits & 0x7FFFFF, bits >> 31
    if exponent == 0xFF:
        return f"0x{sign << 63 | 0x7FF << 52 | fraction << 29:016X}"
    return float_text(struct.unpack("<f", struct.pack("<I", bits))[0], "f32")


def parse_integer(text: str) -> int:
    """Parse an integer constant of PTX (4.5.1)."""
    plain = text.rstrip("U")
    sign = -1 if plain.startswith("-") else 1
    digits = plain.lstrip("-")
    if digits.lower().startswith(("0x", "0b")):
        return sign * int(digits, 0)
    return sign * int(digits, 8 if len(digits) > 1 and digits.startswith("0") else 10)


def bits_text(operand: str, type_: str) -> str | None:
    """Write a constant given by its bits (``0f3F800000``, ``0d…``); None for another operand."""
    single, double = _HEX_FLOAT.match(operand), _HEX_DOUBLE.match(operand)
    if single:
        bits = int(single[1], 16)
        if type_ == "f64":
            return float_text(struct.unpack("<f", struct.pack("<I", bits))[0], "f64")
        return single_text(bits) if type_ == "f32" else str(bits)
    if double:
        bits = int(double[1], 16)
        if type_ == "f32":
            value = struct.unpack("<d", struct.pack("<Q", bits))[0]
            return float_text(value, "f32")
        return f"0x{bits:016X}" if type_ == "f64" else str(bits)
    return None


def integer_text(operand: str, type_: str) -> str:
    """Write an integer constant as a value of ``type_``, modulo its range."""
    number = parse_integer(operand)
    if type_ == "pred":
        return "true" if number else "false"
    if is_float(type_):
        return float_text(float(number), type_)
    return str(number & ((1 << 8 * SIZES[type_]) - 1))
