"""A viewer for tests: the real server on a real port, in a thread; the renderer in its process."""

from __future__ import annotations

import json
import socket
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import uvicorn
from websockets.sync.client import ClientConnection, connect

from nau_py.passes.frame import RunOptions
from nau_py.viewer.render_thread import RenderThread, make_worker
from nau_py.viewer.server import make_app
from nau_py.viewer.state import ViewerState

TOKEN = "token-of-the-tests"
SECONDS = 60.0


class Served:
    """``root`` is the page's address."""

    def __init__(self, project: Path, limit: float = SECONDS) -> None:
        self.state = ViewerState(project)
        self.worker = make_worker(self.state.path, RunOptions(threads=2), limit)
        self.render_thread = RenderThread(self.state, self.worker)
        self.listening = socket.socket()
        self.listening.bind(("127.0.0.1", 0))
        self.listening.listen()
        self.port = self.listening.getsockname()[1]
        self.root = f"http://127.0.0.1:{self.port}/{TOKEN}/"
        config = uvicorn.Config(
            make_app(self.state, self.render_thread, TOKEN),
            log_level="error",
            ws="websockets-sansio",
            timeout_graceful_shutdown=1,
        )
        self.server = uvicorn.Server(config)
        self.thread = threading.Thread(target=self.server.run, args=([self.listening],))

    def __enter__(self) -> Served:
        self.thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.server.should_exit = True
        self.thread.join(20)
        self.listening.close()
        assert not self.thread.is_alive()

    def get(self, path: str, method: str = "GET", **headers: str) -> tuple[int, bytes]:
        """Status and body."""
        named = {k.replace("_", "-"): v for k, v in headers.items()}
        request = urllib.request.Request(self.root + path, method=method, headers=named)
        try:
            with urllib.request.urlopen(request, timeout=SECONDS) as answer:
                return answer.status, answer.read()
        except urllib.error.HTTPError as refused:
            with refused:
                return refused.code, refused.read()

    def window(self, origin: str | None = None, token: str = TOKEN) -> Window:
        address = f"ws://127.0.0.1:{self.port}/{token}/live"
        # without a limit of waiting messages: a full queue would keep the answer to a close, too
        limits: dict[str, Any] = {"open_timeout": SECONDS, "max_queue": None}
        return Window(connect(address, origin=origin, **limits))  # type: ignore[arg-type]


class Window:
    """One browser window: the messages that it receives."""

    def __init__(self, connecting: AbstractContextManager[ClientConnection]) -> None:
        self._connecting = connecting
        self.socket = connecting.__enter__()
        self.content: dict[str, Any] = {}
        self.glance: dict[str, Any] = {}
        self.refused: list[str] = []

    def __enter__(self) -> Window:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self._connecting.__exit__(None, None, None)

    def do(self, **command: Any) -> None:
        self.socket.send(json.dumps(command))

    def until(self, what: Callable[[Window], bool]) -> None:
        """Listen until something is so."""
        end = time.monotonic() + SECONDS
        while not what(self):
            said = json.loads(self.socket.recv(timeout=max(end - time.monotonic(), 0.01)))
            self.content = said.get("content", self.content)
            self.glance = said.get("glance", self.glance)
            if "refused" in said:
                self.refused.append(said["refused"])

    def rules(self) -> list[str]:
        return [d["rule"] for d in self.content.get("diagnostics", [])]


def sharp(window: Window) -> bool:
    """Return True if there is a picture of full size."""
    return bool(window.glance.get("pictures")) and not window.glance["coarse"]
