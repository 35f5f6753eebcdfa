"""Report of a cost run: data with a published schema (docs/cost-1.schema.json)."""

from __future__ import annotations

import csv
import io
from typing import Any

from pydantic import BaseModel, ConfigDict, Field

SCHEMA = "https://nau-py.invalid/schema/cost-1.json"
Range = tuple[float, float]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", ser_json_inf_nan="null")


class Estimate(_Part):
    """A mean over the runs, and its 95 % confidence interval."""

    mean: float | None
    interval: tuple[float | None, float | None]


class RegionErrors(_Part):
    """Errors over the whole picture or inside the mask. `bias2` + `variance` = MSE of one run,
    the reference's own error taken off."""

    mse: Estimate
    rmse: Estimate
    relmse: Estimate
    psnr: Estimate
    ssim: Estimate
    flip: Estimate | None = None
    bias2: float | None
    variance: float | None


class TimeSpread(_Part):
    """Median, least and greatest over the runs, milliseconds."""

    median: float
    range: Range


class SettingCost(_Part):
    """One setting of the knobs: its cost, and its errors against the reference."""

    label: str
    values: dict[str, float | int | str]
    base: bool = Field(description="True for the unchanged project.")
    time: TimeSpread
    set_up_ms: float
    build_ms: float
    stages: dict[str, float] = Field(description="Milliseconds of a frame, medians.")
    passes: dict[str, float] = Field(
        description="Milliseconds of each pass that does not trace, last run."
    )
    rays: dict[str, int]
    pixels: int
    est_error: float | None = Field(description="Estimate of a run itself for its traced pixels.")
    nonfinite: int = Field(description="Pixels that were not finite, all runs.")
    errors: dict[str, RegionErrors]
    on_front: bool
    better_than_reference: bool = Field(
        description="More accurate than the reference: shown, not ranked."
    )


class ReferenceFacts(_Part):
    """The reference, and its own error."""

    label: str
    spp: int
    cached: bool
    own_rmse: dict[str, float | None]


class Answer(_Part):
    """The setting that answers a question, and a sentence."""

    question: str
    setting: str | None
    text: str


class Comparison(_Part):
    """The best of the other settings at equal time and at equal error; None where there is none."""

    setting: str
    at_equal_time: str | None
    error_ratio: float | None = Field(description="Its error, as a part of this one's.")
    at_equal_error: str | None
    time_ratio: float | None = Field(description="Its time, as a part of this one's.")


class Verified(_Part):
    """A promise, checked by renders with new seeds."""

    promise: str
    setting: str
    found: Estimate
    kept: bool


class EffectCost(_Part):
    """Time and rays that leaving one effect out saves, and the change of the picture."""

    effect: str
    called_for: bool
    rays: int = Field(description="Rays fewer without it.")
    ms: float = Field(description="Milliseconds saved: the median with, less that without.")
    rmse: float = Field(description="Difference that it makes, root mean square.")
    largest: float
    pixels: int = Field(description="Pixels that differ at all.")


class CostReport(_Part):
    """A whole run of `nau-cost`."""

    schema_: str = Field(SCHEMA, alias="schema")
    project: str
    pipeline: str
    size: tuple[int, int]
    frame: int
    machine: dict[str, str | int]
    runs: int
    measure: str
    region: str
    reference: ReferenceFacts
    settings: list[SettingCost]
    knee: str | None
    halving: float | None = Field(description="To halve the error costs so many times the time.")
    comparisons: list[Comparison]
    answers: list[Answer]
    verified: list[Verified]
    effects: list[EffectCost]
    notes: list[str]


def to_json(report: CostReport) -> str:
    return report.model_dump_json(indent=2, by_alias=True) + "\n"


def make_schema() -> dict[str, Any]:
    """Make the JSON Schema of the report."""
    return {"$id": SCHEMA} | CostReport.model_json_schema(by_alias=True)


def to_csv(report: CostReport) -> str:
    """Write a row for each setting: knobs, time, stages, rays, errors by region with intervals."""
    knobs = list(dict.fromkeys(k for s in report.settings for k in s.values))
    stages = list(dict.fromkeys(k for s in report.settings for k in s.stages))
    names = ["mse", "rmse", "relmse", "psnr", "ssim", "flip"]
    head = [*knobs, "ms", "ms_low", "ms_high", *(f"ms_{n}" for n in stages), "rays", "nonfinite"]
    regions = list(dict.fromkeys(r for s in report.settings for r in s.errors))
    for region in regions:
        for name in names:
            head += [f"{region}_{name}", f"{region}_{name}_low", f"{region}_{name}_high"]
        head += [f"{region}_bias2", f"{region}_variance"]
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow([*head, "est_error", "on_front"])
    for s in report.settings:
        row: list[object] = [s.values.get(k) for k in knobs]
        row += [s.time.median, *s.time.range, *(s.stages.get(n) for n in stages)]
        row += [sum(s.rays.values()), s.nonfinite]
        for region in regions:
            errors = s.errors[region]
            for name in names:
                found = getattr(errors, name)
                row += [found.mean, *found.interval] if found is not None else [None] * 3
            row += [errors.bias2, errors.variance]
        writer.writerow([*row, s.est_error, s.on_front])
    return stream.getvalue()
