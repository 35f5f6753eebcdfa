"""GLSL programs: sources, compilation, and errors located in the source files."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import moderngl
import numpy as np

from nau_py.diagnostics.diagnostic import Diagnostic, error
from nau_py.diagnostics.errors import ShaderError
from nau_py.diagnostics.location import Location
from nau_py.model.shader import STAGES, Shader
from nau_py.process.paths import resolve
from nau_py.raster import gl
from nau_py.raster.tolerant_glsl import adapt_stages, rename_word

_STAGE_NAMES = {
    "vs": "vertex_shader",
    "gs": "geometry_shader",
    "tc": "tess_control_shader",
    "te": "tess_evaluation_shader",
    "ps": "fragment_shader",
}
_STRIDE = 100_000
"""Line numbers of the k-th file of a list begin at k · _STRIDE: drivers lose the file index of
``#line``, but not the line."""
_LOG_LINE = re.compile(
    r"^\s*(?:ERROR:\s*)?(?P<file>\d+)[:(](?P<line>\d+)\)?(?:\((?P<column>\d+)\))?\s*:\s*"
    r"(?P<text>.*)$",
    re.IGNORECASE,
)


@dataclass(slots=True)
class StageSource:
    """The text of one stage and its files; ``skipped`` blank lines were removed at the top."""

    text: str
    files: list[Path]
    skipped: int

    def place(self, line: int, column: int = 1) -> Location:
        """Locate line ``line`` of the text, as the driver counts, in its file."""
        index, row = divmod(line, _STRIDE)
        index = min(index, len(self.files) - 1)
        return Location(str(self.files[index]), row + (0 if index else self.skipped), column)

    def tests(self, macro: str) -> bool:
        """Return True if a condition of the preprocessor tests ``macro``."""
        return re.search(rf"^\s*#\s*(?:if|elif)\w*\b.*\b{macro}\b", self.text, re.M) is not None


@dataclass(slots=True)
class UniformSlot:
    """An active uniform and the bytes last uploaded to it."""

    location: int
    gl_type: int
    count: int
    last: bytes = b""


@dataclass(slots=True)
class ShaderProgram:
    """A linked program with its active uniforms."""

    library: str
    name: str
    mgl: Any
    uniforms: dict[str, UniformSlot]
    inputs: list[tuple[str, int]]
    has_fragment: bool
    is_compute: bool
    is_tessellated: bool = False
    notes: list[str] = field(default_factory=list)
    """Changes without which the driver rejects the program."""

    def set(self, name: str, value: np.ndarray[Any, Any]) -> None:
        """Upload a flat value, cut or filled with zeros to the size that the shader declares."""
        slot = self.uniforms.get(name.removesuffix("[0]"))
        if slot is None:
            return
        wanted = gl.count_components(slot.gl_type) * slot.count
        flat = np.zeros(wanted, gl.uniform_dtype(slot.gl_type))
        given = value.reshape(-1)[:wanted]
        flat[: len(given)] = given
        raw = flat.tobytes()
        if raw != slot.last:
            gl.set_uniform(self.mgl.glo, slot.location, slot.gl_type, slot.count, flat)
            slot.last = raw


def list_stage_files(shader: Shader) -> list[Path]:
    """List the resolved paths of all source files of a shader."""
    folder = Path(shader.location.file).parent
    names = [name for stage in STAGES for name in shader.files(stage)]
    return [resolve(folder, name).best.resolve() for name in names]


def read_stage(shader: Shader, stage: str) -> StageSource | None:
    """Concatenate the files of a stage with line directives between them (docs/format.md, 6.5)."""
    names = shader.files(stage)
    if not names:
        return None
    folder = Path(shader.location.file).parent
    files = [resolve(folder, name).best for name in names]
    texts = []
    for index, file in enumerate(files):
        try:
            text = file.read_bytes().decode("utf-8", "replace").lstrip("\ufeff")
        except OSError as problem:
            where = shader.where(stage)
            message = f"shader '{shader.name}', stage {stage}: file '{file}': {problem.strerror}"
            raise ShaderError(error("G002", where, message)) from None
        texts.append(text if index == 0 else f"\n#line {index * _STRIDE + 1} {index}\n{text}")
    whole = "".join(texts)
    stripped = whole.lstrip()
    return StageSource(stripped, files, whole[: len(whole) - len(stripped)].count("\n"))


def _locate_errors(
    log: str, sources: dict[str, StageSource], shader: Shader, label: str
) -> list[Diagnostic]:
    """Make diagnostics from a driver's log: each error with its own file, line and column."""
    found: list[Diagnostic] = []
    stage = next(iter(sources))
    headings = {name: key for key, name in _STAGE_NAMES.items()} | {"compute_shader": "cs"}
    for line in log.splitlines():
        stage = headings.get(line.strip(), stage)
        match = _LOG_LINE.match(line)
        if match is None or "warning" in match["text"].lower().split(":")[0]:
            continue
        source = sources[stage] if stage in sources else next(iter(sources.values()))
        where = source.place(int(match["line"]), int(match["column"] or 1))
        text = re.sub(r"^error\s*\w*\s*:\s*", "", match["text"], flags=re.IGNORECASE)
        found.append(error("G001", where, f"{label}, stage {stage}: {text}"))
    if not found:
        text = " ".join(part.strip() for part in log.splitlines() if part.strip())
        found.append(error("G003", shader.location, f"{label} does not link: {text}"))
    return found


def compile_program(ctx: Any, library: str, shader: Shader) -> ShaderProgram:
    """Compile and link a program. Raises :class:`~nau_py.ShaderError`."""
    label = f"shader '{shader.name}' of library '{library}'"
    sources = {s: src for s in STAGES if (src := read_stage(shader, s)) is not None}
    unsupported = [s for s in ("ts", "ms") if s in sources]
    if unsupported:
        message = (
            f"{label}: stage {unsupported[0]} needs the extension GL_NV_mesh_shader, which nau_py "
            "does not use"
        )
        raise ShaderError(error("G004", shader.where(unsupported[0]), message))
    texts = {stage: source.text for stage, source in sources.items()}
    notes: list[str] = []
    try:
        made = _link_program(ctx, texts)
    except moderngl.Error as problem:
        adapted, notes = adapt_stages(texts)
        try:
            if not notes:
                raise problem
            made = _link_program(ctx, adapted)
        except moderngl.Error:
            lacking = _report_missing_extensions(ctx, sources, label)
            raise ShaderError(
                lacking or _locate_errors(str(problem), sources, shader, label)
            ) from None
    except KeyError as problem:
        message = f"{label}: #include {problem} is not supported"
        raise ShaderError(error("G001", shader.location, message)) from None
    uniforms = {
        name.removeprefix(rename_word("")): UniformSlot(location, gl_type, length)
        for name, location, gl_type, length in gl.active_uniforms(made.glo)
    }
    inputs = [] if "cs" in sources else gl.active_inputs(made.glo)
    return ShaderProgram(
        library,
        shader.name or "",
        made,
        uniforms,
        inputs,
        "ps" in sources,
        "cs" in sources,
        "te" in sources,
        notes,
    )


_EXTENSION = re.compile(r"^\s*#\s*extension\s+(\w+)\s*:\s*(?:enable|require)\b")
_LINE = re.compile(r"^#line (\d+)")


def _report_missing_extensions(
    ctx: Any, sources: dict[str, StageSource], label: str
) -> list[Diagnostic]:
    """Report extensions that a program requires without an alternative and the driver lacks."""
    found = []
    for stage, source in sources.items():
        at = 0
        for line in source.text.splitlines():
            directive = _LINE.match(line)
            at = int(directive[1]) - 1 if directive else at + 1
            asked = _EXTENSION.match(line)
            if asked is None or asked[1] in ctx.extensions or source.tests(asked[1]):
                continue
            message = (
                f"{label}, stage {stage}, needs the extension {asked[1]}, which this driver does "
                "not have"
            )
            found.append(error("G004", source.place(at), message))
    return found


def _link_program(ctx: Any, texts: dict[str, str]) -> Any:
    if "cs" in texts:
        return ctx.compute_shader(texts["cs"])
    return ctx.program(**{_STAGE_NAMES[stage]: text for stage, text in texts.items()})
