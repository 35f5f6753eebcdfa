"""Machine code of LLVM's text, compiled in this process and kept in the cache folder."""

from __future__ import annotations

import contextlib
import ctypes
import hashlib
import platform
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm

from nau_py.process.files import write_bytes
from nau_py.raytrace.kernels.core.machine_code import cache_folder
from nau_py.raytrace.ptx.runtime.layout import fill_in
from nau_py.raytrace.tracing.accelerator import load_embree


class NativeError(Exception):
    """LLVM rejects a text."""


_DIGEST = 32
"""Bytes of the checksum in front of a cached file."""
_RUNTIME = files("nau_py.raytrace.ptx.runtime") / "runtime.ll"


@lru_cache(maxsize=1)
def _processor() -> Any:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.Target.from_default_triple()


def _make_target() -> Any:
    """Return a new target machine. The engine that uses it owns it."""
    target = _processor()
    return target.create_target_machine(
        opt=2, cpu=llvm.get_host_cpu_name(), features=llvm.get_host_cpu_features().flatten()
    )


class NativeModule:
    """Machine code of one module, freed with this object.

    Raises :class:`NativeError` where LLVM rejects the text.
    """

    def __init__(self, text: str) -> None:
        load_embree()
        machine = _make_target()
        try:
            module = llvm.parse_assembly(text)
            module.link_in(llvm.parse_assembly(_runtime_text()))
        except RuntimeError as problem:
            raise NativeError(str(problem).strip().splitlines()[0]) from None
        module.triple, module.data_layout = machine.triple, str(machine.target_data)
        place = _cache_path(text)
        known = _read_code(place)
        if known is None:
            tuning = llvm.create_pipeline_tuning_options(speed_level=2)
            builder = llvm.create_pass_builder(machine, tuning)
            builder.getModulePassManager().run(module, builder)
        self._engine = llvm.create_mcjit_compiler(module, machine)
        self._engine.set_object_cache(
            lambda _, code: _write_code(place, bytes(code)), lambda _: known
        )
        self._engine.finalize_object()

    def address(self, name: str) -> int:
        """Return the address of a function; 0 for an unknown name."""
        return int(self._engine.get_function_address(name))

    def set_variable(self, name: str, data: bytes) -> None:
        """Write a variable of the module; do nothing for an unknown name."""
        place = int(self._engine.get_global_value_address(name))
        if place:
            ctypes.memmove(place, data, len(data))


@lru_cache(maxsize=1)
def _runtime_text() -> str:
    """Return the runtime that programs call, without lines for other processors.

    Only x86 has the register ``mxcsr``, which makes denormals zero.
    """
    text = fill_in(_RUNTIME.read_text("utf-8"))
    if platform.machine().lower() in ("x86_64", "amd64"):
        return text
    return "\n".join(line for line in text.splitlines() if "mxcsr" not in line)


def _cache_path(text: str) -> Path | None:
    """Return the file for the machine code of a text; None without a cache folder."""
    folder = cache_folder()
    if not folder:
        return None
    about = (text, _runtime_text(), str(llvm.llvm_version_info), llvm.get_host_cpu_name())
    digest = hashlib.sha256("\0".join(about).encode()).hexdigest()
    return Path(folder) / f"ptx-{digest[:32]}.o"


def _read_code(place: Path | None) -> bytes | None:
    """Return cached code if its checksum is right. LLVM does not check it."""
    try:
        data = place.read_bytes() if place is not None else b""
    except OSError:
        return None
    code = data[_DIGEST:]
    return code if code and hashlib.sha256(code).digest() == data[:_DIGEST] else None


def _write_code(place: Path | None, code: bytes) -> None:
    if place is not None:
        with contextlib.suppress(OSError):  # the next process compiles it again
            write_bytes(place, hashlib.sha256(code).digest() + code)
