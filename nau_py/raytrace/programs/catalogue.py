"""The built-in ray programs (``file="builtin"``), found in the folder ``builtin`` and registered.

Importing this module adds their attributes to the materials of projects, and their kernels to the
tables of the engine. The order, and so the codes, are those of kinds and of file names.
"""

from __future__ import annotations

import pkgutil
from collections.abc import Callable
from importlib import import_module
from typing import Any

from nau_py.model.attribute import Attribute
from nau_py.model.attributes import declare_attributes
from nau_py.model.values import DataType
from nau_py.raytrace.kernels.core import tables
from nau_py.raytrace.kernels.core.kernel_tables import (
    ANY_HIT_KERNELS,
    CLOSEST_HIT_KERNELS,
    MISS_KERNELS,
    RAY_GENERATION_KERNELS,
    KernelTable,
)
from nau_py.raytrace.kernels.core.layout import Field
from nau_py.raytrace.programs import builtin
from nau_py.raytrace.programs.description import (
    ANY_HIT,
    CLOSEST_HIT,
    KINDS,
    MISS,
    RAY_GENERATION,
    BuiltInProgram,
)

KERNEL_TABLES: dict[str, KernelTable] = {
    RAY_GENERATION: RAY_GENERATION_KERNELS,
    CLOSEST_HIT: CLOSEST_HIT_KERNELS,
    ANY_HIT: ANY_HIT_KERNELS,
    MISS: MISS_KERNELS,
}


def _find_programs() -> dict[str, BuiltInProgram]:
    """Import the files of built-in programs; return name to program."""
    names = sorted(module.name for module in pkgutil.iter_modules(builtin.__path__))
    found: list[BuiltInProgram] = [
        import_module(f"{builtin.__name__}.{name}").PROGRAM for name in names
    ]
    return {program.name: program for kind in KINDS for program in found if program.kind == kind}


def _field_of(attribute: Attribute) -> Field:
    """Return the field of MATERIAL for an attribute."""
    name = attribute.name.lower()
    if attribute.type is DataType.INT:
        return name, "i4"
    return (name, "f4", 3) if len(attribute.default) > 1 else (name, "f4")


def _register(program: BuiltInProgram) -> None:
    """Add attributes, material fields, tables and kernel of a program to those of its kind."""
    declare_attributes("COLOR", program.attributes)
    for attribute in program.attributes:
        tables.MATERIAL.add(_field_of(attribute))
    for name in program.tables:
        tables.add_array(name, "f8")
    codes = CODES.setdefault(program.kind, {})
    if program.kernel is not None:
        codes[program.name] = KERNEL_TABLES[program.kind].add(program.kernel, program.partial)


CODES: dict[str, dict[str, int]] = {}
"""Code by kind and name of the compiled programs."""
BUILTIN_PROGRAMS = _find_programs()
"""The built-in programs by name, kind by kind."""
for _program in BUILTIN_PROGRAMS.values():
    _register(_program)

FUNCTIONS: dict[str, dict[str, Callable[[Any], Any]]] = {
    kind: {p.name: p.function for p in BUILTIN_PROGRAMS.values() if p.kind == kind and p.function}
    for kind in KINDS
}
"""Programs written in Python, by kind and name."""
EFFECT_ATTRIBUTES = tuple(
    dict.fromkeys(
        ["DIFFUSE", "EMISSION"]
        + [
            name
            for p in BUILTIN_PROGRAMS.values()
            if p.kind != RAY_GENERATION
            for effect in p.effects
            for name in effect.attributes
        ]
    )
)
"""Attributes of materials that decide which effects a scene calls for."""


def find_zeroed_attributes(effect: str) -> set[str]:
    """Return the attributes that are taken for 0 where an effect is left out."""
    return {
        name
        for program in BUILTIN_PROGRAMS.values()
        for e in program.effects
        if e.name == effect and e.zeroes_attributes
        for name in e.attributes
    }


def find_code_without_effects(kind: str, code: int) -> int:
    """Return the code of the program that runs if the effects of program ``code`` are left out."""
    codes = CODES[kind]
    name = next(name for name, known in codes.items() if known == code)
    return codes[BUILTIN_PROGRAMS[name].without_effects or name]
