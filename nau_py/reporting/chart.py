"""A scatter plot with logarithmic axes, drawn once for SVG and for PNG."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from itertools import pairwise
from math import ceil, floor, log10

from PIL import Image, ImageDraw, ImageFont

WIDTH, HEIGHT = 860, 480
LEFT, RIGHT, TOP, BOTTOM = 84, 24, 40, 60
INK, GREY, PALE, FRONT = "#1b1f24", "#57606a", "#d8dee4", "#0b62c4"
SERIES = ("#0b62c4", "#b35900", "#1a7f37", "#8250df", "#bf3989", "#57606a")
"""Colours of point groups; a group is told by its shape in the legend's words, too."""
SIZE = 13


@dataclass(frozen=True, slots=True)
class Dot:
    """A point with intervals: ``x`` and ``y`` are (value, low, high). ``hollow``: dominated."""

    x: tuple[float, float, float]
    y: tuple[float, float, float]
    label: str
    series: str
    hollow: bool = False
    marked: bool = False


@dataclass(frozen=True, slots=True)
class Line:
    x0: float
    y0: float
    x1: float
    y1: float
    colour: str
    width: float = 1.0


@dataclass(frozen=True, slots=True)
class Circle:
    x: float
    y: float
    radius: float
    colour: str
    filled: bool
    title: str = ""


@dataclass(frozen=True, slots=True)
class Text:
    x: float
    y: float
    text: str
    colour: str = INK
    anchor: str = "start"
    size: int = SIZE
    turned: bool = False


Shape = Line | Circle | Text


class _Axis:
    """A logarithmic axis from ``low`` to ``high`` onto pixels ``begin`` to ``end``."""

    def __init__(self, values: Sequence[float], begin: float, end: float) -> None:
        usable = [v for v in values if v > 0] or [1.0]
        self.low, self.high = log10(min(usable)), log10(max(usable))
        margin = 0.08 * (self.high - self.low) + 0.05
        self.low, self.high = self.low - margin, self.high + margin
        self.begin, self.end = begin, end

    def at(self, value: float) -> float:
        share = (log10(max(value, 1e-300)) - self.low) / (self.high - self.low)
        return self.begin + min(max(share, 0.0), 1.0) * (self.end - self.begin)

    def ticks(self) -> list[float]:
        """1, 2 and 5 times powers of ten, or powers of ten alone where those are many."""
        steps = (1, 2, 5) if self.high - self.low < 2.5 else (1,)
        powers = range(floor(self.low), ceil(self.high) + 1)
        found = [s * 10.0**p for p in powers for s in steps]
        return [v for v in found if self.low <= log10(v) <= self.high]


def scatter(
    dots: Sequence[Dot], line: Sequence[int], title: str, x_label: str, y_label: str
) -> list[Shape]:
    """The shapes of a plot; ``line``: indices of the dots on the front, by growing x."""
    x = _Axis([v for d in dots for v in d.x], LEFT, WIDTH - RIGHT)
    y = _Axis([v for d in dots for v in d.y], HEIGHT - BOTTOM, TOP)
    shapes: list[Shape] = [Text(LEFT, 24, title, size=15)]
    for v in x.ticks():
        shapes.append(Line(x.at(v), y.begin, x.at(v), y.end, PALE))
        shapes.append(Text(x.at(v), y.begin + 18, f"{v:g}", GREY, "middle"))
    for v in y.ticks():
        shapes.append(Line(x.begin, y.at(v), x.end, y.at(v), PALE))
        shapes.append(Text(x.begin - 8, y.at(v) + 4, f"{v:g}", GREY, "end"))
    shapes.append(Line(x.begin, y.begin, x.end, y.begin, GREY))
    shapes.append(Line(x.begin, y.begin, x.begin, y.end, GREY))
    shapes.append(Text((x.begin + x.end) / 2, HEIGHT - 14, x_label, GREY, "middle"))
    shapes.append(Text(18, (y.begin + y.end) / 2, y_label, GREY, "middle", turned=True))
    for a, b in pairwise(line):
        one, two = dots[a], dots[b]
        shapes.append(
            Line(x.at(one.x[0]), y.at(one.y[0]), x.at(two.x[0]), y.at(two.y[0]), FRONT, 1.5)
        )
    names = list(dict.fromkeys(d.series for d in dots))
    taken: list[tuple[float, float]] = []
    for d in dots:
        colour = SERIES[names.index(d.series) % len(SERIES)]
        px, py = x.at(d.x[0]), y.at(d.y[0])
        shapes.append(Line(x.at(d.x[1]), py, x.at(d.x[2]), py, colour))
        shapes.append(Line(px, y.at(d.y[1]), px, y.at(d.y[2]), colour))
        shapes.append(Circle(px, py, 5, colour, not d.hollow, d.label))
        if d.marked:
            shapes.append(Circle(px, py, 9, colour, False, "knee"))
        shapes.append(_label(d, px, py, taken, colour))
    for k, name in enumerate(names):
        colour = SERIES[k % len(SERIES)]
        shapes.append(Circle(WIDTH - 220, TOP + 10 + 20 * k, 5, colour, True))
        shapes.append(Text(WIDTH - 208, TOP + 14 + 20 * k, name, INK))
    return shapes


def _label(d: Dot, px: float, py: float, taken: list[tuple[float, float]], colour: str) -> Text:
    """The dot's name beside it, moved away from names that stand there already."""
    tx, ty = px + 9, py - 7
    while any(abs(tx - a) < 8 * len(d.label) and abs(ty - b) < 13 for a, b in taken):
        ty += 14 if ty < py + 60 else -150
        if ty < TOP:
            break
    taken.append((tx, ty))
    if tx + 7 * len(d.label) > WIDTH - 4:
        return Text(px - 9, ty, d.label, colour, "end", 12)
    return Text(tx, ty, d.label, colour, "start", 12)


def to_svg(shapes: Sequence[Shape], title: str) -> str:
    """An SVG element for a page."""
    parts = [
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(title)}" '
        f'font-family="system-ui, sans-serif">'
    ]
    for s in shapes:
        if isinstance(s, Line):
            parts.append(
                f'<line x1="{s.x0:.1f}" y1="{s.y0:.1f}" x2="{s.x1:.1f}" y2="{s.y1:.1f}" '
                f'stroke="{s.colour}" stroke-width="{s.width}"/>'
            )
        elif isinstance(s, Circle):
            fill = s.colour if s.filled else "none"
            parts.append(
                f'<circle cx="{s.x:.1f}" cy="{s.y:.1f}" r="{s.radius}" fill="{fill}" '
                f'stroke="{s.colour}" stroke-width="1.5"><title>{escape(s.title)}</title></circle>'
            )
        else:
            turn = f' transform="rotate(-90 {s.x:.1f} {s.y:.1f})"' if s.turned else ""
            parts.append(
                f'<text x="{s.x:.1f}" y="{s.y:.1f}" fill="{s.colour}" font-size="{s.size}" '
                f'text-anchor="{s.anchor}"{turn}>{escape(s.text)}</text>'
            )
    return "".join(parts) + "</svg>"


def to_png(shapes: Sequence[Shape], scale: int = 2) -> bytes:
    """A PNG, ``scale`` pixels a unit; drawn twice as large first, for smooth edges."""
    k = 2 * scale
    image = Image.new("RGB", (WIDTH * k, HEIGHT * k), "white")
    draw = ImageDraw.Draw(image)
    for s in shapes:
        if isinstance(s, Line):
            ends = [(s.x0 * k, s.y0 * k), (s.x1 * k, s.y1 * k)]
            draw.line(ends, s.colour, max(round(s.width * k), 1))
        elif isinstance(s, Circle):
            x, y, r = s.x * k, s.y * k, s.radius * k
            fill = s.colour if s.filled else None
            draw.ellipse((x - r, y - r, x + r, y + r), fill, s.colour, round(1.5 * k))
        else:
            _write(image, draw, s, k)
    small = image.resize((WIDTH * scale, HEIGHT * scale), Image.Resampling.LANCZOS)
    stream = io.BytesIO()
    small.save(stream, "PNG")
    return stream.getvalue()


def _write(image: Image.Image, draw: ImageDraw.ImageDraw, s: Text, k: int) -> None:
    font = ImageFont.load_default(s.size * k)
    if not s.turned:
        anchor = {"start": "ls", "middle": "ms", "end": "rs"}[s.anchor]
        draw.text((s.x * k, s.y * k), s.text, s.colour, font, anchor)
        return
    left, top, right, bottom = draw.textbbox((0, 0), s.text, font)
    patch = Image.new("RGB", (round(right - left) + 8, round(bottom - top) + 8), "white")
    ImageDraw.Draw(patch).text((4 - left, 4 - top), s.text, s.colour, font)
    patch = patch.rotate(90, expand=True)
    x, y = round(s.x * k - patch.width * 0.75), round(s.y * k - patch.height / 2)
    image.paste(patch, (max(x, 0), y))
