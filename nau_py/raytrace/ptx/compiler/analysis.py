"""Static analysis of programs: the bytes of records and words of payloads that they use.

Nothing is executed. A register is followed where it is written once, through moves and sums with
constants, as nvcc computes the addresses of fields.
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
    """Memory that a program and the functions that it calls use.

    ``record``: bytes of the record up to the last one; ``payload``: words up to the last one;
    ``sent``: words of the payloads of traced rays (OptiX 7); ``sent_bytes``: bytes of them
    (OptiX 3 to 6).
    """

    record: int = 0
    payload: int = 0
    sent: set[int] = field(default_factory=set)
    sent_bytes: set[int] = field(default_factory=set)


def analyse_program(module: PtxModule, function: PtxFunction) -> ProgramUses:
    """Analyse a program and the functions that it calls."""
    found, seen, open_ = ProgramUses(), set[str](), [function]
    while open_:
        current = open_.pop()
        if current.name in seen:
            continue
        seen.add(current.name)
        _FunctionAnalysis(found, current).run()
        for instruction in current.body or []:
            if instruction.opcode.startswith("call"):
                called = module.functions.get(split_call(instruction.operands)[1])
                open_ += [called] if called is not None else []
    return found


class _FunctionAnalysis:
    """Known values of the registers of one function."""

    def __init__(self, found: ProgramUses, function: PtxFunction) -> None:
        self.found = found
        self.body = function.body or []
        self.numbers: dict[str, int] = {}
        """Constants by register."""
        self.records: dict[str, int] = {}
        """Offsets in the record by the register that has the address."""

    def run(self) -> None:
        """Add the uses of the function to ``found``."""
        once = _written_once(self.body)
        for instruction in self.body:
            operands, base = instruction.operands, instruction.opcode.split(".")[0]
            if base == "call":
                self._add_call(operands)
            elif len(operands) > 1 and operands[0] in once:
                self._follow_register(base, operands)
            if base in ("ld", "ldu", "st") and operands:
                place = _ADDRESS.match(operands[0 if base == "st" else -1])
                if place is not None and place[1] in self.records:
                    begin = self.records[place[1]] + int(place[2] or 0)
                    self.found.record = max(self.found.record, begin + _access_bytes(instruction))

    def _follow_register(self, base: str, operands: tuple[str, ...]) -> None:
        to, source = operands[0], operands[1]
        if base in ("mov", "cvta"):
            if source in self.records:
                self.records[to] = self.records[source]
            elif source in self.numbers:
                self.numbers[to] = self.numbers[source]
            elif _NUMBER.match(source):
                self.numbers[to] = int(source)
        elif base == "add" and len(operands) > 2 and source in self.records:
            more = operands[2]
            if _NUMBER.match(more):
                self.records[to] = self.records[source] + int(more)

    def _number(self, operand: str) -> int | None:
        return int(operand) if _NUMBER.match(operand) else self.numbers.get(operand)

    def _add_call(self, operands: tuple[str, ...]) -> None:
        found = self.found
        returns, name, takes = split_call(operands)
        if name == "_optix_get_sbt_data_ptr_64" and returns:
            self.records[returns[0]] = 0
        elif words := _TRACE.match(name):
            found.sent.add(int(words[1]))
        elif name == "_optix_trace_typed_32" and len(takes) > 16:
            found.sent.add(self._number(takes[16]) or 32)
        elif word := _PAYLOAD.match(name):
            found.payload = max(found.payload, int(word[1]) + 1)
        elif name in ("_optix_get_payload", "_optix_set_payload") and takes:
            index = self._number(takes[0])
            found.payload = max(found.payload, index + 1 if index is not None else 0)
        elif _OLD_TRACE.match(name) and takes:
            size = self._number(takes[-1])
            if size is not None:
                found.sent_bytes.add(size)


def _written_once(body: list[PtxInstruction]) -> set[str]:
    counts: dict[str, int] = {}
    for instruction in body:
        first = instruction.operands[0] if instruction.operands else ""
        for register in first.strip("(){}").split(","):
            counts[register.strip()] = counts.get(register.strip(), 0) + 1
    return {name for name, count in counts.items() if count == 1}


def _access_bytes(instruction: PtxInstruction) -> int:
    words = instruction.opcode.split(".")
    type_ = next((word for word in reversed(words) if word in SIZES), "b8")
    count = 4 if "v4" in words else 2 if "v2" in words else 1
    return SIZES[type_] * count
