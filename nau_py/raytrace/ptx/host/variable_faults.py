"""Faults of the variables of OptiX 3 to 6 programs (7.2), found without executing them."""

from __future__ import annotations

import re
from collections.abc import Iterator

from nau_py.diagnostics.diagnostic import Diagnostic, error, warning
from nau_py.diagnostics.suggest import format_names, suggest_name
from nau_py.model.linked import Project
from nau_py.model.raytrace import Program, RaytracePass, RayVariable
from nau_py.raytrace.programs.used import used_programs
from nau_py.raytrace.ptx.compiler.module import PtxError, PtxModule
from nau_py.raytrace.ptx.host.modules import Modules, find_function, program_path
from nau_py.raytrace.ptx.optix.variables import DeclaredVariable, declared_variables

CAMERA = {"eye": 12, "U": 12, "V": 12, "W": 12, "fov": 4, "top_object": 4}
"""Bytes of the camera's variables, by name."""
TEXTURE_UNITS = 8
"""Texture units that are variables: ``tex0`` to ``tex7``."""
_WORD = re.compile(r"[A-Za-z_$][\w$]*")


def list_given(project: Project, pass_: RaytracePass) -> dict[str, int | None]:
    """Return the variables that a pass sets, with their bytes; None for buffers and textures."""
    found: dict[str, int | None] = dict(CAMERA)
    found |= dict.fromkeys(pass_.ray_types, 4)
    owner = project.target_of(pass_)
    found |= {f"output{i}": None for i in range(len(owner[1].colors) if owner else 0)}
    found |= {i.var: None for i in pass_.rtInput if i.var}
    found |= {o.var: None for o in pass_.rtOutput if o.var}
    found |= {"vertex_buffer": None, "index_buffer": None}
    found |= {a.name: None for a in pass_.rtVertexAttributes if a.name}
    found |= {f"tex{unit}": None for unit in range(TEXTURE_UNITS)}
    for node in [*pass_.rtGlobalParams, *pass_.rtMaterialParams]:
        if node.name:
            found[node.name] = value_bytes(project, node)
    return found


def value_bytes(project: Project, node: RayVariable) -> int | None:
    """Return the bytes of a parameter's value; None for an unknown attribute."""
    if node.component == "ID" and node.type in ("TEXTURE", "BUFFER"):
        return 8
    set_ = project.registry.get(node.type or "")
    attribute = set_.get(node.component or "") if set_ is not None else None
    return 4 * attribute.type.components if attribute is not None else None


def find_named_variables(module: PtxModule, proc: str) -> dict[str, DeclaredVariable]:
    """Return the variables that a program's own instructions name, by name and in their order.

    Empty for a program that the module lacks, and for a faulty module: ``check_modules`` reports
    both.
    """
    try:
        names = declared_variables(module)
    except PtxError:
        return {}
    function = find_function(module, proc)
    found: dict[str, DeclaredVariable] = {}
    for instruction in (function.body if function is not None else None) or []:
        for operand in instruction.operands:
            found |= {w: names[w] for w in _WORD.findall(operand) if w in names}
    return found


def check_variables(
    project: Project,
    pass_: RaytracePass,
    modules: Modules,
) -> Iterator[Diagnostic]:
    """Yield variables that nothing sets (T017), or that have another size (T018)."""
    known = list_given(project, pass_)
    seen: set[str] = set()
    for program, *_ in used_programs(pass_):
        module = modules.get(program_path(project.folder, program.file))
        if not isinstance(module, PtxModule):
            continue
        for name, variable in find_named_variables(module, program.proc or "").items():
            if name not in seen and not variable.semantic:
                yield from _check_variable(pass_, program, name, variable, known)
            seen.add(name)


def _check_variable(
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
            f"{label}: its variable '{name}' has {variable.size} bytes, the value of the pass "
            f"has {size}; the rest is {'0' if size < variable.size else 'ignored'}",
        )
