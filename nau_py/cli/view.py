"""``nau-view``: see a project in the browser, and steer it."""

from __future__ import annotations

import secrets
import socket
import sys
import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from nau_py.cli.common import FAILED, size_of
from nau_py.passes.frame import RunOptions
from nau_py.viewer.state import ViewerState

app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
HOST = "127.0.0.1"


def open_socket(port: int) -> socket.socket | None:
    """Open a socket that listens on the loopback interface; None if the port is taken."""
    found = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        found.bind((HOST, port))
        found.listen()
    except OSError:
        found.close()
        return None
    return found


@app.command()
def view(
    project: Annotated[Path, typer.Argument(help="Project file.")],
    port: Annotated[int, typer.Option(help="Port; 0 takes a free one.", min=0, max=65535)] = 0,
    browser: Annotated[bool, typer.Option(help="Open a browser.")] = True,
    size: Annotated[str | None, typer.Option(help="Window size, WxH.")] = None,
    threads: Annotated[int, typer.Option(help="Threads; 0 is one a core.", min=0)] = 0,
    allow_programs: Annotated[
        list[Path] | None, typer.Option(help="Folders that programs may be loaded from.")
    ] = None,
    no_programs: Annotated[bool, typer.Option(help="Load no programs of the project.")] = False,
    limit: Annotated[
        float, typer.Option(help="Seconds until a renderer without a sign of work is ended.", min=1)
    ] = 60.0,
) -> None:
    """Show a project in the browser: picture, passes, targets, parameters, findings."""
    try:
        import uvicorn

        from nau_py.viewer.server import make_app
    except ModuleNotFoundError as missing:
        sys.stderr.write(
            f"nau-view: '{missing.name}' is missing; pip install 'nau_py[view]' brings it\n"
        )
        raise typer.Exit(FAILED) from None
    from nau_py.viewer.render_thread import RenderThread, make_worker

    listening = open_socket(port)
    if listening is None:
        sys.stderr.write(f"nau-view: port {port} is taken; another one, or 0 for a free one\n")
        raise typer.Exit(FAILED)
    options = RunOptions(
        threads=threads,
        allow_programs=tuple(str(p) for p in allow_programs or []),
        no_programs=no_programs,
    )
    token = secrets.token_urlsafe(16)
    state = ViewerState(project, size_of(size))
    render_thread = RenderThread(state, make_worker(state.path, options, limit))
    config = uvicorn.Config(
        make_app(state, render_thread, token),
        log_level="error",
        ws="websockets-sansio",
        timeout_graceful_shutdown=1,
    )
    address = f"http://{HOST}:{listening.getsockname()[1]}/{token}/"
    sys.stdout.write(f"{address}\n")
    sys.stdout.flush()
    if browser and not _opened(address):
        sys.stderr.write("nau-view: no browser was found; open the address yourself\n")
    uvicorn.Server(config).run(sockets=[listening])


def _opened(address: str) -> bool:
    try:
        return webbrowser.open(address)
    except webbrowser.Error:
        return False


def main() -> None:
    """Entry point of ``nau-view``."""
    app()
