"""GPU resources of a project by qualified name, made when first used."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from nau_py.diagnostics.diagnostic import Diagnostic, error, warning
from nau_py.diagnostics.errors import NauError, ProjectError, ShaderError
from nau_py.diagnostics.location import Location
from nau_py.model.attributes.texture import count_channels
from nau_py.model.buffer import Buffer
from nau_py.model.linked import Project
from nau_py.model.physics import PhysicsMaterial
from nau_py.model.target import CubeMapAttachment, RenderTarget
from nau_py.model.texture import ArrayOfTextures, CubeMap
from nau_py.model.texture import Texture as TextureNode
from nau_py.process.paths import resolve
from nau_py.raster import gl
from nau_py.raster.blocks import UniformBlocks
from nau_py.raster.buffers import read_initial_content
from nau_py.raster.device import Device
from nau_py.raster.geometry import GeometryCache
from nau_py.raster.programs import ShaderProgram, compile_program, list_stage_files
from nau_py.raster.samplers import Samplers
from nau_py.raster.targets import COMPLETE, Attachment, Target, make_window_target
from nau_py.raster.textures import (
    GpuTexture,
    make_cube_map,
    make_image_texture,
    make_texture,
    make_volume_texture,
)
from nau_py.scene.images import ImageError, load_image
from nau_py.scene.volume import is_volume, load_volume


class Resources:
    """Textures, buffers, targets and programs of one project on one device.

    ``diagnostics`` reports resources that could not be made; drawing continues without them.
    """

    def __init__(
        self, device: Device, project: Project, window: tuple[int, int], texels: str = "RGBA"
    ) -> None:
        self.device = device
        self.project = project
        self.samplers = Samplers()
        self.geometry = GeometryCache(device.ctx)
        self.blocks = UniformBlocks(device.ctx)
        self._check_size("the window", *window, project.file.location)
        self.window = make_window_target(*window, texels)
        self.diagnostics: list[Diagnostic] = []
        self._targets: dict[str, Target] = {}
        self._textures: dict[str, GpuTexture | None] = {}
        self._owners: dict[str, tuple[str, RenderTarget] | None] = {}
        self._cleared: list[Any] = []
        self._buffers: dict[str, Any] = {}
        self._programs: dict[tuple[str, str], ShaderProgram | None] = {}
        self._replaced: list[ShaderProgram] = []
        """Old versions of recompiled programs. They stay alive because vertex arrays are stored by
        OpenGL's number of a program, which must not be used again."""

    def release(self) -> None:
        """Delete the GPU objects that moderngl does not own."""
        for texture in self._textures.values():
            if texture is not None:
                texture.delete()
        for target in (*self._targets.values(), self.window):
            target.delete()
        self.geometry.release()
        self.samplers.release()

    def _check_size(self, what: str, width: int, height: int, where: Location) -> None:
        most = self.device.max_size
        if not (1 <= width <= most and 1 <= height <= most):
            message = f"{what} is {width} x {height}; this driver allows 1 to {most} each way"
            raise ProjectError(error("P010", where, message))

    def _check_samples(self, what: str, wanted: int, where: Location) -> int:
        """Return the samples per pixel, 0 for one. Raise if the driver allows fewer."""
        if wanted > self.device.max_samples:
            most = self.device.max_samples
            message = f"{what} has {wanted} SAMPLES; this driver allows 0 to {most}"
            raise ProjectError(error("P010", where, message))
        return wanted if wanted > 1 else 0

    def target(self, library: str, name: str) -> Target:
        """Return a render target. Raises :class:`~nau_py.ProjectError` if it is incomplete."""
        key = f"{library}::{name}"
        if key not in self._targets:
            node = self.project.render_target(library, name)
            if node is None:
                raise ProjectError(
                    error("R010", self.project.file.location, f"render target '{key}' is undefined")
                )
            self._targets[key] = self._make_target(library, node)
        return self._targets[key]

    def _make_target(self, library: str, node: RenderTarget) -> Target:
        def value(name: str) -> tuple[Any, ...]:
            return self.project.value(node, "RENDER_TARGET", name)

        width, height = (int(v) for v in value("SIZE"))
        self._check_size(f"render target '{node.name}'", width, height, node.location)
        colors = [
            Attachment(f"{library}::{c.name}", c.internalFormat or "RGBA") for c in node.colors
        ]
        fmt = "DEPTH24_STENCIL8" if node.depthStencil else "DEPTH_COMPONENT32F"
        if node.depth is not None and node.depth.internalFormat:
            fmt = node.depth.internalFormat
        r, g, b, a = (float(v) for v in value("CLEAR_VALUES"))
        target = Target(
            f"{library}::{node.name}",
            width,
            height,
            colors,
            Attachment(f"{library}::{node.depth_name}", fmt),
            (r, g, b, a),
            max(int(value("LEVELS")[0]), 1),
            max(int(value("LAYERS")[0]), 1),
            self._check_samples(
                f"render target '{node.name}'", int(value("SAMPLES")[0]), node.location
            ),
            any(isinstance(c, CubeMapAttachment) for c in node.colors),
        )
        status = target.allocate()
        if status != COMPLETE:
            message = (
                f"render target '{node.name}' is incomplete (OpenGL status {status:#x}): "
                "check its size, its formats and the number of colours"
            )
            raise ProjectError(error("P010", node.location, message))
        return target

    def texture(self, name: str, path: Path | None = None) -> GpuTexture | None:
        """Return a texture by qualified name, or by path for an image file of a model.

        Return None, and report it once, if the texture cannot be made.
        """
        if name not in self._owners:
            self._owners[name] = self.project.target_of_texture(name)
        owner = self._owners[name]
        if owner is not None:
            return self.target(owner[0], owner[1].name or "").textures.get(name)
        if name not in self._textures:
            try:
                self._textures[name] = self._make_texture(name, path)
            except ImageError as problem:
                where = self.project.file.location
                message = f"texture '{name}': {problem}; it is drawn as unset"
                self.diagnostics.append(warning("F004", where, message))
                self._textures[name] = None
        return self._textures[name]

    def _make_texture(self, name: str, path: Path | None) -> GpuTexture | None:
        if path is not None:
            return make_image_texture(load_image(path), mipmap=True)
        node = self.project.names("texture").get(name)
        if isinstance(node, CubeMap):
            folder = Path(node.location.file).parent
            axes = ("PosX", "NegX", "PosY", "NegY", "PosZ", "NegZ")
            files = [resolve(folder, getattr(node, f"file{axis}") or "").best for axis in axes]
            faces = [_expand_to_rgba(load_image(file)) for file in files]
            if len({face.shape for face in faces}) > 1:
                raise ImageError("its six faces differ in size")
            return make_cube_map(faces, node.mipmap == "true")
        if isinstance(node, TextureNode) and node.filename:
            file = resolve(Path(node.location.file).parent, node.filename).best
            if is_volume(file):
                return make_volume_texture(load_volume(file))
            return make_image_texture(load_image(file), bool(node.mipmap))
        if isinstance(node, TextureNode):
            return self._make_empty_texture(node, "TEXTURE")
        if isinstance(node, ArrayOfTextures):
            return self._make_empty_texture(node, "ARRAY_OF_TEXTURES")
        return None

    def _make_empty_texture(self, node: TextureNode | ArrayOfTextures, type_: str) -> GpuTexture:
        def number(attribute: str) -> int:
            return int(self.project.value(node, type_, attribute)[0])

        fmt = str(self.project.value(node, type_, "INTERNAL_FORMAT")[0])
        width, height, depth = (max(number(k), 1) for k in ("WIDTH", "HEIGHT", "DEPTH"))
        self._check_size(f"texture '{node.name}'", width, height, node.location)
        levels = max(number("LEVELS"), 1)
        if self.project.value(node, type_, "MIPMAP")[0]:
            levels = max(int(np.log2(max(width, height, depth))), 1)
        content = "NONE"
        if type_ == "TEXTURE":
            content = str(self.project.value(node, type_, "CONTENT")[0])
        if content == "NONE":
            samples = self._check_samples(
                f"texture '{node.name}'", number("SAMPLES"), node.location
            )
            layers = max(number("LAYERS"), 1)
            deep = depth if depth > 1 else 0
            return make_texture(fmt, width, height, levels, layers, deep, samples)
        wide = count_channels(fmt)
        texture = make_texture({1: "R32F", 2: "RG32F", 4: "RGBA32F"}[wide], width, height, levels)
        random = np.random.default_rng(0)
        shape = (height, width, wide)
        normal = content == "RANDOM_NORMAL"
        values = random.standard_normal(shape) if normal else random.random(shape)
        texture.write(values.astype(np.float32))
        return texture

    def buffer(self, name: str) -> Any:
        """Return a GPU buffer with its initial content, or None if it is undefined or empty."""
        if name not in self._buffers:
            node = self.project.names("buffer").get(name)
            self._buffers[name] = None
            if isinstance(node, PhysicsMaterial):
                self._buffers[name] = self._make_particles(node)
            if isinstance(node, Buffer):
                try:
                    content = read_initial_content(self.project, node)
                except (OSError, ValueError) as problem:
                    message = f"buffer '{name}': its file cannot be read: {problem}"
                    self.diagnostics.append(error("B001", node.location, message))
                    content = b""
                if content:
                    self._buffers[name] = self.device.ctx.buffer(content)
                    if self.project.value(node, "BUFFER", "CLEAR")[0] == "BY_FRAME":
                        self._cleared.append(self._buffers[name])
        return self._buffers[name]

    def _make_particles(self, node: PhysicsMaterial) -> Any:
        """Make the positions, vec4, of a body's particles. Nothing simulates them: all are zero."""
        most = int(self.project.value(node, "PHYSICS_MATERIAL", "MAX_PARTICLES")[0])
        return self.device.ctx.buffer(bytes(16 * most)) if most > 0 else None

    def clear_buffers_by_frame(self) -> None:
        """Fill buffers with zero if their CLEAR is BY_FRAME (docs/format.md, 11.1)."""
        for made in self._cleared:
            made.clear()

    def program(self, library: str, name: str) -> ShaderProgram | None:
        """Return a program, or None if it does not compile, and report its errors."""
        key = (library, name)
        if key not in self._programs:
            found = self.project.shader(library, name)
            self._programs[key] = None
            if found is not None:
                try:
                    made = compile_program(self.device.ctx, library, found[1])
                    self.blocks.attach(made.mgl.glo)
                    self._programs[key] = made
                    if made.notes:
                        message = f"shader '{name}' of library '{library}': {'; '.join(made.notes)}"
                        self.diagnostics.append(warning("G005", found[1].location, message))
                except ShaderError as problem:
                    self.diagnostics += problem.diagnostics
        return self._programs[key]

    def reload_programs(self, files: set[Path]) -> int:
        """Recompile the programs with a source in ``files`` (resolved paths); return their number.

        Raises :class:`~nau_py.ShaderError` if one does not compile; then no program changes.
        """
        made: dict[tuple[str, str], ShaderProgram] = {}
        for key in self._programs:
            found = self.project.shader(*key)
            if found is None or not files & set(list_stage_files(found[1])):
                continue
            made[key] = compile_program(self.device.ctx, key[0], found[1])
        for key, program in made.items():
            self.blocks.attach(program.mgl.glo)
            old = self._programs[key]
            if old is not None:
                self._replaced.append(old)
            self._programs[key] = program
        return len(made)

    def check(self) -> None:
        """Raise :class:`~nau_py.NauError` if an error has been reported so far."""
        errors = [d for d in self.diagnostics if d.severity == "error"]
        if errors:
            raise NauError(errors)

    def made_target(self, name: str) -> Target | None:
        """Return the render target of that qualified name, if it has been used."""
        return self._targets.get(name)

    def barrier(self) -> None:
        gl.barrier()


def _expand_to_rgba(
    texels: np.ndarray[Any, np.dtype[np.uint8]],
) -> np.ndarray[Any, np.dtype[np.uint8]]:
    """Convert any number of channels to RGBA: repeat grey; missing alpha is 255."""
    if texels.shape[2] == 4:
        return texels
    grey = np.repeat(texels[:, :, :1], 3, axis=2)
    alpha = texels[:, :, 1:2] if texels.shape[2] == 2 else np.full_like(texels[:, :, :1], 255)
    return np.concatenate([grey, alpha], axis=2)
