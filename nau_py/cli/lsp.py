"""``nau-lsp``: help in the editor, by the Language Server Protocol on stdin and stdout."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from nau_py.cli.common import FAILED

app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)


@app.command()
def serve(
    stdio: Annotated[bool, typer.Option("--stdio", help="The default; editors name it.")] = True,
) -> None:
    """Serve an editor: diagnostics, completion, hover, navigation, rename, quick fixes."""
    try:
        from nau_py.lsp.server import make_server
    except ModuleNotFoundError as missing:
        sys.stderr.write(
            f"nau-lsp: '{missing.name}' is missing; pip install 'nau_py[lsp]' brings it\n"
        )
        raise typer.Exit(FAILED) from None
    make_server().start_io()


def main() -> None:
    """Entry point of ``nau-lsp``."""
    app()
