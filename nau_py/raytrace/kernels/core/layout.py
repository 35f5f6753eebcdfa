"""Layout of a record that kernels read: its fields, to which modules can add until it is used."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

Field = tuple[str, Any] | tuple[str, Any, int]
"""Name, dtype, and for an array its length, as numpy takes them."""


class RecordLayout:
    """The fields of a record. ``dtype`` fixes them."""

    def __init__(self, fields: Sequence[Field] = ()) -> None:
        self._fields: dict[str, Field] = {field[0]: field for field in fields}
        self._dtype: np.dtype[Any] | None = None

    @property
    def dtype(self) -> np.dtype[Any]:
        """Aligned dtype of numpy. No field can be added after its first use."""
        if self._dtype is None:
            self._dtype = np.dtype(list(self._fields.values()), align=True)
        return self._dtype

    def add(self, field: Field) -> None:
        """Add a field. One of this name and format may be there already.

        Raises RuntimeError once the layout is in use, ValueError for another format.
        """
        known = self._fields.get(field[0])
        if known == field:
            return
        if known is not None:
            raise ValueError(f"the field {field[0]} is {known[1:]} already, not {field[1:]}")
        if self._dtype is not None:
            raise RuntimeError(f"the field {field[0]} comes too late: the layout is in use")
        self._fields[field[0]] = field


Record = RecordLayout | np.dtype[Any]
"""A layout, or a dtype that nothing adds to."""


def dtype_of(record: Record | str) -> np.dtype[Any]:
    """Return the dtype of a record, or of a name of numpy; a layout is fixed by that."""
    return record.dtype if isinstance(record, RecordLayout) else np.dtype(record)
