"""PTX text to instructions, with the line of each (PTX ISA, sections 4 and 5)."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from functools import cached_property

SPACES = ("param", "local", "const", "global", "shared", "reg")
SIZES = {
    "b8": 1, "u8": 1, "s8": 1, "b16": 2, "u16": 2, "s16": 2, "f16": 2, "b32": 4, "u32": 4, "s32": 4,
    "f32": 4, "b64": 8, "u64": 8, "s64": 8, "f64": 8, "pred": 1,
    "texref": 8, "samplerref": 8, "surfref": 8,
}  # fmt: skip
"""Bytes of each type (5.2)."""
FLUSHED = ("add", "sub", "mul", "mad", "fma", "div", "rcp", "rsqrt", "sqrt", "setp", "set")
"""Instructions that the processor's own mode makes treat denormals as zero (``.ftz``)."""
_SKIPPED = re.compile(r'"[^"\n]*"|//[^\n]*|/\*.*?(?:\*/|\Z)', re.DOTALL)
_LABEL = re.compile(r"([A-Za-z$_%][\w$]*)\s*:(?!:)")
_DIGITS = 8
"""Of a size or a count: no program has a hundred megabytes of its own."""
_NAME = r"[A-Za-z$_%][\w$%.]*"
_DECLARED = re.compile(
    rf"\.(?P<space>{'|'.join(SPACES)})\s*(?P<attributes>(?:\.align\s+\d+\s*|\.ptr\s*)*)"
    rf"(?P<vector>\.v[24]\s*)?\.(?P<type>[a-z]\w*)\s+(?P<name>{_NAME})"
    r"(?:<(?P<count>\d+)>)?(?:\[(?P<length>\d*)\])?\s*(?:=\s*(?P<value>.*))?$",
    re.DOTALL,
)
_HEAD = re.compile(
    rf"(?P<linkage>(?:\.(?:visible|extern|weak|common)\s+)*)\.(?P<kind>entry|func)\s*"
    rf"(?P<returns>\([^)]*\))?\s*(?P<name>{_NAME})\s*(?P<takes>\([^)]*\))?",
    re.DOTALL,
)
_IGNORED = re.compile(
    r"\.(?:version|target|address_size|pragma|loc|file|section|alias|callprototype|calltargets|"
    r"branchtargets|noreturn|minnctapersm|maxntid|maxnreg|reqntid|maxnctapersm)\b"
)


class PtxError(Exception):
    """What a text has that cannot be read or compiled; ``line`` counts from 1."""

    def __init__(self, line: int, message: str) -> None:
        super().__init__(message)
        self.line = line


@dataclass(frozen=True, slots=True)
class PtxVariable:
    """A variable: ``count`` registers of the name with numbers, or an array of ``length``."""

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
        """Bytes."""
        return SIZES[self.type] * (1 if self.length is None else max(self.length, 1))


@dataclass(frozen=True, slots=True)
class PtxInstruction:
    """``@guard opcode operands``. ``guard``: a predicate, ``!`` before it where it must be false;
    ``label``: the name of a place instead of an instruction."""

    opcode: str
    operands: tuple[str, ...]
    line: int
    guard: str = ""
    label: str = ""


@dataclass(slots=True)
class PtxFunction:
    """An entry point (``.entry``) or function (``.func``); ``body`` is None where it is only
    declared."""

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
    """A module: its variables outside of functions, and its functions by name."""

    variables: list[PtxVariable] = field(default_factory=list)
    functions: dict[str, PtxFunction] = field(default_factory=dict)

    @cached_property
    def flushes(self) -> bool:
        """Whether its floats treat denormals as zero: most of them, for library functions may do
        so inside of modules that do not."""
        votes = 0
        for function in self.functions.values():
            for instruction in function.body or []:
                if instruction.opcode.split(".")[0] in FLUSHED and ".f32" in instruction.opcode:
                    votes += 1 if ".ftz" in instruction.opcode else -1
        return votes > 0


def _without_comments(text: str) -> str:
    """Comments as blanks, lines kept; what looks like one inside a string is none."""

    def blank(found: re.Match[str]) -> str:
        return found[0] if found[0].startswith('"') else re.sub(r"[^\n]", " ", found[0])

    return _SKIPPED.sub(blank, text)


_TOKEN = re.compile(r"[%A-Za-z$_][\w$]*")
_NUMBERED = re.compile(r"(.*?)(\d+)$")


class _BlockScopes:
    """Blocks inside of a function: what they declare is theirs, whatever else has that name (5.4).
    Their variables get names of their own, so that a function has one list of them."""

    def __init__(self) -> None:
        self._open: list[tuple[int, dict[str, str], set[str]]] = []
        self._count = 0

    def enter(self) -> None:
        self._count += 1
        self._open.append((self._count, {}, set()))

    def leave(self) -> None:
        if self._open:
            self._open.pop()

    def declared(self, variable: PtxVariable) -> PtxVariable:
        if len(self._open) < 2:  # of the function itself
            return variable
        number, names, families = self._open[-1]
        if variable.count is not None:
            families.add(variable.name)
            return replace(variable, name=f"{variable.name}.s{number}.")
        names[variable.name] = f"{variable.name}.s{number}"
        return replace(variable, name=names[variable.name])

    def _name(self, found: re.Match[str]) -> str:
        word = found[0]
        for number, names, families in reversed(self._open[1:]):
            if word in names:
                return names[word]
            numbered = _NUMBERED.match(word) if families else None
            if numbered and numbered[1] in families:
                return f"{numbered[1]}.s{number}.{numbered[2]}"
        return word

    def renamed(self, made: PtxInstruction) -> PtxInstruction:
        if not any(names or families for _, names, families in self._open[1:]):
            return made
        operands = tuple(_TOKEN.sub(self._name, operand) for operand in made.operands)
        return replace(made, operands=operands, guard=_TOKEN.sub(self._name, made.guard))


class _ModuleReader:
    def __init__(self, text: str) -> None:
        self.text = _without_comments(text)
        self.at = 0
        self.line = 1
        self.module = PtxModule()

    def fail(self, message: str) -> PtxError:
        return PtxError(self.line, message)

    def skip(self) -> str:
        """Skip blanks; the next character, empty at the end."""
        while self.at < len(self.text) and self.text[self.at].isspace():
            self.line += self.text[self.at] == "\n"
            self.at += 1
        return self.text[self.at : self.at + 1]

    def take(self, end: int) -> str:
        """The text up to ``end``, behind which reading goes on."""
        found = self.text[self.at : end]
        self.line += found.count("\n")
        self.at = end
        return found

    def statement(self) -> str:
        """Up to the next ``;``, which is skipped."""
        end = self.text.find(";", self.at)
        if end < 0:
            raise self.fail(f"no ';' follows '{self.text[self.at : self.at + 30].strip()}'")
        found = self.take(end)
        self.at += 1
        return found.strip()

    def run(self) -> PtxModule:
        while self.skip():
            rest = self.text[self.at : self.at + 400]
            head = _HEAD.match(self.text, self.at)
            if head is not None:
                self.function(head)
            elif _IGNORED.match(rest):
                self.directive()
            elif rest.startswith("."):
                line = self.line
                declared = re.sub(r"^(\.(visible|extern|weak|common)\s+)+", "", self.statement())
                self.module.variables += _variables(declared, line)
            else:
                raise self.fail(f"a directive is expected, found '{rest.split()[0][:30]}'")
        return self.module

    def directive(self) -> None:
        """A line that says nothing about what a program does."""
        end = self.text.find("\n", self.at)
        line = self.text[self.at : len(self.text) if end < 0 else end]
        if line.startswith(".section"):
            close = self.text.find("}", self.at)
            self.take(len(self.text) if close < 0 else close + 1)
        else:
            self.take(self.at + len(line))

    def function(self, head: re.Match[str]) -> None:
        line = self.line
        self.take(head.end())
        made = PtxFunction(
            head["name"],
            head["kind"] == "entry",
            "visible" in head["linkage"],
            _parameters(head["returns"], line),
            _parameters(head["takes"], line),
            line,
        )
        while self.skip() not in ("", "{", ";"):
            if not self.text.startswith(".", self.at):
                raise self.fail(f"'{{' or ';' is expected after function '{made.name}'")
            self.directive()
        if self.skip() == ";":
            self.at += 1
        elif self.skip() == "{":
            self.body(made)
        else:
            raise self.fail(f"function '{made.name}' ends early")
        known = self.module.functions.get(made.name)
        if known is None or known.body is None:
            self.module.functions[made.name] = made

    def body(self, made: PtxFunction) -> None:
        made.body = []
        depth = 0
        scopes = _BlockScopes()
        while True:
            char = self.skip()
            if char == "":
                raise self.fail(f"function '{made.name}' is not closed: no '}}' follows")
            if char in "{}":
                depth += 1 if char == "{" else -1
                scopes.enter() if char == "{" else scopes.leave()
                self.at += 1
                if depth == 0:
                    return
                continue
            label = _LABEL.match(self.text, self.at)
            if label is not None:
                made.body.append(PtxInstruction("", (), self.line, label=label[1]))
                self.take(label.end())
                continue
            line = self.line
            if re.compile(r"\.(loc|pragma)\b").match(self.text, self.at):
                self.directive()
                continue
            text = self.statement()
            if text.startswith(".branchtargets"):
                name = made.body[-1].label if made.body else ""
                made.tables[name] = _operands(text.removeprefix(".branchtargets"), line)
            elif text.startswith("."):
                if not _IGNORED.match(text):
                    made.variables += [scopes.declared(v) for v in _variables(text, line)]
            elif text:
                made.body.append(scopes.renamed(_instruction(text, line)))


def _parameters(text: str | None, line: int) -> list[PtxVariable]:
    inside = (text or "").strip().removeprefix("(").removesuffix(")").strip()
    return [_variable(part.strip(), line) for part in inside.split(",") if part.strip()]


def _variables(text: str, line: int) -> list[PtxVariable]:
    """``.reg .u32 a, b, c`` declares three."""
    if "=" in text or "," not in text:
        return [_variable(text, line)]
    first, *others = [part.strip() for part in text.split(",")]
    if not first:
        raise PtxError(line, f"this is no declaration: '{text[:60]}'")
    head = first[: len(first) - len(first.split()[-1])]
    return [_variable(first, line), *(_variable(head + other, line) for other in others)]


def _variable(text: str, line: int) -> PtxVariable:
    found = _DECLARED.match(text)
    if found is None or found["type"] not in SIZES:
        raise PtxError(line, f"this is no declaration: '{text[:60]}'")
    if max(len(found["count"] or ""), len(found["length"] or "")) > _DIGITS:
        raise PtxError(line, f"a number is too large: '{text[:60]}'")
    align = re.search(r"\.align\s+(\d+)", found["attributes"] or "")
    length = found["length"]
    wide = int((found["vector"] or ".v1").strip()[2:])
    count = None if length is None and wide == 1 else int(length or 0) * wide if length else wide
    if length == "" and found["value"]:
        count = found["value"].count(",") + 1
    return PtxVariable(
        found["space"],
        found["type"],
        found["name"],
        count,
        int(found["count"]) if found["count"] else None,
        int(align[1]) if align else 0,
        (found["value"] or "").strip(),
        line,
    )


_GUARD = re.compile(r"@\s*(!?)\s*([%\w$]+)\s+")


def _instruction(text: str, line: int) -> PtxInstruction:
    guard = ""
    found = _GUARD.match(text)
    if found:
        guard, text = found[1] + found[2], text[found.end() :]
    opcode, _, rest = text.partition(" ") if " " in text.split("\t")[0] else text.partition("\t")
    opcode = opcode.strip()
    if not re.fullmatch(r"[a-z][\w.:]*", opcode):
        raise PtxError(line, f"this is no instruction: '{text[:60]}'")
    return PtxInstruction(opcode, tuple(_operands(rest, line)), line, guard)


def _operands(text: str, line: int) -> list[str]:
    """Parts between commas that stand in no bracket."""
    parts, depth, begin = [], 0, 0
    for index, char in enumerate(text):
        if char in "([{":
            depth += 1
        elif char in ")]}":
            depth -= 1
            if depth < 0:
                raise PtxError(line, f"'{char}' closes nothing: '{text.strip()[:60]}'")
        elif char == "," and depth == 0:
            parts.append(text[begin:index].strip())
            begin = index + 1
    if depth:
        raise PtxError(line, f"a bracket is not closed: '{text.strip()[:60]}'")
    last = text[begin:].strip()
    return [*parts, last] if last or parts else []


def call_parts(operands: tuple[str, ...]) -> tuple[list[str], str, list[str]]:
    """``call (returns), name, (arguments)``, where each list may be missing; no name: empty."""
    parts = list(operands)
    returns = _listed(parts.pop(0)) if parts and parts[0].startswith("(") else []
    name = parts.pop(0) if parts else ""
    takes = _listed(parts.pop(0)) if parts and parts[0].startswith("(") else []
    return returns, name, takes


def _listed(text: str) -> list[str]:
    return [part.strip() for part in text.strip("()").split(",") if part.strip()]


def read_ptx(text: str) -> PtxModule:
    """The module of a text. Raises :class:`PtxError`."""
    return _ModuleReader(text).run()
