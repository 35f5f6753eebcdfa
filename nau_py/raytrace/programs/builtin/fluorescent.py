"""``fluorescent``: diffuse path tracing of surfaces that re-emit light in other bands."""

from __future__ import annotations

from typing import Any

from nau_py.model.attribute import colour
from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.memory import field_reader
from nau_py.raytrace.kernels.core.sampling import sample_2d
from nau_py.raytrace.kernels.core.tables import MATERIAL
from nau_py.raytrace.kernels.shading.closest_hit import evaluate_albedo
from nau_py.raytrace.kernels.shading.emitters import add_emission
from nau_py.raytrace.kernels.shading.radiance import add_coverage, scale_weight
from nau_py.raytrace.kernels.shading.scatter import FOURTH, hit_dimension
from nau_py.raytrace.programs.builtin.path import light_diffuse_surface
from nau_py.raytrace.programs.description import CLOSEST_HIT, BuiltInProgram, Effect, LightUse

_red_of = field_reader(MATERIAL, "fluorescence_red")
_green_of = field_reader(MATERIAL, "fluorescence_green")
_blue_of = field_reader(MATERIAL, "fluorescence_blue")
Matrix = tuple[float, float, float, float, float, float, float, float, float]


@inner
def reradiation_of(material: Any) -> Matrix:
    """Return the re-radiation matrix, row-major, [emitted band, absorbed band]."""
    r, g, b = _red_of(material), _green_of(material), _blue_of(material)
    return r[0], g[0], b[0], r[1], g[1], b[1], r[2], g[2], b[2]


@inner
def choose_band(scene: Any, path: Any, material: Any, albedo: V3) -> V3:
    """Choose the band whose light the path follows, and weight the path accordingly.

    The re-radiation matrix is diag(albedo) + FLUORESCENCE. Return the albedo that the path has
    after the choice.
    """
    matrix = reradiation_of(material)
    if path.band >= 0:
        b = path.band
        row = (
            matrix[3 * b] + (albedo[0] if b == 0 else 0.0),
            matrix[3 * b + 1] + (albedo[1] if b == 1 else 0.0),
            matrix[3 * b + 2] + (albedo[2] if b == 2 else 0.0),
        )
        total = row[0] + row[1] + row[2]
    else:
        row = (
            matrix[0] + matrix[3] + matrix[6] + albedo[0],
            matrix[1] + matrix[4] + matrix[7] + albedo[1],
            matrix[2] + matrix[5] + matrix[8] + albedo[2],
        )
        total = row[0] + row[1] + row[2]
    if not total > 0.0:
        return (0.0, 0.0, 0.0)
    x, _ = sample_2d(scene.seed, path.pixel, path.sample, hit_dimension(path, FOURTH))
    chosen = 0
    if x * total >= row[0]:
        chosen = 1
    if x * total >= row[0] + row[1] and row[2] > 0.0:
        chosen = 2
    probability = row[chosen] / total
    if not probability > 0.0:
        return (0.0, 0.0, 0.0)
    if path.band >= 0:
        scale = row[chosen] / probability
        path.band = chosen
        return (scale, scale, scale)
    scale_weight(
        path,
        (
            (matrix[chosen] + (albedo[0] if chosen == 0 else 0.0)) / probability,
            (matrix[3 + chosen] + (albedo[1] if chosen == 1 else 0.0)) / probability,
            (matrix[6 + chosen] + (albedo[2] if chosen == 2 else 0.0)) / probability,
        ),
    )
    path.band = chosen
    return (1.0, 1.0, 1.0)


@inner
def shade_fluorescent(scene: Any, tile: Any, ray_type: int, path: Any, hit: Any) -> bool:
    """Add EMISSION and light of one band; continue the path in that band."""
    add_coverage(tile, path)
    add_emission(scene, tile, path, hit.material, hit.face)
    albedo = choose_band(scene, path, hit.material, evaluate_albedo(scene, hit))
    return light_diffuse_surface(scene, tile, ray_type, path, hit, albedo)


_MATRIX = tuple(
    colour(
        f"FLUORESCENCE_{band}",
        (0.0, 0.0, 0.0, 1.0),
        f"nau_py: what `fluorescent` emits for the {band.lower()} light that it absorbs.",
    )
    for band in ("RED", "GREEN", "BLUE")
)
PROGRAM = BuiltInProgram(
    "fluorescent",
    CLOSEST_HIT,
    "As `path`, with light re-emitted in other bands by FLUORESCENCE_RED, _GREEN and _BLUE.",
    shade_fluorescent,
    attributes=_MATRIX,
    effects=(
        Effect("indirect", recursive=True),
        Effect(
            "fluorescence", tuple(a.name for a in _MATRIX), recursive=True, zeroes_attributes=True
        ),
    ),
    lights=LightUse.EMITTERS,
)
