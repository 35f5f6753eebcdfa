"""Triangles with their neighbours, for geometry shaders (docs/format.md, 10.9)."""

from __future__ import annotations

import numpy as np

from nau_py.scene.mesh import U32


def add_neighbours(triangles: U32) -> U32:
    """Add the neighbours of triangles: uint32 (m, 3) to (m, 6).

    After each corner comes the far corner of the triangle beyond the edge that begins there, or at
    an open edge the corner again. The order is that of GL_TRIANGLES_ADJACENCY (OpenGL 4.5
    specification, 10.1.14), from the third corner on, as in Nau. Neighbours share two vertices;
    equal positions do not count.
    """
    if not len(triangles):
        return np.zeros((0, 6), np.uint32)
    wide = triangles.astype(np.int64)
    a, b, c = wide.T
    size = int(wide.max()) + 1
    starts, ends = np.stack([c, a, b], axis=1), np.stack([a, b, c], axis=1)
    far = np.stack([b, c, a], axis=1)
    keys, twins = (starts * size + ends).reshape(-1), (ends * size + starts).reshape(-1)
    order = np.argsort(keys, kind="stable")  # of equal edges the last one counts
    at = np.searchsorted(keys[order], twins, side="right") - 1
    candidate = order[np.maximum(at, 0)]
    known = (at >= 0) & (keys[candidate] == twins)
    beyond = np.where(known, far.reshape(-1)[candidate], starts.reshape(-1)).reshape(-1, 3)
    return np.stack([starts, beyond], axis=2).reshape(-1, 6).astype(np.uint32)
