"""The tables of a cost run, once for terminal, page and Markdown."""

from __future__ import annotations

from nau_py.accuracy.report import CostReport, Estimate, RegionErrors
from nau_py.reporting.table import Grid


def number(value: float | None, digits: int = 3) -> str:
    """So many significant digits; empty for none."""
    return "" if value is None else f"{value:.{digits}g}"


def _root(value: float | None) -> str:
    return number(None if value is None else value**0.5)


def _half(found: Estimate) -> str:
    """Half the width of the interval."""
    high = found.interval[1]
    return "" if high is None or found.mean is None else f"±{high - found.mean:.1g}"


_ERRORS = ("rmse", "95 %", "relMSE", "PSNR", "SSIM", "FLIP", "bias", "noise")
_BRIEF = ("rmse", "95 %", "relMSE", "bias")


def _errors(e: RegionErrors) -> dict[str, str]:
    return {
        "rmse": number(e.rmse.mean),
        "95 %": _half(e.rmse),
        "relMSE": number(e.relmse.mean),
        "PSNR": number(e.psnr.mean),
        "SSIM": number(e.ssim.mean, 4),
        "FLIP": number(e.flip.mean) if e.flip else "",
        "bias": _root(e.bias2),
        "noise": _root(e.variance),
    }


def settings(report: CostReport, brief: bool = False) -> Grid:
    """All settings: time, rays, errors by region, whether on the front."""
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
            errors = _errors(s.errors[region])
            row += [errors[name] for name in columns]
        mark = "better than the reference" if s.better_than_reference else ""
        rows.append((*row, number(s.est_error), "yes" if s.on_front else mark))
    strong = frozenset(k for k, s in enumerate(report.settings) if s.on_front)
    return Grid("All settings", (*head, "est. error", "front"), tuple(rows), strong)


def samples(report: CostReport) -> Grid | None:
    """What more samples buy over the fewest; None without a ladder of them."""
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
                number(error),
                number(gain),
            )
        )
    title = f"What {', '.join(r[0] for r in rows[1:])} samples buy over {rows[0][0]}"
    head = ("spp", "ms a frame", "of it trace and shade", "rmse", "times less error")
    return Grid(title, head, tuple(rows))


def comparisons(report: CostReport) -> Grid:
    """The best other setting at equal time, and at equal error."""
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


def effects(report: CostReport) -> Grid | None:
    """What each effect is worth; None where that was not asked."""
    if not report.effects:
        return None
    rows = tuple(
        (
            e.effect,
            "yes" if e.called_for else "no",
            f"{e.rays:,}",
            f"{e.ms:,.0f}",
            number(e.rmse),
            number(e.largest),
            f"{e.pixels:,}",
        )
        for e in report.effects
    )
    head = ("without", "called for", "rays saved", "ms saved", "rmse", "largest", "pixels")
    return Grid("What each effect is worth", head, rows)


def sentences(report: CostReport) -> list[str]:
    """The answers in words."""
    where = "inside the mask" if report.region == "mask" else "over the whole picture"
    own = report.reference.own_rmse.get(report.region)
    found = [
        f"Reference: {report.reference.label}; its own error is about {number(own, 2)} ({where}, "
        "root mean square)."
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
        found.append(
            f"Promise '{v.promise}' by {v.setting}, rendered again with new seeds: "
            f"{number(v.found.mean)} ({number(low)} to {number(high)}), {kept}."
        )
    return found + report.notes
