"""Textures, buffers and parameters as compiled programs see them."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from nau_py.diagnostics.diagnostic import warning
from nau_py.model.raytrace import RaytracePass, RayVariable
from nau_py.model.texture import Texture
from nau_py.process.paths import resolve as resolve_path

if TYPE_CHECKING:
    from nau_py.passes.frame import Session
    from nau_py.raytrace.kernels.geometry.cuda_texture import Image
    from nau_py.scene.material import TextureBinding


class Resources:
    """What programs have the addresses of; textures of files are read once, those that passes
    write in every frame."""

    def __init__(self, session: Session, pass_: RaytracePass) -> None:
        self.session = session
        weights = session.project.value(pass_, "PASS", "TEXTURE_WEIGHTS")[0]
        self._exact = weights == "EXACT"
        self._images: dict[tuple[str, object], Image | None] = {}
        self._now: list[Image] = []
        self._buffers: dict[str, NDArray[np.uint8]] = {}

    def begin_frame(self) -> None:
        self._now, self._buffers = [], {}

    def image(
        self, name: str, path: Path | None = None, how: TextureBinding | None = None
    ) -> Image | None:
        """A texture of the project or of a model; None, with a finding, where it has no file.
        ``how``: its sampler counts, as in class ``optix``."""
        from nau_py.scene.images import ImageError

        settings = dict(how.sampler) if how is not None else None
        key = (str(path) if path is not None else name, how.sampler if how else None)
        if key not in self._images:
            if path is None:
                node = self.session.project.names("texture").get(name)
                if isinstance(node, Texture) and node.filename:
                    path = resolve_path(Path(node.location.file).parent, node.filename).best
            self._images[key] = None
            try:
                if path is not None:
                    self._images[key] = _sampled(_texels(path), settings, self._exact)
            except (ImageError, OSError, ValueError) as problem:
                where = self.session.project.file.location
                said = f"texture '{name}': {problem}; rays see none"
                self.session.resources.diagnostics.append(warning("F004", where, said))
        return self._images[key]

    def drawn(self, name: str, by_texel: bool = False) -> Image | None:
        """A texture that passes write, as it is in this frame. ``by_texel``: coordinates count
        texels, the nearest one is read, and the last one goes on."""
        from nau_py.raster import gl
        from nau_py.raytrace.kernels.geometry.cuda_texture import Image

        texture = self.session.resources.texture(name)
        if texture is None:
            return None
        format_ = texture.format
        shape = (max(texture.layers, 1), texture.height, texture.width, format_.channels)
        out = np.empty(shape, format_.dtype)
        gl.read_texture(texture.glo, 0, format_.layout, format_.kind, out)
        values = out if format_.dtype == np.uint8 else out.astype(np.float32)
        texels = values[0] if len(values) == 1 else values
        made = Image(texels, exact=self._exact)
        if by_texel:
            made = Image(texels, False, (True, True), True)
        self._now.append(made)
        return made

    def memory(self, name: str) -> int:
        """The address of a copy of a GPU buffer, which :meth:`give_back` writes back, or 0."""
        buffer = self.session.resources.buffer(name)
        if buffer is None:
            return 0
        if name not in self._buffers:
            self._buffers[name] = np.frombuffer(bytearray(buffer.read()), np.uint8)
        return int(self._buffers[name].ctypes.data)

    def give_back(self) -> None:
        """Write the buffers that programs may have changed."""
        for name, data in self._buffers.items():
            self.session.resources.buffer(name).write(data.tobytes())

    def packed(self, node: RayVariable, context: Any) -> bytes:
        """The value of a parameter or variable."""
        from nau_py.raster.semantics import resolve_source

        type_, name, component = node.type or "", node.context or "CURRENT", node.component or ""
        if type_ == "TEXTURE" and component == "ID":
            image = self.image(name) or self.drawn(name)
            return struct.pack("<Q", image.handle if image is not None else 0)
        if type_ == "BUFFER" and component == "ID":
            return struct.pack("<Q", self.memory(name))
        set_ = self.session.project.registry.get(type_)
        attribute = set_.get(component) if set_ is not None else None
        value = resolve_source(context, type_, name, component, node.id or 0)
        samples = self.session.options.samples
        if (type_, component) == ("PASS", "RAYS_PER_PIXEL") and samples:
            value = np.array([samples])
        if attribute is None or value is None:
            count = attribute.type.components if attribute is not None else 1
            said = f"parameter '{node.name}' of pass: {type_} '{name}' has no {component}; it is 0"
            self.session.resources.diagnostics.append(warning("L007", node.location, said))
            return bytes(4 * count)
        whole = attribute.type.is_integer or attribute.type.is_boolean
        return np.asarray(value).astype(np.int32 if whole else np.float32).tobytes()


def _sampled(texels: Any, settings: dict[str, Any] | None, exact: bool) -> Image:
    from nau_py.raytrace.kernels.geometry.cuda_texture import Image

    if settings is None:
        return Image(texels, exact=exact)
    named = {name: str(parts[0]) for name, parts in settings.items() if parts}
    clamp = tuple(named.get(f"WRAP_{axis}") == "CLAMP_TO_EDGE" for axis in "ST")
    between = named.get("MAG_FILTER") != "NEAREST"
    return Image(texels, between, (clamp[0], clamp[1]), exact=exact)


def _texels(path: Path) -> Any:
    """Of an image, bytes; of a volume, bytes or floats."""
    from nau_py.scene.images import load_image
    from nau_py.scene.volume import is_volume, load_volume

    if not is_volume(path):
        return load_image(path)
    values = load_volume(path)
    kept = values if values.dtype == np.uint8 else values.astype(np.float32)
    return kept[..., None]
