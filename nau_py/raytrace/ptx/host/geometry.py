"""Geometry of a pass: triangles of the scene's objects, by material.

As in Nau, geometry is taken once, at the first frame. Object transforms are not applied, except
where the scene type has baked them into the vertices.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.model.raytrace import RaytracePass
from nau_py.raytrace.ptx.optix.records import TriangleGroup
from nau_py.scene.mesh import Mesh, SceneObject
from nau_py.scene.world import World

Values = dict[str, "bytes | NDArray[Any] | int"]
"""Values of variables by name: bytes, an array (a buffer whose last axis is one element), or the
handle of a texture."""


@dataclass(slots=True)
class GeometryInstance:
    """One material of one object: the material's name, and the buffers of the geometry."""

    material: str
    buffers: Values


def collect_groups(world: World, pass_: RaytracePass) -> Iterator[TriangleGroup]:
    """Yield the triangles of each object and material, both by name in byte order (class ``rt``).

    Of several objects with one name the last one counts.
    """
    objects = {o.name: o for o in world.objects(pass_.scene_names)}
    named = (objects[name] for name in sorted(objects, key=str.encode))
    for mesh in _triangle_meshes(named):
        attributes = {k: np.ascontiguousarray(v, np.float32) for k, v in mesh.attributes.items()}
        parts: dict[str, list[NDArray[np.uint32]]] = {}
        for group in mesh.groups:
            parts.setdefault(group.material, []).append(group.indices)
        for material in sorted(parts, key=str.encode):
            indices = np.concatenate(parts[material])
            if len(indices):
                yield TriangleGroup(material, attributes, np.ascontiguousarray(indices, np.uint32))


def collect_instances(world: World, pass_: RaytracePass) -> list[GeometryInstance]:
    """Return the material groups of all objects (class ``optix``). Missing attributes are 0."""
    found = []
    for mesh in _triangle_meshes(world.objects(pass_.scene_names)):
        names = {a.name or "" for a in pass_.rtVertexAttributes} - {"position"}
        zeros = np.zeros((len(mesh.positions), 4), np.float32)
        shared: Values = {
            name: np.ascontiguousarray(mesh.attributes.get(name, zeros), np.float32)
            for name in sorted(names)
        }
        shared["vertex_buffer"] = np.ascontiguousarray(mesh.positions, np.float32)
        for group in mesh.groups:
            if len(group.indices):
                indices = np.ascontiguousarray(group.indices, np.uint32).reshape(-1, 1)
                found.append(GeometryInstance(group.material, shared | {"index_buffer": indices}))
    return found


def _triangle_meshes(objects: Iterable[SceneObject]) -> Iterator[Mesh]:
    for each in objects:
        if each.mesh.primitive == "TRIANGLES" and not each.mesh.buffers:
            yield each.mesh
