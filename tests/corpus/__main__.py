"""The conformance command: all of Nau's own projects, and how near their pictures come.

``python -m tests.corpus --nau CHECKOUT [--oracle DIR] [--out report.html] [--markdown FILE]
[--only TEXT] [--jobs N] [--timeout S]``

Each pipeline is rendered in a process of its own. The report has a row a pipeline with the real
picture, ours and the difference beside each other; the Markdown is the table of docs/conformance.md.
"""

from __future__ import annotations

import argparse
import base64
import csv
import html
import io
import json
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from PIL import Image

from tests.corpus.conformance import Difference, Request, Result, project_files

SUBSTITUTED = "__substituted_model"
STAND_IN = "models/ntg-bench/bench.obj"
"""The model in the place of those that the checkout lacks."""


def requests(
    nau: Path, oracle: Path | None, only: str, folder: Path, copies: list[Path]
) -> list[Request]:
    """A request for each picture of the real engine, and one for each other project. ``copies``:
    the checkout, then files that were written into it."""
    made: list[Request] = []
    seen: set[str] = set()
    index = oracle / "index.csv" if oracle else None
    rows = list(csv.DictReader(index.read_text().splitlines())) if index else []
    for row in rows:
        if only in row["path"]:
            seen.add(row["path"])
            reference = str(oracle / row["folder"]) if oracle else None
            size = (int(row["width"]), int(row["height"]))
            picture = str(folder / f"{len(made)}.png")
            project = _edited(nau / row["path"], row["folder"], copies)
            made.append(Request(project, row["pipeline"], size, reference, picture))
    for path in project_files(nau):
        name = str(path.relative_to(nau))
        if name not in seen and only in name:
            picture = str(folder / f"{len(made)}.png")
            made.append(Request(_edited(path, "", copies), None, None, None, picture))
    return made


def _edited(path: Path, reference: str, made: list[Path]) -> str:
    """The project's file; where models are missing, a copy beside it with another one."""
    import nau_py
    from nau_py.diagnostics.errors import NauError

    text = path.read_text(encoding="utf-8", errors="replace")
    changed = text
    if SUBSTITUTED in reference:
        changed = changed.replace(
            '<scene name="MainScene" param="SWAP_YZ">', '<scene name="MainScene">'
        )
    try:
        found = nau_py.lint(nau_py.load(path))
    except NauError:
        return str(path)
    missing = [d.message for d in found if d.rule == "F001" and "the model file" in d.message]
    for message in missing:
        name = message.split("the model file '")[1].split("'")[0]
        up = "../" * (len(path.relative_to(made[0]).parts) - 1)
        changed = changed.replace(name, up + STAND_IN)
    if changed == text:
        return str(path)
    copy = path.with_name(f"{path.stem}{SUBSTITUTED}.xml")
    copy.write_text(changed)
    made.append(copy)
    return str(copy)


def work(request: Request, timeout: float) -> Result:
    """Run a request in a child process."""
    with tempfile.NamedTemporaryFile("w", suffix=".json", delete=False) as file:
        json.dump(request.__dict__, file)
    command = [sys.executable, "-m", "tests.corpus.conformance", file.name]
    result = Result(request.project, request.pipeline)
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=False)
        lines = done.stdout.strip().splitlines()
        if done.returncode or not lines:
            result.stage = "crash"
            result.message = (done.stderr.strip().splitlines() or ["no output"])[-1]
            return result
        found = json.loads(lines[-1])
        found["differences"] = [Difference(**d) for d in found["differences"]]
        return Result(**found)
    except subprocess.TimeoutExpired:
        result.stage, result.message = "time", f"no frame {2} within {timeout:.0f} s"
        return result
    finally:
        Path(file.name).unlink()


def _embedded(image: Image.Image) -> str:
    image.thumbnail((320, 240))
    buffer = io.BytesIO()
    image.convert("RGB").save(buffer, "PNG")
    return f'<img src="data:image/png;base64,{base64.b64encode(buffer.getvalue()).decode()}">'


def _pictures(request: Request) -> str:
    ours = Path(request.picture)
    if not ours.exists():
        return ""
    shown = [_embedded(Image.open(ours))]
    if request.reference:
        real = Image.open(Path(request.reference) / "final.png").convert("RGB")
        shown.insert(0, _embedded(real.copy()))
        a, b = (np.asarray(i.convert("RGB")).astype(int) for i in (real, Image.open(ours)))
        if a.shape == b.shape:
            shown.append(
                _embedded(Image.fromarray(np.clip(np.abs(a - b) * 8, 0, 255).astype("u1")))
            )
    return "".join(shown)


def _cells(nau: Path, request: Request, result: Result) -> list[str]:
    try:
        name = str(Path(request.project).relative_to(nau)).removeprefix("projects/")
    except ValueError:
        name = request.project
    name = name.replace(f"{SUBSTITUTED}.xml", ".xml, another model")
    worst = max(result.differences, key=lambda d: (not d.good, d.mean), default=None)
    picture = result.differences[0] if result.differences else None
    return [
        name,
        request.pipeline or "(default)",
        result.verdict,
        f"{result.frame_ms:.0f}" if result.frame_ms else "",
        f"{picture.mean:.2f} / {picture.high:.0f}" if picture else "",
        f"{worst.name}: {worst.mean:.2f} / {worst.high:.0f}"
        if worst and worst is not picture
        else "",
        result.message.replace("\n", " ").replace(f"{nau}/", "")[:240],
    ]


INTRODUCTION = """\
# Conformance

Nau3D's own projects (the public repository Nau3D/nau), each pipeline that the real engine rendered and
the default pipeline of each other project: {said}. *Equal* means a mean absolute difference of at most
1.5/255 and a 99th percentile of at most 8/255, in the picture and in every render target that the real
engine left; the columns give mean / 99th percentile. If a model is in no checkout, another one
replaces it, and there is no reference. Made by

```sh
python -m tests.corpus --nau CHECKOUT --oracle DIR --out report.html --markdown docs/conformance.md
```

A project that does not run has the reason in the last column. Ray tracing runs the shipped PTX, of classes `rt` and `optix`
([programs](programs.md)); `tests/corpus/test_ptx.py` compares it with pictures of real OptiX. The profiler's picture differs by its text: the real one writes more
lines, in a font of its own, of a clock that does not run.

"""
HEAD = ["project", "pipeline", "verdict", "ms a frame", "picture", "worst target", "message"]


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.corpus")
    parser.add_argument("--nau", type=Path, required=True)
    parser.add_argument("--oracle", type=Path)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--markdown", type=Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--timeout", type=float, default=120)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        copies = [options.nau]
        asked = requests(options.nau, options.oracle, options.only, Path(folder), copies)
        with ThreadPoolExecutor(options.jobs) as pool:
            results = []
            for request, result in zip(asked, pool.map(lambda r: work(r, options.timeout), asked)):
                results.append(result)
                print(" | ".join(_cells(options.nau, request, result))[:230], flush=True)
        for copy in copies[1:]:
            copy.unlink()
        summary = Counter(r.verdict for r in results)
        said = ", ".join(f"{n} {verdict}" for verdict, n in summary.most_common())
        print(f"{len(results)} pipelines: {said}")
        rows = [_cells(options.nau, q, r) for q, r in zip(asked, results)]
        if options.markdown:
            table = ["| " + " | ".join(HEAD) + " |", "|" + "---|" * len(HEAD)]
            table += ["| " + " | ".join(c.replace("|", "\\|") for c in row) + " |" for row in rows]
            options.markdown.write_text(INTRODUCTION.format(said=said) + "\n".join(table) + "\n")
        if options.out:
            body = "".join(
                "<tr>"
                + "".join(f"<td>{html.escape(c)}</td>" for c in row)
                + f"<td>{_pictures(q)}</td></tr>"
                for row, q in zip(rows, asked)
            )
            head = "".join(f"<th>{h}</th>" for h in [*HEAD, "real, ours, difference x 8"])
            options.out.write_text(
                "<!doctype html><meta charset=utf-8><title>Conformance</title><style>body{font:13px "
                "sans-serif}td{border-top:1px solid #ccc;vertical-align:top;padding:4px;min-width:5em;"
                "max-width:24em;overflow-wrap:anywhere}td:nth-child(7){min-width:20em}"
                "td:last-child{max-width:none;white-space:nowrap}"
                "img{height:110px;margin-right:4px}</style>"
                f"<h1>Nau's own projects</h1><p>{html.escape(said)}</p><table><tr>{head}</tr>{body}</table>"
            )


if __name__ == "__main__":
    main()
