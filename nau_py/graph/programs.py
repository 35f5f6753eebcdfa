"""Ray programs that a raytrace pass binds, for pictures and exports."""

from __future__ import annotations

from nau_py.model.passes import Pass
from nau_py.model.raytrace import RaytracePass


def list_programs(pass_: Pass) -> list[dict[str, str]]:
    """List the programs of a raytrace pass: kind, file, procedure, and material and ray type.

    The list of a pass of another class is empty.
    """
    if not isinstance(pass_, RaytracePass):
        return []
    found = []
    entry = pass_.rtEntryPoint
    for kind, node in (
        ("ray generation", entry.rayGen if entry else None),
        ("exception", entry.exception if entry else None),
    ):
        if node is not None:
            found.append({"kind": kind, "file": node.file or "", "proc": node.proc or ""})
    for material in pass_.materials:
        for group in material.rayTypes:
            found += [
                {
                    "kind": (program.type or "").lower().replace("_", " "),
                    "material": material.to or "default",
                    "ray": group.name or "",
                    "file": program.file or "",
                    "proc": program.proc or "",
                }
                for program in group.programs
            ]
    for geometry in pass_.rtGeometryProgram:
        kind = (geometry.type or "").lower().replace("_", " ")
        found.append({"kind": kind, "file": geometry.file or "", "proc": geometry.proc or ""})
    return found
