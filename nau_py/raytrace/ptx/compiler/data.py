"""Variables of a module outside of functions, as global variables of LLVM."""

from __future__ import annotations

import re

from nau_py.raytrace.ptx.compiler.literals import WHOLE_NUMBER, parse_integer
from nau_py.raytrace.ptx.compiler.module import SIZES, PtxError, PtxVariable

_HEX_FLOAT = re.compile(r"0[fFdD]([0-9a-fA-F]{8}|[0-9a-fA-F]{16})$")
_SYMBOL = re.compile(r"(?:generic\()?([A-Za-z_$%][\w$]*)\)?(?:\s*\+\s*(\d+))?$")
InitialValue = int | tuple[str, int]
"""A number, or a name and the offset from its address."""


def _read_values(variable: PtxVariable) -> list[InitialValue]:
    """Read the values of an initialiser, one per element. Raises :class:`PtxError`."""
    found: list[InitialValue] = []
    for word in variable.value.replace("{", " ").replace("}", " ").split(","):
        text = word.strip()
        if not text:
            continue
        bits, whole = _HEX_FLOAT.match(text), WHOLE_NUMBER.match(text)
        symbol = _SYMBOL.match(text)
        if bits:
            found.append(int(bits[1], 16))
        elif whole:
            found.append(parse_integer(text))
        elif symbol and SIZES[variable.type] == 8:
            found.append((symbol[1], int(symbol[2] or 0)))
        else:
            said = (
                f"'{variable.name}' has a value that is neither a number nor an address: '{text}'"
            )
            raise PtxError(variable.line, said)
    return found


def initial_bytes(variable: PtxVariable) -> bytes | None:
    """Return the initial bytes of a variable, addresses as 0; None without an initialiser."""
    if not variable.value:
        return None
    width = SIZES[variable.type]
    values = (part if isinstance(part, int) else 0 for part in _read_values(variable))
    return b"".join((value % (1 << 8 * width)).to_bytes(width, "little") for value in values)


def global_text(variable: PtxVariable, known: dict[str, str]) -> str:
    """Write the definition of a variable.

    ``known``: LLVM's names of the variables and functions of the module. Raises
    :class:`PtxError` for an address of another name.
    """
    size = max(variable.size, 1)
    head = f'@"{variable.name}" = global'
    align = f"align {max(variable.align, 16)}"
    parts = _read_values(variable)
    if any(isinstance(part, tuple) for part in parts):
        count = max(size // 8, len(parts))
        words = [
            _address_text(variable, part, known) for part in [*parts, *[0] * (count - len(parts))]
        ]
        return f"{head} [{count} x i64] [{', '.join(words)}], {align}"
    data = initial_bytes(variable)
    text = "zeroinitializer"
    if data is not None:
        filled = (data + bytes(size))[:size]
        text = "[" + ", ".join(f"i8 {byte}" for byte in filled) + "]"
    return f"{head} [{size} x i8] {text}, {align}"


def _address_text(variable: PtxVariable, part: InitialValue, known: dict[str, str]) -> str:
    if isinstance(part, int):
        return f"i64 {part % (1 << 64)}"
    name, more = part
    if name not in known:
        raise PtxError(variable.line, f"'{variable.name}' names '{name}', which is not declared")
    place = f"getelementptr (i8, ptr {known[name]}, i64 {more})"
    return f"i64 ptrtoint (ptr {place} to i64)"
