"""The error of a text that cannot be read."""

from __future__ import annotations

from nau_py.diagnostics.location import Location


class ParseError(Exception):
    """A project file that is neither Nau's XML dialect nor YAML."""

    def __init__(self, location: Location, message: str) -> None:
        super().__init__(f"{location}: {message}")
        self.location = location
        self.message = message
