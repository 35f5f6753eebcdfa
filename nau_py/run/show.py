"""Frames as notebooks show them."""

from __future__ import annotations

import base64
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.run.output import png


def picture_html(image: NDArray[Any], words: str) -> str:
    """An image element that carries the picture."""
    data = base64.b64encode(png(image)).decode()
    return f'<img src="data:image/png;base64,{data}" alt="{escape(words)}">'


def frame_html(image: NDArray[np.generic], report: dict[str, Any]) -> str:
    """The picture, and what each pass cost."""
    frame = report["frames"][-1]
    words = f"{report['project']}: {frame['pipeline']}, frame {frame['index']}"
    head = "".join(f"<th>{h}</th>" for h in ("pass", "class", "ms", "pixels", "rays", "est. error"))
    rows = []
    for item in frame["passes"]:
        ran = item["status"] == "run"
        rays = ", ".join(f"{kind} {count:,}" for kind, count in item["rays"].items())
        error = item.get("est_error")
        cells = (
            item["name"],
            item["class"],
            f"{item['ms']:,.1f}" if ran else f"left out: {item['reason']}",
            f"{item['pixels']:,}" if item["pixels"] else "",
            rays,
            "" if error is None else f"{error:.4f}",
        )
        rows.append("<tr>" + "".join(f"<td>{escape(c)}</td>" for c in cells) + "</tr>")
    return (
        f"<div><p>{escape(words)}, {frame['ms']:,.0f} ms</p>{picture_html(image, words)}"
        f"<table><tr>{head}</tr>{''.join(rows)}</table></div>"
    )
