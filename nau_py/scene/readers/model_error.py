"""The exception of model readers."""

from __future__ import annotations


class ModelError(Exception):
    """A model file cannot be read; ``line`` is 0 if no line is at fault."""

    def __init__(self, message: str, line: int = 0) -> None:
        super().__init__(message)
        self.line = line
