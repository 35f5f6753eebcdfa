"""Frames as notebooks show them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import nau_py.reporting.html as html
from nau_py.reporting.output import png


def frame_html(image: NDArray[np.generic], report: dict[str, Any]) -> str:
    """The picture, and what each pass cost."""
    frame = report["frames"][-1]
    words = f"{report['project']}: {frame['pipeline']}, frame {frame['index']}"
    rows = []
    for item in frame["passes"]:
        ran, error = item["status"] == "run", item.get("est_error")
        rows.append(
            (
                item["name"],
                item["class"],
                f"{item['ms']:,.1f}" if ran else f"left out: {item['reason']}",
                f"{item['pixels']:,}" if item["pixels"] else "",
                ", ".join(f"{kind} {count:,}" for kind, count in item["rays"].items()),
                "" if error is None else f"{error:.4f}",
            )
        )
    head = ("pass", "class", "ms", "pixels", "rays", "est. error")
    about = html.tag("p", f"{words}, {frame['ms']:,.0f} ms")
    return f"<div>{about}{html.picture(png(image), words)}{html.table(head, rows)}</div>"
