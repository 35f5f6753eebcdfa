"""Tables of a cost run for terminal, page and Markdown."""

from __future__ import annotations

from nau_py.accuracy.report import CostReport, Estimate, RegionErrors
from nau_py.reporting.table import Grid


def format_number(value: float | None, digits: int = 3) -> str:
    """Write a number with ``digits`` significant digits; nothing for None."""
    return "" if value is None else f"{value:.{digits}g}"


def _format_root(value: float | None) -> str:
    return format_number(None if value is None else value**0.5)


def _format_half_width(found: Estimate) -> str:
    """Write half the width of the interval."""
    high = found.interval[1]
    return "" if high is None or found.mean is None else f"±{high - found.mean:.1g}"


_ERRORS = ("rmse", "95 %", "relMSE", "PSNR", "SSIM", "FLIP", "bias", "noise")
_BRIEF = ("rmse", "95 %", "relMSE", "bias")


def _format_errors(e: RegionErrors) -> dict[str, str]:
    return {
        "rmse": format_number(e.rmse.mean),
        "95 %": _format_half_width(e.rmse),
        "relMSE": format_number(e.relmse.mean),
        "PSNR": format_number(e.psnr.mean),
        "SSIM": format_number(e.ssim.mean, 4),
        "FLIP": format_number(e.flip.mean) if e.flip else "",
        "bias": _format_root(e.bias2),
        "noise": _format_root(e.variance),
    }


def make_setting_grid(report: CostReport, brief: bool = False) -> Grid:
    """Make the table of all settings: time, rays, errors by region, front."""
    columns = _BRIEF if brief else _ERRORS
    regions = list(report.settings[0].errors)
    head = ["setting", "ms", "least to most", "rays"]
    for region in regions:
        head += [f"{region}: {columns[0]}", *columns[1:]]
    rows = []
    for s in report.settings:
        row = [
            s.label + (" (as it is)" if s.base else ""),
            f"{s.time.median:,.0f}",
            f"{s.time.range[0]:,.0f} to {s.time.range[1]:,.0f}",
            f"{sum(s.rays.values()):,}",
        ]
        for region in regions:
            errors = _format_errors(s.errors[region])
            row += [errors[name] for name in columns]
        mark = "better than the reference" if s.better_than_reference else ""
        rows.append((*row, format_number(s.est_error), "yes" if s.on_front else mark))
    strong = frozenset(k for k, s in enumerate(report.settings) if s.on_front)
    return Grid("All settings", (*head, "est. error", "front"), tuple(rows), strong)


def make_sample_grid(report: CostReport) -> Grid | None:
    """Make the table of gains by more samples; None without a ladder of samples."""
    base = next(s for s in report.settings if s.base)
    line = [
        s
        for s in report.settings
        if "spp" in s.values and all(s.values[k] == v for k, v in base.values.items() if k != "spp")
    ]
    line.sort(key=lambda s: float(s.values["spp"]))
    if len(line) < 2:
        return None
    first = line[0].errors[report.region].rmse.mean
    rows = []
    for s in line:
        error = s.errors[report.region].rmse.mean
        gain = first / error if first and error else None
        sampling = s.stages["trace"] + s.stages["shade"]
        rows.append(
            (
                str(s.values["spp"]),
                f"{s.time.median:,.0f}",
                f"{sampling:,.0f}",
                format_number(error),
                format_number(gain),
            )
        )
    title = f"Gain of {', '.join(r[0] for r in rows[1:])} samples over {rows[0][0]}"
    head = ("spp", "ms a frame", "of it trace and shade", "rmse", "times less error")
    return Grid(title, head, tuple(rows))


def make_comparison_grid(report: CostReport) -> Grid:
    """Make the table of the best other settings at equal time and at equal error."""
    rows = tuple(
        (
            c.setting,
            c.at_equal_time or "nothing is better",
            f"{c.error_ratio:.2f} x" if c.error_ratio is not None else "",
            c.at_equal_error or "nothing is faster",
            f"{c.time_ratio:.2f} x" if c.time_ratio is not None else "",
        )
        for c in report.comparisons
    )
    head = ("setting", "in no more time", "error", "with no more error", "time")
    return Grid("Equal time, equal error", head, rows)


def make_effect_grid(report: CostReport) -> Grid | None:
    """Make the table of the cost of each effect; None if it was not measured."""
    if not report.effects:
        return None
    rows = tuple(
        (
            e.effect,
            "yes" if e.called_for else "no",
            f"{e.rays:,}",
            f"{e.ms:,.0f}",
            format_number(e.rmse),
            format_number(e.largest),
            f"{e.pixels:,}",
        )
        for e in report.effects
    )
    head = ("without", "called for", "rays saved", "ms saved", "rmse", "largest", "pixels")
    return Grid("Rays, time and difference of each effect", head, rows)


def write_sentences(report: CostReport) -> list[str]:
    """Write the answers as sentences."""
    where = "inside the mask" if report.region == "mask" else "over the whole picture"
    own = report.reference.own_rmse.get(report.region)
    found = [
        f"Reference: {report.reference.label}; its own error is about {format_number(own, 2)} "
        f"({where}, root mean square)."
    ]
    if report.knee:
        found.append(f"Knee of the front: {report.knee}.")
    if report.halving:
        found.append(
            f"To halve the error by more samples costs {report.halving:.1f} times the time of "
            "tracing and shading."
        )
    found += [f"{a.question[0].upper()}{a.question[1:]}: {a.text}." for a in report.answers]
    for v in report.verified:
        low, high = v.found.interval
        kept = "kept" if v.kept else "NOT kept"
        mean, least, most = (format_number(value) for value in (v.found.mean, low, high))
        found.append(
            f"Promise '{v.promise}' by {v.setting}, rendered again with new seeds: "
            f"{mean} ({least} to {most}), {kept}."
        )
    return found + report.notes
