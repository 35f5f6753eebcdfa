"""Media that a path is inside of: nested dielectrics by PRIORITY, and their absorption."""

from __future__ import annotations

from math import exp
from typing import Any

from nau_py.raytrace.kernels.core.jit import inner
from nau_py.raytrace.kernels.core.memory import field_reader
from nau_py.raytrace.kernels.core.tables import MATERIAL, material_at, media_of, set_media
from nau_py.raytrace.kernels.shading.radiance import scale_weight

absorption_of = field_reader(MATERIAL, "absorption")


@inner
def find_medium(scene: Any, path: Any, without: int) -> int:
    """Return the medium of highest PRIORITY of those that contain the path; -1 for vacuum.

    One entry of the medium ``without`` is left out.
    """
    best, rank = -1, 0
    skipped = False
    for m in media_of(path):
        if m < 0:
            continue
        if m == without and not skipped:
            skipped = True
            continue
        priority = material_at(scene.materials, m).priority
        if best < 0 or priority > rank:
            best, rank = m, priority
    return best


@inner
def apply_absorption(scene: Any, path: Any) -> None:
    """Weaken the path over the segment just traced: exp(-ABSORPTION · distance), the law of Beer
    and Lambert."""
    medium = find_medium(scene, path, -1)
    if medium < 0:
        return
    a = absorption_of(material_at(scene.materials, medium))
    t = float(path.t)
    scale_weight(path, (exp(-a[0] * t), exp(-a[1] * t), exp(-a[2] * t)))


@inner
def replace_medium(path: Any, old: int, new: int) -> None:
    """Put ``new`` in the place of the first medium ``old``; drop it if there is no place."""
    a, b, c, d = media_of(path)
    if a == old:
        set_media(path, (new, b, c, d))
    elif b == old:
        set_media(path, (a, new, c, d))
    elif c == old:
        set_media(path, (a, b, new, d))
    elif d == old:
        set_media(path, (a, b, c, new))


@inner
def refractive_index(scene: Any, medium: int) -> float:
    """Return the refractive index of a medium; 1 for vacuum."""
    if medium < 0:
        return 1.0
    return float(material_at(scene.materials, medium).index_of_refraction)
