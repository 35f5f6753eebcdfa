"""Normals for models without them (docs/format.md, 10.2)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nau_py.scene.mesh import F64, normalize

CREASE = 0.01
"""Facets that share a vertex are smoothed when the dot product of their normals exceeds this."""


def compute_facet_normals(points: F64, triangles: NDArray[np.integer]) -> F64:
    """Compute unit normals of facets, float64 (m, 3); zero for degenerate triangles."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return normalize(np.cross(b - a, c - a))


def compute_smooth_normals(points: F64, triangles: NDArray[np.integer]) -> F64:
    """Compute unit normals of corners, float64 (3m, 3), in the order of the triangles."""
    facets = compute_facet_normals(points, triangles)
    corner_vertex = triangles.reshape(-1)
    corner_facet = np.repeat(np.arange(len(triangles)), 3)
    order = np.argsort(corner_vertex, kind="stable")
    sorted_vertex = corner_vertex[order]
    start = np.searchsorted(sorted_vertex, sorted_vertex, side="left")
    end = np.searchsorted(sorted_vertex, sorted_vertex, side="right")
    total = np.zeros((len(order), 3))
    own = facets[corner_facet[order]]
    for step in range(int((end - start).max(initial=0))):
        other = start + step
        valid = other < end
        neighbour = facets[corner_facet[order[np.minimum(other, len(order) - 1)]]]
        near = valid & (np.einsum("ij,ij->i", own, neighbour) > CREASE)
        total[near] += neighbour[near]
    result = np.empty_like(total)
    result[order] = normalize(total)
    return result
