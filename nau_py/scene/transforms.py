"""Matrices: float64 (4, 4), column vectors, GL clip space (docs/format.md, 9.11 and 9.12)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import cos, radians, sin, tan

import numpy as np

from nau_py.model.linked import Project
from nau_py.model.node import Configured
from nau_py.scene.mesh import F64


def translation(vector: Sequence[float]) -> F64:
    matrix = np.eye(4)
    matrix[:3, 3] = vector[:3]
    return matrix


def scaling(vector: Sequence[float]) -> F64:
    return np.diag([*vector[:3], 1.0])


def rotation(axis_angle: Sequence[float]) -> F64:
    """Make a right-handed rotation about ``axis_angle[:3]`` by ``axis_angle[3]`` degrees.

    A zero axis gives the identity, as in Nau.
    """
    axis = np.asarray(axis_angle[:3], np.float64)
    length = np.linalg.norm(axis)
    if length == 0:
        return np.eye(4)
    x, y, z = axis / length
    angle = radians(axis_angle[3])
    c, s = cos(angle), sin(angle)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    outer = np.outer([x, y, z], [x, y, z])
    matrix = np.eye(4)
    matrix[:3, :3] = c * np.eye(3) + s * cross + (1 - c) * outer
    return matrix


def compose_transform(
    project: Project,
    node: Configured,
    type_: str,
    instead: Mapping[str, Sequence[float]] | None = None,
) -> F64:
    """Compose SCALE, TRANSLATE and ROTATE in the written TRANSFORM_ORDER, float64 (4, 4).

    ``instead``: values that replace those of the file.
    """

    def numbers(name: str) -> list[float]:
        if instead and name in instead:
            return list(instead[name])
        return [float(v) for v in project.value(node, type_, name)]

    parts = {
        "T": translation(numbers("TRANSLATE")),
        "R": rotation(numbers("ROTATE")),
        "S": scaling(numbers("SCALE")),
    }
    order = str(project.value(node, type_, "TRANSFORM_ORDER")[0]).split("_")
    result = np.eye(4)
    for letter in order:
        result = result @ parts.get(letter, np.eye(4))
    return result


def perspective(fov_degrees: float, aspect: float, near: float, far: float) -> F64:
    """Make an OpenGL perspective projection; ``fov_degrees`` is vertical (docs/format.md, 9.12)."""
    f = 1.0 / tan(radians(fov_degrees) / 2)
    matrix = np.zeros((4, 4))
    matrix[0, 0] = f / aspect
    matrix[1, 1] = f
    matrix[2, 2] = (far + near) / (near - far)
    matrix[2, 3] = 2 * far * near / (near - far)
    matrix[3, 2] = -1
    return matrix


def orthographic(
    left: float, right: float, bottom: float, top: float, near: float, far: float
) -> F64:
    """Make the matrix of glOrtho (OpenGL 2.1 reference page)."""
    matrix = np.eye(4)
    for row, (low, high) in enumerate(((left, right), (bottom, top), (-far, -near))):
        matrix[row, row] = 2 / (high - low)
        matrix[row, 3] = -(high + low) / (high - low)
    matrix[2, 2] = -2 / (far - near)
    matrix[2, 3] = -(far + near) / (far - near)
    return matrix


def to_unit_cube() -> F64:
    """Make the matrix from clip space to 0..1: T(0.5)·S(0.5)."""
    return translation((0.5, 0.5, 0.5)) @ scaling((0.5, 0.5, 0.5))


def inverse(matrix: F64) -> F64:
    """Invert a matrix; return a singular one as it is, as Nau does (9.12)."""
    try:
        return np.asarray(np.linalg.inv(matrix), np.float64)
    except np.linalg.LinAlgError:
        return matrix
