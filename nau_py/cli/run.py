"""``nau-run``: render a project."""

from __future__ import annotations

import json
import re
import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

import nau_py
from nau_py.cli.batch import run_batch
from nau_py.cli.common import USAGE, guarded, say, size_of, write_result
from nau_py.cli.doctor import examine
from nau_py.cli.progress import progress_bar
from nau_py.diagnostics.diagnostic import Severity
from nau_py.model.effects import parse_effects
from nau_py.passes.frame import RunOptions
from nau_py.run.report import joined

ENTRY = "nau_py.cli.run:main"
app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)


def _frames(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"(\d+)(?::(\d+))?", text)
    if match is None:
        raise typer.BadParameter(f"'{text}' is no range of frames; write A:B, as in 0:9")
    first = int(match[1])
    last = int(match[2]) if match[2] else first
    if last < first:
        raise typer.BadParameter(f"'{text}': the last frame comes before the first")
    return first, last


def _parameters(texts: list[str]) -> dict[str, str]:
    found = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not name.strip():
            raise typer.BadParameter(f"'{text}' sets nothing; write NAME=VALUE")
        found[name.strip()] = value.strip()
    return found


class Programs(StrEnum):
    """Programs that a pass of class ``rt`` runs if both are there."""

    PTX = "ptx"
    PY = "py"


def _effects(text: str | None) -> str | None:
    try:
        if text is not None:
            parse_effects(text)
    except ValueError as problem:
        raise typer.BadParameter(str(problem)) from None
    return text


def _numbered(path: Path) -> bool:
    return re.search(r"%0?\d*d", path.name) is not None


@app.command()
def run(
    project: Annotated[Path | None, typer.Argument(help="Project file, XML or YAML.")] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="OUT.png, .exr or .npy; %04d numbers.")
    ] = None,
    pipeline: Annotated[
        str | None, typer.Option(help="Only this pipeline; default the project's.")
    ] = None,
    size: Annotated[str | None, typer.Option(help="Window, WxH pixels.")] = None,
    frames: Annotated[str, typer.Option(help="Frames A:B, both included.")] = "0",
    time_step: Annotated[float, typer.Option(help="Seconds from frame to frame.")] = 0.02,
    spp: Annotated[int | None, typer.Option(min=1, help="Samples a pixel of rays.")] = None,
    seed: Annotated[int, typer.Option(help="Seed of random numbers.")] = 0,
    threads: Annotated[int, typer.Option(min=0, help="Threads; 0: one a core.")] = 0,
    targets: Annotated[Path | None, typer.Option(help="Folder for every target.")] = None,
    report: Annotated[Path | None, typer.Option(help="JSON report.")] = None,
    explain: Annotated[
        bool, typer.Option(help="Say why passes and effects are simulated or left out.")
    ] = False,
    effects: Annotated[
        str | None, typer.Option(help="auto, all, none, or a list: what is simulated.")
    ] = None,
    allow_programs: Annotated[
        list[Path] | None, typer.Option(help="Folder to load ray programs from.")
    ] = None,
    programs: Annotated[
        Programs | None,
        typer.Option(help="ptx: compiled programs (default); py: Python files beside them."),
    ] = None,
    program_limit: Annotated[
        float, typer.Option(min=0.1, help="Seconds that a compiled program may take for a pixel.")
    ] = 60.0,
    no_programs: Annotated[bool, typer.Option(help="Refuse all ray programs of files.")] = False,
    check_numerics: Annotated[
        bool, typer.Option(help="Fail on any value that is not finite.")
    ] = False,
    show_mask: Annotated[bool, typer.Option(help="Tint the traced pixels of the picture.")] = False,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", help="NAME=VALUE of the project's interface; may be repeated."),
    ] = None,
    batch: Annotated[
        Path | None, typer.Option(help="Render every project below this folder instead.")
    ] = None,
    time_limit: Annotated[
        float, typer.Option(min=0.1, help="Of --batch: seconds for a project.")
    ] = 120.0,
    memory_limit: Annotated[
        float, typer.Option(min=1, help="Of --batch: megabytes for a project.")
    ] = 4096.0,
    jobs: Annotated[int, typer.Option(min=1, help="Of --batch: projects at a time.")] = 1,
    watch: Annotated[
        bool, typer.Option(help="Render again when a file of the project changes.")
    ] = False,
    quiet: Annotated[bool, typer.Option(help="No table, no progress, no warnings.")] = False,
    debug: Annotated[bool, typer.Option(help="Show tracebacks.")] = False,
    doctor: Annotated[bool, typer.Option(help="Say what this machine has and lacks.")] = False,
) -> None:
    """Render a project to a picture."""
    if doctor:
        raise typer.Exit(examine())
    if batch is not None:
        if project is not None or output is not None or targets is not None:
            raise typer.BadParameter(
                "--batch renders a folder: no PROJECT, -o or --targets with it"
            )
        words = {
            "--pipeline": pipeline, "--size": size, "--spp": spp, "--effects": effects,
            "--frames": frames, "--time-step": time_step, "--seed": seed, "--threads": threads,
        }  # fmt: skip
        more = [w for k, v in words.items() if v is not None for w in (k, str(v))]
        more += ["--no-programs"] * no_programs
        raise typer.Exit(
            guarded(
                lambda: run_batch(batch, report, time_limit, memory_limit, jobs, more, quiet),
                {},
                debug,
            )
        )
    if project is None:
        sys.stderr.write("Missing argument 'PROJECT'. Try 'nau-run --help'.\n")
        raise typer.Exit(USAGE)
    window, (first, last) = size_of(size), _frames(frames)
    given = _parameters(set_ or [])
    from nau_py.raytrace.ptx.host.supervision import needs_supervision, run_supervised

    loaded = nau_py.load(project)
    chosen = programs.value if programs else ""
    if needs_supervision(loaded, chosen):  # compiled programs could end this process
        status, said = run_supervised(ENTRY, sys.argv[1:], loaded, program_limit)
        say(said, loaded.sources)
        raise typer.Exit(status)
    options = RunOptions(
        spp,
        seed,
        threads,
        tuple(str(p) for p in allow_programs or ()),
        no_programs,
        check_numerics=check_numerics,
        effects=_effects(effects),
        programs=chosen,
    )

    def work() -> int:
        from nau_py.reporting.output import check_output
        from nau_py.run.renderer import Renderer

        if output is not None:
            check_output(output)
        if watch:
            from nau_py.cli.watch import run_watch
            from nau_py.reporting.pass_table import print_table

            return run_watch(
                project,
                output,
                lambda changed: Renderer(
                    changed, pipeline, size=window, options=options, time_step=time_step,
                    parameters=given,
                ),
                last,
                lambda frame: None if quiet else print_table(frame.report, explain),
            )  # fmt: skip
        with progress_bar(quiet) as progress:
            renderer = Renderer(
                loaded,
                pipeline,
                size=window,
                options=options,
                time_step=time_step,
                keep_targets=targets is not None,
                progress=progress,
                parameters=given,
            )
            reports = _render(renderer, output, targets, first, last, show_mask)
        if not quiet:
            say((d for d in renderer.diagnostics if d.severity is Severity.WARNING), loaded.sources)
        _finish(reports, report, quiet, explain)
        return 0

    raise typer.Exit(guarded(work, loaded.sources, debug))


def _render(
    renderer: Any,
    output: Path | None,
    targets: Path | None,
    first: int,
    last: int,
    show_mask: bool,
) -> list[dict[str, Any]]:
    """Render frames ``first`` to ``last``, or to the end of the pipelines; write the outputs."""
    from nau_py.reporting.output import write_image, write_targets
    from nau_py.run.mask_overlay import mask_overlay

    reports = []
    for index in range(first, last + 1):
        frame = renderer.render(index)
        if show_mask:
            frame.image = mask_overlay(frame.image, frame.targets, renderer.plan)
        reports.append(frame.report)
        if output is not None and _numbered(output):
            write_image(output.with_name(output.name % index), frame.image)
        if renderer.ended:
            break
    if output is not None and not _numbered(output):
        write_image(output, frame.image)
    if targets is not None:
        write_targets(targets, frame.targets)
    return reports


def _finish(reports: list[dict[str, Any]], path: Path | None, quiet: bool, explain: bool) -> None:
    from nau_py.reporting.pass_table import print_table

    whole = joined(reports)
    if path is not None:
        write_result(path, json.dumps(whole, indent=2) + "\n")
    if not quiet:
        print_table(whole, explain)


def main() -> None:
    """Entry point of ``nau-run``."""
    app()
