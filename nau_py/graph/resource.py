"""Resources that passes exchange."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Kind = Literal["texture", "buffer", "window"]


@dataclass(frozen=True, slots=True, order=True)
class Resource:
    """A texture or buffer (``lib::name``), or the window that the user sees."""

    kind: Kind
    name: str

    def __str__(self) -> str:
        return self.name if self.kind == "window" else f"{self.kind} {self.name}"


WINDOW = Resource("window", "window")
