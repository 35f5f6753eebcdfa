"""``nau-fmt``: write a project or library as clean XML or YAML."""

from __future__ import annotations

import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from nau_py.cli.common import FAILED, USAGE, guarded, stop_if_unreadable, write_result
from nau_py.formats.json_schema import json_schema
from nau_py.formats.load import is_library, load_library, load_project
from nau_py.formats.write import format_node
from nau_py.formats.xsd import xsd
from nau_py.model.attributes import Registry
from nau_py.syntax.language import is_yaml

app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)


class FileFormat(StrEnum):
    """File formats."""

    XML = "xml"
    YAML = "yaml"


class SchemaKind(StrEnum):
    """Schemas."""

    JSON = "json"
    LIBRARY = "json-library"
    XSD = "xsd"


@app.command()
def fmt(
    project: Annotated[
        Path | None, typer.Argument(help="Project file or material library.")
    ] = None,
    to: Annotated[FileFormat | None, typer.Option(help="Format; default the file's own.")] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="File; else stdout.")
    ] = None,
    schema: Annotated[
        SchemaKind | None, typer.Option(help="Write a schema for editors instead.")
    ] = None,
    check: Annotated[bool, typer.Option(help="Only say whether the file is formatted.")] = False,
    debug: Annotated[bool, typer.Option(help="Show tracebacks.")] = False,
) -> None:
    """Format a file. Comments are not kept."""
    if schema is not None:
        raise typer.Exit(guarded(lambda: _schema(schema, output), {}, debug))
    if project is None:
        sys.stderr.write("Missing argument 'PROJECT'. Try 'nau-fmt --help'.\n")
        raise typer.Exit(USAGE)

    path = project
    library = is_library(path)
    loaded = load_library(path) if library else load_project(path)
    stop_if_unreadable(loaded)
    own = FileFormat.YAML if is_yaml(path) else FileFormat.XML
    node = loaded.libraries[-1] if library else loaded.file
    text = format_node(node, loaded.registry, (to or own).value)
    if check:
        same = loaded.sources[str(path)] == text
        if not same:
            sys.stderr.write(f"{path}: not formatted; run nau-fmt {path} -o {path}\n")
        raise typer.Exit(0 if same else FAILED)

    def work() -> int:
        write_result(output, text)
        return 0

    raise typer.Exit(guarded(work, loaded.sources, debug))


def _schema(kind: SchemaKind, output: Path | None) -> int:

    registry = Registry()
    made = (
        xsd(registry)
        if kind is SchemaKind.XSD
        else json_schema(registry, kind is SchemaKind.LIBRARY)
    )
    write_result(output, made)
    return 0


def main() -> None:
    """Entry point of ``nau-fmt``."""
    app()
