"""Warnings about triangles that rays cannot hit well."""

from __future__ import annotations

from pathlib import Path

from nau_py.diagnostics.diagnostic import Diagnostic, warning
from nau_py.model.passes import Pass
from nau_py.raytrace.tracing.geometry import PRECISION, DroppedFaces, measure_precision
from nau_py.scene.mesh import SceneObject


def find_face_faults(
    pass_: Pass, objects: list[SceneObject], dropped: DroppedFaces
) -> list[Diagnostic]:
    """Return M005 for faces that are left out, M006 for objects that float32 rounds too much."""
    found = []
    for reason, count in dropped.counts.items():
        name, face = dropped.first[reason]
        message = (
            f"pass '{pass_.name}': {count} faces are {reason} and left out of ray tracing; the "
            f"first is face {face} of '{Path(name).name}'"
        )
        found.append(warning("M005", pass_.location, message))
    for item in objects:
        step, feature = measure_precision(item)
        if step > PRECISION * feature:
            message = (
                f"pass '{pass_.name}': the coordinates of '{Path(item.name).name}' are rounded to "
                f"{step:g}, its smallest triangle measures {feature:g}"
            )
            found.append(warning("M006", pass_.location, message))
    return found
