"""What programs do with records and payloads, as far as their text tells: nothing is run.

Registers are followed where they are written once, through moves and sums with numbers, as nvcc
writes the addresses of structures.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from nau_py.raytrace.ptx.compiler.module import SIZES, PtxFunction, PtxInstruction, PtxModule
from nau_py.raytrace.ptx.compiler.reader import split_call

_TRACE = re.compile(r"_optix_trace_([0-8])$")
_PAYLOAD = re.compile(r"_optix_[gs]et_payload_([0-7])$")
_OLD_TRACE = re.compile(r"_rt_trace\w*$")
_ADDRESS = re.compile(r"\[\s*([^\s+\]]+)\s*(?:\+\s*(\d+)\s*)?\]$")
_NUMBER = re.compile(r"\d+$")


@dataclass(slots=True)
class ProgramUses:
    """Of a program with what it calls: ``record`` and ``payload``: how far it reaches, in bytes and
    in words; ``sent``: words of payload of the rays that it sends (OptiX 7); ``sent_bytes``: bytes
    (OptiX 3 to 6)."""

    record: int = 0
    payload: int = 0
    sent: set[int] = field(default_factory=set)
    sent_bytes: set[int] = field(default_factory=set)


def analyse_program(module: PtxModule, function: PtxFunction) -> ProgramUses:
    """What a program and the functions that it calls use."""
    found, seen, open_ = ProgramUses(), set[str](), [function]
    while open_:
        current = open_.pop()
        if current.name in seen:
            continue
        seen.add(current.name)
        _add(found, current)
        for instruction in current.body or []:
            if instruction.opcode.startswith("call"):
                called = module.functions.get(split_call(instruction.operands)[1])
                open_ += [called] if called is not None else []
    return found


def _add(found: ProgramUses, function: PtxFunction) -> None:
    body = function.body or []
    once = _written_once(body)
    numbers: dict[str, int] = {}
    records: dict[str, int] = {}
    for instruction in body:
        operands, base = instruction.operands, instruction.opcode.split(".")[0]
        if base == "call":
            _call(found, operands, numbers, records)
        elif len(operands) > 1 and operands[0] in once:
            _follow(base, operands, numbers, records)
        if base in ("ld", "ldu", "st") and operands:
            place = _ADDRESS.match(operands[0 if base == "st" else -1])
            if place is not None and place[1] in records:
                end = records[place[1]] + int(place[2] or 0) + _width(instruction)
                found.record = max(found.record, end)


def _written_once(body: list[PtxInstruction]) -> set[str]:
    counts: dict[str, int] = {}
    for instruction in body:
        first = instruction.operands[0] if instruction.operands else ""
        for register in first.strip("(){}").split(","):
            counts[register.strip()] = counts.get(register.strip(), 0) + 1
    return {name for name, count in counts.items() if count == 1}


def _follow(
    base: str, operands: tuple[str, ...], numbers: dict[str, int], records: dict[str, int]
) -> None:
    to, source = operands[0], operands[1]
    if base in ("mov", "cvta"):
        if source in records:
            records[to] = records[source]
        elif source in numbers:
            numbers[to] = numbers[source]
        elif _NUMBER.match(source):
            numbers[to] = int(source)
    elif base == "add" and len(operands) > 2 and source in records:
        more = operands[2]
        if _NUMBER.match(more):
            records[to] = records[source] + int(more)


def _call(
    found: ProgramUses, operands: tuple[str, ...], numbers: dict[str, int], records: dict[str, int]
) -> None:
    returns, name, takes = split_call(operands)

    def number(operand: str) -> int | None:
        return int(operand) if _NUMBER.match(operand) else numbers.get(operand)

    if name == "_optix_get_sbt_data_ptr_64" and returns:
        records[returns[0]] = 0
    elif words := _TRACE.match(name):
        found.sent.add(int(words[1]))
    elif name == "_optix_trace_typed_32" and len(takes) > 16:
        found.sent.add(number(takes[16]) or 32)
    elif word := _PAYLOAD.match(name):
        found.payload = max(found.payload, int(word[1]) + 1)
    elif name in ("_optix_get_payload", "_optix_set_payload") and takes:
        index = number(takes[0])
        found.payload = max(found.payload, index + 1 if index is not None else 0)
    elif _OLD_TRACE.match(name) and takes:
        size = number(takes[-1])
        if size is not None:
            found.sent_bytes.add(size)


def _width(instruction: PtxInstruction) -> int:
    words = instruction.opcode.split(".")
    type_ = next((word for word in reversed(words) if word in SIZES), "b8")
    count = 4 if "v4" in words else 2 if "v2" in words else 1
    return SIZES[type_] * count
