"""The variables of OptiX 3 to 6 programs that a pass sets (7.2), checked by reading only."""

from __future__ import annotations

import re
from collections.abc import Iterator

from nau_py.diagnostics.diagnostic import Diagnostic, error, warning
from nau_py.diagnostics.suggest import format_names, suggest_name
from nau_py.model.linked import Project
from nau_py.model.raytrace import Program, RaytracePass, RayVariable
from nau_py.passes.ptx.programs import Modules, find_function
from nau_py.process.paths import resolve as resolve_path
from nau_py.raytrace.programs.used import used_programs
from nau_py.raytrace.ptx.compiler.module import PtxError, PtxFunction, PtxModule
from nau_py.raytrace.ptx.optix.variables import DeclaredVariable, declared_variables

CAMERA = {"eye": 12, "U": 12, "V": 12, "W": 12, "fov": 4, "top_object": 4}
"""Variables of the context, and their bytes."""
UNITS = 8
"""``tex0`` to ``tex7``: textures of the first units."""
_WORD = re.compile(r"[A-Za-z_$][\w$]*")


def given(project: Project, pass_: RaytracePass) -> dict[str, int | None]:
    """What a pass sets, by name, with its bytes; None for buffers and textures."""
    found: dict[str, int | None] = dict(CAMERA)
    found |= dict.fromkeys(pass_.ray_types, 4)
    owner = project.target_of(pass_)
    found |= {f"output{i}": None for i in range(len(owner[1].colors) if owner else 0)}
    found |= {i.var: None for i in pass_.rtInput if i.var}
    found |= {o.var: None for o in pass_.rtOutput if o.var}
    found |= {"vertex_buffer": None, "index_buffer": None}
    found |= {a.name: None for a in pass_.rtVertexAttributes if a.name}
    found |= {f"tex{unit}": None for unit in range(UNITS)}
    for node in [*pass_.rtGlobalParams, *pass_.rtMaterialParams]:
        if node.name:
            found[node.name] = value_bytes(project, node)
    return found


def value_bytes(project: Project, node: RayVariable) -> int | None:
    """Bytes of a parameter's value; None where it is not known."""
    if node.component == "ID" and node.type in ("TEXTURE", "BUFFER"):
        return 8
    set_ = project.registry.get(node.type or "")
    attribute = set_.get(node.component or "") if set_ is not None else None
    return 4 * attribute.type.components if attribute is not None else None


def mentioned(function: PtxFunction, names: dict[str, DeclaredVariable]) -> list[str]:
    """The variables that a function's own instructions name, in their order."""
    found: dict[str, None] = {}
    for instruction in function.body or []:
        for operand in instruction.operands:
            found |= {w: None for w in _WORD.findall(operand) if w in names}
    return list(found)


def variable_faults(
    project: Project,
    pass_: RaytracePass,
    modules: Modules,
) -> Iterator[Diagnostic]:
    """Variables that programs read and nothing sets, or that have another size."""
    known = given(project, pass_)
    said: set[str] = set()
    for program, *_ in used_programs(pass_):
        module = modules.get(resolve_path(project.folder, program.file or "").best)
        if not isinstance(module, PtxModule):
            continue
        try:
            names = declared_variables(module)
        except PtxError:
            continue  # module_faults says so
        function = find_function(module, program.proc or "")
        for name in mentioned(function, names) if function is not None else []:
            variable = names[name]
            if name not in said and not variable.semantic:
                yield from _variable(pass_, program, name, variable, known)
            said.add(name)


def _variable(
    pass_: RaytracePass,
    program: Program,
    name: str,
    variable: DeclaredVariable,
    known: dict[str, int | None],
) -> Iterator[Diagnostic]:
    label = f"pass '{pass_.name}': program '{program.proc}' of '{program.file}'"
    if name not in known:
        yield error(
            "T017",
            program.where("proc"),
            f"{label} reads the {variable.kind} '{name}', which nothing sets; there is "
            f"{format_names(sorted(known))}{suggest_name(name, sorted(known))}",
        )
        return
    size = known[name]
    if size is not None and size != variable.size:
        yield warning(
            "T018",
            program.where("proc"),
            f"{label}: its variable '{name}' has {variable.size} bytes, what the pass sets has "
            f"{size}; the rest is {'0' if size < variable.size else 'left out'}",
        )
