"""Projects that launch compiled programs."""

from __future__ import annotations

import os

from nau_py.model.linked import Project
from nau_py.model.raytrace import RaytracePass
from nau_py.raytrace.programs.source import launches_ptx
from nau_py.raytrace.ptx.runtime.guarded import MARKS


def needs_supervision(project: Project, programs: str = "") -> bool:
    """Return True if ``project`` launches compiled programs and this process is not supervised.

    ``programs``: ``py`` selects the Python files beside the compiled ones.
    """
    passes = [p for pipeline in project.pipelines for p in pipeline.passes]
    traced = (p for p in passes if isinstance(p, RaytracePass))
    return MARKS not in os.environ and any(
        launches_ptx(p, project.folder, programs) for p in traced
    )
