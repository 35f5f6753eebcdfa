"""Lua without files, sockets or Python, with limits on instructions and memory."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

INSTRUCTIONS = 20_000_000
"""Instructions that one call, or loading a file, may take."""
MEMORY = 64 * 1024 * 1024
"""Bytes that a Lua state may take."""
MAX_OUTPUT = 1000
"""Lines of printed and written text that are kept."""


class LuaError(Exception):
    """Failure of a script; the message is Lua's, with its line."""


def available() -> bool:
    """Return True if Lua is installed (the extra ``lua``)."""
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
    """A Lua state. ``output`` holds the lines that scripts print and write to files."""

    def __init__(self, instructions: int = INSTRUCTIONS, memory: int = MEMORY) -> None:
        self.output: list[str] = []
        self._memory = memory
        self._lua = _runtime(memory)
        code = (Path(__file__).parent / "sandbox.lua").read_text()
        self._running = False
        parts = self._lua.execute(code, instructions, lambda: self._running, self._write)
        self._begin, self._finish = parts

    def _write(self, text: str) -> None:
        if len(self.output) < MAX_OUTPUT:
            self.output.append(text)

    def _message(self, problem: Exception) -> str:
        lines = str(problem).strip().splitlines()
        return lines[0] if lines else f"it needs more than {self._memory >> 20} MiB of memory"

    def define(self, name: str, function: Callable[..., Any]) -> None:
        """Make ``function`` a global of the scripts."""
        self._lua.globals()[name] = function

    def _limited(self, work: Callable[[], Any]) -> Any:
        self._begin()
        self._running = True
        try:
            return work()
        except Exception as problem:
            raise LuaError(self._message(problem)) from None
        finally:
            self._running = False
            self._finish()

    def load(self, text: str, name: str) -> None:
        """Run the top level of a script. Raises :class:`LuaError`."""
        try:
            chunk = self._lua.compile(text, name=f"@{name}".encode())
        except Exception as problem:
            raise LuaError(self._message(problem)) from None
        self._limited(chunk)

    def call(self, name: str) -> Any:
        """Call a global function without arguments. Raises :class:`LuaError`."""
        function = self._lua.globals()[name]
        if function is None:
            raise LuaError(f"there is no function '{name}'")
        return self._limited(function)
