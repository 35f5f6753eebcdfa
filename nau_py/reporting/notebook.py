"""Projects and frames as HTML, for notebooks."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.model.linked import Project
from nau_py.reporting.page import render_template
from nau_py.reporting.pass_rows import make_pass_grid
from nau_py.reporting.table import Grid


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
    label = f"{project.name}: {width} x {height} pixels, {project.path}"
    head = ("pipeline", "pass", "class", "draws into")
    pipelines = Grid("Pipelines", head, tuple(rows), left=len(head))
    return render_template("project.html", label=label, pipelines=pipelines)


def frame_html(image: NDArray[np.generic], report: dict[str, Any]) -> str:
    """Write the picture of a frame, and the cost of each pass."""
    frame = report["frames"][-1]
    label = f"{report['project']}: {frame['pipeline']}, frame {frame['index']}"
    passes = make_pass_grid(frame)
    ms = f"{frame['ms']:,.0f}"
    return render_template("frame.html", label=label, ms=ms, image=image, passes=passes)
