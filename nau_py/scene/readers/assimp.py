"""Models that Assimp reads, by Nau's rules (docs/format.md, 10.3)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import assimp_py
import numpy as np

from nau_py.process.paths import resolve
from nau_py.scene.mesh import F32, F64, Group, Mesh, SceneObject, pad4
from nau_py.scene.readers.model_error import ModelError
from nau_py.scene.readers.model_material import ModelMaterial
from nau_py.scene.readers.registry import Model

_POST_PROCESS = (
    assimp_py.Process_CalcTangentSpace
    | assimp_py.Process_JoinIdenticalVertices
    | assimp_py.Process_Triangulate
    | assimp_py.Process_GenSmoothNormals
    | assimp_py.Process_SplitLargeMeshes
    | assimp_py.Process_RemoveRedundantMaterials
    | assimp_py.Process_SortByPType
    | assimp_py.Process_GenUVCoords
)
_SWAP_YZ = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]], np.float64)
_COLOURS = {
    "COLOR_DIFFUSE": "DIFFUSE",
    "COLOR_AMBIENT": "AMBIENT",
    "COLOR_SPECULAR": "SPECULAR",
    "COLOR_EMISSIVE": "EMISSION",
}
_UNITS = {
    assimp_py.TextureType_DIFFUSE: 0,
    assimp_py.TextureType_HEIGHT: 1,
    assimp_py.TextureType_NORMALS: 2,
}


def load_assimp(path: Path, swap_yz: bool) -> Model:
    """Load the objects of a model file, with node transforms, and its materials.

    Raises :class:`~nau_py.scene.readers.model_error.ModelError`.
    """
    try:
        scene = assimp_py.import_file(str(path), _POST_PROCESS)
    except (RuntimeError, ValueError, OSError) as error:
        raise ModelError(f"cannot be read by Assimp: {error}") from None
    materials = [_convert_material(data, path) for data in scene.materials]
    names = [m.name for m in materials]
    meshes = [_convert_mesh(mesh, names, swap_yz) for mesh in scene.meshes]
    objects: list[SceneObject] = []
    _collect_objects(scene.root_node, np.eye(4), meshes, objects)
    if not objects:
        raise ModelError("holds no triangle mesh")
    return objects, materials


def _collect_objects(
    node: Any, parent: F64, meshes: list[Mesh | None], objects: list[SceneObject]
) -> None:
    matrix = parent @ np.array(node.transformation, np.float64)
    for index in node.mesh_indices:
        mesh = meshes[index]
        if mesh is not None:
            objects.append(SceneObject("default", mesh, matrix))
    for child in node.children:
        _collect_objects(child, matrix, meshes, objects)


def _copy_array(view: Any, width: int) -> F32:
    return np.frombuffer(view, np.float32).reshape(-1, width).copy()


def _convert_mesh(data: Any, materials: list[str], swap_yz: bool) -> Mesh | None:
    if data.num_indices != 3 * data.num_faces:
        return None
    turn = _SWAP_YZ if swap_yz else np.eye(4)
    attributes: dict[str, F32] = {}
    sources = (
        ("position", data.vertices, 1.0),
        ("normal", data.normals, 0.0),
        ("tangent", data.tangents, 0.0),
        ("bitangent", data.bitangents, 0.0),
    )
    for name, view, w in sources:
        if view is not None and len(view):
            turned = _copy_array(view, 3) @ turn[:3, :3].T
            attributes[name] = pad4(turned, w)
    if data.texcoords:
        width = int(data.num_uv_components[0])
        uv = _copy_array(data.texcoords[0], width)[:, :2]
        attributes["texCoord0"] = pad4(uv, 1.0)
    indices = np.frombuffer(data.indices, np.uint32).reshape(-1, 3).copy()
    return Mesh(attributes, [Group(materials[data.material_index], indices)])


def _convert_material(data: dict[str, Any], path: Path) -> ModelMaterial:
    material = ModelMaterial(str(data.get("NAME") or "Default"))
    for key, name in _COLOURS.items():
        value = data.get(key)
        if value is not None:
            r, g, b, *a = (float(v) for v in value)
            material.colours[name] = (r, g, b, a[0] if a else 1.0)
    if "SHININESS" in data:
        material.colours["SHININESS"] = (float(data["SHININESS"]),)
    for kind, files in (data.get("TEXTURES") or {}).items():
        unit = _UNITS.get(kind)
        if unit is not None and files:
            material.textures[unit] = resolve(path.parent, str(files[0])).best
    return material
