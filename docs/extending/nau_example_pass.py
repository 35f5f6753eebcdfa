"""A pass class: ``vignette`` darkens its render target towards the corners."""

from __future__ import annotations

import numpy as np

from nau_py.plugin import (
    Access,
    DataType,
    FrameContext,
    Pass,
    PassClass,
    PassReport,
    Project,
    add_target,
    number,
    pass_value,
    register_pass,
    resolve_view,
)


@register_pass("vignette")
class Vignette(PassClass):
    """Darkens its render target towards the corners."""

    parameters = (
        number(
            "STRENGTH",
            DataType.FLOAT,
            0.5,
            "Light that the corners lose.",
            minimum=0.0,
            maximum=1.0,
            unit="share of the light",
        ),
    )

    def access(self, project: Project, pass_: Pass) -> Access:
        """Read the target and draw over it: nothing is cleared."""
        access = Access()
        add_target(access, project, pass_, clears=False)
        for resource in access.writes:
            access.add_read(resource)
            access.keeps.append(resource)
        return access

    def execute(self, pass_: Pass, frame: FrameContext) -> PassReport:
        """Multiply by 1 in the middle, by 1 - STRENGTH in a corner, quadratic between."""
        target = resolve_view(pass_, frame).target
        texture = target.textures[target.colors[0].name]
        values = texture.read_values()
        height, width = values.shape[:2]
        y, x = np.mgrid[0:height, 0:width].astype(np.float32)
        across, up = (x + 0.5) / width * 2 - 1, (y + 0.5) / height * 2 - 1
        strength = float(pass_value(frame.project, pass_, "STRENGTH"))
        factor = 1 - strength * (across**2 + up**2) / 2
        values[:, :, :3] *= factor[:, :, None]
        texture.write_values(values)
        return PassReport(pixels=width * height)
