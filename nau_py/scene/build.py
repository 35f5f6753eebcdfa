"""Scene objects from ``<scene>`` elements, by Nau's scene types (docs/format.md, 3.4)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from nau_py.diagnostics.diagnostic import Diagnostic, warning
from nau_py.diagnostics.diagnostic import error as error_at
from nau_py.diagnostics.location import Location
from nau_py.model.library import qualify_name
from nau_py.model.linked import Project
from nau_py.model.scene import BufferGeometry, Primitive, Scene, Terrain
from nau_py.process.paths import resolve
from nau_py.scene import primitives
from nau_py.scene.mesh import Group, Mesh, SceneObject, merge_meshes, pad4, transform_mesh
from nau_py.scene.readers.loading import list_suffixes, read_model
from nau_py.scene.readers.model_error import ModelError
from nau_py.scene.readers.model_material import PRIMITIVE_MATERIAL, ModelMaterial
from nau_py.scene.readers.terrain import load_terrain
from nau_py.scene.transforms import compose_transform

_MERGED_TYPES = ("OctreeUnified",)


class SceneBuilder:
    """Builds scenes and their materials. Primitives of one name share one mesh, as in Nau."""

    def __init__(self, project: Project) -> None:
        self.project = project
        self.materials: list[ModelMaterial] = []
        self.new_materials: list[str] = []
        self.diagnostics: list[Diagnostic] = []
        self._primitives: dict[str, Mesh] = {}

    def build(self, scene: Scene) -> list[SceneObject]:
        """Build the objects of ``scene``, in world space if its type bakes transforms."""
        objects = self._make_objects(scene)
        if not objects:
            return []
        if scene.has_flag("USE_ADJACENCY"):
            for item in objects:
                item.mesh.adjacency = item.mesh.primitive == "TRIANGLES"
        merged = (scene.type or "OctreeUnified") in _MERGED_TYPES
        if merged and not any(o.mesh.buffers for o in objects):
            baked = [transform_mesh(o.mesh, o.matrix) for o in objects]
            objects = [SceneObject(scene.name or "default", merge_meshes(baked))]
            if scene.has_flag("UNITIZE"):  # its box is the merged object's: no scene transform
                objects = _scale_to_unit(objects)
        if scene.filename is None:
            matrix = compose_transform(self.project, scene, "SCENE")
            objects = [SceneObject(o.name, o.mesh, matrix @ o.matrix) for o in objects]
        if scene.has_flag("UNITIZE") and not merged:
            objects = _scale_to_unit(objects)
        return objects

    def _make_objects(self, scene: Scene) -> list[SceneObject]:
        swap = scene.has_flag("SWAP_YZ")
        if scene.filename is not None:
            return self._read_file(scene.filename, scene.where("filename"), swap)
        objects = [o for g in scene.geometry for o in self._place_primitive(g)]
        objects += [o for t in scene.terrain for o in self._make_terrain(t)]
        objects += [self._make_buffer_object(b) for b in scene.buffers]
        for file in scene.files:
            if file.name is not None:
                objects += self._read_file(file.name, file.where("name"), swap)
        for folder in scene.folders:
            objects += self._read_folder(folder.name or "", folder.where("name"), swap)
        return objects

    def _place_primitive(self, node: Primitive) -> list[SceneObject]:
        name = node.name or ""
        mesh = self._primitives.get(name)
        if mesh is None:
            mesh = self._make_primitive(node)
            if mesh is None:
                return []
            self._primitives[name] = mesh
            self.new_materials += [g.material for g in mesh.groups]
        return [SceneObject(name, mesh, compose_transform(self.project, node, "SCENE_OBJECT"))]

    def _make_primitive(self, node: Primitive) -> Mesh | None:
        def size(name: str, set_: str, default: float) -> float:
            setting = (node.sphere if set_ == "SPHERE" else node.grid).get(name)
            return self.project.number(setting.parts[0]) if setting else default

        material = node.material or PRIMITIVE_MATERIAL
        if node.type == "BOX":
            return primitives.make_box(material)
        if node.type == "SQUARE":
            return primitives.make_square(material)
        if node.type == "SPHERE":
            slices, stacks = size("SLICES", "SPHERE", 10), size("STACKS", "SPHERE", 10)
            return primitives.make_sphere(max(int(slices), 2), max(int(stacks), 3), material)
        if node.type == "GRID":
            divisions, length = size("DIVISIONS", "GRID", 10), size("LENGTH", "GRID", 1.0)
            return primitives.make_grid(max(int(divisions), 1), length, material)
        if node.type == "AXIS":
            return primitives.make_axis(node.material)
        return None

    def _make_terrain(self, node: Terrain) -> list[SceneObject]:
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
        matrix = compose_transform(self.project, node, "SCENE_OBJECT")
        return [SceneObject(node.name or "", mesh, matrix)]

    def _make_buffer_object(self, node: BufferGeometry) -> SceneObject:
        material = node.material or "__nauDefault"
        self.new_materials.append(material)
        places = {a.tag: qualify_name(a.name or "", a.fromLibrary or "") for a in node.attributes}
        group = Group(material, np.zeros((0, 1), np.uint32))
        mesh = Mesh({}, [group], node.primitive or "TRIANGLES", places)
        return SceneObject(node.name or "", mesh)

    def _read_folder(self, name: str, where: Location, swap: bool) -> list[SceneObject]:
        folder = resolve(Path(where.file).parent, name)
        objects: list[SceneObject] = []
        if folder.exists and folder.best.is_dir():
            known = list_suffixes()
            for path in sorted(folder.best.iterdir()):
                if path.suffix.lower() in known:
                    objects += self._read_objects(path, where, swap)
        return objects

    def _read_file(self, name: str, where: Location, swap: bool) -> list[SceneObject]:
        found = resolve(Path(where.file).parent, name)
        return self._read_objects(found.best, where, swap) if found.exists else []

    def _read_objects(self, path: Path, where: Location, swap: bool) -> list[SceneObject]:
        try:
            objects, materials = read_model(path, swap)
        except ModelError as problem:
            line = f":{problem.line}" if problem.line else ""
            self.diagnostics.append(
                error_at("M001", where, f"model '{path.name}{line}': {problem}")
            )
            return []
        for material in materials:
            self._remove_missing_textures(material, path, where)
        self.materials += materials
        self.new_materials += [g.material for o in objects for g in o.mesh.groups]
        for item in objects:
            item.mesh = self._remove_bad_faces(item.mesh, path, where)
        return objects

    def _remove_missing_textures(
        self, material: ModelMaterial, path: Path, where: Location
    ) -> None:
        """Remove textures whose file is missing, as Nau does, with a warning for each."""
        for unit, texture in list(material.textures.items()):
            if not texture.is_file():
                del material.textures[unit]
                message = (
                    f"model '{path.name}': material '{material.name}' names the texture "
                    f"'{texture}', which does not exist; it is drawn without"
                )
                self.diagnostics.append(warning("M004", where, message))

    def _remove_bad_faces(self, mesh: Mesh, path: Path, where: Location) -> Mesh:
        """Remove the faces that have a non-finite vertex; report each mesh once."""
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


def _scale_to_unit(objects: list[SceneObject]) -> list[SceneObject]:
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
