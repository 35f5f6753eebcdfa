"""Variables of OptiX 3 to 6 programs: declarations in a module, and their offsets in records.

OptiX looks a variable up by its name in the scope that the program runs for: the geometry of a
material (closest hit, any hit, intersection) or the context (ray generation, miss, exception). Here
both scopes are *records* of one layout, so a variable is an offset in the frame's record. Names,
sizes and semantics are those that ``rtDeclareVariable`` leaves in a module (``optix_device.h``).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from nau_py.raytrace.ptx.compiler.data import initial_bytes
from nau_py.raytrace.ptx.compiler.module import PtxModule, PtxVariable
from nau_py.raytrace.ptx.compiler.reader import split_call
from nau_py.raytrace.ptx.runtime.layout import FRAME_FIELDS, LAUNCH_FIELDS

PLAIN, BUFFER, TEXTURE = "variable", "buffer", "texture"
BUFFER_BYTES = 40
"""Bytes of a buffer's variable: address, width, height, depth (64 bits each), bytes per element."""
_INTERNAL = re.compile(r"_ZN\d+rti_internal_(typeinfo|semantic)(\d+)(\w+)E$")
_SEMANTICS = {
    "rtCurrentRay": ("frame", FRAME_FIELDS["origin_x"][0]),
    "rtLaunchIndex": ("frame", FRAME_FIELDS["index_x"][0]),
    "rtLaunchDim": ("launch", LAUNCH_FIELDS["width"][0]),
    "rtPayload": ("payload", 0),
    "rtIntersectionDistance": ("frame", FRAME_FIELDS["tmax"][0]),
}
"""Base and offset of each semantic."""
_ATTRIBUTE = "attribute "


@dataclass(frozen=True, slots=True)
class DeclaredVariable:
    """A variable of a program. ``semantic`` is empty where the variable is bound by its name."""

    kind: str
    size: int
    semantic: str = ""


def declared_variables(module: PtxModule) -> dict[str, DeclaredVariable]:
    """Return the variables of a module by name; none for a module of OptiX 7.

    Raises :class:`PtxError` where an initial value cannot be read.
    """
    if not uses_variables(module):
        return {}
    facts: dict[str, dict[str, bytes]] = {}
    for variable in module.variables:
        found = _INTERNAL.match(variable.name)
        if found is not None:
            name = found[3][: int(found[2])]
            facts.setdefault(name, {})[found[1]] = initial_bytes(variable) or b""
    return {
        v.name: made
        for v in module.variables
        if (made := _declared_variable(v, facts.get(v.name))) is not None
    }


def _declared_variable(
    variable: PtxVariable, facts: dict[str, bytes] | None
) -> DeclaredVariable | None:
    if facts is not None:
        size = int.from_bytes(facts.get("typeinfo", b"")[4:8], "little") or variable.size
        semantic = facts.get("semantic", b"").split(b"\0")[0].decode("latin-1")
        return DeclaredVariable(PLAIN, size, semantic)
    if variable.type == "texref":
        return DeclaredVariable(TEXTURE, 8)
    if variable.type == "b8" and variable.length == 1 and not variable.value:
        inner = variable.name.startswith("_ZN") and "rti_internal" in variable.name
        return None if inner else DeclaredVariable(BUFFER, BUFFER_BYTES)
    return None


def uses_variables(module: PtxModule) -> bool:
    """Return True if a module is of OptiX 3 to 6, which bind variables by name."""
    named = any(_INTERNAL.match(variable.name) for variable in module.variables)
    return named or calls_interface(module, "_rt_")


def calls_interface(module: PtxModule, prefix: str) -> bool:
    """Return True if a module calls any function whose name begins with ``prefix``."""
    return any(
        split_call(instruction.operands)[1].startswith(prefix)
        for function in module.functions.values()
        for instruction in function.body or []
        if instruction.opcode.startswith("call")
    )


@dataclass(slots=True)
class VariableLayout:
    """Offsets of the variables of all modules of a pass, by name.

    ``offsets`` are in a record, ``attributes`` in the attributes that intersection programs give.
    """

    variables: dict[str, DeclaredVariable] = field(default_factory=dict)
    offsets: dict[str, int] = field(default_factory=dict)
    attributes: dict[str, int] = field(default_factory=dict)
    sizes: dict[str, int] = field(default_factory=dict)
    """Bytes of each attribute."""
    record_bytes: int = 0
    attribute_bytes: int = 0

    def add_module(self, module: PtxModule) -> list[str]:
        """Place a module's variables. Returns messages on those that differ from earlier ones."""
        wrong = []
        for name, variable in declared_variables(module).items():
            if variable.semantic in _SEMANTICS:
                continue
            if variable.semantic.startswith(_ATTRIBUTE):
                attribute = variable.semantic.removeprefix(_ATTRIBUTE)
                if self.sizes.setdefault(attribute, variable.size) != variable.size:
                    wrong.append(
                        f"attribute '{attribute}' has {variable.size} bytes, elsewhere in the pass "
                        f"{self.sizes[attribute]}"
                    )
                elif attribute not in self.attributes:
                    self.attributes[attribute] = self.attribute_bytes
                    self.attribute_bytes += -(-variable.size // 16) * 16
                continue
            other = self.variables.setdefault(name, variable)
            if other != variable:
                wrong.append(
                    f"'{name}' is a {variable.kind} of {variable.size} bytes, in another "
                    f"file of the pass a {other.kind} of {other.size} bytes"
                )
            elif name not in self.offsets:
                self.offsets[name] = self.record_bytes
                self.record_bytes += -(-variable.size // 16) * 16
        return wrong

    def bindings(self, module: PtxModule) -> dict[str, tuple[str, int]]:
        """Return the base and offset of each variable of a module, by name."""
        found = {}
        for name, variable in declared_variables(module).items():
            if variable.semantic in _SEMANTICS:
                found[name] = _SEMANTICS[variable.semantic]
            elif variable.semantic.startswith(_ATTRIBUTE):
                at = self.attributes[variable.semantic.removeprefix(_ATTRIBUTE)]
                found[name] = ("attributes", at)
            else:
                found[name] = ("record", self.offsets[name])
        return found
