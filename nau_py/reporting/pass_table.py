"""The table after a run."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.table import Table


def _count(number: int) -> str:
    return f"{number:,}" if number else ""


def print_table(report: dict[str, Any], explain: bool) -> None:
    """Print the last frame's passes: status, time, pixels, rays by kind, rays avoided."""
    console = Console(width=None if Console().is_terminal else 160)
    frame = report["frames"][-1]
    title = f"{report['project']}: {frame['pipeline']}, frame {frame['index']}"
    table = Table(title=title, title_justify="left")
    table.add_column("pass")
    table.add_column("class")
    table.add_column("status")
    for name in ("ms", "pixels"):
        table.add_column(name, justify="right")
    table.add_column("rays by kind")
    for name in ("rays avoided", "est. error", "ms to halve it"):
        table.add_column(name, justify="right")
    for item in frame["passes"]:
        ran = item["status"] == "run"
        rays = ", ".join(f"{kind} {count:,}" for kind, count in item["rays"].items())
        error = item.get("est_error")
        table.add_row(
            item["name"],
            item["class"],
            "run" if ran else "left out",
            f"{item['ms']:,.1f}" if ran else "",
            _count(item["pixels"]),
            rays,
            _count(item["rays_avoided"]),
            f"{error:.4f}" if error is not None else "",
            f"{item['ms_to_halve_error']:,.0f}" if error is not None else "",
        )
    table.add_section()
    total = sum(report["totals"]["rays"].values())
    table.add_row(
        "total",
        "",
        "",
        f"{frame['ms']:,.1f}",
        "",
        f"{total:,} rays" if total else "",
        _count(report["totals"]["rays_avoided"]),
        "",
        "",
    )
    console.print(table)
    if "ended" in report:
        console.print(f"no frame after {frame['index']}: {report['ended']}")
    if report["nonfinite"]:
        console.print(f"{report['nonfinite']:,} samples were not finite")
    if explain and report["effects"]:
        console.print(_effects(report["effects"]))
    for item in frame["passes"]:
        for note in item.get("notes", []):
            console.print(f"{item['name']}: {note}")
        if explain and item["status"] != "run":
            console.print(f"{item['name']} is left out: {item['reason']}")


def _effects(effects: list[dict[str, Any]]) -> Table:
    """Make the table of effects: elements that call for each, and its status."""
    table = Table(title="effects", title_justify="left")
    for name in ("effect", "called for by", "in view", "status"):
        table.add_column(name)
    for name in ("rays", "rays saved", "ms saved"):
        table.add_column(name, justify="right")
    table.add_column("difference to all effects")
    for e in effects:
        first = [f"{c['what']} ({_short(c['where'])})" for c in e["by"][:2]]
        more = len(e["by"]) - len(first)
        by = ", ".join(first) + (f" and {more} more" if more > 0 else "")
        status = e["status"].replace("_", " ")
        why = f": {e['reason']}" if "reason" in e else ""
        note = f"; {e['note']}" if "note" in e else ""
        table.add_row(
            e["effect"],
            by,
            "yes" if e["in_view"] and e["called_for"] else "",
            status + why + note,
            _count(e["rays"]),
            _count(e["rays_saved"]),
            f"{e['ms_saved']:,.0f}" if e["rays_saved"] else "",
            e["bound"],
        )
    return table


def _short(where: str) -> str:
    """``folder/file:line:col`` without the folder."""
    return where.rsplit("/", 1)[-1]
