"""Nau's binary models, NBO and CBO (docs/format.md, 10.4): little-endian, without a header."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from nau_py.process.paths import resolve
from nau_py.scene.mesh import F32, F64, Group, Mesh, SceneObject
from nau_py.scene.readers.model_error import ModelError
from nau_py.scene.readers.model_material import ModelMaterial
from nau_py.scene.readers.registry import Model

NO_TEXTURE = "<no texture>"
TEXTURE_UNITS = 8
LONGEST_STRING = 4096
"""Upper bound in bytes; with a longer name the file is not an NBO."""


class _NboReader:
    """A position in the bytes of a file, and the values that NBO files hold."""

    def __init__(self, data: bytes) -> None:
        self.data, self.at = data, 0

    def read_bytes(self, size: int) -> bytes:
        if size < 0 or self.at + size > len(self.data):
            raise ModelError(f"it ends {self.at + size - len(self.data)} bytes early")
        part = self.data[self.at : self.at + size]
        self.at += size
        return part

    def u32(self) -> int:
        return int(struct.unpack("<I", self.read_bytes(4))[0])

    def floats(self, count: int) -> F32:
        return np.frombuffer(self.read_bytes(4 * count), "<f4").astype(np.float32)

    def string(self) -> str:
        length = self.u32()
        if length > LONGEST_STRING:
            raise ModelError(f"a name of {length} bytes at byte {self.at}: it is no NBO file")
        return self.read_bytes(length + 1)[:length].decode("utf-8", "replace")

    def matrix(self) -> F64:
        return self.floats(16).astype(np.float64).reshape(4, 4).T

    def attributes(self) -> dict[str, F32]:
        found = {}
        for _ in range(self.u32()):
            name, count = self.string(), self.u32()
            found[name] = self.floats(4 * count).reshape(-1, 4)
        self.u32()
        return found

    def indices(self) -> np.ndarray[tuple[int, ...], np.dtype[np.uint32]]:
        self.u32()
        count = self.u32()
        values = np.frombuffer(self.read_bytes(4 * count), "<u4").astype(np.uint32)
        return values[: len(values) // 3 * 3].reshape(-1, 3)


def load_nbo(path: Path) -> Model:
    """Load the objects of an NBO file and its materials.

    Raises :class:`~nau_py.scene.readers.model_error.ModelError`.
    """
    try:
        reader = _NboReader(path.read_bytes())
    except OSError as problem:
        raise ModelError(str(problem)) from None
    materials = [_read_material(reader, path) for _ in range(reader.u32())]
    if reader.string() == "OctreeByMatScene":
        reader.floats(6)
        reader.string()
        objects: list[SceneObject] = []
        _read_node(reader, objects)
    else:
        objects = _read_objects(reader)
    for item in objects:
        _check_object(item)
    return objects, materials


def _read_material(reader: _NboReader, path: Path) -> ModelMaterial:
    made = ModelMaterial(reader.string())
    for name in ("AMBIENT", "SPECULAR", "DIFFUSE", "EMISSION"):
        made.colours[name] = tuple(float(v) for v in reader.floats(4))
    made.colours["SHININESS"] = (float(reader.floats(1)[0]),)
    for unit in range(TEXTURE_UNITS):
        name = reader.string()
        if name and name != NO_TEXTURE:
            made.textures[unit] = resolve(path.parent, name).best
    return made


def _read_objects(reader: _NboReader) -> list[SceneObject]:
    found: list[SceneObject] = []
    meshes: dict[str, Mesh] = {}
    for _ in range(reader.u32()):
        reader.string()  # class
        name = reader.string()
        reader.string()  # kind of bounding volume
        reader.floats(3 * reader.u32())
        matrix, renderable = reader.matrix(), reader.string()
        if renderable == "NULLOBJECT":
            continue
        if renderable not in meshes:
            reader.string()  # class
            attributes = reader.attributes()
            groups = [Group(reader.string(), reader.indices()) for _ in range(reader.u32())]
            meshes[renderable] = Mesh(attributes, groups)
        found.append(SceneObject(name, meshes[renderable], matrix))
    return found


def _read_node(reader: _NboReader, found: list[SceneObject]) -> None:
    reader.floats(12)
    for _ in range(reader.u32()):
        reader.string()
        name = reader.string()
        reader.floats(6)
        matrix = reader.matrix()
        reader.string()
        attributes = reader.attributes()
        material = reader.string()
        found.append(
            SceneObject(name, Mesh(attributes, [Group(material, reader.indices())]), matrix)
        )
    children = reader.u32()
    reader.read_bytes(8)
    for _ in range(children):
        _read_node(reader, found)


def _check_object(item: SceneObject) -> None:
    if "position" not in item.mesh.attributes:
        raise ModelError(f"object '{item.name}' has no positions")
    count = item.mesh.vertex_count
    for name, values in item.mesh.attributes.items():
        if len(values) != count:
            raise ModelError(f"object '{item.name}': {len(values)} of '{name}', {count} positions")
    for group in item.mesh.groups:
        if group.indices.size and int(group.indices.max()) >= count:
            raise ModelError(
                f"object '{item.name}': index {int(group.indices.max())} of {count} vertices"
            )
