"""Nau's XML dialect made well-formed (docs/format.md, 1.1), with every position kept.

The scanner re-emits each tag with quoted, escaped attribute values and drops comments,
declarations and stray text. It records where each start tag and attribute value stood, in document
order, so that the tree that lxml builds can be given its positions back.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from dataclasses import dataclass, field
from xml.sax.saxutils import quoteattr

from nau_py.diagnostics.location import Location

_NAME = re.compile(r"[^\W\d][\w.:\-]*")
_SPACE = re.compile(r"\s*")
_UNQUOTED = re.compile(r"[^\s/>]+")
_ENTITY = re.compile(r"&(amp|lt|gt|quot|apos|#\d+|#x[0-9A-Fa-f]+);")
_NAMED = {"amp": "&", "lt": "<", "gt": ">", "quot": '"', "apos": "'"}


class XmlSyntaxError(Exception):
    """The text is not even Nau's dialect."""

    def __init__(self, location: Location, message: str) -> None:
        super().__init__(f"{location}: {message}")
        self.location = location
        self.message = message


@dataclass(slots=True)
class StartTag:
    """Positions of one start tag and of its attribute values."""

    location: Location
    attributes: dict[str, Location] = field(default_factory=dict)


@dataclass(slots=True)
class Repaired:
    """Well-formed text, the positions of its start tags, and stray text that was left out."""

    text: str
    tags: list[StartTag]
    stray: list[tuple[Location, str]]


class _Scanner:
    def __init__(self, text: str, file: str) -> None:
        self.text = text
        self.file = file
        self.pos = 1 if text.startswith("\ufeff") else 0
        self.out: list[str] = []
        self.tags: list[StartTag] = []
        self.stray: list[tuple[Location, str]] = []
        self.open: list[tuple[str, Location]] = []
        self._lines = [0] + [m.end() for m in re.finditer("\n", text)]

    def at(self, pos: int) -> Location:
        line = bisect_right(self._lines, pos)
        return Location(self.file, line, pos - self._lines[line - 1] + 1)

    def fail(self, pos: int, message: str) -> XmlSyntaxError:
        return XmlSyntaxError(self.at(min(pos, max(len(self.text) - 1, 0))), message)

    def skip_space(self) -> None:
        match = _SPACE.match(self.text, self.pos)
        if match is not None:
            self.pos = match.end()

    def skip_past(self, end: str, what: str) -> None:
        found = self.text.find(end, self.pos)
        if found < 0:
            raise self.fail(self.pos, f"{what} is not closed: no '{end}' follows")
        self.pos = found + len(end)

    def run(self) -> Repaired:
        while self.pos < len(self.text):
            mark = self.text.find("<", self.pos)
            self.plain_text(self.pos, mark if mark >= 0 else len(self.text))
            if mark < 0:
                break
            self.pos = mark
            if self.markup():
                return Repaired("".join(self.out), self.tags, self.stray)
        if self.open:
            name, where = self.open[-1]
            raise XmlSyntaxError(where, f"element <{name}> is not closed: no </{name}> follows")
        raise self.fail(0, "the document is empty: it has no root element")

    def plain_text(self, start: int, end: int) -> None:
        raw = self.text[start:end]
        if raw.strip():
            where = start + len(raw) - len(raw.lstrip())
            if not self.open:
                raise self.fail(where, f"text before the root element: {raw.strip()[:40]!r}")
            self.stray.append((self.at(where), raw.strip()))

    def markup(self) -> bool:
        """Take one construct. True when it ends the root element."""
        text, start = self.text, self.pos
        if text.startswith("<!--", start):
            self.pos += 4
            self.skip_past("-->", "the comment")
            return False
        if text.startswith(("<!", "<?"), start):
            self.skip_past(">", "the declaration")
            return False
        if text.startswith("</", start):
            return self.end_tag()
        return self.start_tag()

    def name(self, what: str) -> str:
        match = _NAME.match(self.text, self.pos)
        if match is None:
            raise self.fail(
                self.pos, f"{what} expected, found {self.text[self.pos : self.pos + 12]!r}"
            )
        self.pos = match.end()
        return match[0]

    def end_tag(self) -> bool:
        start = self.pos
        self.pos += 2
        name = self.name("element name")
        self.skip_past(">", f"end tag </{name}")
        if not self.open or self.open[-1][0] != name:
            opened = f"<{self.open[-1][0]}> from {self.open[-1][1]}" if self.open else "nothing"
            raise self.fail(start, f"end tag </{name}> does not match: {opened} is open")
        self.open.pop()
        self.out.append(f"</{name}>")
        return not self.open

    def start_tag(self) -> bool:
        tag = StartTag(self.at(self.pos))
        self.pos += 1
        name = self.name("element name")
        self.out.append(f"<{name}")
        self.tags.append(tag)
        while True:
            self.skip_space()
            if self.text.startswith("/>", self.pos):
                self.pos += 2
                self.out.append("/>")
                return not self.open
            if self.text.startswith(">", self.pos):
                self.pos += 1
                self.out.append(">")
                self.open.append((name, tag.location))
                return False
            if self.pos >= len(self.text):
                raise XmlSyntaxError(
                    tag.location, f"start tag <{name} is not closed: no '>' follows"
                )
            self.attribute(name, tag)

    def attribute(self, element: str, tag: StartTag) -> None:
        start = self.pos
        name = self.name(f"attribute name in <{element}>")
        if name in tag.attributes:
            raise self.fail(start, f"attribute '{name}' of <{element}> is given twice")
        self.skip_space()
        if not self.text.startswith("=", self.pos):
            raise self.fail(start, f"attribute '{name}' of <{element}> has no value ('=' expected)")
        self.pos += 1
        self.skip_space()
        value = self.value(element, name, tag)
        self.out.append(f" {name}={quoteattr(value, {chr(10): '&#10;', chr(9): '&#9;'})}")

    def value(self, element: str, name: str, tag: StartTag) -> str:
        quote = self.text[self.pos : self.pos + 1]
        if quote in ('"', "'"):
            start = self.pos + 1
            end = self.text.find(quote, start)
            if end < 0:
                raise self.fail(
                    self.pos, f"value of attribute '{name}' of <{element}> has no closing {quote}"
                )
            self.pos = end + 1
        else:
            start = self.pos
            match = _UNQUOTED.match(self.text, start)
            if match is None:
                raise self.fail(start, f"attribute '{name}' of <{element}> has no value")
            if '"' in match[0] or "'" in match[0]:
                raise self.fail(
                    start,
                    f"value of attribute '{name}' of <{element}> has a quote inside: {match[0]}",
                )
            end = self.pos = match.end()
        tag.attributes[name] = self.at(start)
        return _ENTITY.sub(_decode, self.text[start:end])


def _decode(match: re.Match[str]) -> str:
    body = match[1]
    if body in _NAMED:
        return _NAMED[body]
    code = int(body[2:], 16) if body[1] == "x" else int(body[1:])
    return chr(code) if code in (9, 10, 13) or 32 <= code < 0xD800 else match[0]


def repair(text: str, file: str) -> Repaired:
    """Make ``text`` well-formed. Raises :class:`XmlSyntaxError` where even Nau would stop."""
    return _Scanner(text, file).run()
