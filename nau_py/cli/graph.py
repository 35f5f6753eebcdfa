"""``nau-graph``: the passes of a pipeline and what they hand to each other."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from nau_py.cli.common import guarded, stop_if_unreadable, write_result

app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)


class Style(StrEnum):
    """Output formats."""

    SVG = "svg"
    DOT = "dot"
    MERMAID = "mermaid"
    JSON = "json"


@app.command()
def graph(
    project: Annotated[Path, typer.Argument(help="Project file, XML or YAML.")],
    pipeline: Annotated[str | None, typer.Option(help="Pipeline; default the project's.")] = None,
    format: Annotated[Style, typer.Option(help="Output format.")] = Style.SVG,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="File; else stdout.")
    ] = None,
    debug: Annotated[bool, typer.Option(help="Show tracebacks.")] = False,
) -> None:
    """Draw a pipeline, without a GL context."""
    import nau_py
    from nau_py.graph.export import export

    loaded = nau_py.load(project)
    stop_if_unreadable(loaded)

    def work() -> int:
        write_result(output, export(nau_py.plan(loaded, pipeline), format.value))
        return 0

    raise typer.Exit(guarded(work, loaded.sources, debug))


def main() -> None:
    """Entry point of ``nau-graph``."""
    app()
