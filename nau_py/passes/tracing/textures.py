"""Textures of a raytrace pass: inputs and mask, image files that rays read, the target."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from nau_py.diagnostics.diagnostic import warning
from nau_py.model.linked import Project
from nau_py.model.raytrace import RaytracePass
from nau_py.model.texture import Texture
from nau_py.passes.frame import FrameContext, Session
from nau_py.process.paths import resolve
from nau_py.raytrace.selection.mask import force_mask, read_mask
from nau_py.raytrace.tracing.ray_texture import RayTexture
from nau_py.scene.images import ImageError, load_image
from nau_py.scene.material import TextureBinding

if TYPE_CHECKING:
    from nau_py.raster.targets import Target


@dataclass(frozen=True, slots=True)
class RayInputs:
    """Input textures of a pass, read back from the GPU; row 0 at the bottom.

    ``variables``: (height, width, channels) by variable name; ``mask``: weights (height, width), or
    None for a pass without a mask.
    """

    variables: dict[str, NDArray[Any]]
    mask: NDArray[Any] | None


def read_inputs(pass_: RaytracePass, frame: FrameContext) -> RayInputs:
    """Read the input textures and the mask; the option ``mask`` overwrites the mask first."""
    resources, forced = frame.session.resources, frame.session.options.mask
    if forced != "project" and pass_.mask is not None:
        texture = resources.texture(pass_.mask.texture or "")
        if texture is not None:
            weight = float(forced == "all")
            texture.write_values(force_mask(pass_, texture.read_values(), weight))
    variables: dict[str, NDArray[Any]] = {}
    textures: dict[str, NDArray[Any]] = {}
    for source in pass_.rtInput:
        name = source.texture or ""
        texture = resources.texture(name)
        if source.var and texture is not None:
            if name not in textures:
                textures[name] = texture.read_values()
            variables[source.var] = textures[name]
    return RayInputs(variables, read_mask(pass_, textures))


def store_colours(target: Target, pixels: NDArray[np.int64], colours: NDArray[np.float32]) -> None:
    """Write colours to the first colour texture of a target; other pixels get the clear value.

    ``pixels`` int64 (n,): flat indices, row 0 at the bottom; ``colours``: RGBA float32 (n, 4).
    """
    texture = target.textures[target.colors[0].name]
    image = np.empty((target.width * target.height, 4), np.float32)
    image[:] = target.clear
    image[pixels] = colours
    channels = texture.format.channels
    texture.write_values(image.reshape(target.height, target.width, 4)[:, :, :channels])


def store_selected(target: Target, pixels: NDArray[np.int64], values: NDArray[Any]) -> None:
    """Do :func:`store_colours` for a whole image (height, width, channels) of floats or bytes."""
    chosen = values.reshape(-1, values.shape[2])[pixels].astype(np.float32)
    colours = np.zeros((len(pixels), 4), np.float32)
    colours[:, : values.shape[2]] = chosen / 255 if values.dtype == np.uint8 else chosen
    store_colours(target, pixels, colours)


class TextureCache:
    """Textures of materials that rays read, loaded once a session."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._textures: dict[TextureBinding, RayTexture | None] = {}

    def load(self, binding: TextureBinding) -> RayTexture | None:
        """Return the texture of a binding; None for one without an image file.

        An image that cannot be read is reported as F004.
        """
        if binding not in self._textures:
            path = binding.path or _find_image(self._session.project, binding.texture)
            self._textures[binding] = self._read(binding, path) if path is not None else None
        return self._textures[binding]

    def _read(self, binding: TextureBinding, path: Path) -> RayTexture | None:
        settings = {name: str(parts[0]) for name, parts in binding.sampler if parts}
        border = dict(binding.sampler).get("BORDER_COLOR", (0.0,) * 4)
        r, g, b, a = (*(float(v) for v in border), 0.0)[:4]
        try:
            return RayTexture(
                load_image(path),
                settings.get("WRAP_S", "REPEAT"),
                settings.get("WRAP_T", "REPEAT"),
                settings.get("MAG_FILTER") == "NEAREST",
                (r, g, b, a),
            )
        except ImageError as problem:
            message = f"texture '{binding.texture}': {problem}; rays see it as white"
            where = self._session.project.file.location
            self._session.resources.diagnostics.append(warning("F004", where, message))
            return None


def _find_image(project: Project, name: str) -> Path | None:
    """Return the image file of a library texture; None for one without a file."""
    node = project.names("texture").get(name)
    if isinstance(node, Texture) and node.filename:
        return resolve(Path(node.location.file).parent, node.filename).best
    return None
