"""T: compiled ray programs: the exports of their files, and rules that only a launch can break."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from nau_py.diagnostics.catalogue import ERROR, WARNING, rule
from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.diagnostics.suggest import format_names, suggest_fix, suggest_name
from nau_py.model.raytrace import RaytracePass
from nau_py.process.paths import resolve
from nau_py.raytrace.programs.source import is_compiled, launches_ptx, stand_in
from nau_py.raytrace.programs.used import UsedProgram, used_programs
from nau_py.raytrace.ptx.compiler.exports import program_kind, read_exports
from nau_py.rules.ray_programs import T004, T005
from nau_py.rules.raytrace import raytrace_passes
from nau_py.rules.registry import LintContext, check

T015 = rule(
    "T015",
    ERROR,
    "Compiled program cannot be run",
    "The PTX text is broken, or has an instruction or a call that is not supported. The message "
    "names line, procedure and instruction.",
    "file='x.ptx', which uses wmma",
    "nvcc without those, or a Python file x.py beside it",
)
T016 = rule(
    "T016",
    ERROR,
    "Compiled program failed",
    "The program crashed its process (a wrong address) or exceeded the time limit. The message "
    "names the program and the launch index.",
    "ld.global.f32 %f1, [0];",
    "an address of the launch parameters or of the record",
)
T017 = rule(
    "T017",
    ERROR,
    "Unset program variable",
    "A compiled program of OptiX 3 to 6 reads a variable by a name that neither the pass nor "
    "nau_py sets. nau_py sets eye, U, V, W, fov, top_object, the ray types, output0 and "
    "following, vertex_buffer, index_buffer, the vertex attributes and tex0 to tex7; a pass sets "
    "the variables that it names.",
    "rtDeclareVariable(float4, lightdir, , ); and <valueof optixVar='lightDir' …/>",
    "<valueof optixVar='lightdir' …/>",
)
T018 = rule(
    "T018",
    WARNING,
    "Program variable of another size",
    "A compiled program declares a variable with another size than the value that the pass sets.",
    "rtDeclareVariable(float3, diffuse, , ); and COLOR DIFFUSE, four floats",
    "rtDeclareVariable(float4, diffuse, , );",
)
T019 = rule(
    "T019",
    WARNING,
    "Compiled program raised an exception",
    "The program threw an exception, rays were nested deeper than 20, or a buffer was indexed "
    "out of bounds. At these launch indices the exception program ran, or the work ended.",
    "rtTrace inside of a closest hit program without an end",
    "if (prd.depth < 8) rtTrace(…);",
)
T020 = rule(
    "T020",
    WARNING,
    "Program reads beyond its record",
    "Records of hits have 112 bytes, those of ray generation and misses 16 (docs/format.md, 7.1).",
    "((HitData *)optixGetSbtDataPointer())->mine, at byte 128",
    "a member of Nau's own structure, or a parameter of rtGlobalParams",
)
T021 = rule(
    "T021",
    WARNING,
    "Payload that does not fit",
    "A program uses words or bytes of a payload that no ray of the pass carries, or sends more "
    "than the two words of Nau's pipeline.",
    "optixSetPayload_2 in a hit program, optixTrace(…, p0, p1)",
    "optixTrace(…, p0, p1, p2) or two words that hold an address",
)
T022 = rule(
    "T022",
    WARNING,
    "Incomplete material entry",
    "Nau makes the records of a material from its own entry only: an entry with fewer ray types "
    "shifts the records behind it, and an entry without a miss program may leave the pass "
    "without one. nau_py keeps the records aligned.",
    "<rtMap to='Glass'> with Radiance only, where there is Shadow, too",
    "<rtMap to='Glass'> with an entry for each ray type, miss programs included",
)
T023 = rule(
    "T023",
    WARNING,
    "Misaligned parameter",
    "The block of rtGlobalParams is packed without gaps, but compilers align addresses to 8 bytes.",
    "a FLOAT, then a BUFFER ID",
    "the BUFFER ID first",
)
T024 = rule(
    "T024",
    WARNING,
    "Attribute without effect on compiled programs",
    "A compiled program decides itself how samples are drawn, accumulated and ended.",
    "<TARGET_ERROR value='0.01' /> beside <rayGen file='x.ptx' …/>",
    "RAYS_PER_PIXEL, which programs read",
)


@check
def check_compiled_programs(context: LintContext) -> Iterator[Diagnostic]:
    """Check the procedures of compiled files that are launched, or that have no Python file."""
    folder = context.project.folder
    for _, pass_ in raytrace_passes(context.project):
        by_file: dict[str, list[UsedProgram]] = {}
        for used in used_programs(pass_):
            file = used.program.file
            if file and used.program.proc and is_compiled(used.program):
                by_file.setdefault(file, []).append(used)
        for file, listed in by_file.items():
            known = read_exports(resolve(folder, file).best)
            launched = launches_ptx(pass_, folder)
            if known and (launched or stand_in(folder, file) is None):
                yield from _exports(pass_, file, known, listed, launched)


def _exports(
    pass_: RaytracePass, file: str, known: list[str], listed: list[UsedProgram], launched: bool
) -> Iterator[Diagnostic]:
    """Compare the exports of a file with the programs that the pass names in it."""
    label, sibling = f"pass '{pass_.name}'", resolve(Path(), file).path.with_suffix(".py").name
    roles: dict[str, list[str]] = {name: [] for name in known}
    for program, kind, owner in listed:
        proc = program.proc or ""
        if proc in roles:
            roles[proc].append(", ".join([kind.lower().replace("_", " "), *owner]))
        else:
            yield T004.at(
                program.where("proc"),
                f"{', '.join([label, *owner])}: '{file}' exports no '{proc}'; it exports "
                f"{format_names(known)}{suggest_name(proc, known)}",
                fixes=suggest_fix(program.where("proc"), proc, known),
            )
    if launched:
        return
    exported = [
        f"{name} ({'; '.join(used) or f'not used {program_kind(name)}'.rstrip()})"
        for name, used in roles.items()
    ]
    yield T005.at(
        listed[0].program.where("file"),
        f"{label}: '{file}' does not run here, and no '{sibling}' beside it stands in; the file "
        f"exports {', '.join(exported)}",
    )
