"""T: ray programs: their files and procedures. Nothing is executed."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

from nau_py.diagnostics.catalogue import ERROR, rule
from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.diagnostics.suggest import format_names, suggest_fix, suggest_name
from nau_py.model.linked import Project
from nau_py.model.raytrace import BUILTIN, Program
from nau_py.plugins import PREFIX, program_files
from nau_py.process.paths import resolve, similar
from nau_py.raytrace.programs.catalogue import BUILTIN_PROGRAMS
from nau_py.raytrace.programs.source import launches_ptx, parse_program, stand_in, strip_decoration
from nau_py.raytrace.programs.used import UsedProgram, used_programs
from nau_py.raytrace.ptx.compiler.exports import read_exports
from nau_py.rules.raytrace import raytrace_passes
from nau_py.rules.registry import LintContext, check

T003 = rule(
    "T003",
    ERROR,
    "Program file not found",
    "The file of a ray program does not exist.",
    "file='programs/glas.py'",
    "file='programs/glass.py'",
)
T004 = rule(
    "T004",
    ERROR,
    "Procedure not found",
    "The program file defines no function of that name.",
    "proc='shad'",
    "proc='shade'",
)
T005 = rule(
    "T005",
    ERROR,
    "Compiled program without a Python counterpart",
    "A pass whose ray generation program is compiled launches compiled programs. In any other "
    "pass a `.ptx` file needs a Python file of the same name beside it, with a function for each "
    "procedure that it exports.",
    "<rayGen file='a.py' …/> and <rtProgram file='x.ptx' …/> alone",
    "all of them in x.ptx, or x.py beside it",
)
T006 = rule(
    "T006",
    ERROR,
    "Unknown built-in program",
    "There is no built-in program of that name, or it is of another kind.",
    "file='builtin' proc='miror'",
    "file='builtin' proc='mirror'",
)


@check
def check_programs(context: LintContext) -> Iterator[Diagnostic]:
    """Check the file and procedure of every program."""
    for _, pass_ in raytrace_passes(context.project):
        compiled = launches_ptx(pass_, context.project.folder)
        for used in used_programs(pass_):
            label = ", ".join([f"pass '{pass_.name}'", *used.owner])
            yield from _program(context.project, used, label, compiled)


def _program(
    project: Project, used: UsedProgram, label: str, launched: bool
) -> Iterator[Diagnostic]:
    program = used.program
    if program.file is None or program.proc is None:
        return  # S004 reports it
    if launched and resolve(project.folder, program.file).exists:
        return  # the compiler reads it
    if program.file == BUILTIN:
        yield from _built_in(program, used.kind, label)
        return
    path = stand_in(project.folder, program.file)
    if path is None:
        yield from _missing_file(project, program, label)
        return
    known = defined_names(path)
    proc = program.proc
    if known is not None and not {proc, strip_decoration(proc)} & set(known):
        yield T004.at(
            program.where("proc"),
            f"{label}: '{path.name}' defines no function '{proc}'; it defines "
            f"{format_names(known)}{suggest_name(proc, known)}",
            fixes=suggest_fix(program.where("proc"), proc, known),
        )


def _built_in(program: Program, kind: str, label: str) -> Iterator[Diagnostic]:
    proc = program.proc or ""
    fitting = [p.name for p in BUILTIN_PROGRAMS.values() if p.kind == kind]
    if proc not in fitting:
        yield T006.at(
            program.where("proc"),
            f"{label}: there is no built-in {kind} program '{proc}'; there is "
            f"{format_names(fitting)}{suggest_name(proc, fitting)}",
            fixes=suggest_fix(program.where("proc"), proc, fitting),
        )


def _missing_file(project: Project, program: Program, label: str) -> Iterator[Diagnostic]:
    """Report a program without a Python file."""
    file, where = program.file or "", program.where("file")
    if file.startswith(PREFIX):
        names = [PREFIX + name for name in program_files()]
        yield T003.at(
            where,
            f"{label}: there is no plug-in '{file}'; there is {format_names(names)}"
            f"{suggest_name(file, names)}",
            fixes=suggest_fix(where, file, names),
        )
        return
    written = resolve(project.folder, file)
    if not written.exists:
        near = similar(written)
        hint = f" (did you mean {format_names(near)}?)" if near else ""
        yield T003.at(where, f"{label}: program file '{file}' does not exist{hint}")
    elif not read_exports(written.best):  # else one finding lists its exports
        sibling = written.path.with_suffix(".py").name
        yield T005.at(
            where,
            f"{label}: program '{program.proc}' is in '{file}', which does not run here, and no "
            f"'{sibling}' beside it stands in",
        )


def defined_names(path: Path) -> list[str] | None:
    """List the names that a Python file defines or imports at its top level, without running it.

    Returns None for a file that does not parse, and for one that imports all names of a module.
    """
    tree = parse_program(path)
    if tree is None:
        return None
    names = [n.name for n in tree.body if isinstance(n, ast.FunctionDef)]
    for node in tree.body:
        if isinstance(node, ast.Assign):
            names += [t.id for t in node.targets if isinstance(t, ast.Name)]
        elif isinstance(node, ast.ImportFrom | ast.Import):
            names += [a.asname or a.name for a in node.names]
    return None if "*" in names else names
