"""Pages from the templates of ``templates/``: HTML files that need no network.

The templates escape every text, so names and messages of a project are never markup.
"""

from __future__ import annotations

import base64
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from nau_py.reporting.pixels import Array, encode_png

if TYPE_CHECKING:
    from jinja2 import Environment

TEMPLATES = Path(__file__).parent / "templates"


@cache
def _environment() -> Environment:
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    made = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    made.filters["png"] = lambda image: to_data_uri(encode_png(image))
    return made


def render_template(name: str, **values: object) -> str:
    """Render ``templates/NAME`` with ``values``. Its filter ``png`` makes the address of an image
    from an array (:func:`~nau_py.reporting.pixels.encode_png`)."""
    return _environment().get_template(name).render(values)


def to_data_uri(data: bytes, type_: str = "image/png") -> str:
    """Return an address that carries the file itself."""
    return f"data:{type_};base64,{base64.b64encode(data).decode()}"


def shrink(image: Array, longest: int) -> Array:
    """Leave out rows and columns so that no side is longer than ``longest`` pixels."""
    step = max(-(-max(image.shape[:2]) // longest), 1)
    return image[::step, ::step]
