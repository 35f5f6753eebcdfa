"""Triangles with neighbours."""

from __future__ import annotations

import numpy as np

from nau_py.scene.adjacency import add_neighbours
from nau_py.scene.primitives import make_sphere


def test_two_triangles_see_each_other() -> None:
    """A square of two triangles that share the edge 0-2: beyond it each sees the other's corner,
    beyond open edges the edge's own start."""
    found = add_neighbours(np.array([[0, 1, 2], [0, 2, 3]], np.uint32))
    corners, beyond = found[:, ::2], found[:, 1::2]
    assert corners.tolist() == [[2, 0, 1], [3, 0, 2]]
    assert beyond.tolist() == [[3, 0, 1], [3, 1, 2]]


def test_neighbours_of_a_closed_mesh_are_mutual() -> None:
    """A tetrahedron: beyond every edge lies the fourth corner."""
    faces = np.array([[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]], np.uint32)
    found = add_neighbours(faces)
    for face, row in zip(faces, found):
        missing = ({0, 1, 2, 3} - set(face.tolist())).pop()
        assert row[1::2].tolist() == [missing] * 3


def test_a_slow_search_finds_the_same() -> None:
    faces = make_sphere(12, 7, "m").groups[0].indices
    found = add_neighbours(faces)
    edges = {}
    for face in faces.tolist():
        for k in range(3):
            edges[face[k], face[(k + 1) % 3]] = face[(k + 2) % 3]
    for row in found.tolist():
        for k in range(0, 6, 2):
            start, end = row[k], row[(k + 2) % 6]
            assert row[k + 1] == edges.get((end, start), start)


def test_no_triangle() -> None:
    assert add_neighbours(np.zeros((0, 3), np.uint32)).shape == (0, 6)
