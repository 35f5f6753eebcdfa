"""Class ``profiler``: times of the passes of this frame so far, written over the picture."""

from __future__ import annotations

import numpy as np

from nau_py.graph.contract import Access
from nau_py.model.linked import Project
from nau_py.model.passes import Pass
from nau_py.passes.access import add_process, add_target
from nau_py.passes.drawing import resolve_view
from nau_py.passes.frame import FrameContext
from nau_py.passes.registry import PassClass, register_pass
from nau_py.passes.report import PassReport

MARGIN, LINE, COLUMN = 10, 12, 150
"""Distances in pixels: to the upper left corner, between lines, between names and times."""


@register_pass("profiler")
class ProfilerClass(PassClass):
    """Draws timings over the picture, a line of text for each pass."""

    def access(self, project: Project, pass_: Pass) -> Access:
        access = Access()
        add_process(access, pass_)
        add_target(access, project, pass_, clears=False)
        return access

    def execute(self, pass_: Pass, frame: FrameContext) -> PassReport:
        target = resolve_view(pass_, frame).target
        texture = target.textures[target.colors[0].name]
        lines = [(r.name, r.ms) for r in frame.records if r.status == "run"]
        lines.append(("frame", sum(r.ms for r in frame.records)))
        if texture.format.dtype != np.uint8 or texture.samples:
            return PassReport(
                notes=(f"'{target.name}' is no 8-bit texture of one sample: no text",)
            )
        values = texture.read()
        written = _text(lines, target.width, target.height)
        values[..., :3][written] = 255
        texture.write(values)
        return PassReport()


def _text(
    lines: list[tuple[str, float]], width: int, height: int
) -> np.ndarray[tuple[int, int], np.dtype[np.bool_]]:
    """Return True for each pixel that the text covers, (height, width), row 0 at the bottom."""
    from PIL import Image, ImageDraw, ImageFont

    image = Image.new("L", (width, height))
    drawing, font = ImageDraw.Draw(image), ImageFont.load_default()
    for index, (name, ms) in enumerate(lines):
        y = MARGIN + index * LINE
        drawing.text((MARGIN, y), name, 255, font)
        drawing.text((MARGIN + COLUMN, y), f"{ms:8.2f} ms", 255, font)
    return np.asarray(image)[::-1] > 127
