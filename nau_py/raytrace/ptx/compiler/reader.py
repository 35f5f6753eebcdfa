"""Read PTX text: instructions with the line of each (PTX ISA, sections 4 and 5)."""

from __future__ import annotations

import re
from dataclasses import replace

from nau_py.raytrace.ptx.compiler.module import (
    SIZES,
    PtxError,
    PtxFunction,
    PtxInstruction,
    PtxModule,
    PtxVariable,
)

SPACES = ("param", "local", "const", "global", "shared", "reg")
_SKIPPED = re.compile(r'"[^"\n]*"|//[^\n]*|/\*.*?(?:\*/|\Z)', re.DOTALL)
_LABEL = re.compile(r"([A-Za-z$_%][\w$]*)\s*:(?!:)")
_DIGITS = 8
"""Longest size or count in the text: no program has arrays of 100 MB."""
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


def _without_comments(text: str) -> str:
    """Replace comments by blanks, and keep line ends and strings."""

    def blank(found: re.Match[str]) -> str:
        return found[0] if found[0].startswith('"') else re.sub(r"[^\n]", " ", found[0])

    return _SKIPPED.sub(blank, text)


_TOKEN = re.compile(r"[%A-Za-z$_][\w$]*")
_NUMBERED = re.compile(r"(.*?)(\d+)$")


class _BlockScopes:
    """Names that blocks inside a function declare (5.4).

    A variable of a block gets a unique name, so that a function has one list of variables.
    """

    def __init__(self) -> None:
        self._open: list[tuple[int, dict[str, str], set[str]]] = []
        self._count = 0

    def enter(self) -> None:
        self._count += 1
        self._open.append((self._count, {}, set()))

    def leave(self) -> None:
        if self._open:
            self._open.pop()

    def rename_variable(self, variable: PtxVariable) -> PtxVariable:
        """Give a variable the unique name of its block."""
        if len(self._open) < 2:  # the function's own block
            return variable
        number, names, families = self._open[-1]
        if variable.count is not None:
            families.add(variable.name)
            return replace(variable, name=f"{variable.name}.s{number}.")
        names[variable.name] = f"{variable.name}.s{number}"
        return replace(variable, name=names[variable.name])

    def _replace_name(self, found: re.Match[str]) -> str:
        word = found[0]
        for number, names, families in reversed(self._open[1:]):
            if word in names:
                return names[word]
            numbered = _NUMBERED.match(word) if families else None
            if numbered and numbered[1] in families:
                return f"{numbered[1]}.s{number}.{numbered[2]}"
        return word

    def rename_operands(self, made: PtxInstruction) -> PtxInstruction:
        """Replace the names that an open block declares in an instruction."""
        if not any(names or families for _, names, families in self._open[1:]):
            return made
        operands = tuple(_TOKEN.sub(self._replace_name, operand) for operand in made.operands)
        return replace(made, operands=operands, guard=_TOKEN.sub(self._replace_name, made.guard))


class _ModuleReader:
    def __init__(self, text: str) -> None:
        self.text = _without_comments(text)
        self.at = 0
        self.line = 1
        self.module = PtxModule()

    def fail(self, message: str) -> PtxError:
        return PtxError(self.line, message)

    def skip_blanks(self) -> str:
        """Skip blanks and return the next character, empty at the end."""
        while self.at < len(self.text) and self.text[self.at].isspace():
            self.line += self.text[self.at] == "\n"
            self.at += 1
        return self.text[self.at : self.at + 1]

    def take(self, end: int) -> str:
        """Return the text up to ``end`` and move behind it."""
        found = self.text[self.at : end]
        self.line += found.count("\n")
        self.at = end
        return found

    def take_statement(self) -> str:
        """Return the text up to the next ``;`` and move behind that."""
        end = self.text.find(";", self.at)
        if end < 0:
            raise self.fail(f"no ';' follows '{self.text[self.at : self.at + 30].strip()}'")
        found = self.take(end)
        self.at += 1
        return found.strip()

    def read_module(self) -> PtxModule:
        """Read the whole text. Raises :class:`PtxError`."""
        while self.skip_blanks():
            rest = self.text[self.at : self.at + 400]
            head = _HEAD.match(self.text, self.at)
            if head is not None:
                self.read_function(head)
            elif _IGNORED.match(rest):
                self.skip_directive()
            elif rest.startswith("."):
                line = self.line
                declared = re.sub(
                    r"^(\.(visible|extern|weak|common)\s+)+", "", self.take_statement()
                )
                self.module.variables += _read_variables(declared, line)
            else:
                raise self.fail(f"a directive is expected, found '{rest.split()[0][:30]}'")
        return self.module

    def skip_directive(self) -> None:
        """Skip a line that does not change the results of a program."""
        end = self.text.find("\n", self.at)
        line = self.text[self.at : len(self.text) if end < 0 else end]
        if line.startswith(".section"):
            close = self.text.find("}", self.at)
            self.take(len(self.text) if close < 0 else close + 1)
        else:
            self.take(self.at + len(line))

    def read_function(self, head: re.Match[str]) -> None:
        """Read a function whose head is at the current position, and its body."""
        line = self.line
        self.take(head.end())
        made = PtxFunction(
            head["name"],
            head["kind"] == "entry",
            "visible" in head["linkage"],
            _read_parameters(head["returns"], line),
            _read_parameters(head["takes"], line),
            line,
        )
        while self.skip_blanks() not in ("", "{", ";"):
            if not self.text.startswith(".", self.at):
                raise self.fail(f"'{{' or ';' is expected after function '{made.name}'")
            self.skip_directive()
        if self.skip_blanks() == ";":
            self.at += 1
        elif self.skip_blanks() == "{":
            self.read_body(made)
        else:
            raise self.fail(f"function '{made.name}' ends early")
        known = self.module.functions.get(made.name)
        if known is None or known.body is None:
            self.module.functions[made.name] = made

    def read_body(self, made: PtxFunction) -> None:
        """Read the instructions of a function, from its ``{`` to the matching ``}``."""
        made.body = []
        depth = 0
        scopes = _BlockScopes()
        while True:
            char = self.skip_blanks()
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
                self.skip_directive()
                continue
            text = self.take_statement()
            if text.startswith(".branchtargets"):
                name = made.body[-1].label if made.body else ""
                made.tables[name] = _split_operands(text.removeprefix(".branchtargets"), line)
            elif text.startswith("."):
                if not _IGNORED.match(text):
                    made.variables += [
                        scopes.rename_variable(v) for v in _read_variables(text, line)
                    ]
            elif text:
                made.body.append(scopes.rename_operands(_read_instruction(text, line)))


def _read_parameters(text: str | None, line: int) -> list[PtxVariable]:
    inside = (text or "").strip().removeprefix("(").removesuffix(")").strip()
    return [_read_variable(part.strip(), line) for part in inside.split(",") if part.strip()]


def _read_variables(text: str, line: int) -> list[PtxVariable]:
    """Read the variables of a declaration: ``.reg .u32 a, b, c`` declares three."""
    if "=" in text or "," not in text:
        return [_read_variable(text, line)]
    first, *others = [part.strip() for part in text.split(",")]
    if not first:
        raise PtxError(line, f"this is no declaration: '{text[:60]}'")
    head = first[: len(first) - len(first.split()[-1])]
    return [_read_variable(first, line), *(_read_variable(head + other, line) for other in others)]


def _read_variable(text: str, line: int) -> PtxVariable:
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


def _read_instruction(text: str, line: int) -> PtxInstruction:
    guard = ""
    found = _GUARD.match(text)
    if found:
        guard, text = found[1] + found[2], text[found.end() :]
    opcode, _, rest = text.partition(" ") if " " in text.split("\t")[0] else text.partition("\t")
    opcode = opcode.strip()
    if not re.fullmatch(r"[a-z][\w.:]*", opcode):
        raise PtxError(line, f"this is no instruction: '{text[:60]}'")
    return PtxInstruction(opcode, tuple(_split_operands(rest, line)), line, guard)


def _split_operands(text: str, line: int) -> list[str]:
    """Split at the commas outside of brackets."""
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


def split_call(operands: tuple[str, ...]) -> tuple[list[str], str, list[str]]:
    """Split ``call (returns), name, (arguments)``. A missing part is empty."""
    parts = list(operands)
    returns = _split_list(parts.pop(0)) if parts and parts[0].startswith("(") else []
    name = parts.pop(0) if parts else ""
    takes = _split_list(parts.pop(0)) if parts and parts[0].startswith("(") else []
    return returns, name, takes


def _split_list(text: str) -> list[str]:
    return [part.strip() for part in text.strip("()").split(",") if part.strip()]


def read_ptx(text: str) -> PtxModule:
    """Read the module of a text. Raises :class:`PtxError` with the line."""
    return _ModuleReader(text).read_module()
