"""Variables of a module outside of functions, as LLVM's globals."""

from __future__ import annotations

import re

from nau_py.raytrace.ptx.function import integer
from nau_py.raytrace.ptx.reader import SIZES, PtxError, Variable

_WORD = re.compile(r"-?0[xX][0-9a-fA-F]+|-?0[fFdD][0-9a-fA-F]+|-?\d+")


def initial_bytes(variable: Variable) -> bytes | None:
    """What a variable holds at first; None where the text does not say."""
    if not variable.value:
        return None
    width = SIZES[variable.type]
    data = b""
    try:
        for word in _WORD.findall(variable.value):
            if re.match(r"0[fFdD]", word):
                data += int(word[2:], 16).to_bytes(width, "little")
            else:
                data += (integer(word) % (1 << 8 * width)).to_bytes(width, "little")
    except (ValueError, OverflowError):
        said = f"'{variable.name}' has a value that is no number"
        raise PtxError(variable.line, said) from None
    return data


def global_text(variable: Variable) -> str:
    """Memory of a variable. Raises :class:`PtxError`."""
    size = max(variable.size, 1)
    data = initial_bytes(variable)
    text = "zeroinitializer"
    if data is not None:
        filled = (data + bytes(size))[:size]
        text = "[" + ", ".join(f"i8 {byte}" for byte in filled) + "]"
    return f'@"{variable.name}" = global [{size} x i8] {text}, align {max(variable.align, 16)}'
