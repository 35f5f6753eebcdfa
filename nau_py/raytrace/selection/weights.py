"""Selectors to weights: a weight for each pixel from the surface that it shows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from nau_py.model.maps import match_pattern
from nau_py.model.mask import (
    AndSelector,
    DistanceSelector,
    GazeSelector,
    MaterialSelector,
    NotSelector,
    PropertySelector,
    RegionSelector,
    ShadowBorderSelector,
    TextureSelector,
)
from nau_py.model.node import Node
from nau_py.model.raytrace import component
from nau_py.scene.mesh import F32, F64

NEIGHBOURS = [(dx, dy) for dy in (-1, 0, 1) for dx in (-1, 0, 1) if dx or dy]
"""Offsets of the eight texels around one."""
SHADOW_BIAS = 0.002
"""Default bias of ``shadowBorder``, in units of the shadow map's depth."""


@dataclass
class VisibleSurfaces:
    """The surfaces that a picture shows. Row 0 at the bottom.

    ``position`` float32 (h, w, 3), world space; ``item`` int32 (h, w): index into ``materials``, -1
    for the background; ``materials``: name and COLOR attributes; ``eye``: camera position.
    ``textures``: images (h, w, channels) that selectors name; ``cameras``: matrices from world
    space to the unit cube, float64 (4, 4), of the shadow cameras by name.
    """

    position: F32
    item: NDArray[np.int32]
    materials: list[tuple[str, dict[str, tuple[float, ...]]]]
    eye: F64
    textures: dict[str, NDArray[np.floating]] = field(default_factory=dict)
    cameras: dict[str, F64] = field(default_factory=dict)

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width in pixels."""
        height, width = self.item.shape
        return int(height), int(width)


def compute_weights(selectors: list[Node], surfaces: VisibleSurfaces) -> F32:
    """Return the weight of every pixel, float32 (h, w) in 0..1.

    Several selectors count as ``or``; without a selector every weight is 1. A weight that is not a
    number becomes 1, so that the pixel is traced.
    """
    if not selectors:
        return np.ones(surfaces.shape, np.float32)
    found = np.max([_evaluate(s, surfaces) for s in selectors], axis=0)
    sound = np.nan_to_num(found, nan=1.0)
    return np.asarray(np.clip(sound, 0.0, 1.0), np.float32)


def _evaluate(selector: Node, surfaces: VisibleSurfaces) -> F64:
    """Return the weights of one selector, float64 (h, w)."""
    if isinstance(selector, MaterialSelector):
        return _match_materials(surfaces, lambda name, _: match_pattern(selector.name or "", name))
    if isinstance(selector, PropertySelector):
        return _match_materials(surfaces, lambda _, colours: _is_between(selector, colours))
    if isinstance(selector, RegionSelector):
        return _evaluate_region(selector, surfaces)
    if isinstance(selector, DistanceSelector):
        return _evaluate_distance(selector, surfaces)
    if isinstance(selector, GazeSelector):
        return _evaluate_gaze(selector, surfaces)
    if isinstance(selector, ShadowBorderSelector):
        return _evaluate_shadow_border(selector, surfaces)
    if isinstance(selector, TextureSelector):
        values = surfaces.textures[selector.name or ""]
        return np.asarray(values[..., component(selector.component, values.shape[2])], np.float64)
    parts = [_evaluate(part, surfaces) for part in selector.parts]  # type: ignore[attr-defined]
    if isinstance(selector, AndSelector):
        return np.min(parts, axis=0) if parts else np.ones(surfaces.shape)
    greatest: F64 = np.max(parts, axis=0) if parts else np.zeros(surfaces.shape)
    return 1.0 - greatest if isinstance(selector, NotSelector) else greatest


def _match_materials(
    surfaces: VisibleSurfaces, test: Callable[[str, dict[str, tuple[float, ...]]], bool]
) -> F64:
    """Return 1 for pixels whose material passes ``test``, else 0."""
    table = np.array([*(test(name, colours) for name, colours in surfaces.materials), False], float)
    return np.asarray(table[surfaces.item])  # index -1, the background, reads the last entry


def _is_between(selector: PropertySelector, colours: dict[str, tuple[float, ...]]) -> bool:
    """Test if the greatest component of a colour is between the bounds."""
    parts = colours.get(selector.name or "")
    if parts is None:
        return False
    value = max(parts[:3])
    above = selector.above is None or value > selector.above
    return above and (selector.below is None or value < selector.below)


def _pixel_centres(surfaces: VisibleSurfaces) -> tuple[F64, F64]:
    """Return x and y of the pixel centres, in pixels."""
    height, width = surfaces.shape
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    return x, y


def _evaluate_region(selector: RegionSelector, surfaces: VisibleSurfaces) -> F64:
    """Return 1 inside a rectangle, falling linearly to 0 over ``edge`` pixels about its border."""
    height, width = surfaces.shape
    x, y = _pixel_centres(surfaces)
    left = (selector.x or 0.0) * width
    low = (selector.y or 0.0) * height
    right = left + (1.0 if selector.width is None else selector.width) * width
    top = low + (1.0 if selector.height is None else selector.height) * height
    inside = np.minimum(np.minimum(x - left, right - x), np.minimum(y - low, top - y))
    edge = selector.edge or 0.0
    if edge <= 0:
        return np.asarray(inside > 0, np.float64)
    return np.clip(inside / edge + 0.5, 0.0, 1.0)


def _interpolate_falloff(value: F64, full: float, end: float, floor: float) -> F64:
    """Return 1 up to ``full``, linear from there to ``floor`` at ``end``, then constant."""
    if end <= full:
        return np.where(value <= full, 1.0, floor)
    return 1.0 - (1.0 - floor) * np.clip((value - full) / (end - full), 0.0, 1.0)


def _evaluate_distance(selector: DistanceSelector, surfaces: VisibleSurfaces) -> F64:
    """Return weights that fall with the distance from the camera, world units."""
    d = np.sqrt(((surfaces.position.astype(np.float64) - surfaces.eye) ** 2).sum(axis=-1))
    d = np.where(surfaces.item < 0, np.inf, d)
    near = selector.near or 0.0
    far = near if selector.far is None else selector.far
    return _interpolate_falloff(d, near, far, selector.floor or 0.0)


def _evaluate_gaze(selector: GazeSelector, surfaces: VisibleSurfaces) -> F64:
    """Return weights that fall with the distance from a point of the image, in its heights."""
    height, width = surfaces.shape
    x, y = _pixel_centres(surfaces)
    px = (0.5 if selector.x is None else selector.x) * width
    py = (0.5 if selector.y is None else selector.y) * height
    r = np.hypot(x - px, y - py) / height
    inner = selector.inner or 0.0
    outer = inner if selector.outer is None else selector.outer
    return _interpolate_falloff(r, inner, outer, selector.floor or 0.0)


def _evaluate_shadow_border(selector: ShadowBorderSelector, surfaces: VisibleSurfaces) -> F64:
    """Return 1 where a shadow map's texel and its eight neighbours are partly lit, partly shadowed.

    With ``spread``, only where the blocker is far enough away for its penumbra to reach the pixel.
    A neighbour is compared with the plane of the surface there, not with the point: Isidoro,
    *Shadow Mapping: GPU-based Tips and Techniques*, 2006 (receiver plane depth bias).
    """
    depth = np.asarray(surfaces.textures[selector.texture or ""][..., 0], np.float64)
    rows, columns = depth.shape
    p = surfaces.position.astype(np.float64).reshape(-1, 3)
    clip = np.column_stack([p, np.ones(len(p))]) @ surfaces.cameras[selector.camera or ""].T
    with np.errstate(divide="ignore", invalid="ignore"):
        unit = clip[:, :3] / clip[:, 3:]
    unit = np.where(np.isfinite(unit), unit, -1.0)
    inside = ((unit >= 0) & (unit <= 1)).all(axis=1) & (surfaces.item.reshape(-1) >= 0)
    slope_u, slope_v, towards = _compute_receiver_plane(unit.reshape(*surfaces.shape, 3))
    column = np.floor(unit[:, 0] * columns).astype(np.int64)
    row = np.floor(unit[:, 1] * rows).astype(np.int64)
    step = max(selector.radius or 1, 1)
    bias = SHADOW_BIAS if selector.bias is None else selector.bias
    matrix = surfaces.cameras[selector.camera or ""]
    reach = 0.0
    if selector.spread:  # gap in map depth from which a penumbra is as wide as the step
        across, along = _projection_scale(matrix, p, unit, clip[:, 3])
        reach = step / columns / across / selector.spread * along
    centre = depth[np.clip(row, 0, rows - 1), np.clip(column, 0, columns - 1)]
    hidden, wide = unit[:, 2] > centre + bias, unit[:, 2] - centre >= reach
    found = np.zeros(len(p), bool)
    for dx, dy in NEIGHBOURS:
        at = depth[
            np.clip(row + dy * step, 0, rows - 1), np.clip(column + dx * step, 0, columns - 1)
        ]
        plane = unit[:, 2] + slope_u * (dx * step / columns) + slope_v * (dy * step / rows)
        there = plane > at + bias
        found |= np.where(hidden, ~there & wide, there & (plane - at >= reach))
    return (inside & towards & found).reshape(surfaces.shape).astype(np.float64)


def _projection_scale(matrix: F64, points: F64, unit: F64, w: F64) -> tuple[F64, F64]:
    """Return map units per world unit at ``points``, across and along the light's view, (n,) each.

    They are lengths of the derivative of the projection.
    """
    lengths = [
        np.sqrt((((matrix[k, :3] - unit[:, k, None] * matrix[3, :3]) / w[:, None]) ** 2).sum(1))
        for k in (0, 2)
    ]
    return lengths[0], lengths[1]


def _compute_receiver_plane(unit: F64) -> tuple[F64, F64, NDArray[np.bool_]]:
    """Return the change of depth along u and v of the surface, and if it faces the light; (n,).

    ``unit`` (h, w, 3): coordinates in the map. A surface seen from its lit side keeps its
    orientation in the map, one seen from its dark side is mirrored there. Of the differences to
    the two neighbours the smaller is used: the larger may cross an edge.
    """

    def difference(axis: int) -> F64:
        step = np.diff(unit, axis=axis)
        ahead = np.concatenate([step, step.take([-1], axis=axis)], axis=axis)
        behind = np.concatenate([step.take([0], axis=axis), step], axis=axis)
        nearer = np.abs(ahead).sum(axis=-1) <= np.abs(behind).sum(axis=-1)
        return np.where(nearer[..., None], ahead, behind)

    x, y = difference(1), difference(0)
    det = x[..., 0] * y[..., 1] - x[..., 1] * y[..., 0]
    safe = np.where(np.abs(det) > 1e-20, det, np.inf)
    along_u = (x[..., 2] * y[..., 1] - y[..., 2] * x[..., 1]) / safe
    along_v = (y[..., 2] * x[..., 0] - x[..., 2] * y[..., 0]) / safe
    return along_u.reshape(-1), along_v.reshape(-1), (det > 0).reshape(-1)
