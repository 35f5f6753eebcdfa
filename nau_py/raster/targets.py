"""Framebuffers: the window and the render targets of libraries."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from nau_py.raster import gl
from nau_py.raster.gl import GL
from nau_py.raster.textures import GpuTexture, make_texture
from nau_py.scene.viewport import Rect


@dataclass(slots=True)
class Attachment:
    """A texture of a target: its qualified name and internal format."""

    name: str
    format: str


@dataclass(slots=True)
class Target:
    """A framebuffer with its textures; ``depth`` may carry stencil."""

    name: str
    width: int
    height: int
    colors: list[Attachment]
    depth: Attachment
    clear: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    levels: int = 1
    layers: int = 1
    samples: int = 0
    cube: bool = False
    """True if its textures are cube maps: six layers, faces in OpenGL's order."""
    fbo: int = 0
    textures: dict[str, GpuTexture] = field(default_factory=dict)

    def allocate(self) -> int:
        """Create textures and framebuffer. Returns the OpenGL completeness status."""
        self.fbo = gl.create_framebuffer()
        for index, attachment in enumerate(self.colors):
            texture = self._make_texture(attachment, self.levels)
            self.textures[attachment.name] = texture
            point = GL.GL_COLOR_ATTACHMENT0 + index
            GL.glNamedFramebufferTexture(self.fbo, point, texture.glo, 0)
        depth = self._make_texture(self.depth, 1)
        self.textures[self.depth.name] = depth
        point = GL.GL_DEPTH_STENCIL_ATTACHMENT if depth.format.stencil else GL.GL_DEPTH_ATTACHMENT
        GL.glNamedFramebufferTexture(self.fbo, point, depth.glo, 0)
        buffers = [GL.GL_COLOR_ATTACHMENT0 + i for i in range(len(self.colors))] or [GL.GL_NONE]
        GL.glNamedFramebufferDrawBuffers(self.fbo, len(buffers), np.array(buffers, np.uint32))
        return int(GL.glCheckNamedFramebufferStatus(self.fbo, GL.GL_FRAMEBUFFER))

    def _make_texture(self, attachment: Attachment, levels: int) -> GpuTexture:
        return make_texture(
            attachment.format,
            self.width,
            self.height,
            levels,
            self.layers,
            samples=self.samples,
            cube=self.cube,
        )

    def resize(self, width: int, height: int) -> None:
        """Allocate all attachments again if the size differs. Their content is lost."""
        if (width, height) == (self.width, self.height):
            return
        self.delete()
        self.width, self.height = width, height
        self.allocate()

    def delete(self) -> None:
        for texture in self.textures.values():
            texture.delete()
        self.textures.clear()
        gl.delete_framebuffer(self.fbo)

    def bind(self, rect: Rect) -> None:
        """Draw into this target, inside ``rect`` (viewport and scissor)."""
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self.fbo)
        GL.glViewportIndexedf(0, rect.x, rect.y, rect.width, rect.height)
        GL.glEnable(GL.GL_SCISSOR_TEST)
        GL.glScissor(*rect.scissor)

    def add_viewport(self, index: int, rect: Rect) -> None:
        """Set ``gl_ViewportIndex`` ``index`` with its scissor rectangle."""
        GL.glViewportIndexedf(index, rect.x, rect.y, rect.width, rect.height)
        GL.glScissorIndexed(index, *rect.scissor)

    def clear_color(self, colour: tuple[float, float, float, float]) -> None:
        """Fill the colour textures inside the scissor rectangle, all with one colour."""
        for index, attachment in enumerate(self.colors):
            fmt = self.textures[attachment.name].format
            if not fmt.integer:
                GL.glClearBufferfv(GL.GL_COLOR, index, np.array(colour, np.float32))
            elif fmt.name.endswith("UI"):
                GL.glClearBufferuiv(GL.GL_COLOR, index, np.array(colour, np.uint32))
            else:
                GL.glClearBufferiv(GL.GL_COLOR, index, np.array(colour, np.int32))

    def clear_depth(self, value: float) -> None:
        GL.glClearBufferfv(GL.GL_DEPTH, 0, np.array([value], np.float32))

    def clear_stencil(self, value: int) -> None:
        if self.textures[self.depth.name].format.stencil:
            GL.glClearBufferiv(GL.GL_STENCIL, 0, np.array([value], np.int32))


COMPLETE = int(GL.GL_FRAMEBUFFER_COMPLETE)


def make_window_target(width: int, height: int, texels: str = "RGBA") -> Target:
    """Make the window, which is never shown: 8-bit RGBA or other ``texels``, depth, stencil."""
    target = Target(
        "window",
        width,
        height,
        [Attachment("window", texels)],
        Attachment("window_depth", "DEPTH24_STENCIL8"),
    )
    target.allocate()
    # Clears are limited to the first viewport of a pass; elsewhere the depth is set here.
    target.bind(Rect(0.0, 0.0, float(width), float(height)))
    target.clear_depth(1.0)
    return target
