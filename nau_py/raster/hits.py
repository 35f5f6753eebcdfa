"""Shading of ray hits by the GLSL program that rasterises their material.

Hits are drawn as points into a target of their own, one per pixel, through the material's vertex
and fragment stages. Values that depend on the view (camera position, view and normal matrices) are
read per hit: the eye of a hit is the origin of its ray and looks along it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from nau_py.diagnostics.diagnostic import error
from nau_py.diagnostics.errors import ShaderError
from nau_py.model.shader import Shader
from nau_py.raster import gl
from nau_py.raster.draw import bind_material, set_uniforms, unbind_material
from nau_py.raster.draw_context import DrawContext
from nau_py.raster.gl import GL
from nau_py.raster.programs import ShaderProgram, UniformSlot, read_stage
from nau_py.raster.state import reset_state
from nau_py.raster.targets import Attachment, Target
from nau_py.scene.material import RenderMaterial, UniformSource
from nau_py.scene.mesh import F32, F64
from nau_py.scene.viewport import Rect

SIDE = 256
"""Width and height of the hit target. One draw call shades SIDE² hits."""
BINDING = 7
"""Binding point of the buffer with the views."""
VIEW_DEPENDENT = {
    "RENDERER": (
        "VIEW",
        "VIEW_MODEL",
        "PROJECTION_VIEW",
        "PROJECTION_VIEW_MODEL",
        "NORMAL",
    ),
    "CAMERA": (
        "POSITION",
        "VIEW",
        "NORMALIZED_VIEW",
        "VIEW_MATRIX",
        "VIEW_INVERSE_MATRIX",
        "PROJECTION_VIEW_MATRIX",
    ),
}
_ROWS = {"mat4": 4, "mat3": 3, "vec4": 1, "vec3": 1}
_DECLARATION = re.compile(
    r"\buniform\s+(?:(?:lowp|mediump|highp)\s+)?(mat4|mat3|vec4|vec3)\s+([^;{}()]+);"
)
_VERSION = re.compile(r"^\s*#version\s+(\d+)[^\n]*\n")
_POINT = """
#undef main
void main() {{
    nau_material_main();
    nau_slot_of_fragment = gl_VertexID;
    vec2 nau_cell = vec2(gl_VertexID % {side}, gl_VertexID / {side}) + 0.5;
    gl_Position = vec4(nau_cell / {side}.0 * 2.0 - 1.0, 0.0, 1.0);
    gl_PointSize = 1.0;
}}
"""


@dataclass(frozen=True, slots=True)
class ViewUniform:
    """A uniform that is read per hit. ``first``: its first vec4 row in the part of a hit."""

    source: UniformSource
    type: str
    first: int


@dataclass(slots=True)
class HitProgram:
    """A material's program, compiled for hits."""

    program: ShaderProgram
    views: list[ViewUniform]
    rows: int


def _is_view(source: UniformSource) -> bool:
    if source.block or (source.type == "CAMERA" and source.context != "CURRENT"):
        return False
    return source.component in VIEW_DEPENDENT.get(source.type, ())


def remove_declarations(text: str, names: set[str]) -> tuple[str, dict[str, str]]:
    """Remove the declarations of the uniforms ``names``; return the text and their types."""
    types: dict[str, str] = {}

    def keep(match: re.Match[str]) -> str:
        listed = [part.strip() for part in match[2].split(",")]
        own = [part for part in listed if part in names]
        types.update(dict.fromkeys(own, match[1]))
        rest = [part for part in listed if part not in names]
        return f"uniform {match[1]} {', '.join(rest)};" if rest else ""

    return _DECLARATION.sub(keep, text), types


def _insert_head(text: str, lines: list[str]) -> str:
    """Insert ``lines`` behind the version, which is raised to 430; keep the line numbers."""
    match = _VERSION.match(text)
    version = max(int(match[1]), 430) if match else 430
    body = text[match.end() :] if match else text
    start = 2 if match else 1
    head = "\n".join(lines)
    return f"#version {version} core\n{head}\n#line {start}\n{body}"


def _define_macro(view: ViewUniform) -> str:
    rows = [f"nau_views[nau_slot * nau_rows + {view.first + k}]" for k in range(_ROWS[view.type])]
    if view.type == "mat4":
        value = f"mat4({', '.join(rows)})"
    elif view.type == "mat3":
        value = f"mat3({', '.join(row + '.xyz' for row in rows)})"
    else:
        value = rows[0] + (".xyz" if view.type == "vec3" else "")
    return f"#define {view.source.uniform} ({value})"


def compile_for_hits(
    ctx: Any, library: str, shader: Shader, material: RenderMaterial
) -> HitProgram:
    """Compile the program of ``material`` for hits. Raises :class:`ShaderError`."""
    label = f"material '{material.name}', shader '{shader.name}' of library '{library}'"
    for stage in ("gs", "tc", "te"):
        if shader.files(stage):
            message = f"{label}: built-in program 'material' cannot run its stage {stage}"
            raise ShaderError(error("G004", shader.where(stage), message))
    vertex, fragment = read_stage(shader, "vs"), read_stage(shader, "ps")
    if vertex is None or fragment is None:
        message = f"{label}: built-in program 'material' needs a vertex and a fragment stage"
        raise ShaderError(error("G004", shader.location, message))
    sources = {s.uniform: s for s in material.uniforms if _is_view(s)}
    texts, types = [], {}
    for source in (vertex, fragment):
        text, found = remove_declarations(source.text, set(sources))
        texts.append(text)
        types.update(found)
    views: list[ViewUniform] = []
    rows = 0
    for name, type_ in types.items():
        views.append(ViewUniform(sources[name], type_, rows))
        rows += _ROWS[type_]
    shared = [
        f"const int nau_rows = {max(rows, 1)};",
        f"layout(std430, binding = {BINDING}) readonly buffer nau_Views {{ vec4 nau_views[]; }};",
        *(_define_macro(view) for view in views),
    ]
    head = ["#define main nau_material_main", "flat out int nau_slot_of_fragment;"]
    tail = ["flat in int nau_slot_of_fragment;", "#define nau_slot nau_slot_of_fragment"]
    try:
        made = ctx.program(
            vertex_shader=_insert_head(texts[0], [*head, "#define nau_slot gl_VertexID", *shared])
            + _POINT.format(side=SIDE),
            fragment_shader=_insert_head(texts[1], [*tail, *shared]),
        )
    except moderngl.Error as problem:
        text = " ".join(line.strip() for line in str(problem).splitlines() if line.strip())
        message = f"{label} does not compile for the built-in program 'material': {text}"
        raise ShaderError(error("G001", shader.location, message)) from None
    uniforms = {
        name: UniformSlot(location, gl_type, length)
        for name, location, gl_type, length in gl.active_uniforms(made.glo)
    }
    program = ShaderProgram(
        library, shader.name or "", made, uniforms, gl.active_inputs(made.glo), True, False
    )
    return HitProgram(program, views, max(rows, 1))


def compute_view_rows(
    program: HitProgram, origin: F32, direction: F32, up: F64, projection: F64, model: F64
) -> F32:
    """Compute the view values of ``program`` for rays (n, 3): float32 (n, rows, 4), column-major.

    The eye of a hit is the ray's origin and looks along the ray; ``up`` is the camera's.
    """
    n = len(origin)
    d = direction.astype(np.float64)
    right = np.cross(d, up)
    length = np.linalg.norm(right, axis=1)
    other = np.cross(d, np.eye(3)[int(np.argmin(np.abs(up)))])
    right = np.where((length > 1e-6)[:, None], right, other)
    right /= np.linalg.norm(right, axis=1, keepdims=True)
    view = np.zeros((n, 4, 4))
    view[:, 0, :3], view[:, 1, :3], view[:, 2, :3] = right, np.cross(right, d), -d
    view[:, :3, 3] = -np.einsum("nij,nj->ni", view[:, :3, :3], origin.astype(np.float64))
    view[:, 3, 3] = 1
    result = np.zeros((n, program.rows, 4), np.float32)
    for used in program.views:
        name = used.source.component
        values: NDArray[np.floating[Any]]
        if used.source.type == "CAMERA" and name in ("POSITION", "VIEW", "NORMALIZED_VIEW"):
            vector = origin if name == "POSITION" else direction
            result[:, used.first, :3] = vector
            result[:, used.first, 3] = 1.0 if name == "POSITION" else 0.0
            continue
        if name in ("VIEW", "VIEW_MATRIX"):
            values = view
        elif name == "VIEW_MODEL":
            values = view @ model
        elif name in ("PROJECTION_VIEW", "PROJECTION_VIEW_MATRIX"):
            values = projection @ view
        elif name == "PROJECTION_VIEW_MODEL":
            values = projection @ view @ model
        elif name == "VIEW_INVERSE_MATRIX":
            values = np.linalg.inv(view)
        else:  # NORMAL
            linear = (view @ model)[:, :3, :3]
            values = np.linalg.inv(linear).transpose(0, 2, 1)
        count = _ROWS[used.type]
        size = min(values.shape[1], 4 if used.type == "mat4" else 3)
        columns = values.transpose(0, 2, 1)[:, :count, :size]
        result[:, used.first : used.first + columns.shape[1], :size] = columns
    return result


class HitShading:
    """Shades batches of hits. Keeps the programs, and the target that they draw into."""

    def __init__(self) -> None:
        self._programs: dict[tuple[str, str, tuple[UniformSource, ...]], HitProgram] = {}
        self._target: Target | None = None

    def _find_program(self, context: DrawContext, material: RenderMaterial) -> HitProgram:
        key = (*material.program, material.uniforms)
        if key not in self._programs:
            found = context.world.project.shader(*material.program)
            if found is None:
                message = f"material '{material.name}' has no shader '{material.program[1]}'"
                raise ShaderError(error("G004", context.pass_.location, message))
            ctx = context.resources.device.ctx
            self._programs[key] = compile_for_hits(ctx, material.program[0], found[1], material)
            context.resources.blocks.attach(self._programs[key].program.mgl.glo)
        return self._programs[key]

    def shade(
        self,
        context: DrawContext,
        material: RenderMaterial,
        model: F64,
        attributes: dict[str, F32],
        origin: F32,
        direction: F32,
    ) -> F32:
        """Compute the colours of hits, RGBA float32 (n, 4).

        ``attributes`` float32 (n, 4) by name, in the space of the object whose matrix is ``model``;
        rays float32 (n, 3), world space. Raises :class:`ShaderError`.
        """
        hit_program = self._find_program(context, material)
        parts = []
        for start in range(0, len(origin), SIDE * SIDE):
            part = slice(start, start + SIDE * SIDE)
            some = {name: values[part] for name, values in attributes.items()}
            own = replace(context, material=material, model=model)
            parts.append(self._draw_hits(own, hit_program, some, origin[part], direction[part]))
        return np.concatenate(parts)

    def _draw_hits(
        self,
        context: DrawContext,
        hit_program: HitProgram,
        attributes: dict[str, F32],
        origin: F32,
        direction: F32,
    ) -> F32:
        ctx, program = context.resources.device.ctx, hit_program.program
        material = context.material
        assert material is not None
        count = len(origin)
        if self._target is None:
            depth = Attachment("hits::depth", "DEPTH_COMPONENT24")
            colours = [Attachment("hits::colour", "RGBA32F")]
            self._target = Target("hits", SIDE, SIDE, colours, depth)
            self._target.allocate()
        reset_state()
        self._target.bind(Rect(0.0, 0.0, float(SIDE), float(SIDE)))
        self._target.clear_color((0.0, 0.0, 0.0, 0.0))
        bind_material(context.resources, material)
        for switch in (GL.GL_DEPTH_TEST, GL.GL_BLEND, GL.GL_CULL_FACE, GL.GL_STENCIL_TEST):
            GL.glDisable(switch)
        GL.glColorMask(True, True, True, True)
        set_uniforms(program, context)
        up, projection = context.camera.true_up, context.projection
        rows = compute_view_rows(hit_program, origin, direction, up, projection, context.model)
        views = ctx.buffer(rows.tobytes())
        views.bind_to_storage_buffer(BINDING)
        zero = np.zeros((count, 4), np.float32)
        buffers = [
            (location, ctx.buffer(np.ascontiguousarray(attributes.get(name, zero)).tobytes()))
            for name, location in program.inputs
        ]
        indices = ctx.buffer(np.arange(count, dtype=np.uint32).tobytes())
        array = gl.create_vertex_array([(k, b.glo) for k, b in buffers], indices.glo)
        gl.draw_elements(program.mgl.glo, array, GL.GL_POINTS, count, 0, 1)
        gl.barrier()
        image = self._target.textures["hits::colour"].read()
        gl.delete_vertex_arrays([array])
        for made in (views, indices, *(b for _, b in buffers)):
            made.release()
        unbind_material(material)
        return np.asarray(image, np.float32).reshape(-1, 4)[:count]
