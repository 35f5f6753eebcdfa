"""A ``<scene>`` element to scene objects, by Nau's scene types (docs/format.md, 3.4)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from nau_py.diagnostics.diagnostic import Diagnostic, warning
from nau_py.diagnostics.diagnostic import error as error_at
from nau_py.diagnostics.location import Location
from nau_py.model.library import qualified
from nau_py.model.linked import Project
from nau_py.model.scene import BufferGeometry, Primitive, Scene, Terrain
from nau_py.process.paths import resolve
from nau_py.scene import primitives
from nau_py.scene.mesh import Group, Mesh, SceneObject, merge, pad4, transform_mesh
from nau_py.scene.readers.loading import list_suffixes, read_model
from nau_py.scene.readers.model_error import ModelError
from nau_py.scene.readers.model_material import PRIMITIVE_MATERIAL, ModelMaterial
from nau_py.scene.readers.terrain import load_terrain
from nau_py.scene.transforms import transform_of

_MERGED_TYPES = ("OctreeUnified",)


class SceneBuilder:
    """Builds scenes, sharing primitives by name as Nau does, and collects their materials."""

    def __init__(self, project: Project) -> None:
        self.project = project
        self.materials: list[ModelMaterial] = []
        self.new_materials: list[str] = []
        self.diagnostics: list[Diagnostic] = []
        self._primitives: dict[str, Mesh] = {}

    def build(self, scene: Scene) -> list[SceneObject]:
        """The objects of ``scene``, in world space where its type bakes transforms."""
        objects = self._objects(scene)
        if not objects:
            return []
        if scene.has_flag("USE_ADJACENCY"):
            for item in objects:
                item.mesh.adjacency = item.mesh.primitive == "TRIANGLES"
        merged = (scene.type or "OctreeUnified") in _MERGED_TYPES
        if merged and not any(o.mesh.buffers for o in objects):
            baked = [transform_mesh(o.mesh, o.matrix) for o in objects]
            objects = [SceneObject(scene.name or "default", merge(baked))]
            if scene.has_flag("UNITIZE"):  # its box is the merged object's: no scene transform
                objects = _unitize(objects)
        if scene.filename is None:
            matrix = transform_of(self.project, scene, "SCENE")
            objects = [SceneObject(o.name, o.mesh, matrix @ o.matrix) for o in objects]
        if scene.has_flag("UNITIZE") and not merged:
            objects = _unitize(objects)
        return objects

    def _objects(self, scene: Scene) -> list[SceneObject]:
        swap = scene.has_flag("SWAP_YZ")
        if scene.filename is not None:
            return self._file(scene.filename, scene.where("filename"), swap)
        objects = [o for g in scene.geometry for o in self._geometry(g)]
        objects += [o for t in scene.terrain for o in self._terrain(t)]
        objects += [self._buffers(b) for b in scene.buffers]
        for file in scene.files:
            if file.name is not None:
                objects += self._file(file.name, file.where("name"), swap)
        for folder in scene.folders:
            objects += self._folder(folder.name or "", folder.where("name"), swap)
        return objects

    def _geometry(self, node: Primitive) -> list[SceneObject]:
        name = node.name or ""
        mesh = self._primitives.get(name)
        if mesh is None:
            mesh = self._primitive(node)
            if mesh is None:
                return []
            self._primitives[name] = mesh
            self.new_materials += [g.material for g in mesh.groups]
        return [SceneObject(name, mesh, transform_of(self.project, node, "SCENE_OBJECT"))]

    def _primitive(self, node: Primitive) -> Mesh | None:
        def size(name: str, set_: str, default: float) -> float:
            setting = (node.sphere if set_ == "SPHERE" else node.grid).get(name)
            return self.project.number(setting.parts[0]) if setting else default

        material = node.material or PRIMITIVE_MATERIAL
        if node.type == "BOX":
            return primitives.box(material)
        if node.type == "SQUARE":
            return primitives.square(material)
        if node.type == "SPHERE":
            slices, stacks = size("SLICES", "SPHERE", 10), size("STACKS", "SPHERE", 10)
            return primitives.sphere(max(int(slices), 2), max(int(stacks), 3), material)
        if node.type == "GRID":
            divisions, length = size("DIVISIONS", "GRID", 10), size("LENGTH", "GRID", 1.0)
            return primitives.grid(max(int(divisions), 1), length, material)
        if node.type == "AXIS":
            return primitives.axis(node.material)
        return None

    def _terrain(self, node: Terrain) -> list[SceneObject]:
        where = node.where("heightMap")
        found = resolve(Path(where.file).parent, node.heightMap or "")
        if not found.exists:
            return []
        material = node.material or PRIMITIVE_MATERIAL
        try:
            mesh = load_terrain(found.best, material)
        except ModelError as problem:
            self.diagnostics.append(
                error_at("M001", where, f"height map '{found.best.name}': {problem}")
            )
            return []
        self.new_materials.append(material)
        matrix = transform_of(self.project, node, "SCENE_OBJECT")
        return [SceneObject(node.name or "", mesh, matrix)]

    def _buffers(self, node: BufferGeometry) -> SceneObject:
        material = node.material or "__nauDefault"
        self.new_materials.append(material)
        places = {a.tag: qualified(a.name or "", a.fromLibrary or "") for a in node.attributes}
        group = Group(material, np.zeros((0, 1), np.uint32))
        mesh = Mesh({}, [group], node.primitive or "TRIANGLES", places)
        return SceneObject(node.name or "", mesh)

    def _folder(self, name: str, where: Location, swap: bool) -> list[SceneObject]:
        folder = resolve(Path(where.file).parent, name)
        objects: list[SceneObject] = []
        if folder.exists and folder.best.is_dir():
            known = list_suffixes()
            for path in sorted(folder.best.iterdir()):
                if path.suffix.lower() in known:
                    objects += self._read(path, where, swap)
        return objects

    def _file(self, name: str, where: Location, swap: bool) -> list[SceneObject]:
        found = resolve(Path(where.file).parent, name)
        return self._read(found.best, where, swap) if found.exists else []

    def _read(self, path: Path, where: Location, swap: bool) -> list[SceneObject]:
        try:
            objects, materials = read_model(path, swap)
        except ModelError as problem:
            line = f":{problem.line}" if problem.line else ""
            self.diagnostics.append(
                error_at("M001", where, f"model '{path.name}{line}': {problem}")
            )
            return []
        for material in materials:
            self._existing_textures(material, path, where)
        self.materials += materials
        self.new_materials += [g.material for o in objects for g in o.mesh.groups]
        for item in objects:
            item.mesh = self._valid(item.mesh, path, where)
        return objects

    def _existing_textures(self, material: ModelMaterial, path: Path, where: Location) -> None:
        """Forget textures whose file is missing, as Nau does, with a warning each."""
        for unit, texture in list(material.textures.items()):
            if not texture.is_file():
                del material.textures[unit]
                message = (
                    f"model '{path.name}': material '{material.name}' names the texture "
                    f"'{texture}', which does not exist; it is drawn without"
                )
                self.diagnostics.append(warning("M004", where, message))

    def _valid(self, mesh: Mesh, path: Path, where: Location) -> Mesh:
        """``mesh`` without faces that have a non-finite vertex; each mesh is reported once."""
        if mesh.buffers:
            return mesh
        bad = np.asarray(~np.isfinite(mesh.positions).all(axis=1))
        if not bad.any():
            return mesh
        vertex = int(np.argmax(bad))
        groups = [Group(g.material, g.indices[~bad[g.indices].any(axis=1)]) for g in mesh.groups]
        self.diagnostics.append(
            warning(
                "M003",
                where,
                f"model '{path.name}': {int(bad.sum())} vertices are not finite (the first is "
                f"{vertex}); their faces are left out",
            )
        )
        positions = np.where(bad[:, None], np.float32(0), mesh.positions)
        attributes = mesh.attributes | {"position": positions}
        return Mesh(attributes, groups, mesh.primitive, adjacency=mesh.adjacency)


def _unitize(objects: list[SceneObject]) -> list[SceneObject]:
    """Scale positions so that the longest side of the scene's box spans -1..1 (10.9)."""
    world = [o.mesh.positions.astype(np.float64) @ o.matrix.T for o in objects]
    low = np.min([p[:, :3].min(axis=0) for p in world], axis=0)
    high = np.max([p[:, :3].max(axis=0) for p in world], axis=0)
    centre, extent = (low + high) / 2, float((high - low).max())
    scale = 2.0 / extent if extent > 0 else 1.0
    result = []
    for item in objects:
        points = (item.mesh.positions[:, :3].astype(np.float64) - centre) * scale
        attributes = item.mesh.attributes | {"position": pad4(points, 1.0)}
        kept = item.mesh
        mesh = Mesh(attributes, kept.groups, kept.primitive, adjacency=kept.adjacency)
        result.append(SceneObject(item.name, mesh, item.matrix))
    return result
