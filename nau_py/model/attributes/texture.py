"""TEXTURE and ARRAY_OF_TEXTURES attributes, and the internal formats (docs/format.md, 6.2, 9.6)."""

from __future__ import annotations

from nau_py.model.attribute import Attribute, AttributeSet, choice, flag, number
from nau_py.model.values import DataType

_SUFFIXES = ("8", "16", "16F", "32F", "8I", "16I", "32I", "8UI", "16UI", "32UI")
COLOR_FORMATS = tuple(
    "RGBA" if family + suffix == "RGBA8" else family + suffix
    for family in ("R", "RG", "RGBA")
    for suffix in _SUFFIXES
)
DEPTH_FORMATS = (
    "DEPTH_COMPONENT16",
    "DEPTH_COMPONENT24",
    "DEPTH_COMPONENT32F",
    "DEPTH32F_STENCIL8",
)
INTERNAL_FORMATS = COLOR_FORMATS + DEPTH_FORMATS
_FORMATS = " ".join(INTERNAL_FORMATS)
_INT = DataType.INT


def count_channels(internal_format: str) -> int:
    """Return the number of channels of an internal format: 1, 2 or 4 (1 for depth)."""
    if internal_format.startswith("RGBA"):
        return 4
    return 2 if internal_format.startswith("RG") else 1


def _texture(type_: str) -> AttributeSet:
    return AttributeSet.of(
        type_,
        [
            number("WIDTH", _INT, 1, "Texels.", minimum=0),
            number("HEIGHT", _INT, 1, "Texels; 1 gives no storage in Nau.", minimum=0),
            number("DEPTH", _INT, 1, "Texels; above 1 a 3D texture.", minimum=0),
            number("LEVELS", _INT, 1, "Mip levels."),
            number("LAYERS", _INT, 1, "Above 1 a texture array."),
            number("SAMPLES", _INT, 0, "Above 1 a multisample texture."),
            choice("INTERNAL_FORMAT", "RGBA", _FORMATS, "Texel format."),
            flag("MIPMAP", False, "Allocate mip levels."),
            choice("CONTENT", "NONE", "NONE RANDOM_UNIFORM RANDOM_NORMAL", "Initial content."),
            number("ID", _INT, -1, "OpenGL name.", readonly=True),
            number("COMPONENT_COUNT", _INT, 0, "Channels.", readonly=True),
            number("ELEMENT_SIZE", _INT, 0, "Bits a texel.", readonly=True),
            number("SEED", _INT, 0, "Seed of random content.", readonly=True),
            choice("DIMENSION", "TEXTURE_2D", "TEXTURE_2D", "Kind of texture.", True),
            choice("FORMAT", "RGBA", "RGBA", "Transfer format.", True),
            choice("TYPE", "UNSIGNED_BYTE", "UNSIGNED_BYTE", "Transfer type.", True),
        ],
    )


TEXTURE = _texture("TEXTURE")
TEXTURE_MATERIAL = _texture("TEXTURE_MATERIAL")

ARRAY_OF_TEXTURES = AttributeSet.of(
    "ARRAY_OF_TEXTURES",
    [
        *(number(n, _INT, 1, "See TEXTURE.") for n in ("WIDTH", "HEIGHT", "DEPTH", "LEVELS")),
        number("LAYERS", _INT, 1, "See TEXTURE."),
        number("SAMPLES", _INT, 0, "See TEXTURE."),
        number("TEXTURE_COUNT", DataType.UINT, 1, "Number of textures to create."),
        flag("MIPMAP", False, "Allocate mip levels."),
        flag("CREATE_BUFFER", False, "Create a buffer of bindless handles."),
        choice("INTERNAL_FORMAT", "RGBA", _FORMATS, "Texel format; must be given."),
        number("BUFFER_ID", _INT, -1, "OpenGL name of the buffer.", readonly=True),
        Attribute("TEXTURE_ID_ARRAY", DataType.INTARRAY, (), "OpenGL names.", readonly=True),
    ],
)
