"""Everything that a project draws, at a moment: scenes, materials, cameras, lights."""

from __future__ import annotations

import numpy as np

from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.diagnostics.suggest import format_names
from nau_py.model.linked import Project
from nau_py.model.scene import Scene
from nau_py.scene.build import SceneBuilder
from nau_py.scene.camera import CameraState, camera_state
from nau_py.scene.events import EventSystem
from nau_py.scene.frustum import frustum_corners, frustum_mesh
from nau_py.scene.lights import LightState, light_state
from nau_py.scene.mapping import MaterialTable
from nau_py.scene.material import default_material, from_model
from nau_py.scene.mesh import F32, F64, SceneObject, bounding_box
from nau_py.scene.transforms import inverse, transform_of
from nau_py.scene.viewport import Rect, viewport_rect

DEFAULT_NAME = "__nauDefault"


class World:
    """The world of a project. Scenes are loaded once, in file order; materials follow them.

    ``diagnostics`` holds what model files had wrong.
    """

    def __init__(self, project: Project, window: tuple[int, int]) -> None:
        self.project = project
        self.window = window
        self.materials = MaterialTable(project)
        builder = SceneBuilder(project)
        self.scenes: dict[str, list[SceneObject]] = {}
        self._nodes: dict[str, Scene] = {}
        self._moving: dict[str, dict[str, tuple[float, ...]]] = {}
        for node in project.assets.scenes:
            if node.name:
                self.scenes.setdefault(node.name, []).extend(builder.build(node))
                self._nodes.setdefault(node.name, node)
        self._reference: dict[int, F32] = {}
        assets = project.assets
        self.events = EventSystem(
            assets.sensors, assets.interpolators, assets.routes, assets.scenes, self.place,
            self.animate,
        )  # fmt: skip
        for material in builder.materials:
            self.materials.add(from_model(project, material))
        for name in builder.new_materials:
            self.materials.add(default_material(project, name))
        self.diagnostics: list[Diagnostic] = builder.diagnostics
        self.renderer_values: dict[str, tuple[float, ...]] = {}
        """RENDERER attributes that scripts have set."""
        self.moved: frozenset[str] = frozenset()
        """Names of objects that have been moved."""
        self.moves = 0
        """How often anything was moved."""
        self._cameras: dict[str, CameraState] = {}
        self._frusta: dict[str, SceneObject] = {}
        for camera in project.assets.cameras:
            if camera.name and camera.name not in self._cameras:
                self._cameras[camera.name] = camera_state(project, camera, camera.name)
        self._cameras.setdefault(DEFAULT_NAME, camera_state(project, None, DEFAULT_NAME))
        self._lights: dict[str, LightState] = {}
        for light in project.assets.lights:
            if light.name:
                nodes = [other for other in project.assets.lights if other.name == light.name]
                self._lights[light.name] = light_state(project, nodes, light.name)
        self._lights.setdefault(DEFAULT_NAME, light_state(project, [], DEFAULT_NAME))

    def objects(self, names: list[str]) -> list[SceneObject]:
        """The objects of the named scenes, in that order; a camera's name means its frustum."""
        found = []
        for name in names:
            found += self.scenes.get(name, [])
            if name not in self.scenes and name in self._cameras:
                found.append(self._frustum(self._cameras[name]))
        return found

    def _frustum(self, camera: CameraState) -> SceneObject:
        aspect = self.viewport(camera.viewport).aspect
        if camera.name not in self._frusta:
            self._frusta[camera.name] = SceneObject(camera.name, frustum_mesh(camera, aspect))
        found = self._frusta[camera.name]
        corners = frustum_corners(camera, aspect)
        if not np.array_equal(corners, found.mesh.positions):
            found.mesh.attributes["position"] = corners
            found.mesh.version += 1
        found.matrix = inverse(camera.view_matrix())
        return found

    def move(self, name: str, matrix: F64) -> None:
        """Put the objects called ``name`` where ``matrix`` says: object to world, (4, 4).

        Raises ValueError for a name that no object has, or a matrix that is none.
        """
        found = [o for objects in self.scenes.values() for o in objects if o.name == name]
        wide = np.asarray(matrix, np.float64)
        if not found:
            known = sorted({o.name for objects in self.scenes.values() for o in objects})
            raise ValueError(f"no object is called '{name}'; there is {format_names(known)}")
        if wide.shape != (4, 4) or not np.isfinite(wide).all():
            raise ValueError(f"object '{name}': a finite matrix of shape (4, 4) is expected")
        for item in found:
            item.matrix = wide
        self.moved |= {name}
        self.moves += 1

    def place(self, scene: str, attribute: str, values: tuple[float, ...]) -> None:
        """Set TRANSLATE or ROTATE of a scene, four numbers; its objects follow."""
        node = self._nodes.get(scene)
        if node is None:
            return
        instead = self._moving.setdefault(scene, {})
        before = transform_of(self.project, node, "SCENE", instead)
        instead[attribute] = values
        change = transform_of(self.project, node, "SCENE", instead) @ inverse(before)
        self._changed(scene, [(o, change @ o.matrix) for o in self.scenes[scene]])

    def scene_value(self, scene: str, attribute: str) -> F64 | None:
        """A SCENE attribute, flat: matrices column after column, boxes in world space.

        A box is that of the eight corners of the box of each mesh, as in Nau
        (``boundingBox.cpp``, ``setTransform``), so around a rotated object it is not the smallest.
        """
        node = self._nodes.get(scene)
        if node is None:
            return None
        moving = self._moving.get(scene, {})
        if attribute == "TRANSFORM":
            return transform_of(self.project, node, "SCENE", moving).T.reshape(-1)
        if attribute == "TRIANGLE_COUNT":
            groups = [g for o in self.scenes[scene] for g in o.mesh.groups]
            return np.array([float(sum(len(g.indices) for g in groups))])
        if attribute.startswith("BB_"):
            low, high = bounding_box(self.scenes[scene])
            boxes = {"BB_MIN": low, "BB_MAX": high, "BB_CENTER": (low + high) / 2}
            return boxes.get(attribute)
        parts = moving.get(attribute) or self.project.value(node, "SCENE", attribute)
        numbers = [float(p) for p in parts if not isinstance(p, str)]
        return np.array(numbers) if numbers else None

    def animate(self, scene: str, fraction: float) -> None:
        """Put the pose animation of a scene at ``fraction`` of its length."""
        node = self._nodes.get(scene)
        if node is None or node.type != "ScenePoses":
            return
        for item in self.scenes[scene]:
            mesh = item.mesh
            if mesh.poses is None:
                continue
            start = self._reference.setdefault(id(mesh), mesh.positions)
            moved = start.copy()
            moved[:, :3] += mesh.poses.offset(fraction * mesh.poses.length)
            mesh.attributes["position"] = moved
            mesh.version += 1
        self._changed(scene, [(o, o.matrix) for o in self.scenes[scene]])

    def _changed(self, scene: str, places: list[tuple[SceneObject, F64]]) -> None:
        for item, matrix in places:
            item.matrix = matrix
        self.moved |= {item.name for item, _ in places}
        self.moves += 1

    def camera(self, name: str | None) -> CameraState:
        return self._cameras.get(name or DEFAULT_NAME, self._cameras[DEFAULT_NAME])

    def add_camera(self, camera: CameraState) -> None:
        """Add a camera that a pass makes (a depth map's light camera)."""
        self._cameras[camera.name] = camera

    def light(self, name: str) -> LightState:
        return self._lights.get(name, self._lights[DEFAULT_NAME])

    def viewport(self, name: str | None) -> Rect:
        """The rectangle of a viewport in the window; the whole window for None."""
        nodes = {v.name: v for v in self.project.assets.viewports}
        return viewport_rect(self.project, nodes.get(name), self.window)
