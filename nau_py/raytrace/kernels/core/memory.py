"""Loads and stores by address.

Arrays that compiled functions hand on are reference-counted at every call, which costs more than
what is done with them. So kernels take one record a scene and one a tile, which hold addresses, and
read through these functions. Nothing here checks bounds: indices come from the engine's own tables.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.extending import intrinsic

_WORD = ir.IntType(64)
_LOADED = {
    "f": ir.FloatType(),
    "d": ir.DoubleType(),
    "i": ir.IntType(32),
    "b": ir.IntType(8),
    "q": _WORD,
}


def _pointer(builder: Any, address: Any, index: Any, size: int, type_: Any) -> Any:
    place = builder.add(address, builder.mul(index, ir.Constant(_WORD, size)))
    return builder.inttoptr(place, type_.as_pointer())


def _widen(builder: Any, value: Any, code: str) -> Any:
    if code == "f":
        return builder.fpext(value, ir.DoubleType())
    return builder.sext(value, _WORD) if code in "ib" else value


def _size(code: str) -> int:
    return {"f": 4, "d": 8, "i": 4, "b": 1, "q": 8}[code]


def make_loader(code: str) -> Callable[[Any, Any], Any]:
    """``f(address, index)``: entry ``index`` of an array of float32 ``f``, float64 ``d``, int32
    ``i``, int8 ``b`` or int64 ``q``, as float64 or int64."""
    result = types.float64 if code in "fd" else types.int64

    @intrinsic  # type: ignore[untyped-decorator, unused-ignore]
    def load(context: Any, address: Any, index: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            pointer = _pointer(builder, args[0], args[1], _size(code), _LOADED[code])
            return _widen(builder, builder.load(pointer), code)

        return result(types.uint64, types.int64), generate

    return cast(Callable[[Any, Any], Any], load)


def make_storer(code: str) -> Callable[[Any, Any, Any], None]:
    """``f(address, index, value)``: the reverse of ``make_loader``, for ``f``, ``i`` and ``q``."""
    argument = types.float64 if code == "f" else types.int64

    @intrinsic  # type: ignore[untyped-decorator, unused-ignore]
    def store(context: Any, address: Any, index: Any, value: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            pointer = _pointer(builder, args[0], args[1], _size(code), _LOADED[code])
            value = args[2]
            if code == "f":
                value = builder.fptrunc(value, _LOADED[code])
            elif code == "i":
                value = builder.trunc(value, _LOADED[code])
            builder.store(value, pointer)
            return context.get_dummy_value()

        return types.void(types.uint64, types.int64, argument), generate

    return cast(Callable[[Any, Any, Any], None], store)


def record_reader(dtype: np.dtype[Any]) -> Callable[[Any, Any], Any]:
    """``f(address, index)``: a record of an array, by reference."""
    record = numba.from_dtype(dtype)

    @intrinsic  # type: ignore[untyped-decorator, unused-ignore]
    def at(context: Any, address: Any, index: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            size = ir.Constant(_WORD, dtype.itemsize)
            place = builder.add(args[0], builder.mul(args[1], size))
            return builder.inttoptr(place, context.get_value_type(record))

        return record(types.uint64, types.int64), generate

    return cast(Callable[[Any, Any], Any], at)


def record_copier(dtype: np.dtype[Any]) -> Callable[[Any, Any], None]:
    """``f(to, from)``: one record over another."""
    record = numba.from_dtype(dtype)

    @intrinsic  # type: ignore[untyped-decorator, unused-ignore]
    def assign(context: Any, to: Any, source: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            size = ir.Constant(_WORD, dtype.itemsize)
            cgutils.raw_memcpy(builder, args[0], args[1], size, 1, align=4)
            return context.get_dummy_value()

        return types.void(record, record), generate

    return cast(Callable[[Any, Any], None], assign)


def _field(dtype: np.dtype[Any], name: str) -> tuple[str, int, int]:
    """Code, count and offset of a field."""
    fields = dtype.fields
    assert fields is not None
    inner, offset = fields[name][0], fields[name][1]
    base, shape = inner.subdtype or (inner, (1,))
    code = {"f4": "f", "f8": "d", "i4": "i"}[base.str[1:]]
    return code, int(np.prod(shape)), int(offset)


def field_reader(dtype: np.dtype[Any], name: str) -> Callable[[Any], Any]:
    """``f(record)``: an array field as a tuple of float64 or int64."""
    record = numba.from_dtype(dtype)
    code, count, offset = _field(dtype, name)
    item = types.float64 if code in "fd" else types.int64

    @intrinsic  # type: ignore[untyped-decorator, unused-ignore]
    def get(context: Any, value: Any) -> Any:
        result = types.UniTuple(item, count)

        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            base = builder.ptrtoint(args[0], _WORD)
            start = builder.add(base, ir.Constant(_WORD, offset))
            values = [
                _widen(
                    builder,
                    builder.load(
                        _pointer(builder, start, ir.Constant(_WORD, k), _size(code), _LOADED[code])
                    ),
                    code,
                )
                for k in range(count)
            ]
            return context.make_tuple(builder, result, values)

        return result(record), generate

    return cast(Callable[[Any], Any], get)


def field_writer(dtype: np.dtype[Any], name: str) -> Callable[[Any, Any], None]:
    """``f(record, values)``: store a tuple into an array field of float32 or int32."""
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
                pointer = _pointer(
                    builder, start, ir.Constant(_WORD, k), _size(code), _LOADED[code]
                )
                wide = builder.extract_value(args[1], k)
                builder.store(narrow(wide, _LOADED[code]), pointer)
            return context.get_dummy_value()

        return types.void(record, types.UniTuple(item, count)), generate

    return cast(Callable[[Any, Any], None], put)


f32, f64, i32, i8, i64 = (make_loader(code) for code in "fdibq")
put_f32, put_i32, put_i64 = (make_storer(code) for code in "fiq")
