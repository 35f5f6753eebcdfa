"""Loads and stores by address.

Arrays that compiled functions pass on are reference-counted at every call, which costs more than
the work on them. So kernels take one record of a scene and one of a tile, which hold addresses, and
read through these functions. Nothing here checks bounds: indices come from the engine's own tables.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

from nau_py.raytrace.kernels.core.jit import Deferred
from nau_py.raytrace.kernels.core.layout import Record

Load = Callable[[Any, Any], Any]
Store = Callable[[Any, Any, Any], None]


def make_loader(code: str) -> Load:
    """Return ``f(address, index)``: entry ``index`` of an array of float32 ``f``, float64 ``d``,
    int32 ``i``, int8 ``b`` or int64 ``q``, as float64 or int64."""
    return cast(Load, Deferred("make_loader", code))


def make_storer(code: str) -> Store:
    """Return ``f(address, index, value)``: the reverse of a loader, for ``f``, ``i`` and ``q``."""
    return cast(Store, Deferred("make_storer", code))


def record_reader(record: Record) -> Load:
    """Return ``f(address, index)``: a record of an array, by reference."""
    return cast(Load, Deferred("make_record_reader", record))


def record_copier(record: Record) -> Callable[[Any, Any], None]:
    """Return ``f(to, from)``, which writes one record over another."""
    return cast(Callable[[Any, Any], None], Deferred("make_record_copier", record))


def field_reader(record: Record, name: str) -> Callable[[Any], Any]:
    """Return ``f(record)``: an array field as a tuple of float64 or int64."""
    return cast(Callable[[Any], Any], Deferred("make_field_reader", record, name))


def field_writer(record: Record, name: str) -> Callable[[Any, Any], None]:
    """Return ``f(record, values)``: store a tuple in an array field of float32 or int32."""
    return cast(Callable[[Any, Any], None], Deferred("make_field_writer", record, name))


f32, f64, i32, i8, i64 = (make_loader(code) for code in "fdibq")
put_f32, put_i32, put_i64 = (make_storer(code) for code in "fiq")
