"""The report of a run: data with a published schema (docs/report.md)."""

from __future__ import annotations

import os
import platform
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from nau_py.diagnostics.diagnostic import Diagnostic, Severity
from nau_py.model.linked import Project
from nau_py.passes.frame import Session
from nau_py.passes.report import PassRecord
from nau_py.version import __version__

SCHEMA = "https://nau-py.invalid/schema/report-1.json"


def _processor() -> str:
    """Return the name of the processor, where the system has it."""
    try:
        text = Path("/proc/cpuinfo").read_text()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.partition(":")[2].strip() for line in text.splitlines() if "model name" in line]
    return names[0] if names else platform.machine()


def machine_facts(session: Session) -> dict[str, Any]:
    """Return the versions and devices that timings depend on."""
    device = session.resources.device
    return {
        "gl_renderer": device.renderer,
        "gl_version": device.version,
        "cpus": os.cpu_count() or 1,
        "threads": session.options.threads or (os.cpu_count() or 1),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "embreex": version("embreex"),
        "nau_py": __version__,
        "system": platform.platform(),
        "processor": _processor(),
    }


def halving_ms(record: PassRecord) -> float:
    """Project the time of the pass with half its estimated error, milliseconds.

    The standard error falls with the square root of the number of samples, so tracing and shading
    take four times as long; other stages stay the same. Low-discrepancy points do better.
    """
    sampling = sum(record.report.stages.get(name, 0.0) for name in ("trace", "shade"))
    return record.ms + 3 * sampling


def pass_data(record: PassRecord) -> dict[str, Any]:
    """Return the report of one pass in one frame."""
    data: dict[str, Any] = {
        "name": record.name,
        "class": record.pass_class,
        "status": record.status,
    }
    if record.reason:
        data["reason"] = record.reason
    done = record.report
    data |= {
        "ms": round(record.ms, 3),
        "pixels": done.pixels,
        "rays": dict(done.rays),
        "rays_avoided": done.avoided,
    }
    if done.est_error is not None:
        data["est_error"] = done.est_error
        data["ms_to_halve_error"] = round(halving_ms(record), 3)
    if done.stages:
        data["stages"] = {name: round(ms, 3) for name, ms in done.stages.items()}
    if done.notes:
        data["notes"] = list(done.notes)
    return data


def make_report(
    project: Project,
    pipeline: str,
    machine: dict[str, Any],
    diagnostics: list[Diagnostic],
    frames: list[tuple[int, float, list[PassRecord]]],
    setup_ms: float,
) -> dict[str, Any]:
    """Return the report of ``frames``: (index, milliseconds, records)."""
    done = [record.report for _, _, records in frames for record in records]
    rays: dict[str, int] = {}
    for report in done:
        for kind, count in report.rays.items():
            rays[kind] = rays.get(kind, 0) + count
    warnings = [str(d) for d in diagnostics if d.severity is Severity.WARNING]
    return {
        "schema": SCHEMA,
        "project": project.name,
        "pipeline": pipeline,
        "machine": machine,
        "setup_ms": round(setup_ms, 3),
        "frames": [
            {
                "index": index,
                "pipeline": pipeline,
                "ms": round(ms, 3),
                "passes": [pass_data(r) for r in records],
            }
            for index, ms, records in frames
        ],
        "totals": {
            "ms": round(sum(ms for _, ms, _ in frames), 3),
            "rays": rays,
            "rays_avoided": sum(r.avoided for r in done),
        },
        "effects": [e for r in done for e in r.effects],
        "warnings": warnings,
        "nonfinite": sum(r.nonfinite for r in done),
    }


def joined(reports: list[dict[str, Any]]) -> dict[str, Any]:
    """Return one report of several single-frame reports of the same run."""
    first = reports[0]
    ended = {k: v for k, v in reports[-1].items() if k == "ended"}
    rays: dict[str, int] = {}
    for report in reports:
        for kind, count in report["totals"]["rays"].items():
            rays[kind] = rays.get(kind, 0) + count
    return (
        first
        | ended
        | {
            "frames": [frame for report in reports for frame in report["frames"]],
            "effects": reports[-1]["effects"],
            "totals": {
                "ms": round(sum(r["totals"]["ms"] for r in reports), 3),
                "rays": rays,
                "rays_avoided": sum(r["totals"]["rays_avoided"] for r in reports),
            },
            "warnings": list(dict.fromkeys(w for r in reports for w in r["warnings"])),
            "nonfinite": sum(r["nonfinite"] for r in reports),
        }
    )
