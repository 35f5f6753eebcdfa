"""Attributes of bindings: textures, images and buffers of materials (docs/format.md, 9.7)."""

from __future__ import annotations

from nau_py.model.attribute import Attribute, AttributeSet, choice, colour, flag, number
from nau_py.model.attributes.texture import INTERNAL_FORMATS
from nau_py.model.values import DataType

_INT = DataType.INT
_UINT = DataType.UINT
_WRAPS = "REPEAT CLAMP_TO_EDGE CLAMP_TO_BORDER MIRRORED_REPEAT"
_FILTERS = (
    "NEAREST LINEAR NEAREST_MIPMAP_NEAREST NEAREST_MIPMAP_LINEAR "
    "LINEAR_MIPMAP_NEAREST LINEAR_MIPMAP_LINEAR"
)
_FORMATS = " ".join(INTERNAL_FORMATS)

SAMPLER = AttributeSet.of(
    "TEXTURE_SAMPLER",
    [
        choice("WRAP_S", "REPEAT", _WRAPS, "Wrapping along u."),
        choice("WRAP_T", "REPEAT", _WRAPS, "Wrapping along v."),
        choice("WRAP_R", "REPEAT", _WRAPS, "Wrapping along w."),
        choice("MAG_FILTER", "LINEAR", "NEAREST LINEAR", "Magnification."),
        choice("MIN_FILTER", "LINEAR", _FILTERS, "Minification; mip variant as available."),
        choice("COMPARE_MODE", "NONE", "NONE COMPARE_REF_TO_TEXTURE", "Depth comparison."),
        choice("COMPARE_FUNC", "LEQUAL", "LEQUAL GEQUAL LESS GREATER EQUAL NOTEQUAL ALWAYS NEVER"),
        colour("BORDER_COLOR", (0.0, 0.0, 0.0, 0.0), "Colour outside CLAMP_TO_BORDER.", False),
        number("ID", _INT, -1, "OpenGL name.", readonly=True),
        flag("MIPMAP", False, "True if the texture has mip levels.", readonly=True),
    ],
)

TEXTURE_BINDING = AttributeSet.of(
    "TEXTURE_BINDING", [number("UNIT", _INT, 0, "Texture unit: feeds sampler uniforms.")]
)


def _image_common() -> list[Attribute]:
    return [
        number("LEVEL", _UINT, 0, "Mip level bound."),
        choice("ACCESS", "WRITE_ONLY", "READ_ONLY WRITE_ONLY READ_WRITE", "Access."),
        choice("INTERNAL_FORMAT", "RGBA", _FORMATS, "Format seen by the shader."),
        flag("CLEAR", False, "Clear that level each time the material is prepared."),
    ]


IMAGE_TEXTURE = AttributeSet.of(
    "IMAGE_TEXTURE",
    [
        number("UNIT", _INT, 0, "Image unit: feeds image uniforms.", readonly=True),
        *_image_common(),
        number("TEX_ID", _UINT, 0, "OpenGL name."),
    ],
)
ARRAY_OF_TEXTURES_BINDING = AttributeSet.of(
    "ARRAY_OF_TEXTURES_BINDING",
    [
        number("FIRST_UNIT", _INT, -1, "Unit of the first texture."),
        Attribute("SAMPLER_ARRAY", DataType.INTARRAY, (), "Units: feeds arrays.", readonly=True),
    ],
)
ARRAY_OF_IMAGE_TEXTURES = AttributeSet.of(
    "ARRAY_OF_IMAGE_TEXTURES",
    [
        number("FIRST_UNIT", _INT, -1, "Unit of the first image.", readonly=True),
        *_image_common(),
        Attribute("SAMPLER_ARRAY", DataType.INTARRAY, (), "Units: feeds arrays.", readonly=True),
    ],
)


def _buffer(type_: str) -> AttributeSet:
    return AttributeSet.of(
        type_,
        [
            number("SIZE", _UINT, 0, "Bytes."),
            number("STRUCT_SIZE", _UINT, 0, "Bytes of one record.", readonly=True),
            number("ID", _INT, -1, "OpenGL name.", readonly=True),
            choice("CLEAR", "NEVER", "NEVER BY_FRAME", "When to fill with zero."),
            Attribute("DIM", DataType.UIVEC3, (1, 1, 1), "SIZE = x·y·z records."),
        ],
    )


BUFFER = _buffer("BUFFER")
BUFFER_MATERIAL = _buffer("BUFFER_MATERIAL")
BUFFER_BINDING = AttributeSet.of(
    "BUFFER_BINDING",
    [
        choice("TYPE", "SHADER_STORAGE", "ATOMIC_COUNTER SHADER_STORAGE UNIFORM", "Kind."),
        number("BINDING_POINT", _INT, -1, "Binding point."),
    ],
)
