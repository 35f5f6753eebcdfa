"""Times of passes, from the report of a run (docs/report.md)."""

from __future__ import annotations

from statistics import median


def median_times(report: object, pipeline: str) -> dict[str, float]:
    """Compute the median time of each pass that ran, over the report's frames of ``pipeline``.

    ``report``: the JSON value that ``nau-run --report`` writes. Returns milliseconds by the name
    of the pass. Raises :class:`ValueError` for another JSON value, and for a report without a
    frame of the pipeline.
    """
    found: dict[str, list[float]] = {}
    try:
        frames = [f for f in report["frames"] if f["pipeline"] == pipeline]  # type: ignore[index]
        known = sorted({str(f["pipeline"]) for f in report["frames"]})  # type: ignore[index]
        for frame in frames:
            for item in frame["passes"]:
                if item["status"] == "run":
                    found.setdefault(str(item["name"]), []).append(float(item["ms"]))
    except (KeyError, TypeError, ValueError) as problem:
        raise ValueError("is not a report of nau-run") from problem
    if not frames:
        listed = ", ".join(f"'{name}'" for name in known) or "none"
        raise ValueError(f"has no frame of pipeline '{pipeline}'; its pipelines: {listed}")
    return {name: median(times) for name, times in found.items()}
