"""Projects and frames as HTML, for notebooks."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import nau_py.reporting.html as html
from nau_py.model.linked import Project
from nau_py.reporting.output import png


def project_html(project: Project) -> str:
    """Write the pipelines and passes of a project as a table."""
    rows = []
    for pipeline in project.pipelines:
        mark = " (default)" if pipeline is project.default_pipeline else ""
        for number, pass_ in enumerate(pipeline.passes):
            first = f"{pipeline.name}{mark}" if number == 0 else ""
            owner = project.target_of(pass_)
            target = f"{owner[0]}::{owner[1].name}" if owner else "window"
            rows.append((first, pass_.name or "", pass_.pass_class, target))
    width, height = project.size
    about = html.tag("p", f"{project.name}: {width} x {height} pixels, {project.path}")
    return f"<div>{about}{html.table(('pipeline', 'pass', 'class', 'draws into'), rows)}</div>"


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
