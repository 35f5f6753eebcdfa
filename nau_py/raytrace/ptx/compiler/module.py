"""Parts of a PTX module: variables, functions and instructions (PTX ISA, sections 4 and 5)."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

SIZES = {
    "b8": 1, "u8": 1, "s8": 1, "b16": 2, "u16": 2, "s16": 2, "f16": 2, "b32": 4, "u32": 4, "s32": 4,
    "f32": 4, "b64": 8, "u64": 8, "s64": 8, "f64": 8, "pred": 1,
    "texref": 8, "samplerref": 8, "surfref": 8,
}  # fmt: skip
"""Bytes of each type (5.2)."""
FLUSHED = ("add", "sub", "mul", "mad", "fma", "div", "rcp", "rsqrt", "sqrt", "setp", "set")
"""Instructions with ``.ftz`` for which the processor's own mode treats denormals as zero."""


class PtxError(Exception):
    """A text cannot be read or compiled. ``line`` counts from 1."""

    def __init__(self, line: int, message: str) -> None:
        super().__init__(message)
        self.line = line


@dataclass(frozen=True, slots=True)
class PtxVariable:
    """A variable, an array of ``length`` elements, or ``count`` numbered registers."""

    space: str
    type: str
    name: str
    length: int | None = None
    count: int | None = None
    align: int = 0
    value: str = ""
    line: int = 0

    @property
    def size(self) -> int:
        """Bytes of the variable."""
        return SIZES[self.type] * (1 if self.length is None else max(self.length, 1))


@dataclass(frozen=True, slots=True)
class PtxInstruction:
    """An instruction ``@guard opcode operands``, or a label.

    ``guard``: a predicate, after ``!`` where it must be false; ``label``: the name of a position in
    the function, in which case there is no opcode.
    """

    opcode: str
    operands: tuple[str, ...]
    line: int
    guard: str = ""
    label: str = ""


@dataclass(slots=True)
class PtxFunction:
    """An entry point (``.entry``) or function (``.func``). ``body`` is None for a declaration."""

    name: str
    entry: bool
    visible: bool
    returns: list[PtxVariable]
    takes: list[PtxVariable]
    line: int
    variables: list[PtxVariable] = field(default_factory=list)
    body: list[PtxInstruction] | None = None
    tables: dict[str, list[str]] = field(default_factory=dict)
    """Lists of labels that ``brx.idx`` chooses from, by name."""


@dataclass
class PtxModule:
    """Variables outside of functions, and functions by name."""

    variables: list[PtxVariable] = field(default_factory=list)
    functions: dict[str, PtxFunction] = field(default_factory=dict)

    @cached_property
    def flushes(self) -> bool:
        """Return True if float32 arithmetic treats denormals as zero in most instructions.

        Library functions may use ``.ftz`` inside a module that does not, so the majority counts.
        """
        votes = 0
        for function in self.functions.values():
            for instruction in function.body or []:
                if instruction.opcode.split(".")[0] in FLUSHED and ".f32" in instruction.opcode:
                    votes += 1 if ".ftz" in instruction.opcode else -1
        return votes > 0
