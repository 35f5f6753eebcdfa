"""Reading of pictures and targets back from OpenGL."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from nau_py.graph.plan import Plan
from nau_py.graph.resource import WINDOW

if TYPE_CHECKING:
    from nau_py.raster.resources import Resources


def read_targets(plan: Plan, resources: Resources) -> dict[str, NDArray[Any]]:
    """Return the textures that running passes write, by qualified name.

    Arrays are (height, width, channels), row 0 at the top, of native dtype; layered textures are
    left out.
    """
    targets: dict[str, NDArray[Any]] = {}
    for step in plan.running:
        for resource in step.access.writes:
            if resource.kind != "texture" or resource.name in targets:
                continue
            texture = resources.texture(resource.name)
            if texture is not None and texture.layers == 1:
                targets[resource.name] = np.ascontiguousarray(texture.read()[::-1])
    return targets


def read_image(
    plan: Plan, resources: Resources, targets: dict[str, NDArray[Any]]
) -> NDArray[Any] | None:
    """Return the picture of a frame, row 0 at the top; None where no pass draws one.

    It is the window, or the target of a plan that draws into no window.
    """
    if not plan.running:
        return None
    if plan.output == WINDOW:
        return read_window(resources)
    return targets.get(plan.output.name)


def read_window(resources: Resources) -> NDArray[Any]:
    """Return the colours of the window, (height, width, 4), row 0 at the top."""
    window = next(iter(resources.window.textures.values()))
    return np.ascontiguousarray(window.read()[::-1])
