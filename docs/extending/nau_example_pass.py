"""A pass class: ``vignette`` darkens its render target towards the corners."""

from __future__ import annotations

import numpy as np

from nau_py.graph.contract import Access
from nau_py.model.linked import Project
from nau_py.model.passes import Pass
from nau_py.passes.access import add_target
from nau_py.passes.drawing import resolve_view
from nau_py.passes.frame import FrameContext
from nau_py.passes.registry import PassClass, register_pass
from nau_py.passes.report import PassReport

STRENGTH = 0.5
"""What is left of the light in the corners."""


@register_pass("vignette")
class Vignette(PassClass):
    """Darkens its render target towards the corners."""

    def access(self, project: Project, pass_: Pass) -> Access:
        """Reads its target and draws over it: nothing is cleared."""
        access = Access()
        add_target(access, project, pass_, clears=False)
        for resource in access.writes:
            access.add_read(resource)
            access.keeps.append(resource)
        return access

    def execute(self, pass_: Pass, frame: FrameContext) -> PassReport:
        target = resolve_view(pass_, frame).target
        texture = target.textures[target.colors[0].name]
        values = texture.read_values()
        height, width = values.shape[:2]
        y, x = np.mgrid[0:height, 0:width].astype(np.float32)
        across, up = (x + 0.5) / width * 2 - 1, (y + 0.5) / height * 2 - 1
        factor = 1 - (1 - STRENGTH) * (across**2 + up**2) / 2
        values[:, :, :3] *= factor[:, :, None]
        texture.write_values(values)
        return PassReport(pixels=width * height)
