"""``nau-cost``: accuracy against time."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import nau_py
from nau_py.accuracy.apply import apply_setting
from nau_py.accuracy.document import write_document
from nau_py.cli.common import guarded, say, size_of, write_result
from nau_py.diagnostics.diagnostic import Severity
from nau_py.passes.frame import RunOptions
from nau_py.run.pipeline_choice import choose_pipeline

if TYPE_CHECKING:
    from nau_py.accuracy.cost_run import CostRun
    from nau_py.model.linked import Project

app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
ENTRY = "nau_py.cli.cost:main"
UNMET = 1


def _knobs(spp: str | None, texts: list[str]) -> dict[str, str]:
    found = {"spp": spp} if spp is not None else {}
    for text in texts:
        name, equals, values = text.partition("=")
        if not equals or not name.strip():
            raise typer.BadParameter(f"'{text}' is no ladder; write KNOB=VALUE,VALUE")
        found[name.strip()] = values
    return found


@app.command()
def run(
    project: Annotated[Path, typer.Argument(help="Project file, XML or YAML.")],
    spp: Annotated[str | None, typer.Option(help="Samples a pixel to try, by commas.")] = None,
    knob: Annotated[
        list[str] | None, typer.Option(help="KNOB=VALUE,VALUE to try; may be repeated.")
    ] = None,
    combine: Annotated[
        bool | None,
        typer.Option("--all/--each", help="Every combination, or each knob by itself."),
    ] = None,
    reference: Annotated[
        int | None, typer.Option(min=2, help="Samples a pixel of the reference.")
    ] = None,
    runs: Annotated[int | None, typer.Option(min=2, help="Runs of each setting.")] = None,
    measure: Annotated[str, typer.Option(help="rmse, mse or relmse: what ranks.")] = "rmse",
    region: Annotated[
        str | None, typer.Option(help="picture or mask: where; default mask if there is one.")
    ] = None,
    target_error: Annotated[
        float | None, typer.Option(min=0.0, help="Find the cheapest setting that meets it.")
    ] = None,
    budget_time: Annotated[
        float | None, typer.Option(min=0.0, help="Find the most accurate in so many seconds.")
    ] = None,
    apply: Annotated[bool, typer.Option(help="Write what was found into the project.")] = False,
    effects: Annotated[
        bool, typer.Option(help="Also render without each effect, and tabulate.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="Folder for cost.json, .csv, .html and .png.")
    ] = None,
    markdown: Annotated[Path | None, typer.Option(help="Page of the numbers.")] = None,
    pipeline: Annotated[str | None, typer.Option(help="Pipeline.")] = None,
    size: Annotated[str | None, typer.Option(help="Window, WxH pixels.")] = None,
    frame: Annotated[int, typer.Option(min=0, help="Frame to measure.")] = 0,
    seed: Annotated[int, typer.Option(min=0, help="Seed of random numbers.")] = 0,
    threads: Annotated[int, typer.Option(min=0, help="Threads; 0: one a core.")] = 0,
    allow_programs: Annotated[
        list[Path] | None, typer.Option(help="Folder to load ray programs from.")
    ] = None,
    no_cache: Annotated[bool, typer.Option(help="Render the reference anew.")] = False,
    quiet: Annotated[bool, typer.Option(help="No table, no progress, no warnings.")] = False,
    debug: Annotated[bool, typer.Option(help="Show tracebacks.")] = False,
) -> None:
    """Measure what accuracy costs in time."""
    from nau_py.accuracy.ranking import RANKED

    if measure not in RANKED:
        raise typer.BadParameter(f"'{measure}' does not rank; one of {', '.join(RANKED)} does")
    if region not in (None, "picture", "mask"):
        raise typer.BadParameter(f"'{region}' is no region; write picture or mask")
    if apply and target_error is None and budget_time is None:
        raise typer.BadParameter("--apply needs --target-error or --budget-time")
    window, knobs = size_of(size), _knobs(spp, knob or [])
    from nau_py.accuracy.cost import CostRequest, measure_cost
    from nau_py.cli.cost_output import print_cost, whole_progress, write_all
    from nau_py.raytrace.ptx.host.supervision import needs_supervision, run_supervised

    loaded = nau_py.load(project)
    if needs_supervision(loaded):  # compiled programs could end this process
        status, said = run_supervised(ENTRY, sys.argv[1:], loaded)
        say(said, loaded.sources)
        raise typer.Exit(status)
    options = RunOptions(
        seed=seed, threads=threads, allow_programs=tuple(str(p) for p in allow_programs or ())
    )
    request = CostRequest(
        knobs, reference, runs, combine, measure, region, target_error, budget_time,
        keep=not no_cache, effects=effects,
    )  # fmt: skip

    def work() -> int:

        with whole_progress(quiet) as progress:
            made = measure_cost(loaded, options, request, pipeline, window, frame, progress)
        if not quiet:
            say((d for d in made.diagnostics if d.severity is Severity.WARNING), loaded.sources)
            print_cost(made.report)
        if out is not None:
            write_all(out, made)
        if markdown is not None:
            write_result(markdown, write_document(made.report))
        if apply:
            _apply(loaded, made)
        unmet = [a for a in made.report.answers if a.setting is None]
        for answer in unmet:
            sys.stderr.write(f"{answer.question}: {answer.text}\n")
        return UNMET if unmet else 0

    raise typer.Exit(guarded(work, loaded.sources, debug))


def _apply(project: Project, made: CostRun) -> None:

    if made.chosen is None:
        sys.stderr.write("nothing to write: no setting meets what was asked\n")
        return
    chosen = choose_pipeline(project, made.report.pipeline)
    said = apply_setting(project, chosen, made.chosen, made.measured[0].candidate)
    file = project.file.location.file
    sys.stderr.write(f"{file}: {'; '.join(said) or 'nothing to change'}\n")


def main() -> None:
    """Entry point of ``nau-cost``."""
    app()
