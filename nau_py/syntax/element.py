"""The representation shared by XML and YAML: elements with attributes, text values and positions.

A file becomes an :class:`Element` tree first; :mod:`nau_py.formats.bind` turns that into models.
Comparison ignores positions, so that two spellings of one project are equal.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from nau_py.diagnostics.location import NOWHERE, Location


@dataclass(slots=True)
class Element:
    """One XML element (or its YAML equivalent) as written, before any meaning is given to it."""

    tag: str
    attributes: dict[str, str] = field(default_factory=dict)
    children: list[Element] = field(default_factory=list)
    location: Location = field(default=NOWHERE, compare=False)
    attribute_locations: dict[str, Location] = field(default_factory=dict, compare=False)
    written: str = field(default="", compare=False)
    """The tag in the file, where an upgrade gave the element another one."""

    @property
    def source_tag(self) -> str:
        """The tag in the file."""
        return self.written or self.tag

    def first(self, tag: str) -> Element | None:
        """Return the first child with a tag; None where there is none."""
        return next((child for child in self.children if child.tag == tag), None)

    def walk(self) -> Iterator[Element]:
        """Yield the element and everything in it, in the order of the file."""
        yield self
        for child in self.children:
            yield from child.walk()

    def where(self, attribute: str) -> Location:
        """Return the position of an attribute's value, or of the element where it has none."""
        return self.attribute_locations.get(attribute, self.location)

    def count_attributes(self) -> int:
        """Count the attributes of the element and everything in it."""
        return sum(len(element.attributes) for element in self.walk())
