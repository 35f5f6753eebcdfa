"""The part of the kernels that uses numba: compilation, and functions of machine instructions.

Imported by ``jit`` at the first compilation, as numba takes a third of a second to load.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba import cfunc, njit, types
from numba.core import cgutils
from numba.core.datamodel import models
from numba.core.dispatcher import Dispatcher
from numba.core.extending import intrinsic, register_model
from numba.core.imputils import lower_constant
from numba.core.registry import cpu_target

from nau_py.raytrace.kernels.core.jit import COUNTS_CYCLES
from nau_py.raytrace.kernels.core.layout import Record, dtype_of
from nau_py.raytrace.kernels.core.machine_code import cache_folder

_WORD = ir.IntType(64)
_LOADED = {
    "f": ir.FloatType(),
    "d": ir.DoubleType(),
    "i": ir.IntType(32),
    "b": ir.IntType(8),
    "q": _WORD,
}
_SIZE = {"f": 4, "d": 8, "i": 4, "b": 1, "q": 8}
_CALLBACKS: list[Any] = []
"""Compiled callbacks: their code lives as long as they do."""


@contextmanager
def _cached() -> Iterator[bool]:
    """Set numba's cache folder; yield whether there is one."""
    folder = cache_folder()
    before, numba.config.CACHE_DIR = numba.config.CACHE_DIR, folder
    try:
        yield bool(folder)
    finally:
        numba.config.CACHE_DIR = before


def compile_kernel(function: Callable[..., Any]) -> Any:
    """Return a dispatcher whose machine code is kept on disk."""
    with _cached() as cache:
        return njit(nogil=True, cache=cache, error_model="numpy", fastmath=False)(function)


def compile_inner(link: Callable[[], Callable[..., Any]], inline: bool) -> Any:
    """Return a dispatcher of the function that ``link`` makes, without wrappers for Python.

    ``inline``: LLVM inlines every call.
    """
    return njit(
        nogil=True,
        error_model="numpy",
        fastmath=False,
        no_cpython_wrapper=True,
        no_cfunc_wrapper=True,
        forceinline=inline,
    )(link())


def compile_callback(function: Callable[..., None], signature: str) -> int:
    """Compile a function for C, with numba's ``signature``; return the address of its code."""
    with _cached() as cache:
        made = cfunc(signature, cache=cache, error_model="numpy")(function)
    _CALLBACKS.append(made)
    return int(made.address)


def find_external(name: str, arguments: int) -> Any:
    """Return the C function ``name``, which takes this number of addresses."""
    return types.ExternalFunction(name, types.void(*[types.uintp] * arguments))


class KernelFunction(types.Dispatcher):  # type: ignore[misc, unused-ignore]
    """Type of a compiled function that is passed to another one. Calls are resolved by the type.

    Numba's own type carries the address of the dispatcher, and code with an address of this process
    cannot be kept on disk.
    """


register_model(KernelFunction)(models.OpaqueModel)


@lower_constant(KernelFunction)  # type: ignore[untyped-decorator, unused-ignore]
def _lower_function(context: Any, builder: Any, type_: Any, value: Any) -> Any:
    return context.get_dummy_value()


def type_of(compiled: Any) -> Any:
    """Return numba's type of a dispatcher, an intrinsic or an external function."""
    if isinstance(compiled, Dispatcher):
        return KernelFunction(compiled)
    context = cpu_target.typing_context
    context.refresh()  # intrinsics that were made during this compilation
    return context.resolve_value_type(compiled)


def make_cycle_counter() -> Any:
    """Return the intrinsic that reads the processor's cycle counter."""

    @intrinsic  # type: ignore[untyped-decorator, unused-ignore]
    def cycles(context: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            if not COUNTS_CYCLES:
                return ir.Constant(_WORD, 0)
            counter = ir.FunctionType(_WORD, [])
            return builder.call(
                builder.module.declare_intrinsic("llvm.readcyclecounter", (), counter), []
            )

        return types.int64(), generate

    return cycles


def _pointer(builder: Any, address: Any, index: Any, size: int, type_: Any) -> Any:
    place = builder.add(address, builder.mul(index, ir.Constant(_WORD, size)))
    return builder.inttoptr(place, type_.as_pointer())


def _widen(builder: Any, value: Any, code: str) -> Any:
    if code == "f":
        return builder.fpext(value, ir.DoubleType())
    return builder.sext(value, _WORD) if code in "ib" else value


def make_loader(code: str) -> Any:
    """Return the intrinsic of :func:`memory.make_loader`."""
    result = types.float64 if code in "fd" else types.int64

    @intrinsic  # type: ignore[untyped-decorator, unused-ignore]
    def load(context: Any, address: Any, index: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            pointer = _pointer(builder, args[0], args[1], _SIZE[code], _LOADED[code])
            return _widen(builder, builder.load(pointer), code)

        return result(types.uint64, types.int64), generate

    return load


def make_storer(code: str) -> Any:
    """Return the intrinsic of :func:`memory.make_storer`."""
    argument = types.float64 if code == "f" else types.int64

    @intrinsic  # type: ignore[untyped-decorator, unused-ignore]
    def store(context: Any, address: Any, index: Any, value: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            pointer = _pointer(builder, args[0], args[1], _SIZE[code], _LOADED[code])
            value = args[2]
            if code == "f":
                value = builder.fptrunc(value, _LOADED[code])
            elif code == "i":
                value = builder.trunc(value, _LOADED[code])
            builder.store(value, pointer)
            return context.get_dummy_value()

        return types.void(types.uint64, types.int64, argument), generate

    return store


def make_record_reader(shape: Record) -> Any:
    """Return the intrinsic of :func:`memory.record_reader`."""
    dtype = dtype_of(shape)
    record = numba.from_dtype(dtype)

    @intrinsic  # type: ignore[untyped-decorator, unused-ignore]
    def at(context: Any, address: Any, index: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            size = ir.Constant(_WORD, dtype.itemsize)
            place = builder.add(args[0], builder.mul(args[1], size))
            return builder.inttoptr(place, context.get_value_type(record))

        return record(types.uint64, types.int64), generate

    return at


def make_record_copier(shape: Record) -> Any:
    """Return the intrinsic of :func:`memory.record_copier`."""
    dtype = dtype_of(shape)
    record = numba.from_dtype(dtype)

    @intrinsic  # type: ignore[untyped-decorator, unused-ignore]
    def assign(context: Any, to: Any, source: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            size = ir.Constant(_WORD, dtype.itemsize)
            cgutils.raw_memcpy(builder, args[0], args[1], size, 1, align=4)
            return context.get_dummy_value()

        return types.void(record, record), generate

    return assign


def _field(dtype: np.dtype[Any], name: str) -> tuple[str, int, int]:
    """Return code, count and offset of a field."""
    fields = dtype.fields
    assert fields is not None
    inner, offset = fields[name][0], fields[name][1]
    base, shape = inner.subdtype or (inner, (1,))
    code = {"f4": "f", "f8": "d", "i4": "i"}[base.str[1:]]
    return code, int(np.prod(shape)), int(offset)


def make_field_reader(shape: Record, name: str) -> Any:
    """Return the intrinsic of :func:`memory.field_reader`."""
    dtype = dtype_of(shape)
    record = numba.from_dtype(dtype)
    code, count, offset = _field(dtype, name)
    item = types.float64 if code in "fd" else types.int64

    @intrinsic  # type: ignore[untyped-decorator, unused-ignore]
    def get(context: Any, value: Any) -> Any:
        result = types.UniTuple(item, count)

        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            base = builder.ptrtoint(args[0], _WORD)
            start = builder.add(base, ir.Constant(_WORD, offset))
            values = []
            for k in range(count):
                step = ir.Constant(_WORD, k)
                pointer = _pointer(builder, start, step, _SIZE[code], _LOADED[code])
                values.append(_widen(builder, builder.load(pointer), code))
            return context.make_tuple(builder, result, values)

        return result(record), generate

    return get


def make_field_writer(shape: Record, name: str) -> Any:
    """Return the intrinsic of :func:`memory.field_writer`."""
    dtype = dtype_of(shape)
    record = numba.from_dtype(dtype)
    code, count, offset = _field(dtype, name)
    item = types.float64 if code == "f" else types.int64

    @intrinsic  # type: ignore[untyped-decorator, unused-ignore]
    def put(context: Any, value: Any, values: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            base = builder.ptrtoint(args[0], _WORD)
            start = builder.add(base, ir.Constant(_WORD, offset))
            narrow = builder.fptrunc if code == "f" else builder.trunc
            for k in range(count):
                step = ir.Constant(_WORD, k)
                pointer = _pointer(builder, start, step, _SIZE[code], _LOADED[code])
                builder.store(narrow(builder.extract_value(args[1], k), _LOADED[code]), pointer)
            return context.get_dummy_value()

        return types.void(record, types.UniTuple(item, count)), generate

    return put
