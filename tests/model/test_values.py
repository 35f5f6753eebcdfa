"""Nau's conversions (docs/format.md, 1.3 and 1.4)."""

from __future__ import annotations

import pytest

from nau_py.model.values import (
    DataType,
    Unconvertible,
    format_scalar,
    has_trailing_text,
    to_bool,
    to_float,
    to_int,
    to_scalar,
)


@pytest.mark.parametrize(
    "text, value", [("1.5", 1), ("256,", 256), (" 12", 12), ("-3x", -3), ("+7", 7)]
)
def test_int_takes_the_longest_prefix(text: str, value: int) -> None:
    assert to_int(text) == value


@pytest.mark.parametrize(
    "text, value", [("102.55.0", 102.55), ("1e3", 1000.0), (".5", 0.5), ("2.f", 2.0), ("-0", 0.0)]
)
def test_float_takes_the_longest_prefix(text: str, value: float) -> None:
    assert to_float(text) == value


@pytest.mark.parametrize(
    "text, value",
    [("TRUE", True), ("yes", True), ("1", True), ("10", True), ("0.5", False), ("No", False)],
)
def test_bool_is_a_prefix_test(text: str, value: bool) -> None:
    assert to_bool(text) is value


@pytest.mark.parametrize("convert, text", [(to_int, "wide"), (to_float, "-"), (to_bool, "on")])
def test_text_without_a_prefix_is_refused(convert: object, text: str) -> None:
    with pytest.raises(Unconvertible):
        convert(text)  # type: ignore[operator]


def test_a_name_stands_for_a_constant() -> None:
    assert to_scalar("SM_size", DataType.UINT) == "SM_size"
    with pytest.raises(Unconvertible):
        to_scalar("!", DataType.FLOAT)


@pytest.mark.parametrize(
    "text, data_type, trailing",
    [
        ("256,", DataType.UINT, True),
        ("1.0", DataType.INT, False),
        ("1.5", DataType.INT, True),
        ("102.55.0", DataType.FLOAT, True),
        ("0.5f", DataType.FLOAT, False),
        ("free text", DataType.STRING, False),
    ],
)
def test_trailing_text(text: str, data_type: DataType, trailing: bool) -> None:
    assert has_trailing_text(text, data_type) is trailing


@pytest.mark.parametrize("value", [1.0, 0.1, 1e-7, 123456789.0, True, -3, "name"])
def test_formatting_reads_back(value: object) -> None:
    kinds = {bool: DataType.BOOL, int: DataType.INT, float: DataType.FLOAT, str: DataType.STRING}
    text = format_scalar(value)  # type: ignore[arg-type]
    assert to_scalar(text, kinds[type(value)]) == value
