"""Lua scripts: what they can do to a running project, and what they cannot do to the machine."""

from __future__ import annotations

import re
import time
from pathlib import Path

import numpy as np
import pytest

import nau_py
from nau_py.run.sandbox import LuaError, Sandbox
from tests.conftest import Folder

pytest.importorskip("lupa", reason="the extra lua is not installed")

QUAD = """\
<project name="P" width="8" height="8"><assets>
 <attributes><attribute type="RENDERER" name="shade" data="FLOAT" value="0.25"/>
  <attribute type="PASS" name="count" data="INT" value="3"/></attributes>
 <cameras><camera name="Eye"><POSITION x="1" y="2" z="3"/></camera></cameras>
 <materialLibs><materialLib filename="lib.mlib"/></materialLibs></assets>
<pipelines><pipeline name="Q"><pass name="draw" class="quad">
 {hooks}
 <material name="grey" fromLibrary="L"/></pass></pipeline></pipelines></project>
"""
LIBRARY = """\
<materialLib name="L">
 <buffers><buffer name="numbers"><SIZE value="16"/></buffer></buffers>
 <shaders><shader name="grey" vs="q.vert" ps="q.frag"/></shaders>
 <materials><material name="grey"><shader name="grey"><values>
  <valueof uniform="shade" type="RENDERER" context="CURRENT" component="shade"/>
 </values></shader></material></materials></materialLib>
"""


def project(folder: Folder, script: str, hooks: str) -> nau_py.Project:
    folder.write(
        "q.vert", "#version 330\nin vec4 position;\nvoid main() { gl_Position = position; }\n"
    )
    folder.write(
        "q.frag",
        "#version 330\nuniform float shade;\nout vec4 c;\nvoid main() { c = vec4(shade); }\n",
    )
    folder.write("lib.mlib", LIBRARY)
    folder.write("a.lua", script)
    folder.write("project.xml", QUAD.format(hooks=hooks))
    return folder.load()


def shade(frame: nau_py.Frame) -> float:
    return float(frame.image[..., 0].mean()) / 255


PRE = '<preScript file="a.lua" script="pre"/>'


def test_a_script_sets_what_a_shader_reads(folder: Folder) -> None:
    script = """
    function pre()
        local t = {}
        getAttr("RENDERER", "CURRENT", "shade", 0, t)
        setAttr("RENDERER", "CURRENT", "shade", 0, {t[1] * 2})
    end
    """
    renderer = nau_py.Renderer(project(folder, script, PRE))
    assert shade(renderer.render(0)) == pytest.approx(0.5, abs=1 / 255)
    assert shade(renderer.render(1)) == pytest.approx(1.0, abs=1 / 255)
    assert shade(renderer.render(0)) == pytest.approx(0.5, abs=1 / 255)  # starts again


def test_while_a_test_says_yes_a_pass_runs(folder: Folder) -> None:
    """count goes from 3 to 0: three runs a frame, none of them left for the next frame."""
    script = """
    function again()
        local t = {}
        getAttr("PASS", "CURRENT", "count", 0, t)
        setAttr("PASS", "Q#draw", "count", 0, {t[1] - 1})
        return t[1] > 0
    end
    """
    hooks = '<testScript file="a.lua" script="again" TEST_MODE="RUN_WHILE"/>'
    loaded = project(folder, script, hooks)
    renderer = nau_py.Renderer(loaded)
    passes = [renderer.render(k).report["frames"][0]["passes"][0] for k in range(2)]
    assert "it ran 3 times" in passes[0]["notes"]
    assert passes[1]["status"] == "left_out"
    assert passes[1]["reason"] == "its test 'again' says no"
    again = nau_py.Renderer(loaded)  # the caller's project is as it was
    assert "it ran 3 times" in again.render(0).report["frames"][0]["passes"][0]["notes"]


def test_without_lua_a_pass_runs_once(folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its test cannot be asked: the pass runs, but not for ever, and a warning says so."""
    monkeypatch.setattr("nau_py.run.scripts.available", lambda: False)
    hooks = '<testScript file="a.lua" script="again" TEST_MODE="RUN_WHILE"/>'
    renderer = nau_py.Renderer(project(folder, "function again() return false end", hooks))
    (record,) = renderer.render(0).report["frames"][0]["passes"]
    assert record["status"] == "run"
    assert "notes" not in record
    assert "L001" in {d.rule for d in renderer.diagnostics}


def test_cameras_and_buffers(folder: Folder) -> None:
    script = """
    function pre()
        local t = {}
        getAttr("CAMERA", "Eye", "POSITION", 0, t)
        setAttr("CAMERA", "Eye", "POSITION", 0, {t[1] + 10, t[2], t[3], 1})
        setBuffer("L::numbers", 4, "FLOAT", {t[3] / 2})
        local u = {}
        getBuffer("L::numbers", 4, "FLOAT", u)
        setBuffer("L::numbers", 8, "UINT", {u[1] * 2})
    end
    """
    renderer = nau_py.Renderer(project(folder, script, PRE))
    renderer.render(0)
    np.testing.assert_array_equal(renderer.session.world.camera("Eye").position, [11, 2, 3])
    raw = renderer.session.resources.buffer("L::numbers").read()
    assert np.frombuffer(raw, "<f4")[1] == 1.5
    assert np.frombuffer(raw, "<u4")[2] == 3


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("return nothing.x", "attempt to index a nil value"),
        ("while true do end", "runs longer than"),
        ("while true do pcall(function() while true do end end) end", "runs longer than"),
        ('local s = "x" while true do s = s .. s end', "memory|runs longer"),
        ('setAttr("RENDERER", "CURRENT", "shde", 0, {1})', "did you mean 'shade'"),
        ('setAttr("PASS", "Q#drow", "count", 0, {1})', "there is no pass 'Q#drow'"),
        ('getBuffer("L::numbers", 99, "FLOAT", {})', "buffer 'L::numbers' has 16 bytes"),
        ('getBuffer("L::none", 0, "FLOAT", {})', "there is no buffer 'L::none'"),
    ],
)
def test_a_script_that_fails_is_named_and_not_called_again(
    folder: Folder, body: str, said: str
) -> None:
    renderer = nau_py.Renderer(project(folder, f"function pre() {body} end", PRE))
    start = time.perf_counter()
    renderer.render(1)
    assert time.perf_counter() - start < 30
    found = [d for d in renderer.diagnostics if d.rule == "L008"]
    assert len(found) == 1
    assert "function 'pre' of 'a.lua'" in found[0].message
    assert re.search(said, found[0].message), found[0].message


def test_a_test_that_fails_says_no(folder: Folder) -> None:
    hooks = '<testScript file="a.lua" script="ask" TEST_MODE="RUN_WHILE"/>'
    frame = nau_py.Renderer(project(folder, "function ask() error('x') end", hooks)).render()
    assert frame.report["frames"][0]["passes"][0]["status"] == "left_out"


ATTACKS = {
    "files": "return io.open('{file}', 'r'):read('a')",
    "files by mode": "return io.open('{file}', 'rb')",
    "written files": "local f = io.open('{new}', 'w') f:write('x') f:close()",
    "shell": "os.execute('touch {new}')",
    "environment": "return os.getenv('PATH')",
    "modules": "require('io')",
    "libraries": "package.loadlib('libc.so.6', 'system')",
    "loaded code": "load('os = 1')()",
    "another file": "dofile('{file}')",
    "hooks": "debug.sethook()",
    "coroutines": "coroutine.wrap(function() while true do end end)()",
    "Python": "python.eval('1')",
    "Python behind functions": "return getAttr.__globals__",
    "Python's classes": "return getAttr.__class__.__mro__",
    "sockets": "require('socket')",
    "patterns": "return ('a'):rep(1000):find(('a?'):rep(30) .. ('a'):rep(30))",
    "pattern functions": "return ('a'):match('.')",
    "a long string": "return ('a'):rep(1e9)",
}


@pytest.mark.parametrize("name", ATTACKS)
def test_scripts_reach_nothing_outside(name: str, tmp_path: Path) -> None:
    secret, new = tmp_path / "secret", tmp_path / "new"
    secret.write_text("treasure")
    sandbox = Sandbox(instructions=1_000_000)
    sandbox.define("getAttr", lambda *a: None)
    body = ATTACKS[name].format(file=secret, new=new)
    sandbox.load(f"function f() {body} end", "a.lua")
    start = time.perf_counter()
    try:
        found = sandbox.call("f")
    except LuaError as problem:
        found = str(problem)
    assert time.perf_counter() - start < 5
    assert "treasure" not in str(found)
    assert not new.exists()


def test_the_limits_hold_while_a_file_loads() -> None:
    with pytest.raises(LuaError, match="runs longer"):
        Sandbox(instructions=100_000).load("while true do end", "a.lua")
    with pytest.raises(LuaError, match=r"a\.lua:1"):
        Sandbox().load("function (", "a.lua")


def test_after_a_limit_the_next_call_has_its_own() -> None:
    sandbox = Sandbox(instructions=100_000)
    sandbox.load("function f() while true do end end function g() return 7 end", "a.lua")
    with pytest.raises(LuaError):
        sandbox.call("f")
    assert sandbox.call("g") == 7


def test_what_scripts_print_is_kept(folder: Folder) -> None:
    sandbox = Sandbox()
    sandbox.load("print('a', 1) io.open('log', 'a'):write('b')", "a.lua")
    assert sandbox.output == ["a\t1", "b"]
