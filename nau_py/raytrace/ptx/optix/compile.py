"""Compile PTX modules that call OptiX of any version to LLVM's text."""

from __future__ import annotations

from functools import partial

from nau_py.raytrace.ptx.compiler.frame_access import offset_pointer, read_pointer
from nau_py.raytrace.ptx.compiler.module import PtxError, PtxModule
from nau_py.raytrace.ptx.compiler.translate import CallHandler, translate_module
from nau_py.raytrace.ptx.compiler.writer import FRAME, FunctionWriter
from nau_py.raytrace.ptx.optix import optix6, optix7
from nau_py.raytrace.ptx.optix.variables import VariableLayout

PARAMETERS = "optixLaunchParams"
"""Name of the variable that the host fills before a launch."""
_INTERFACES = (
    CallHandler(optix7.handles_call, optix7.write_call),
    CallHandler(optix6.handles_call, optix6.write_call),
)


def compile_module(module: PtxModule) -> str:
    """Return LLVM's text of a module. Raises :class:`PtxError` with the line of the first error."""
    found, errors = compile_all(module)
    if errors:
        raise errors[0]
    return found


def compile_all(
    module: PtxModule, layout: VariableLayout | None = None
) -> tuple[str, list[PtxError]]:
    """Return LLVM's text of all functions that can be compiled, and the errors of the others.

    ``layout``: offsets of the variables of OptiX 6 in the records of a pass; the default has the
    variables of this module alone.
    """
    try:
        if layout is None:
            layout = VariableLayout()
            layout.add_module(module)
        bindings = layout.bindings(module)
    except PtxError as error:
        return "", [error]
    return translate_module(module, set(bindings), partial(_bound_pointer, bindings), _INTERFACES)


def _bound_pointer(
    bindings: dict[str, tuple[str, int]], w: FunctionWriter, name: str
) -> str | None:
    """Return the address of a variable of OptiX 6; None for another name."""
    if name not in bindings:
        return None
    base, offset = bindings[name]
    return offset_pointer(w, FRAME if base == "frame" else read_pointer(w, base), offset)
