"""T: raytrace passes: how many, their mask, programs and ray types."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

from nau_py.diagnostics.catalogue import ERROR, WARNING, rule
from nau_py.diagnostics.diagnostic import Diagnostic, guess, listing, nearest
from nau_py.graph.dependencies import find_dependencies
from nau_py.graph.resource import Resource
from nau_py.model.linked import Project
from nau_py.model.raytrace import BUILTIN, Program, RaytracePass
from nau_py.plugins import PREFIX, program_files
from nau_py.process.paths import resolve, similar
from nau_py.raytrace.programs.catalogue import BUILTIN_PROGRAMS
from nau_py.raytrace.programs.description import EXCEPTION, RAY_GENERATION
from nau_py.raytrace.programs.source import COMPILED, launches_ptx, stand_in, strip_decoration
from nau_py.raytrace.ptx.exports import exports, kind_of
from nau_py.rules.registry import LintContext, check

T001 = rule(
    "T001",
    ERROR,
    "More than one raytrace pass",
    "Nau's integration allows one raytrace pass a project, in whichever pipeline. "
    "`<project raytracePasses='many'>` lifts the limit for nau_py.",
    "two passes of class raytrace",
    "one, or <project raytracePasses='many' …>",
)
T002 = rule(
    "T002",
    ERROR,
    "Mask that nothing writes",
    "No earlier pass of the pipeline writes the texture that selects the pixels, so nothing "
    "would be traced.",
    "<buffer var='mask' texture='L::position'/> before the pass that draws it",
    "let a pass draw into the mask's render target first",
)
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
    "A pass launches compiled programs where its ray generation program is one; else a `.ptx` runs "
    "only where a Python file of the same name stands beside it, with functions in the place of "
    "what it exports.",
    "<rayGen file='a.py' …/> and <rtProgram file='x.ptx' …/> alone",
    "all of them in x.ptx, or x.py beside it",
)
T015 = rule(
    "T015",
    ERROR,
    "Compiled program cannot be run",
    "The PTX text is broken, or has an instruction or a call that is not supported: the message "
    "names line, procedure and instruction.",
    "file='x.ptx', which uses wmma",
    "nvcc without those, or a Python file x.py beside it",
)
T016 = rule(
    "T016",
    ERROR,
    "Compiled program failed",
    "It ended its process (a wrong address) or did not end: the message names the program and the "
    "launch index.",
    "ld.global.f32 %f1, [0];",
    "an address of the launch parameters or of the record",
)
T017 = rule(
    "T017",
    ERROR,
    "Program variable that nothing sets",
    "A compiled program of OptiX 3 to 6 reads a variable by name, and neither the pass nor nau_py "
    "sets one of that name. Set are: eye, U, V, W, fov, top_object, the ray types, output0 and on, "
    "vertex_buffer, index_buffer, the vertex attributes, tex0 to tex7, and what the pass names.",
    "rtDeclareVariable(float4, lightdir, , ); and <valueof optixVar='lightDir' …/>",
    "<valueof optixVar='lightdir' …/>",
)
T018 = rule(
    "T018",
    WARNING,
    "Program variable of another size",
    "A compiled program declares a variable with other bytes than what the pass sets.",
    "rtDeclareVariable(float3, diffuse, , ); and COLOR DIFFUSE, four floats",
    "rtDeclareVariable(float4, diffuse, , );",
)
T019 = rule(
    "T019",
    WARNING,
    "Compiled program threw",
    "It threw an exception, rays went deeper than 20, or it reached beyond a buffer: its exception "
    "program ran at these launch indices, or their work ended.",
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
    "A program uses words or bytes of a payload with which no ray of the pass is sent, or sends "
    "more than the two words of Nau's pipeline.",
    "optixSetPayload_2 in a hit program, optixTrace(…, p0, p1)",
    "optixTrace(…, p0, p1, p2) or two words that hold an address",
)
T022 = rule(
    "T022",
    WARNING,
    "Material entry is not whole",
    "Nau makes the records of a material from its own entry, without looking at the default one: "
    "an entry with fewer ray types shifts the records behind it, one without a miss program may "
    "leave the pass without. nau_py keeps records in step.",
    "<rtMap to='Glass'> with Radiance only, where there is Shadow, too",
    "<rtMap to='Glass'> with an entry for each ray type, miss programs included",
)
T023 = rule(
    "T023",
    WARNING,
    "Parameter at an odd place",
    "The block of rtGlobalParams is packed without gaps, compilers align addresses to 8 bytes.",
    "a FLOAT, then a BUFFER ID",
    "the BUFFER ID first",
)
T024 = rule(
    "T024",
    WARNING,
    "Attribute that compiled programs do not follow",
    "How samples are drawn, gathered and ended is what a compiled program itself does.",
    "<TARGET_ERROR value='0.01' /> beside <rayGen file='x.ptx' …/>",
    "RAYS_PER_PIXEL, which programs read",
)
T006 = rule(
    "T006",
    ERROR,
    "Unknown built-in program",
    "There is no built-in program of that name, or it is of another kind.",
    "file='builtin' proc='miror'",
    "file='builtin' proc='mirror'",
)
T007 = rule(
    "T007",
    WARNING,
    "Undeclared ray type",
    "The pass declares its ray types, and this is none of them; Nau would use the first one.",
    "<rayType name='Radiance'> with only Phong declared",
    "<rayType name='Phong'>",
)
T008 = rule(
    "T008",
    ERROR,
    "Raytrace pass lacks what it needs",
    "A raytrace pass needs an entry point with a ray generation program, and a render target; with "
    "compiled programs of OptiX 3 to 6, both geometry programs, too.",
    "<pass class='raytrace' name='a'/>",
    "… <rtEntryPoint> … <renderTarget …/> …",
)
T009 = rule(
    "T009",
    WARNING,
    "Output buffer not written",
    "Python programs write the first colour of the render target only.",
    "<optixOutput><buffer var='extra' …/>",
    "write to the render target",
)
T013 = rule(
    "T013",
    WARNING,
    "Only one mask counts",
    "Several inputs claim to select pixels; the first one with `mask` is used.",
    "two <buffer … mask='w'/>",
    "one <buffer … mask='w'/>",
)


def raytrace_passes(project: Project) -> list[tuple[str, RaytracePass]]:
    """(pipeline name, pass) of every raytrace pass, in file order."""
    return [
        (pipeline.name or "", p)
        for pipeline in project.pipelines
        for p in pipeline.passes
        if isinstance(p, RaytracePass)
    ]


@check
def one_pass(context: LintContext) -> Iterator[Diagnostic]:
    """One raytrace pass a project."""
    found = raytrace_passes(context.project)
    if len(found) < 2 or context.project.file.raytracePasses == "many":
        return
    first_pipeline, first = found[0]
    for pipeline, pass_ in found[1:]:
        yield T001.at(
            pass_.location,
            f"pass '{pass_.name}' of pipeline '{pipeline}' is a second raytrace pass; the first is "
            f"'{first.name}' of pipeline '{first_pipeline}' at {first.location}. A project has "
            'one, unless <project raytracePasses="many">',
            ((first.location, f"first raytrace pass '{first.name}'"),),
        )


@check
def masks(context: LintContext) -> Iterator[Diagnostic]:
    """The mask must be written by an earlier pass."""
    project = context.project
    for pipeline in project.pipelines:
        graph = find_dependencies(project, pipeline, context.contracts)
        for index, pass_ in enumerate(graph.passes):
            if not isinstance(pass_, RaytracePass) or pass_.mask is None:
                continue
            if sum(1 for source in pass_.rtInput if source.mask) > 1:
                yield T013.at(
                    pass_.location,
                    f"pass '{pass_.name}' has several mask inputs; '{pass_.mask.var}' is used",
                )
            name = pass_.mask.texture or ""
            if project.target_of_texture(name) is None:
                continue
            if not any(w < index for w in graph.writers(Resource("texture", name))):
                yield T002.at(
                    pass_.mask.where("texture"),
                    f"the mask '{name}' of pass '{pass_.name}' is written by no earlier pass of "
                    f"pipeline '{pipeline.name}'",
                )


@check
def completeness(context: LintContext) -> Iterator[Diagnostic]:
    """Entry point, render target, ray types."""
    for _, pass_ in raytrace_passes(context.project):
        if pass_.rtEntryPoint is None or pass_.rtEntryPoint.rayGen is None:
            yield T008.at(
                pass_.location, f"raytrace pass '{pass_.name}' has no ray generation program"
            )
        if pass_.renderTarget is None:
            yield T008.at(pass_.location, f"raytrace pass '{pass_.name}' has no <renderTarget>")
        if not pass_.ray_types:
            yield T008.at(pass_.location, f"raytrace pass '{pass_.name}' has no ray type")
        compiled = launches_ptx(pass_, context.project.folder)
        for output in pass_.rtOutput if not compiled else []:
            yield T009.at(
                output.location,
                f"output '{output.var}' of pass '{pass_.name}' is not written by Python programs",
            )
        declared = [t.name for t in pass_.rtRayTypes if t.name]
        for material in pass_.materials:
            for group in material.rayTypes:
                if declared and group.name and group.name not in declared:
                    yield T007.at(
                        group.where("name"),
                        f"ray type '{group.name}' of pass '{pass_.name}' is not declared; there is "
                        f"{listing(declared)}{nearest(group.name, declared)}",
                        fixes=guess(group.where("name"), group.name, declared),
                    )


@check
def programs(context: LintContext) -> Iterator[Diagnostic]:
    """Every program's file and procedure, without executing anything."""
    for _, pass_ in raytrace_passes(context.project):
        compiled = launches_ptx(pass_, context.project.folder)
        for program, kind, whose in used_programs(pass_):
            label = ", ".join([f"pass '{pass_.name}'", *whose])
            yield from _program(context.project, program, kind, label, compiled)


def used_programs(pass_: RaytracePass) -> Iterator[tuple[Program, str, list[str]]]:
    """(program, kind, its material and ray type in words) of everything that a pass names. Python
    programs meet triangles, whatever its geometry programs."""
    entry = pass_.rtEntryPoint
    if entry is not None and entry.rayGen is not None:
        yield entry.rayGen, RAY_GENERATION, []
    if entry is not None and entry.exception is not None:
        yield entry.exception, EXCEPTION, []
    for material in pass_.materials:
        for group in material.rayTypes:
            whose = [f"material '{material.to or 'default'}'", f"ray type '{group.name}'"]
            for program in group.programs:
                yield program, program.type or "", whose
    if _is_compiled(entry.rayGen if entry else None):
        for geometry in pass_.rtGeometryProgram:
            yield geometry, geometry.type or "", []


def _is_compiled(program: Program | None) -> bool:
    return program is not None and (program.file or "").lower().endswith(COMPILED)


@check
def compiled_programs(context: LintContext) -> Iterator[Diagnostic]:
    """What the compiled files of a pass export, where they are launched or nothing stands in."""
    folder = context.project.folder
    for _, pass_ in raytrace_passes(context.project):
        uses: dict[str, list[tuple[Program, str, list[str]]]] = {}
        for program, kind, whose in used_programs(pass_):
            if program.file and program.proc and _is_compiled(program):
                uses.setdefault(program.file, []).append((program, kind, whose))
        for file, listed in uses.items():
            known = exports(resolve(folder, file).best)
            launched = launches_ptx(pass_, folder)
            if known and (launched or stand_in(folder, file) is None):
                yield from _exports(pass_, file, known, listed, launched)


def _exports(
    pass_: RaytracePass,
    file: str,
    known: list[str],
    uses: list[tuple[Program, str, list[str]]],
    launched: bool,
) -> Iterator[Diagnostic]:
    label, sibling = f"pass '{pass_.name}'", resolve(Path(), file).path.with_suffix(".py").name
    roles: dict[str, list[str]] = {name: [] for name in known}
    for program, kind, whose in uses:
        proc = program.proc or ""
        if proc in roles:
            roles[proc].append(", ".join([kind.lower().replace("_", " "), *whose]))
        else:
            yield T004.at(
                program.where("proc"),
                f"{', '.join([label, *whose])}: '{file}' exports no '{proc}'; it exports "
                f"{listing(known)}{nearest(proc, known)}",
                fixes=guess(program.where("proc"), proc, known),
            )
    if launched:
        return
    listed = [
        f"{name} ({'; '.join(used) or f'not used {kind_of(name)}'.rstrip()})"
        for name, used in roles.items()
    ]
    yield T005.at(
        uses[0][0].where("file"),
        f"{label}: '{file}' does not run here, and no '{sibling}' beside it stands in; the file "
        f"exports {', '.join(listed)}",
    )


def _program(
    project: Project, program: Program, kind: str, label: str, launched: bool
) -> Iterator[Diagnostic]:
    file, proc = program.file, program.proc
    if file is None or proc is None:
        return  # S004 says so
    if launched and resolve(project.folder, file).exists:
        return  # it is read as what it is
    if file == BUILTIN:
        fitting = [name for name, (of, _) in BUILTIN_PROGRAMS.items() if of == kind]
        if proc not in fitting:
            yield T006.at(
                program.where("proc"),
                f"{label}: there is no built-in {kind} program '{proc}'; there is "
                f"{listing(fitting)}{nearest(proc, fitting)}",
                fixes=guess(program.where("proc"), proc, fitting),
            )
        return
    written = resolve(project.folder, file)
    path = stand_in(project.folder, file)
    if path is None:
        if file.startswith(PREFIX):
            names = [PREFIX + name for name in program_files()]
            yield T003.at(
                program.where("file"),
                f"{label}: there is no plug-in '{file}'; there is {listing(names)}"
                f"{nearest(file, names)}",
                fixes=guess(program.where("file"), file, names),
            )
            return
        if written.exists and not exports(written.best):  # else one finding lists what it exports
            sibling = written.path.with_suffix(".py").name
            yield T005.at(
                program.where("file"),
                f"{label}: program '{proc}' is in '{file}', which does not run here, and no "
                f"'{sibling}' beside it stands in",
            )
        elif not written.exists:
            near = similar(written)
            hint = f" (did you mean {listing(near)}?)" if near else ""
            yield T003.at(
                program.where("file"), f"{label}: program file '{file}' does not exist{hint}"
            )
        return
    known = functions(path)
    if known is not None and not {proc, strip_decoration(proc)} & set(known):
        yield T004.at(
            program.where("proc"),
            f"{label}: '{path.name}' defines no function '{proc}'; it defines "
            f"{listing(known)}{nearest(proc, known)}",
            fixes=guess(program.where("proc"), proc, known),
        )


def functions(path: Path) -> list[str] | None:
    """Names that a Python file defines at its top level, by reading it; None if it has no parse."""
    try:
        tree = ast.parse(path.read_bytes(), str(path))
    except (OSError, SyntaxError, ValueError):
        return None
    names = [n.name for n in tree.body if isinstance(n, ast.FunctionDef)]
    for node in tree.body:
        if isinstance(node, ast.Assign):
            names += [t.id for t in node.targets if isinstance(t, ast.Name)]
        elif isinstance(node, ast.ImportFrom | ast.Import):
            names += [a.asname or a.name for a in node.names]
    return names
