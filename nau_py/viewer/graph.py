"""The pipeline as the viewer's page draws it: passes in order, and what they hand on."""

from __future__ import annotations

from typing import Any

from nau_py.graph.plan import Plan
from nau_py.graph.resource import WINDOW


def graph_data(plan: Plan, report: dict[str, Any] | None) -> dict[str, Any]:
    """Passes with what they cost in the report's last frame, and targets with the passes that read
    and write them, by index."""
    cost = {}
    if report is not None and report["frames"][-1]["pipeline"] == plan.pipeline:
        cost = {p["name"]: p for p in report["frames"][-1]["passes"]}
    passes = []
    targets: dict[str, dict[str, Any]] = {}
    for index, step in enumerate(plan.steps):
        spent = cost.get(step.name, {})
        ran = step.run and spent.get("status") != "left_out"
        passes.append(
            {
                "name": step.name,
                "class": step.pass_.pass_class,
                "runs": ran,
                "reason": step.reason or (spent.get("reason") if not ran else "") or "",
                "ms": spent.get("ms"),
                "pixels": spent.get("pixels"),
                "rays": spent.get("rays", {}),
                "error": spent.get("est_error"),
            }
        )
        for kind, resources in (("writers", step.access.writes), ("readers", step.access.reads)):
            for resource in resources:
                item = targets.setdefault(
                    str(resource),
                    {
                        "name": "window" if resource == WINDOW else resource.name,
                        "kind": resource.kind,
                        "writers": [],
                        "readers": [],
                    },
                )
                if index not in item[kind]:
                    item[kind].append(index)
    return {"passes": passes, "targets": list(targets.values())}
