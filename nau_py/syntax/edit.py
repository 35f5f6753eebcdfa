"""Small edits of a project file's text: only the characters that must change, change.

Comments, layout, quotes, line ends and encoding stay. An edit is (begin, end, new text), in
characters.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import escape, unescape

from nau_py.diagnostics.diagnostic import Change, Fix, Part
from nau_py.diagnostics.location import Location
from nau_py.formats.load import YAML_SUFFIXES
from nau_py.process.files import write_bytes

Edit = tuple[int, int, str]
_ATTRIBUTE = re.compile(r"([^\W\d][\w.:\-]*)\s*=\s*(?:\"([^\"]*)\"|'([^']*)'|([^\s/>\"']+))")
_BEFORE = re.compile(r"(\s*)([^\W\d][\w.:\-]*)(\s*=\s*[\"']?)$")
_TAGS = re.compile(r"<!--.*?-->|<(/?)([^\W\d][\w.:\-]*)([^<>]*?)(/?)>", re.DOTALL)
_YAML_KEY = re.compile(r"[^\s:,{}\[\]]+\s*:(?=\s|$)")
_YAML_SCALAR = re.compile(r"\"[^\"\n]*\"|'[^'\n]*'|[^\s,\[\]{}#]+(?:[ ][^\s,\[\]{}#]+)*")
_YAML_PART = re.compile(r"(?:([^\s:,{}\[\]#]+)\s*:\s+|-\s+)?([^\s,\[\]{}:#]+)")
_QUOTES = {'"': "&quot;", "'": "&apos;"}


@dataclass(frozen=True, slots=True)
class Document:
    """The text of one file, as its positions count it."""

    text: str
    yaml: bool
    encoding: str = "utf-8"

    @classmethod
    def read(cls, path: Path) -> Document:
        """Raises :class:`OSError`."""
        raw = path.read_bytes()
        yaml = path.suffix.lower() in YAML_SUFFIXES
        try:
            return cls(raw.decode("utf-8"), yaml)
        except UnicodeDecodeError:
            return cls(raw.decode("latin-1"), yaml, "latin-1")

    def write(self, path: Path, edits: Iterable[Edit]) -> None:
        """Write the edited text. Raises :class:`OSError`; the file is then as it was."""
        changed = edited(self.text, edits)
        try:
            data = changed.encode(self.encoding)
        except UnicodeEncodeError:
            data = changed.encode("utf-8")
        write_bytes(path, data)

    def offset(self, location: Location) -> int:
        """The character at a location; the end of its line where that is shorter."""
        begin = 0
        for _ in range(location.line - 1):
            found = self.text.find("\n", begin)
            if found < 0:
                return len(self.text)
            begin = found + 1
        end = self.text.find("\n", begin)
        return min(begin + max(location.column - 1, 0), len(self.text) if end < 0 else end)

    def line_end(self, offset: int) -> int:
        end = self.text.find("\n", offset)
        return len(self.text) if end < 0 else end


def edited(text: str, edits: Iterable[Edit]) -> str:
    """The text after all edits; of those that overlap an earlier one, none is made."""
    done = len(text) + 1
    for begin, end, new in sorted(set(edits), reverse=True):
        if end <= done:
            text = text[:begin] + new + text[end:]
            done = begin
    return text


def fixed(fixes: Iterable[Fix]) -> tuple[dict[Path, tuple[Document, list[Edit]]], list[Fix]]:
    """The files that fixes change with their edits, and the fixes that can be made: those of which
    every change fits the text. Files that cannot be read change nothing."""
    files: dict[Path, tuple[Document, list[Edit]]] = {}
    made: list[Fix] = []
    for fix in fixes:
        found: list[tuple[Path, list[Edit]]] = []
        for change in fix.changes:
            path = Path(change.location.file)
            try:
                document, _ = files.setdefault(path, (Document.read(path), []))
            except OSError:
                break
            edits = change_edits(document, change)
            if not edits:
                break
            found.append((path, edits))
        else:
            made.append(fix)
            for path, edits in found:
                files[path][1].extend(edits)
    return {path: (doc, edits) for path, (doc, edits) in files.items() if edits}, made


def change_edits(document: Document, change: Change) -> list[Edit]:
    """The edits that make a change; none where the text is not what the change says."""
    begin = document.offset(change.location)
    if change.part is Part.ELEMENT:
        return _element(document, begin, change)
    if change.part is Part.ATTRIBUTE:
        return _attribute(document, begin, change)
    return _value(document, begin, change)


def _value(document: Document, begin: int, change: Change) -> list[Edit]:
    text = document.text
    if document.yaml:
        key = _YAML_KEY.match(text, begin)
        if key:
            end = document.text.find(" #", key.end(), document.line_end(begin))
            spans = [(key.end(), document.line_end(begin) if end < 0 else end)]
        else:
            spans = [value_span(document, begin)]
    elif text.startswith("<", begin):
        spans = [*_attributes(text, begin).values()]
    else:
        spans = [value_span(document, begin)]
    for first, last in spans:
        raw = text[first:last]
        old = change.old if document.yaml else _as_written(change.old, raw)
        found = [m for m in re.finditer(re.escape(old), raw) if _whole(raw, m)] if old else []
        if found:
            at = first + found[-1].start()
            new = change.new if document.yaml else escape(change.new, _QUOTES)
            return [(at, at + len(old), new)]
    return []


def _as_written(value: str, raw: str) -> str:
    """``value`` as it stands in ``raw``: with entities, or without."""
    return value if value in raw else escape(value, _QUOTES)


def _whole(raw: str, found: re.Match[str]) -> bool:
    """Whether a match is not a part of a longer word."""
    around = raw[found.start() - 1 : found.start()] + raw[found.end() : found.end() + 1]
    return not re.search(r"\w", around)


def _attributes(text: str, begin: int) -> dict[str, tuple[int, int]]:
    """Attribute to the span of its value, of the start tag at ``begin``."""
    end = tag_end(text, begin)
    found: dict[str, tuple[int, int]] = {}
    name = re.compile(r"<[\w.:\-]+").match(text, begin)
    for match in _ATTRIBUTE.finditer(text, name.end() if name else begin, end):
        group = next(g for g in (2, 3, 4) if match.group(g) is not None)
        found[match[1]] = match.span(group)
    return found


def tag_end(text: str, begin: int) -> int:
    """The end of the start tag at ``begin``: behind its ``>``; quoted ones do not count."""
    found = re.compile(r"(?:\"[^\"]*\"|'[^']*'|[^>\"'])*>").match(text, begin)
    return found.end() if found else len(text)


def value_span(document: Document, begin: int) -> tuple[int, int]:
    """The span of the value that stands at ``begin``, without its quotes."""
    text = document.text
    if document.yaml:
        found = _YAML_SCALAR.match(text, begin)
        if found is None:
            return begin, begin
        quoted = found[0][0] in "\"'" and len(found[0]) > 1
        return found.start() + quoted, found.end() - quoted
    quote = text[begin - 1 : begin]
    if quote in _QUOTES:
        end = text.find(quote, begin)
        return begin, len(text) if end < 0 else end
    found = re.compile(r"[^\s/>]*").match(text, begin)
    return begin, found.end() if found else begin


def written_value(document: Document, begin: int) -> str:
    """The value that stands at ``begin``."""
    first, last = value_span(document, begin)
    raw = document.text[first:last]
    return raw if document.yaml else unescape(raw, {v: k for k, v in _QUOTES.items()})


def _element(document: Document, begin: int, change: Change) -> list[Edit]:
    text, old = document.text, change.old
    if document.yaml:
        same = text.startswith(old, begin) and re.match(r"\s*:", text[begin + len(old) :])
        return [(begin, begin + len(old), change.new)] if same else []
    name = re.compile(r"<" + re.escape(old) + r"(?![\w.:\-])").match(text, begin)
    if name is None:
        return []
    edits = [(begin + 1, name.end(), change.new)]
    end = _end_tag(text, begin, old)
    if end is not None:
        edits.append((end, end + len(old), change.new))
    return edits


def _end_tag(text: str, begin: int, name: str) -> int | None:
    """Where the name stands in the end tag of the element at ``begin``; None where it has none."""
    depth = 0
    for found in _TAGS.finditer(text, begin):
        if found[2] is None or found[2] != name:
            continue
        if found[1]:
            depth -= 1
        elif not found[4]:
            depth += 1
        if depth == 0:
            return found.start(2) if found[1] else None
    return None


def _attribute(document: Document, begin: int, change: Change) -> list[Edit]:
    if document.yaml:
        return _yaml_entry(document, begin, change)
    text = document.text
    before = _BEFORE.search(text, max(0, begin - 200), begin)
    if before is None or before[2] != change.old:
        return []
    if change.new:
        return [(before.start(2), before.end(2), change.new)]
    last = value_span(document, begin)[1]
    return [(before.start(), last + (text[last : last + 1] in _QUOTES), "")]


def _yaml_entry(document: Document, begin: int, change: Change) -> list[Edit]:
    text = document.text
    start = text.rfind("\n", 0, begin) + 1
    key = re.compile(re.escape(change.old) + r"\s*:\s*$").search(text, start, begin)
    if key is None:
        return []
    if change.new:
        return [(key.start(), key.start() + len(change.old), change.new)]
    if not text[start : key.start()].strip():  # a line of its own
        return [(start, min(document.line_end(begin) + 1, len(text)), "")]
    last = value_span(document, begin)[1]
    last += text[last : last + 1] in _QUOTES
    follows = re.compile(r"\s*,\s*").match(text, last)
    if follows:
        return [(key.start(), follows.end(), "")]
    comma = re.compile(r"\s*,\s*$").search(text, start, key.start())
    return [(comma.start(), last, "")] if comma else []


def attribute_edits(document: Document, begin: int, key: str, value: str) -> list[Edit]:
    """Give attribute ``key`` of the element at ``begin`` a value: exchanged, or added at the
    end of the start tag (in YAML: among the first keys)."""
    text = document.text
    if document.yaml:
        return _yaml_key(text, begin, key, value)
    new = escape(value, _QUOTES)
    span = _attributes(text, begin).get(key)
    if span is not None:
        first, last = span
        quoted = text[first - 1 : first] in _QUOTES
        if _same(text[first:last], new):
            return []
        return [(first, last, new if quoted else f'"{new}"')]
    end = tag_end(text, begin)
    closing = re.compile(r"\s*/?>$").search(text, begin, end)
    at = closing.start() if closing else end - 1
    return [(at, at, f' {key}="{new}"')]


def _yaml_key(text: str, begin: int, key: str, value: str) -> list[Edit]:
    """Add a key to the map at ``begin``: an item of a list, or what stands behind a key."""
    line = text.rfind("\n", 0, begin) + 1
    owner = _YAML_KEY.match(text, begin)
    if owner is not None and not text[line:begin].endswith("- "):
        inner = re.compile(r"[ \t]*\{[ \t]*").match(text, owner.end())
        if inner:
            rest = "" if text.startswith("}", inner.end()) else ", "
            return [(inner.end(), inner.end(), f"{key}: {value}{rest}")]
        block = re.compile(r"[ \t]*(?:#[^\n]*)?(?:\r?\n[ \t]*(?:#[^\n]*)?)*\n([ ]*)(?=\S)")
        found = block.match(text, owner.end())
        if found is None or len(found[1]) <= begin - line:
            return []  # a scalar stands for the map
        begin = found.end()
    elif owner is not None and re.compile(r"[ \t]*[^\s#\[{|>]").match(text, owner.end()):
        end = text.find("\n", begin)  # behind the first entry: the line with the dash stays
        end = len(text) if end < 0 else end - text[:end].endswith("\r")
        return [(end, end, f"{_newline(text)}{_pad(text, begin)}{key}: {value}")]
    return [(begin, begin, f"{key}: {value}{_newline(text)}{_pad(text, begin)}")]


def value_edits(document: Document, begin: int, value: str) -> list[Edit]:
    """Exchange the value that stands at ``begin``."""
    first, last = value_span(document, begin)
    new = value if document.yaml else escape(value, _QUOTES)
    if not document.yaml and document.text[first - 1 : first] not in _QUOTES:
        new = f'"{new}"'
    return [(first, last, new)] if not _same(document.text[first:last], new) else []


def _same(one: str, other: str) -> bool:
    """Whether two texts are the same value: 1.0 is 1."""
    try:
        return one == other.strip('"') or float(one) == float(other.strip('"'))
    except ValueError:
        return False


def setting_edits(
    document: Document, begin: int, keys: Sequence[tuple[str, ...]], values: Sequence[str]
) -> list[Edit]:
    """Exchange the components of the setting (a child tag, in YAML a key) at ``begin``: those that
    differ, or that it lacks. ``keys``: the spellings of each component."""
    spans = _yaml_scalars(document, begin) if document.yaml else _attributes(document.text, begin)
    edits: list[Edit] = []
    for index, (spellings, value) in enumerate(zip(keys, values)):
        span = next((spans[k] for k in (*spellings, str(index)) if k in spans), None)
        if span is not None:
            edits += value_edits(document, span[0], value)
        elif not document.yaml:
            edits += attribute_edits(document, begin, spellings[0], value)
        elif spans:
            edits += _yaml_component(document.text, spans, spellings[0], value)
    return edits


def _yaml_component(
    text: str, spans: dict[str, tuple[int, int]], key: str, value: str
) -> list[Edit]:
    """Another component behind the last one of a list or a map."""
    last, (begin, end) = list(spans.items())[-1]
    end += text[end : end + 1] in ("'", '"')
    word = value if last.isdigit() else f"{key}: {value}"
    line = text.rfind("\n", 0, begin) + 1
    head = text[line:begin]
    if "[" in head or "{" in head:
        return [(end, end, f", {word}")]
    pad = head[: len(head) - len(head.lstrip(" "))]
    return [(end, end, f"{_newline(text)}{pad}{'- ' if last.isdigit() else ''}{word}")]


def _yaml_scalars(document: Document, begin: int) -> dict[str, tuple[int, int]]:
    """Spans of the scalars of the value of the key at ``begin``: one, a list or a map of them; by
    key, or by index."""
    text = document.text
    key = _YAML_KEY.match(text, begin)
    first = key.end() if key else begin
    rest = re.compile(r"[ \t]*(?:#[^\n]*)?").match(text, first)
    first = rest.end() if rest else first
    if text[first : first + 1] == "\n":
        indent = begin - (text.rfind("\n", 0, begin) + 1)
        block = re.compile(rf"(?:\n(?:[ ]{{{indent + 1},}}|[ ]{{{indent}}}-[ ])[^\n]*)+")
        found = block.match(text, first)
        last = found.end() if found else first
    elif text[first : first + 1] in ("[", "{"):
        last = text.find("]" if text[first] == "[" else "}", first)
    else:
        return {"0": value_span(document, first)}
    return {
        match[1] or str(index): (first + match.start(2), first + match.end(2))
        for index, match in enumerate(_YAML_PART.finditer(text[first:last]))
    }


def insert_edits(
    document: Document, begin: int, name: str, keys: Sequence[str], values: Sequence[str]
) -> list[Edit]:
    """Add a setting as the first thing inside the element (in YAML: the map) at ``begin``."""
    text = document.text
    if document.yaml:
        one = values[0] if len(values) == 1 else f"[{', '.join(values)}]"
        return attribute_edits(document, begin, name, one)
    attributes = " ".join(f'{k}="{escape(v, _QUOTES)}"' for k, v in zip(keys, values))
    child = f"<{name} {attributes} />"
    end = tag_end(text, begin)
    inner = _newline(text) + _pad(text, begin) + "  "
    closing = re.compile(r"\s*/>$").search(text, begin, end)
    if closing:
        tag = re.compile(r"[\w.:\-]+").match(text, begin + 1)
        outer = f"{_newline(text)}{_pad(text, begin)}</{tag[0] if tag else ''}>"
        return [(closing.start(), end, f">{inner}{child}{outer}")]
    following = re.compile(r"\s*").match(text, end)
    blank = following[0] if following and "\n" in following[0] else inner
    if text.startswith("</", end + len(following[0] if following else "")):
        blank = inner
    return [(end, end, f"{blank}{child}")]


def _newline(text: str) -> str:
    return "\r\n" if "\r\n" in text else "\n"


def _pad(text: str, begin: int) -> str:
    """Blanks up to the column of ``begin``: what a sibling of it is indented by."""
    return " " * (begin - (text.rfind("\n", 0, begin) + 1))
