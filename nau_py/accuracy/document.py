"""A cost run as a page of Markdown."""

from __future__ import annotations

from nau_py.accuracy.page import summary
from nau_py.accuracy.report import CostReport, SettingCost


def document(report: CostReport) -> str:
    """The numbers of a run, to be kept beside a project."""
    machine = ", ".join(f"{k} {v}" for k, v in report.machine.items())
    size = f"{report.size[0]} x {report.size[1]}"
    parts = [
        f"# {report.project}: accuracy against time",
        f"Made by `nau-cost`; do not edit. Pipeline {report.pipeline}, {size} pixels, "
        f"{report.runs} runs of each setting, a seed each. {machine}.",
        "\n".join(f"- {line}" for line in summary(report)),
        *_samples(report),
        "## All settings",
        "\n".join(_table(report, report.settings)),
    ]
    parts += ["## Equal time, equal error", "\n".join(_comparisons(report))]
    if report.effects:
        parts += ["## What each effect is worth", "\n".join(_effects(report))]
    return "\n\n".join(parts) + "\n"


def _samples(report: CostReport) -> list[str]:
    """What more samples buy over the fewest."""
    base = next(s for s in report.settings if s.base)
    line = [
        s
        for s in report.settings
        if all(v == base.values[k] for k, v in s.values.items() if k != "spp") and "spp" in s.values
    ]
    line.sort(key=lambda s: float(s.values["spp"]))
    if len(line) < 2:
        return []
    first = line[0]
    known = first.errors[report.region].rmse.mean or float("nan")
    rows = [
        "| spp | ms a frame | of it trace and shade | rmse | times less error |",
        "|--:|--:|--:|--:|--:|",
    ]
    for s in line:
        error = s.errors[report.region].rmse.mean or float("nan")
        rows.append(
            f"| {s.values['spp']} | {s.time.median:.0f} | "
            f"{s.stages['trace'] + s.stages['shade']:.0f} | {error:.4f} | {known / error:.1f} |"
        )
    where = "inside the mask" if report.region == "mask" else "of the picture"
    heading = f"## What {', '.join(str(s.values['spp']) for s in line[1:])} samples buy over "
    return [heading + f"{first.values['spp']}", f"Errors {where}.", "\n".join(rows)]


def _table(report: CostReport, settings: list[SettingCost]) -> list[str]:
    regions = list(settings[0].errors)
    head = ["setting", "ms", "rays"]
    for region in regions:
        head += [f"{region}: rmse", "relMSE", "SSIM", "bias", "noise"]
    rows = ["| " + " | ".join([*head, "front"]) + " |", "|---" * (len(head) + 1) + "|"]
    for s in settings:
        cells = [
            s.label + (" (as it is)" if s.base else ""),
            f"{s.time.median:.0f}",
            f"{sum(s.rays.values()):,}",
        ]
        for region in regions:
            e = s.errors[region]
            half = (e.rmse.interval[1] or 0) - (e.rmse.mean or 0)
            cells += [
                f"{e.rmse.mean or 0:.4f} ± {half:.2g}",
                f"{e.relmse.mean or 0:.3g}",
                f"{e.ssim.mean or 0:.4f}",
                f"{(e.bias2 or 0) ** 0.5:.4f}",
                f"{(e.variance or 0) ** 0.5:.4f}",
            ]
        rows.append("| " + " | ".join([*cells, "yes" if s.on_front else ""]) + " |")
    return rows


def _comparisons(report: CostReport) -> list[str]:
    rows = [
        "| setting | in no more time | error | with no more error | time |",
        "|---|---|--:|---|--:|",
    ]
    for c in report.comparisons:
        error = f"{c.error_ratio:.2f} x" if c.error_ratio is not None else ""
        time = f"{c.time_ratio:.2f} x" if c.time_ratio is not None else ""
        rows.append(
            f"| {c.setting} | {c.at_equal_time or 'nothing is better'} | {error} "
            f"| {c.at_equal_error or 'nothing is faster'} | {time} |"
        )
    return rows


def _effects(report: CostReport) -> list[str]:
    rows = [
        "| without | called for | rays saved | ms saved | rmse | largest | pixels |",
        "|---|---|--:|--:|--:|--:|--:|",
    ]
    for e in report.effects:
        rows.append(
            f"| {e.effect} | {'yes' if e.called_for else 'no'} | {e.rays:,} | {e.ms:.0f} "
            f"| {e.rmse:.4f} | {e.largest:.3f} | {e.pixels:,} |"
        )
    return rows
