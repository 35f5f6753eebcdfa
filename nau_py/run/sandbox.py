"""Lua in a cage: no files, no sockets, no Python, limits on instructions and memory."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

INSTRUCTIONS = 20_000_000
"""Of one call, and of loading a file."""
MEMORY = 64 * 1024 * 1024
"""Bytes of a Lua state."""
MAX_SAID = 1000
"""Lines that are kept of what scripts print and write."""


class LuaError(Exception):
    """A script failed; the message is Lua's, with its line."""


def available() -> bool:
    """Whether Lua is here: the extra ``lua``."""
    try:
        import_module("lupa")
    except ImportError:
        return False
    return True


def _runtime(memory: int) -> Any:
    try:
        module = import_module("lupa.lua53")  # the version that Nau embeds
    except ImportError:
        module = import_module("lupa")

    def deny(obj: object, name: object, setting: bool) -> None:
        raise AttributeError("scripts see nothing of Python")

    return module.LuaRuntime(
        register_eval=False,
        register_builtins=False,
        attribute_filter=deny,
        max_memory=memory,
        unpack_returned_tuples=True,
    )


class Sandbox:
    """One Lua state. ``said`` holds what scripts print, and write to files."""

    def __init__(self, instructions: int = INSTRUCTIONS, memory: int = MEMORY) -> None:
        self.said: list[str] = []
        self._memory = memory
        self._lua = _runtime(memory)
        code = (Path(__file__).parent / "sandbox.lua").read_text()
        self._running = False
        parts = self._lua.execute(code, instructions, lambda: self._running, self._say)
        self._begin, self._finish = parts

    def _say(self, text: str) -> None:
        if len(self.said) < MAX_SAID:
            self.said.append(text)

    def _words(self, problem: Exception) -> str:
        lines = str(problem).strip().splitlines()
        return lines[0] if lines else f"it needs more than {self._memory >> 20} MiB of memory"

    def offer(self, name: str, function: Callable[..., Any]) -> None:
        """Make ``function`` a global of the scripts."""
        self._lua.globals()[name] = function

    def _limited(self, work: Callable[[], Any]) -> Any:
        self._begin()
        self._running = True
        try:
            return work()
        except Exception as problem:
            raise LuaError(self._words(problem)) from None
        finally:
            self._running = False
            self._finish()

    def load(self, text: str, name: str) -> None:
        """Run the top level of a script. Raises :class:`LuaError`."""
        try:
            chunk = self._lua.compile(text, name=f"@{name}".encode())
        except Exception as problem:
            raise LuaError(self._words(problem)) from None
        self._limited(chunk)

    def call(self, name: str) -> Any:
        """Call a global function without arguments. Raises :class:`LuaError`."""
        function = self._lua.globals()[name]
        if function is None:
            raise LuaError(f"there is no function '{name}'")
        return self._limited(function)
