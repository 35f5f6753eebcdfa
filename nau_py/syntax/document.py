"""The text of a project file, and small edits of it: only the characters that must change, change.

Comments, layout, quotes, line ends and encoding stay. :mod:`nau_py.syntax.xml_document` and
:mod:`nau_py.syntax.yaml_document` know where values are written in each language;
:mod:`nau_py.syntax.edit` opens files.
"""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from pathlib import Path

from nau_py.diagnostics.diagnostic import Change, Part
from nau_py.diagnostics.location import Location
from nau_py.process.files import write_bytes

Edit = tuple[int, int, str]
"""Begin, end and new text, in characters of the text before any edit."""


def apply_edits(text: str, edits: Iterable[Edit]) -> str:
    """Return the text after all edits; of those that overlap a later one, none is made."""
    done = len(text) + 1
    for begin, end, new in sorted(set(edits), reverse=True):
        if end <= done:
            text = text[:begin] + new + text[end:]
            done = begin
    return text


def find_offset(text: str, location: Location) -> int:
    """Return the character at a location; the end of its line where that is shorter."""
    begin = 0
    for _ in range(location.line - 1):
        found = text.find("\n", begin)
        if found < 0:
            return len(text)
        begin = found + 1
    end = text.find("\n", begin)
    return min(begin + max(location.column - 1, 0), len(text) if end < 0 else end)


def is_same_value(one: str, other: str) -> bool:
    """Report if two texts are the same value: 1.0 is 1."""
    try:
        return one == other or float(one) == float(other)
    except ValueError:
        return False


def find_word(text: str, word: str) -> int:
    """Return the index of the last occurrence of ``word`` that is no part of a longer word; -1
    where there is none."""
    pattern = rf"(?<!\w){re.escape(word)}(?!\w)"
    found = [match.start() for match in re.finditer(pattern, text)] if word else []
    return found[-1] if found else -1


class Document(ABC):
    """The text of one file. Methods return edits; they change neither the text nor the file.

    ``begin`` is the offset that a location of the file has: of an element, or of a value. A method
    returns no edits where the text has nothing of that kind there.
    """

    def __init__(self, text: str, encoding: str = "utf-8") -> None:
        self.text = text
        self.encoding = encoding

    def write(self, path: Path, edits: Iterable[Edit]) -> None:
        """Write the edited text. Raises :class:`OSError`; the file is then as it was."""
        changed = apply_edits(self.text, edits)
        try:
            data = changed.encode(self.encoding)
        except UnicodeEncodeError:
            data = changed.encode("utf-8")
        write_bytes(path, data)

    def offset(self, location: Location) -> int:
        """Return the character at a location; the end of its line where that is shorter."""
        return find_offset(self.text, location)

    def line_begin(self, offset: int) -> int:
        """Return the first character of the line that ``offset`` is in."""
        return self.text.rfind("\n", 0, offset) + 1

    def line_end(self, offset: int) -> int:
        """Return the offset of the line feed behind ``offset``, or the end of the text."""
        end = self.text.find("\n", offset)
        return len(self.text) if end < 0 else end

    @property
    def newline(self) -> str:
        """The line end that the file uses."""
        return "\r\n" if "\r\n" in self.text else "\n"

    def indent(self, offset: int) -> str:
        """Return blanks up to the column of ``offset``, which indent a sibling of what is there."""
        return " " * (offset - self.line_begin(offset))

    def make_change(self, change: Change) -> list[Edit]:
        """Return the edits that make a change; none where the text differs from ``change.old``."""
        begin = self.offset(change.location)
        if change.part is Part.ELEMENT:
            return self._rename_element(begin, change.old, change.new)
        if change.part is Part.VALUE:
            return self._replace_word(begin, change.old, change.new)
        if change.new:
            return self._rename_attribute(begin, change.old, change.new)
        return self._remove_attribute(begin, change.old)

    @abstractmethod
    def set_value(self, begin: int, value: str) -> list[Edit]:
        """Give the value at ``begin`` another one."""

    @abstractmethod
    def set_attribute(self, begin: int, key: str, value: str) -> list[Edit]:
        """Give attribute ``key`` of the element at ``begin`` a value. A missing attribute is added
        at the end of the start tag, in YAML among the first keys."""

    @abstractmethod
    def set_components(
        self, begin: int, keys: Sequence[tuple[str, ...]], values: Sequence[str]
    ) -> list[Edit]:
        """Change the components of the setting at ``begin`` (a child tag, in YAML a key) that
        differ, and add those that it lacks. ``keys``: the spellings of each component."""

    @abstractmethod
    def add_setting(
        self, begin: int, name: str, keys: Sequence[str], values: Sequence[str]
    ) -> list[Edit]:
        """Add a setting as the first child of the element (in YAML, of the map) at ``begin``."""

    @abstractmethod
    def _replace_word(self, begin: int, old: str, new: str) -> list[Edit]:
        """Replace a word of the value at ``begin``, or of a value of the element there."""

    @abstractmethod
    def _rename_element(self, begin: int, old: str, new: str) -> list[Edit]:
        """Rename the element (in YAML, the key) at ``begin``, with its end tag."""

    @abstractmethod
    def _rename_attribute(self, begin: int, old: str, new: str) -> list[Edit]:
        """Rename the attribute whose value is at ``begin``."""

    @abstractmethod
    def _remove_attribute(self, begin: int, old: str) -> list[Edit]:
        """Remove the attribute whose value is at ``begin``."""
