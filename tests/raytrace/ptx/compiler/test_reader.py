"""Reading of PTX text: modules, lines of errors, and messages for broken texts."""

from __future__ import annotations

import contextlib
import random
from pathlib import Path

import pytest

from nau_py.raytrace.ptx.compiler.analysis import analyse_program
from nau_py.raytrace.ptx.compiler.module import PtxError
from nau_py.raytrace.ptx.compiler.reader import read_ptx
from nau_py.raytrace.ptx.optix.compile import compile_all, compile_module
from nau_py.raytrace.ptx.optix.variables import VariableLayout, declared_variables
from nau_py.raytrace.ptx.runtime.native import NativeError, NativeModule
from tests.raytrace.ptx.bench import HEAD, source

DATA = Path(__file__).parent.parent / "data"
ROOM = (DATA / "room.ptx").read_text()
HEAD_END = ".address_size 64\n"
TEXTS = (ROOM, (DATA / "old.ptx").read_text(), ROOM, (DATA / "new.ptx").read_text())


def test_a_module() -> None:
    module = read_ptx(ROOM)
    assert list(module.functions) == [
        "__raygen__camera", "__closesthit__diffuse", "__anyhit__first_only", "__miss__blue",
    ]  # fmt: skip
    (parameters,) = module.variables
    assert (parameters.space, parameters.size, parameters.align) == ("const", 96, 8)
    hit = module.functions["__closesthit__diffuse"]
    assert (hit.entry, hit.visible) == (True, True)
    assert hit.body is not None
    first = hit.body[0]
    assert (first.opcode, first.operands) == ("call", ("(%r1)", "_optix_get_payload_0", "()"))
    lines = ROOM.split("\n")
    assert all(i.opcode in lines[i.line - 1] for i in hit.body if i.opcode)
    assert module.flushes
    any_ = module.functions["__anyhit__first_only"].body
    assert any_ is not None
    assert [i.label for i in any_ if i.label] == ["KEEP"]
    assert [i.guard for i in any_ if i.guard] == ["%p1"]


def test_declarations_and_initial_values() -> None:
    text = HEAD + (
        '.global .align 1 .b8 $str[4] = {72, 105, 10, 0}; // a "comment"\n'
        ".global .u32 table[2] = {0x10, -1};\n.extern .func (.param .b32 r) vprintf (\n"
        ".param .b64 a,\n.param .b64 b\n)\n;\n"
        ".func (.param .b32 out) twice(.param .b32 in)\n{ .reg .b32 a, b;\n"
        "ld.param.u32 a, [in]; add.u32 b, a, a; st.param.b32 [out], b; ret; }\n"
    )
    module = read_ptx(text)
    assert [v.name for v in module.variables] == ["optixLaunchParams", "$str", "table"]
    assert module.functions["vprintf"].body is None
    assert [v.name for v in module.functions["twice"].takes] == ["in"]
    native = compile_module(module)
    assert "i8 72, i8 105, i8 10, i8 0" in native
    assert "i8 16, i8 0, i8 0, i8 0, i8 255" in native
    NativeModule(native)


@pytest.mark.parametrize(
    "broken, line, words",
    [
        (HEAD + ".visible .entry f()\n{\n\tret\n}\n", 7, "no ';' follows"),
        (HEAD + ".visible .entry f()\n{\n\tret;\n", 8, "function 'f' is not closed"),
        (HEAD + "hello;\n", 5, "a directive is expected, found 'hello;'"),
        (HEAD + ".global .b9 x;\n", 5, "this is no declaration"),
        (HEAD + ".visible .entry f()\n{\n\tmov.u32 %r1, {1;\n}\n", 7, "a bracket is not closed"),
    ],
)
def test_errors_have_their_line(broken: str, line: int, words: str) -> None:
    with pytest.raises(PtxError, match=words) as found:
        read_ptx(broken)
    assert found.value.line == line


@pytest.mark.parametrize(
    "body, words",
    [
        ("wmma.load %d, %a0;", "instruction 'wmma.load' is not supported"),
        (
            "fma.rz.f64 %g1, %g2, %g3, %g4;",
            "a fused multiply-add of doubles rounds to the nearest only",
        ),
        (
            "call (%i1), _optix_get_ias_traversable, ();",
            "'_optix_get_ias_traversable' is not supported",
        ),
        ("call other, ();", "there is no procedure 'other'"),
        ("bra NOWHERE;", "there is no label 'NOWHERE'"),
        ("add.u32 %d, %a0, %zz;", "'%zz' is not declared"),
        ("add.u32 %d, %a0;", "'add.u32' has too few operands"),
        ("add %d, %a0, %a0;", "the instruction names no type"),
    ],
)
def test_unsupported_instructions_are_named(body: str, words: str) -> None:
    text = source(body, ["u32"], "u32")
    _, errors = compile_all(read_ptx(text))
    assert len(errors) == 1
    assert str(errors[0]) == f"procedure 'run': {words}"[: len(str(errors[0]))] or words in str(
        errors[0]
    )
    assert body.split()[0] in text.split("\n")[errors[0].line - 1]


def mutated(text: str, chance: random.Random) -> str:
    """Return a text with a part removed, repeated, exchanged or inserted."""
    at, to = sorted(chance.randrange(len(text)) for _ in range(2))
    to = min(to, at + chance.randrange(1, 60))
    kind = chance.randrange(5)
    if kind == 0:
        return text[:at]
    if kind == 1:
        return text[:at] + text[to:]
    if kind == 2:
        return text[:to] + text[at:]
    if kind == 3:
        return text[:at] + chance.choice("{}[]();,.%@!:$\"'/*\0\n09fx-+|") + text[at + 1 :]
    words = text.split()
    return text[:at] + " " + chance.choice(words) + " " + text[to:]


def survives(text: str, chance: random.Random, native: bool) -> None:
    """Broken text gives a message or is compiled, and raises nothing else."""
    said: list[PtxError] = []
    made = ""
    try:
        module = read_ptx(mutated(text, chance))
        made, said = compile_all(module)
        for function in module.functions.values():
            analyse_program(module, function)
    except PtxError as problem:
        said = [problem]
    assert all(problem.line >= 1 and str(problem) for problem in said)
    if native and made and not said:
        with contextlib.suppress(NativeError):
            NativeModule(made)


def test_broken_texts_end_in_messages() -> None:
    chance = random.Random(7)
    for number in range(1000):
        survives(TEXTS[number % 4], chance, native=number % 30 == 0)


@pytest.mark.slow
def test_a_hundred_thousand_broken_texts() -> None:
    chance = random.Random(11)
    for number in range(100_000):
        survives(TEXTS[number % 4], chance, native=number % 200 == 0)


def test_machine_code_is_kept_and_checked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The second time the code comes from the file; a damaged file is ignored."""
    monkeypatch.setattr("nau_py.raytrace.ptx.runtime.native.cache_folder", lambda: str(tmp_path))
    text = compile_module(read_ptx(ROOM))
    assert NativeModule(text).address("__miss__blue")
    (kept,) = tmp_path.iterdir()
    whole = kept.read_bytes()
    assert NativeModule(text).address("__miss__blue")
    assert kept.read_bytes() == whole
    kept.write_bytes(whole[:-7])
    assert NativeModule(text).address("__raygen__camera")
    assert kept.read_bytes() == whole


def test_only_old_modules_have_bound_variables() -> None:
    """A variable of one byte is a buffer in OptiX 6, and plain memory in OptiX 7."""
    byte = ".global .align 1 .b8 flag[1];\n"
    assert declared_variables(read_ptx(ROOM.replace(HEAD_END, HEAD_END + byte))) == {}
    old = declared_variables(read_ptx((DATA / "old.ptx").read_text() + byte))
    assert (old["flag"].kind, old["diffuse"].size, old["told"].semantic) == (
        "buffer",
        16,
        "attribute told",
    )


def test_attributes_of_all_files_have_one_size() -> None:
    text = (DATA / "old.ptx").read_text()
    name = "_ZN21rti_internal_typeinfo4toldE[8] = {82, 97, 121, 0, "
    assert f"{name}16" in text
    layout = VariableLayout()
    assert layout.add_module(read_ptx(text)) == []
    (said,) = layout.add_module(read_ptx(text.replace(f"{name}16", f"{name}8")))
    assert said == "attribute 'told' has 8 bytes, elsewhere in the pass 16"
