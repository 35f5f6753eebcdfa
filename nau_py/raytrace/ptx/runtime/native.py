"""LLVM's text to machine code, in this process."""

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
    """LLVM does not take a text."""


_DIGEST = 32
RUNTIME = files("nau_py.raytrace.ptx.runtime") / "runtime.ll"


@lru_cache(maxsize=1)
def _processor() -> Any:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.Target.from_default_triple()


def _target() -> Any:
    """A new one for every engine, which owns it."""
    target = _processor()
    return target.create_target_machine(
        opt=2, cpu=llvm.get_host_cpu_name(), features=llvm.get_host_cpu_features().flatten()
    )


class NativeModule:
    """Machine code of one module; lives as long as this object. Raises :class:`NativeError` where
    LLVM does not take the text."""

    def __init__(self, text: str) -> None:
        load_embree()
        machine = _target()
        try:
            module = llvm.parse_assembly(text)
            module.link_in(llvm.parse_assembly(_runtime()))
        except RuntimeError as problem:
            raise NativeError(str(problem).strip().splitlines()[0]) from None
        module.triple, module.data_layout = machine.triple, str(machine.target_data)
        place = _kept(text)
        known = _read(place)
        if known is None:
            tuning = llvm.create_pipeline_tuning_options(speed_level=2)
            builder = llvm.create_pass_builder(machine, tuning)
            builder.getModulePassManager().run(module, builder)
        self._engine = llvm.create_mcjit_compiler(module, machine)
        self._engine.set_object_cache(lambda _, code: _write(place, bytes(code)), lambda _: known)
        self._engine.finalize_object()

    def address(self, name: str) -> int:
        """The address of a function; 0 where there is none."""
        return int(self._engine.get_function_address(name))

    def set_variable(self, name: str, data: bytes) -> None:
        """Write a variable of the module, where it has one of that name."""
        place = int(self._engine.get_global_value_address(name))
        if place:
            ctypes.memmove(place, data, len(data))


@lru_cache(maxsize=1)
def _runtime() -> str:
    """What programs call. Only x86 has the register that makes denormals zero."""
    text = fill_in(RUNTIME.read_text("utf-8"))
    if platform.machine().lower() in ("x86_64", "amd64"):
        return text
    return "\n".join(line for line in text.splitlines() if "mxcsr" not in line)


def _kept(text: str) -> Path | None:
    """Where the machine code of a text is kept; None where nothing can be."""
    folder = cache_folder()
    if not folder:
        return None
    about = (text, _runtime(), str(llvm.llvm_version_info), llvm.get_host_cpu_name())
    digest = hashlib.sha256("\0".join(about).encode()).hexdigest()
    return Path(folder) / f"ptx-{digest[:32]}.o"


def _read(place: Path | None) -> bytes | None:
    """The code that was kept, if it is whole: LLVM trusts what it is given."""
    try:
        data = place.read_bytes() if place is not None else b""
    except OSError:
        return None
    code = data[_DIGEST:]
    return code if code and hashlib.sha256(code).digest() == data[:_DIGEST] else None


def _write(place: Path | None, code: bytes) -> None:
    if place is not None:
        with contextlib.suppress(OSError):  # it is compiled again next time
            write_bytes(place, hashlib.sha256(code).digest() + code)
