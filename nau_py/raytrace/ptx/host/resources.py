"""Textures, buffers and parameter values at the addresses that compiled programs read."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.diagnostics.diagnostic import warning
from nau_py.model.raytrace import RayVariable
from nau_py.model.texture import Texture
from nau_py.process.paths import resolve
from nau_py.raytrace.kernels.geometry.cuda_texture import Image
from nau_py.raytrace.ptx.host.inputs import GpuAccess, PassSetup
from nau_py.scene.images import ImageError, load_image
from nau_py.scene.material import RenderMaterial, TextureBinding
from nau_py.scene.volume import is_volume, load_volume


class ProgramResources:
    """Memory that programs read and write.

    Textures of files are read once. Textures and buffers of the GPU are copied in every frame,
    between :meth:`begin_frame` and :meth:`write_buffers`.
    """

    def __init__(self, setup: PassSetup) -> None:
        self.project = setup.project
        weights = setup.project.value(setup.pass_, "PASS", "TEXTURE_WEIGHTS")[0]
        self._exact = weights == "EXACT"
        self._images: dict[tuple[str, object], Image | None] = {}
        self._copies: list[Image] = []
        self._buffers: dict[str, NDArray[np.uint8]] = {}

    def begin_frame(self) -> None:
        """Free the copies of the frame before."""
        self._copies, self._buffers = [], {}

    def load_image(
        self,
        gpu: GpuAccess,
        name: str,
        path: Path | None = None,
        binding: TextureBinding | None = None,
    ) -> Image | None:
        """Return a texture of an image file, of the project or of a model (``path``).

        ``binding``: sets wrapping and filter, as in class ``optix``. None for a texture without a
        file, or with one that cannot be read, which is reported as F004.
        """
        settings = dict(binding.sampler) if binding is not None else None
        key = (str(path) if path is not None else name, binding.sampler if binding else None)
        if key not in self._images:
            if path is None:
                node = self.project.names("texture").get(name)
                if isinstance(node, Texture) and node.filename:
                    path = resolve(Path(node.location.file).parent, node.filename).best
            self._images[key] = None
            try:
                if path is not None:
                    self._images[key] = _make_image(_read_texels(path), settings, self._exact)
            except (ImageError, OSError, ValueError) as problem:
                message = f"texture '{name}': {problem}; rays see none"
                gpu.report(warning("F004", self.project.file.location, message))
        return self._images[key]

    def copy_texture(self, gpu: GpuAccess, name: str, by_texel: bool = False) -> Image | None:
        """Copy a texture that passes write. None if it is undefined.

        ``by_texel``: coordinates count texels, the nearest texel is read, and those at the edges
        continue outside.
        """
        values = gpu.read_texture(name)
        if values is None:
            return None
        if values.dtype != np.uint8:
            values = values.astype(np.float32)
        texels = values[0] if len(values) == 1 else values
        if by_texel:
            made = Image(texels, False, (True, True), True)
        else:
            made = Image(texels, exact=self._exact)
        self._copies.append(made)
        return made

    def copy_buffer(self, gpu: GpuAccess, name: str) -> int:
        """Copy a buffer; :meth:`write_buffers` writes it back. Returns its address, 0 for none."""
        if name not in self._buffers:
            data = gpu.read_buffer(name)
            if data is None:
                return 0
            self._buffers[name] = np.frombuffer(bytearray(data), np.uint8)
        return int(self._buffers[name].ctypes.data)

    def write_buffers(self, gpu: GpuAccess) -> None:
        """Write the copied buffers, which programs may have changed."""
        for name, data in self._buffers.items():
            gpu.write_buffer(name, data.tobytes())

    def pack_value(
        self,
        gpu: GpuAccess,
        node: RayVariable,
        material: RenderMaterial | None = None,
        samples: int | None = None,
    ) -> bytes:
        """Return the bytes of a parameter or variable.

        ``samples``: replaces RAYS_PER_PIXEL. A value that does not exist is reported as L007, and
        is 0.
        """
        type_, name, component = node.type or "", node.context or "CURRENT", node.component or ""
        if type_ == "TEXTURE" and component == "ID":
            image = self.load_image(gpu, name) or self.copy_texture(gpu, name)
            return struct.pack("<Q", image.handle if image is not None else 0)
        if type_ == "BUFFER" and component == "ID":
            return struct.pack("<Q", self.copy_buffer(gpu, name))
        set_ = self.project.registry.get(type_)
        attribute = set_.get(component) if set_ is not None else None
        value = gpu.resolve_value(node, material)
        if (type_, component) == ("PASS", "RAYS_PER_PIXEL") and samples:
            value = np.array([samples])
        if attribute is None or value is None:
            count = attribute.type.components if attribute is not None else 1
            text = f"parameter '{node.name}' of pass: {type_} '{name}' has no {component}; it is 0"
            gpu.report(warning("L007", node.location, text))
            return bytes(4 * count)
        whole = attribute.type.is_integer or attribute.type.is_boolean
        return np.asarray(value).astype(np.int32 if whole else np.float32).tobytes()


def _make_image(texels: NDArray[Any], settings: dict[str, Any] | None, exact: bool) -> Image:
    if settings is None:
        return Image(texels, exact=exact)
    named = {name: str(parts[0]) for name, parts in settings.items() if parts}
    clamp = tuple(named.get(f"WRAP_{axis}") == "CLAMP_TO_EDGE" for axis in "ST")
    between = named.get("MAG_FILTER") != "NEAREST"
    return Image(texels, between, (clamp[0], clamp[1]), exact=exact)


def _read_texels(path: Path) -> NDArray[Any]:
    """Read an image (bytes) or a volume (bytes or floats)."""
    if not is_volume(path):
        return load_image(path)
    values = load_volume(path)
    kept: NDArray[Any] = values if values.dtype == np.uint8 else values.astype(np.float32)
    return kept[..., None]
