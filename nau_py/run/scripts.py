"""Lua hooks of passes and pipelines (docs/format.md, 4.3 and 12)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from nau_py.diagnostics.diagnostic import Diagnostic, warning
from nau_py.model.linked import Project
from nau_py.model.passes import Pass, Script
from nau_py.passes.frame import FrameContext
from nau_py.process.paths import resolve
from nau_py.run.attributes import Attributes, get_buffer, set_buffer
from nau_py.run.sandbox import LuaError, Sandbox, available

MAX_REPEATS = 10_000
"""Largest number of runs of a pass in one frame, under a test in mode RUN_WHILE."""


def hooks(project: Project) -> list[Script]:
    """Return the scripts of a project, in file order."""
    found: list[Script | None] = []
    for pipeline in project.pipelines:
        found += [pipeline.preScript, pipeline.testScript, pipeline.postScript]
        for pass_ in pipeline.passes:
            found += [pass_.preScript, pass_.testScript, pass_.postScript]
    return [s for s in found if s is not None]


class Scripts:
    """The scripts of a running project, in one Lua state.

    After a failure the functions of a file are not called again, and its tests fail, as in Nau;
    ``diagnostics`` has the reason.
    """

    def __init__(self, project: Project) -> None:
        self.project = project
        self.attributes = Attributes(project)
        self.diagnostics: list[Diagnostic] = []
        self._faulty: set[Path] = set()
        self._frame: FrameContext | None = None
        self._pass: Pass | None = None
        self._lua: Sandbox | None = None
        found = hooks(project)
        if not found:
            return
        if not available():
            message = f"Lua is not installed: the {len(found)} scripts of the project do not run"
            self.diagnostics.append(warning("L001", found[0].location, message))
            return
        self._lua = Sandbox()
        for name, function in (
            ("getAttr", self._get),
            ("setAttr", self._set),
            ("getBuffer", self._get_buffer),
            ("setBuffer", self._set_buffer),
        ):
            self._lua.define(name, function)
        for name in ("saveTexture", "saveBuffer", "saveProfiler", "screenshot"):
            self._lua.define(name, self._saver(name, found[0]))
        loaded: set[Path] = set()
        for script in found:
            path = self._path(script)
            if path not in loaded:
                loaded.add(path)
                self._load(script, path)

    @property
    def running(self) -> bool:
        """True with a Lua state; without one, tests always pass."""
        return self._lua is not None

    @property
    def output(self) -> list[str]:
        """Lines that scripts have printed or written."""
        return self._lua.output if self._lua else []

    def _path(self, script: Script) -> Path:
        return resolve(Path(script.location.file).parent, script.file or "").best

    def _load(self, script: Script, path: Path) -> None:
        assert self._lua is not None
        try:
            self._lua.load(path.read_bytes().decode("utf-8", "replace"), path.name)
        except (OSError, LuaError) as problem:
            self._fail(script, f"'{path.name}' cannot be loaded: {problem}")

    def _fail(self, script: Script, what: str) -> None:
        self._faulty.add(self._path(script))
        message = f"{what}; its functions are not called any more"
        self.diagnostics.append(warning("L008", script.location, message))

    def call(self, script: Script | None, frame: FrameContext, pass_: Pass) -> Any:
        """Call a hook and return its value; None where there is no hook, or its file has failed."""
        if script is None or self._lua is None or self._path(script) in self._faulty:
            return None
        self._frame, self._pass = frame, pass_
        try:
            return self._lua.call(script.script or "")
        except LuaError as problem:
            where = self._path(script).name
            self._fail(script, f"function '{script.script}' of '{where}': {problem}")
            return None

    def test(self, script: Script | None, frame: FrameContext, pass_: Pass) -> bool:
        """Return True if a test passes; without a test, or without Lua, it does."""
        if script is None or self._lua is None:
            return True
        found = self.call(script, frame, pass_)
        return found is not None and found is not False

    def _current(self) -> tuple[FrameContext, Pass]:
        if self._frame is None or self._pass is None:
            raise ValueError("no frame is being drawn yet")
        return self._frame, self._pass

    def _get(self, type_: str, name: str, component: str, index: int, table: Any) -> None:
        frame, pass_ = self._current()
        found = self.attributes.get(frame, pass_, type_, name, component, int(index))
        for k, value in enumerate(found, 1):
            table[k] = int(value) if value == int(value) else value

    def _set(self, type_: str, name: str, component: str, index: int, table: Any) -> None:
        frame, pass_ = self._current()
        values = _numbers(table)
        self.attributes.set(frame, pass_, type_, name, component, int(index), values)

    def _get_buffer(self, name: str, offset: int, type_: str, table: Any) -> None:
        for k, value in enumerate(get_buffer(self._current()[0], name, int(offset), type_), 1):
            table[k] = int(value) if value == int(value) else value

    def _set_buffer(self, name: str, offset: int, type_: str, table: Any) -> None:
        set_buffer(self._current()[0], name, int(offset), type_, _numbers(table))

    def _saver(self, name: str, script: Script) -> Any:
        def save(*arguments: Any) -> None:
            listed = ", ".join(f"'{a}'" for a in arguments)
            message = f"{name}({listed}) writes no file: use nau-run's -o and --targets"
            if all(d.message != message for d in self.diagnostics):
                self.diagnostics.append(warning("L009", script.location, message))

        return save


def _numbers(table: Any) -> list[float]:
    """Return the numbers of a Lua table, in the order of its keys 1, 2, …"""
    values: list[float] = []
    while (value := table[len(values) + 1]) is not None:
        values.append(float(value))
    return values
