"""The viewer's server: a page, pictures and a web socket, on the loopback interface only.

All addresses begin with a random token, so that only users who got the address see the page.
Requests must name the server as their host (against DNS rebinding), and web sockets come from its
own page.
"""

from __future__ import annotations

import asyncio
import contextlib
import hmac
import json
import tempfile
from collections.abc import AsyncIterator, Awaitable, Callable
from concurrent.futures import Future
from importlib.resources import files
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from starlette.applications import Starlette
from starlette.requests import HTTPConnection, Request
from starlette.responses import JSONResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from nau_py.diagnostics.errors import NauError
from nau_py.process.worker import RequestRefused, WorkerLost
from nau_py.reporting.target_picture import CHANNELS
from nau_py.viewer.cost_run import ViewerCostRun
from nau_py.viewer.export import camera_element
from nau_py.viewer.page_data import content_data, picture_data
from nau_py.viewer.render_thread import RenderThread
from nau_py.viewer.request import PictureRequest
from nau_py.viewer.state import ViewerState

PAGE = files("nau_py.viewer") / "page"
TYPES = {".html": "text/html", ".js": "text/javascript", ".css": "text/css"}
STATIC = sorted(p.name for p in PAGE.iterdir() if Path(p.name).suffix in TYPES)
LOOPBACK = ("127.0.0.1", "localhost", "[::1]")
_HEADERS = {
    "Cache-Control": "no-store",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Content-Security-Policy": "default-src 'self'; img-src 'self' data: blob:; "
    "style-src 'self' 'unsafe-inline'; connect-src 'self' "
    "ws: wss:; frame-ancestors 'self'",
}
MOST_SEQUENCE = 1000
"""Largest number of frames of a sequence."""
_OTHER_STEPS = 4
"""Number of pictures that are averaged for a comparison."""


class AccessCheck:
    """Refuses requests without the token or with another host, all with the same answer."""

    def __init__(self, app: Any, token: str) -> None:
        self.app, self.token = app, token

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        if self._allowed(HTTPConnection(scope)):
            await self.app(scope, receive, send)
        elif scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008})
        else:
            answer = PlainTextResponse("not found\n", status_code=404, headers=_HEADERS)
            await answer(scope, receive, send)

    def _allowed(self, connection: HTTPConnection) -> bool:
        first = connection.url.path.lstrip("/").split("/", 1)[0]
        if not hmac.compare_digest(first.encode(), self.token.encode()):
            return False
        host = connection.headers.get("host", "")
        if host.rsplit(":", 1)[0] not in LOOPBACK:
            return False
        origin = connection.headers.get("origin")
        return origin is None or urlsplit(origin).netloc == host


class Windows:
    """Connected windows: each gets the newest state when it is ready for it."""

    def __init__(self, state: ViewerState) -> None:
        self.state = state
        self.events: set[asyncio.Event] = set()
        self._loop: asyncio.AbstractEventLoop | None = None

    def begin(self) -> None:
        self._loop = asyncio.get_running_loop()
        self.state.changed = self.news

    def news(self) -> None:
        """Called by any thread."""
        loop = self._loop
        if loop is not None:
            with contextlib.suppress(RuntimeError):  # the loop has ended
                loop.call_soon_threadsafe(self._wake)

    def _wake(self) -> None:
        for event in self.events:
            event.set()


class ViewerRoutes:
    """Routes of one viewer."""

    def __init__(self, state: ViewerState, render_thread: RenderThread, folder: Path) -> None:
        self.state, self.render_thread = state, render_thread
        self.windows = Windows(state)
        self.cost = ViewerCostRun(state.path, folder)

    async def static(self, request: Request) -> Response:
        name = request.path_params.get("name") or "index.html"
        if name not in STATIC:
            return self._missing(f"there is no file '{name}'")
        text = (PAGE / name).read_text("utf-8")
        return Response(text, media_type=TYPES[Path(name).suffix], headers=_HEADERS)

    def _missing(self, why: str) -> Response:
        return PlainTextResponse(why + "\n", status_code=404, headers=_HEADERS)

    async def live(self, socket: WebSocket) -> None:
        """Receive commands and send states. A slow window delays no other one."""
        await socket.accept()
        event = asyncio.Event()
        event.set()
        self.windows.events.add(event)
        sending = asyncio.create_task(self._send_states(socket, event))
        try:
            while True:
                await self._command(socket, await socket.receive_text())
        except WebSocketDisconnect:
            return
        finally:
            self.windows.events.discard(event)
            sending.cancel()

    async def _send_states(self, socket: WebSocket, event: asyncio.Event) -> None:
        known = -1
        with contextlib.suppress(WebSocketDisconnect, RuntimeError):
            while True:
                await event.wait()
                event.clear()
                said: dict[str, Any] = {"glance": picture_data(self.state)}
                if self.state.version != known:
                    content = content_data(self.state)
                    said["content"], known = content, content["version"]
                await socket.send_text(json.dumps(said))

    async def _command(self, socket: WebSocket, text: str) -> None:
        try:
            command = json.loads(text)
            if not isinstance(command, dict):
                raise ValueError("a command is an object")
            await asyncio.to_thread(self.render_thread.do, command)
        except ValueError as problem:
            await socket.send_text(json.dumps({"refused": str(problem)}))

    async def picture(self, request: Request) -> Response:
        shown = self.state.picture
        if shown is None:
            return self._missing("there is no picture yet")
        return Response(shown.png, media_type="image/png", headers=_HEADERS)

    async def _request(self, name: str, *arguments: Any) -> Any:
        future: Future[Any] = self.render_thread.request(name, *arguments)
        return await asyncio.wrap_future(future)

    async def thumbnails(self, request: Request) -> Response:
        found = await self._request("thumbnails")
        return JSONResponse({name: data.hex() for name, data in found}, headers=_HEADERS)

    async def target(self, request: Request) -> Response:
        query = request.query_params
        channel = query.get("channel", "rgb")
        if channel not in CHANNELS:
            return self._missing(f"there is no channel '{channel}'")
        exposure = min(max(float(query.get("exposure", 0)), -30.0), 30.0)
        mask = query.get("mask") == "1"
        data = await self._request("target", query.get("name", ""), channel, exposure, mask)
        return Response(data, media_type="image/png", headers=_HEADERS)

    async def pixel(self, request: Request) -> Response:
        query = request.query_params
        x, y = int(query.get("x", -1)), int(query.get("y", -1))
        values = await self._request("pixel", query.get("name", ""), x, y)
        said = [v if abs(v) < float("inf") else str(v) for v in values]  # JSON knows no others
        return JSONResponse({"values": said}, headers=_HEADERS)

    async def keep(self, request: Request) -> Response:
        """Keep the picture, or render another pipeline or other effects, to compare with."""
        query = request.query_params
        shown = self.state.picture_request()
        label = query.get("label", "")
        if "pipeline" in query or "effects" in query:
            pipeline = query.get("pipeline") or shown.pipeline
            if self.state.project.pipeline(pipeline) is None:
                return self._missing(f"there is no pipeline '{pipeline}'")
            effects = query.get("effects") or shown.effects
            other = PictureRequest(pipeline, shown.frame, shown.values, effects, shown.size)
            data = await self._request("render_other", other, _OTHER_STEPS, label)
        else:
            data = await self._request("keep", label)
        return Response(data, media_type="image/png", headers=_HEADERS)

    async def compare(self, request: Request) -> Response:
        data, figures = await self._request("compare")
        return JSONResponse({"figures": figures, "difference": data.hex()}, headers=_HEADERS)

    async def export(self, request: Request) -> Response:
        kind = request.path_params["kind"]
        if kind == "picture.png":
            return await self.picture(request)
        if kind == "picture.exr":
            data = await self._request("export_exr")
            return Response(data, media_type="image/x-exr", headers=_HEADERS)
        if kind == "frames.zip":
            first = int(request.query_params.get("first", 0))
            last = int(request.query_params.get("last", 0))
            if not 0 <= first <= last < first + MOST_SEQUENCE:
                return self._missing(f"frames {first} to {last}: at most {MOST_SEQUENCE}, from 0")
            data = await self._request("sequence", self.state.picture_request(), first, last)
            return Response(data, media_type="application/zip", headers=_HEADERS)
        if kind == "camera.txt":
            return PlainTextResponse(camera_element(self.state), headers=_HEADERS)
        return self._missing(f"'{kind}' cannot be exported")

    async def measure(self, request: Request) -> Response:
        """Start ``nau-cost``, or return its state."""
        if request.method == "POST":
            self.cost.start(self.state.pipeline)
        return JSONResponse(self.cost.state(), headers=_HEADERS)

    async def measured(self, request: Request) -> Response:
        page = self.cost.page()
        if page is None:
            return self._missing("nothing has been measured yet")
        return Response(page, media_type="text/html", headers=_HEADERS)


def _answer_errors(
    work: Callable[[Request], Awaitable[Response]],
) -> Callable[..., Awaitable[Response]]:
    """Answer a wrong request with a text, not with a failure of the server."""

    async def answer(request: Request) -> Response:
        try:
            return await work(request)
        except (RequestRefused, WorkerLost, NauError, ValueError) as problem:
            return PlainTextResponse(f"{problem}\n", status_code=409, headers=_HEADERS)

    return answer


def make_app(state: ViewerState, render_thread: RenderThread, token: str) -> Any:
    """Make the application (ASGI); it starts and ends ``render_thread``."""
    scratch = tempfile.TemporaryDirectory(prefix="nau-view-")
    handlers = ViewerRoutes(state, render_thread, Path(scratch.name))

    @contextlib.asynccontextmanager
    async def life(_: Starlette) -> AsyncIterator[None]:
        handlers.windows.begin()
        render_thread.start()
        yield
        handlers.cost.stop()
        await asyncio.to_thread(render_thread.close)
        scratch.cleanup()

    def route(path: str, work: Callable[[Request], Awaitable[Response]], *methods: str) -> Route:
        return Route(f"/{token}/{path}", _answer_errors(work), methods=[*methods] or ["GET"])

    routes = [
        route("", handlers.static),
        route("static/{name}", handlers.static),
        WebSocketRoute(f"/{token}/live", handlers.live),
        route("picture.png", handlers.picture),
        route("thumbnails", handlers.thumbnails),
        route("target.png", handlers.target),
        route("pixel", handlers.pixel),
        route("keep", handlers.keep, "POST"),
        route("compare", handlers.compare),
        route("export/{kind}", handlers.export),
        route("cost", handlers.measure, "GET", "POST"),
        route("cost.html", handlers.measured),
    ]
    return AccessCheck(Starlette(routes=routes, lifespan=life), token)
