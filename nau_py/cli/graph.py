"""``nau-graph``: the passes of a pipeline and the resources that they exchange."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import nau_py
from nau_py.cli.common import guarded, stop_if_unreadable, write_result
from nau_py.graph.times import median_times

if TYPE_CHECKING:
    from nau_py.graph.network import CriticalPath

app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)


class GraphFormat(StrEnum):
    """Output formats."""

    SVG = "svg"
    DOT = "dot"
    MERMAID = "mermaid"
    JSON = "json"
    NODE_LINK = "node-link"


@app.command()
def graph(
    project: Annotated[Path, typer.Argument(help="Project file, XML or YAML.")],
    pipeline: Annotated[str | None, typer.Option(help="Pipeline; default the project's.")] = None,
    format: Annotated[GraphFormat, typer.Option(help="Output format.")] = GraphFormat.SVG,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="File; else stdout.")
    ] = None,
    times: Annotated[
        Path | None,
        typer.Option(
            help="Report of `nau-run --report`: show the passes' times and critical path."
        ),
    ] = None,
    debug: Annotated[bool, typer.Option(help="Show tracebacks.")] = False,
) -> None:
    """Draw a pipeline, without a GL context."""
    from nau_py.graph.export import export
    from nau_py.graph.network import find_critical_path

    loaded = nau_py.load(project)
    stop_if_unreadable(loaded)

    def work() -> int:
        plan = nau_py.plan(loaded, pipeline)
        known = None if times is None else read_times(times, plan.pipeline)
        write_result(output, export(plan, format.value, known))
        if known is not None:
            path = find_critical_path(plan.graph, known)
            sys.stderr.write(describe_path(path, known) + "\n")
        return 0

    raise typer.Exit(guarded(work, loaded.sources, debug))


def read_times(path: Path, pipeline: str) -> dict[str, float]:
    """Read the median times of a pipeline's passes from a report. Raises typer.BadParameter."""

    try:
        return median_times(json.loads(path.read_text("utf-8")), pipeline)
    except OSError as problem:
        raise typer.BadParameter(f"--times: '{path}' cannot be read: {problem.strerror}") from None
    except json.JSONDecodeError as problem:
        raise typer.BadParameter(f"--times: '{path}' is not JSON: {problem}") from None
    except ValueError as problem:
        raise typer.BadParameter(f"--times: '{path}' {problem}") from None


def describe_path(path: CriticalPath, times: Mapping[str, float]) -> str:
    """Describe a critical path in one line, with the time of each pass."""
    chain = " → ".join(f"{name} {times[name]:.1f} ms" for name in path.names) or "none"
    return f"critical path: {chain} = {path.ms:.1f} ms of {path.total_ms:.1f} ms"


def main() -> None:
    """Entry point of ``nau-graph``."""
    app()
