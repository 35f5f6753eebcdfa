"""Meshes on the GPU."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from nau_py.raster import gl
from nau_py.raster.programs import ShaderProgram
from nau_py.scene.adjacency import add_neighbours
from nau_py.scene.mesh import Mesh


@dataclass(slots=True)
class GpuMesh:
    """Vertex buffers by attribute, and one index buffer with the first index of each group."""

    buffers: dict[str, Any]
    indices: Any
    first: list[int]
    count: list[int]
    version: int = 0


class GeometryCache:
    """Keeps the GPU copy of each mesh, and a vertex array for each mesh and program."""

    def __init__(self, ctx: Any) -> None:
        self._ctx = ctx
        self._meshes: dict[int, tuple[Mesh, GpuMesh]] = {}
        self._arrays: dict[tuple[int, int], int] = {}

    def upload(self, mesh: Mesh) -> GpuMesh:
        """Return the GPU copy of ``mesh``. Upload positions again if their version has changed."""
        found = self._meshes.get(id(mesh))
        if found is not None:
            if found[1].version != mesh.version:
                found[1].buffers["position"].write(mesh.positions.tobytes())
                found[1].version = mesh.version
            return found[1]
        buffers = {
            name: self._ctx.buffer(np.ascontiguousarray(values).tobytes())
            for name, values in mesh.attributes.items()
        }
        listed = [group.indices for group in mesh.groups]
        if mesh.adjacency:
            listed = [add_neighbours(indices) for indices in listed]
        counts = [indices.size for indices in listed]
        first = [0, *np.cumsum(counts)[:-1].tolist()]
        flat = np.concatenate([indices.reshape(-1) for indices in listed])
        indices = self._ctx.buffer(flat.astype(np.uint32).tobytes())
        gpu = GpuMesh(buffers, indices, first, counts, mesh.version)
        self._meshes[id(mesh)] = (mesh, gpu)
        return gpu

    def release(self) -> None:
        """Delete the vertex arrays. moderngl deletes the buffers."""
        gl.delete_vertex_arrays(list(self._arrays.values()))
        self._arrays.clear()
        self._meshes.clear()

    def buffer_array(self, mesh: Mesh, program: ShaderProgram, buffers: dict[str, int]) -> int:
        """Return the vertex array for a mesh whose attributes are the named GL ``buffers``."""
        key = (id(mesh), program.mgl.glo)
        if key not in self._arrays:
            inputs = [(at, buffers[name]) for name, at in program.inputs if name in buffers]
            self._meshes.setdefault(id(mesh), (mesh, GpuMesh({}, None, [], [])))
            self._arrays[key] = gl.create_vertex_array(inputs, buffers.get("index", 0))
        return self._arrays[key]

    def vertex_array(self, mesh: Mesh, program: ShaderProgram) -> int:
        """Return the vertex array of ``mesh`` for ``program``, with inputs matched by name."""
        key = (id(mesh), program.mgl.glo)
        if key not in self._arrays:
            gpu = self.upload(mesh)
            inputs = [
                (location, gpu.buffers[name].glo)
                for name, location in program.inputs
                if name in gpu.buffers
            ]
            self._arrays[key] = gl.create_vertex_array(inputs, gpu.indices.glo)
        return self._arrays[key]
