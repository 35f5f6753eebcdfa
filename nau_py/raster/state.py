"""STATE attributes and pass-level stencil as OpenGL state (docs/format.md, 9.5 and 11.4)."""

from __future__ import annotations

from collections.abc import Mapping

from nau_py.model.attributes.state import STATE
from nau_py.model.values import Scalar
from nau_py.raster.gl import GL

_FUNCTIONS = {"NOT_EQUAL": "NOTEQUAL"}
_EQUATIONS = {
    "ADD": GL.GL_FUNC_ADD,
    "SUBTRACT": GL.GL_FUNC_SUBTRACT,
    "REVERSE_SUBTRACT": GL.GL_FUNC_REVERSE_SUBTRACT,
    "MIN": GL.GL_MIN,
    "MAX": GL.GL_MAX,
}
Values = Mapping[str, tuple[Scalar, ...]]
_DEFAULTS: dict[str, tuple[Scalar, ...]] = {a.name: a.default for a in STATE}


def find_comparison(name: str) -> int:
    """Return OpenGL's comparison function for a name in Nau."""
    return int(getattr(GL, f"GL_{_FUNCTIONS.get(name, name)}"))


def find_constant(attribute: str, name: str) -> int:
    """Return OpenGL's constant for a value of a STATE attribute, or the number of an ORDER_TYPE."""
    if attribute.endswith("_FUNC"):
        return find_comparison(name)
    if attribute == "ORDER_TYPE":
        return ("FRONT_TO_BACK", "BACK_TO_FRONT").index(name)
    return _EQUATIONS.get(name) or int(getattr(GL, f"GL_{name}"))


def _set_capability(capability: int, on: bool) -> None:
    (GL.glEnable if on else GL.glDisable)(capability)


def apply_state(values: Values) -> None:
    """Set OpenGL to a material's state; attributes that it does not set take their defaults."""
    state = _DEFAULTS | dict(values)

    def enum(name: str) -> int:
        return int(getattr(GL, f"GL_{state[name][0]}"))

    _set_capability(GL.GL_DEPTH_TEST, bool(state["DEPTH_TEST"][0]))
    GL.glDepthMask(bool(state["DEPTH_MASK"][0]))
    GL.glDepthFunc(find_comparison(str(state["DEPTH_FUNC"][0])))
    _set_capability(GL.GL_CULL_FACE, bool(state["CULL_FACE"][0]))
    GL.glCullFace(enum("CULL_TYPE"))
    blend = bool(state["BLEND"][0])
    _set_capability(GL.GL_BLEND, blend)
    if blend:
        GL.glBlendFunc(enum("BLEND_SRC"), enum("BLEND_DST"))
        GL.glBlendEquation(_EQUATIONS[str(state["BLEND_EQUATION"][0])])
        GL.glBlendColor(*[float(v) for v in state["BLEND_COLOR"]])
    GL.glColorMask(*[bool(v) for v in state["COLOR_MASK_B4"]])


def reset_state() -> None:
    """Set Nau's default state: depth test, back faces culled, no blending, all channels written."""
    apply_state({})
    GL.glFrontFace(GL.GL_CCW)
    GL.glDisable(GL.GL_STENCIL_TEST)
    GL.glDisable(GL.GL_DEPTH_CLAMP)
    GL.glDisable(GL.GL_RASTERIZER_DISCARD)
    GL.glEnable(GL.GL_TEXTURE_CUBE_MAP_SEAMLESS)
    GL.glEnable(GL.GL_PROGRAM_POINT_SIZE)


def apply_stencil(values: Values) -> None:
    """Set the stencil test of a pass from its PASS attributes."""
    on = bool(values["STENCIL_ENABLE"][0])
    _set_capability(GL.GL_STENCIL_TEST, on)
    if on:
        mask = int(values["STENCIL_OP_MASK"][0])
        function = find_comparison(str(values["STENCIL_FUNC"][0]))
        GL.glStencilFunc(function, int(values["STENCIL_OP_REF"][0]), mask)
        names = ("STENCIL_FAIL", "STENCIL_DEPTH_FAIL", "STENCIL_DEPTH_PASS")
        GL.glStencilOp(*[int(getattr(GL, f"GL_{values[n][0]}")) for n in names])
