"""The world that a project draws, at a moment: scenes, materials, cameras, lights."""

from __future__ import annotations

import numpy as np

from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.diagnostics.suggest import format_names
from nau_py.model.linked import Project
from nau_py.model.scene import Scene
from nau_py.scene.build import SceneBuilder
from nau_py.scene.camera import CameraState, make_camera_state
from nau_py.scene.events import EventSystem
from nau_py.scene.frustum import compute_frustum_corners, make_frustum_mesh
from nau_py.scene.lights import LightState, make_light_state
from nau_py.scene.mapping import MaterialTable
from nau_py.scene.material import make_default_material, make_model_material
from nau_py.scene.mesh import F32, F64, SceneObject, compute_bounding_box
from nau_py.scene.transforms import compose_transform, inverse
from nau_py.scene.viewport import Rect, compute_viewport_rect

DEFAULT_NAME = "__nauDefault"


class World:
    """The world of a project. Scenes are loaded once, in file order; materials follow them.

    ``diagnostics`` holds the faults of model files.
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
            self.materials.add(make_model_material(project, material))
        for name in builder.new_materials:
            self.materials.add(make_default_material(project, name))
        self.diagnostics: list[Diagnostic] = builder.diagnostics
        self.renderer_values: dict[str, tuple[float, ...]] = {}
        """RENDERER attributes set by scripts."""
        self.moved: frozenset[str] = frozenset()
        """Names of the objects that have moved."""
        self.moves = 0
        """Number of moves of any object."""
        self._cameras: dict[str, CameraState] = {}
        self._frusta: dict[str, SceneObject] = {}
        for camera in project.assets.cameras:
            if camera.name and camera.name not in self._cameras:
                self._cameras[camera.name] = make_camera_state(project, camera, camera.name)
        self._cameras.setdefault(DEFAULT_NAME, make_camera_state(project, None, DEFAULT_NAME))
        self._lights: dict[str, LightState] = {}
        for light in project.assets.lights:
            if light.name:
                nodes = [other for other in project.assets.lights if other.name == light.name]
                self._lights[light.name] = make_light_state(project, nodes, light.name)
        self._lights.setdefault(DEFAULT_NAME, make_light_state(project, [], DEFAULT_NAME))

    def objects(self, names: list[str]) -> list[SceneObject]:
        """List the objects of the named scenes, in order; a camera's name means its frustum."""
        found = []
        for name in names:
            found += self.scenes.get(name, [])
            if name not in self.scenes and name in self._cameras:
                found.append(self._frustum(self._cameras[name]))
        return found

    def _frustum(self, camera: CameraState) -> SceneObject:
        aspect = self.viewport(camera.viewport).aspect
        if camera.name not in self._frusta:
            self._frusta[camera.name] = SceneObject(camera.name, make_frustum_mesh(camera, aspect))
        found = self._frusta[camera.name]
        corners = compute_frustum_corners(camera, aspect)
        if not np.array_equal(corners, found.mesh.positions):
            found.mesh.attributes["position"] = corners
            found.mesh.version += 1
        found.matrix = inverse(camera.view_matrix())
        return found

    def move(self, name: str, matrix: F64) -> None:
        """Set the object-to-world matrix, (4, 4), of the objects called ``name``.

        Raises ValueError for an unknown name, and for a matrix of another shape or not finite.
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
        """Set TRANSLATE or ROTATE of a scene, four numbers, and move its objects."""
        node = self._nodes.get(scene)
        if node is None:
            return
        instead = self._moving.setdefault(scene, {})
        before = compose_transform(self.project, node, "SCENE", instead)
        instead[attribute] = values
        change = compose_transform(self.project, node, "SCENE", instead) @ inverse(before)
        self._mark_moved(scene, [(o, change @ o.matrix) for o in self.scenes[scene]])

    def scene_value(self, scene: str, attribute: str) -> F64 | None:
        """Return a SCENE attribute, flat: matrices column after column, boxes in world space.

        A box bounds the eight corners of the box of each mesh, as in Nau (``boundingBox.cpp``,
        ``setTransform``), so around a rotated object it is not the smallest.
        """
        node = self._nodes.get(scene)
        if node is None:
            return None
        moving = self._moving.get(scene, {})
        if attribute == "TRANSFORM":
            return compose_transform(self.project, node, "SCENE", moving).T.reshape(-1)
        if attribute == "TRIANGLE_COUNT":
            groups = [g for o in self.scenes[scene] for g in o.mesh.groups]
            return np.array([float(sum(len(g.indices) for g in groups))])
        if attribute.startswith("BB_"):
            low, high = compute_bounding_box(self.scenes[scene])
            boxes = {"BB_MIN": low, "BB_MAX": high, "BB_CENTER": (low + high) / 2}
            return boxes.get(attribute)
        parts = moving.get(attribute) or self.project.value(node, "SCENE", attribute)
        numbers = [float(p) for p in parts if not isinstance(p, str)]
        return np.array(numbers) if numbers else None

    def animate(self, scene: str, fraction: float) -> None:
        """Set the pose animation of a scene to ``fraction`` of its length."""
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
        self._mark_moved(scene, [(o, o.matrix) for o in self.scenes[scene]])

    def _mark_moved(self, scene: str, places: list[tuple[SceneObject, F64]]) -> None:
        for item, matrix in places:
            item.matrix = matrix
        self.moved |= {item.name for item, _ in places}
        self.moves += 1

    def camera(self, name: str | None) -> CameraState:
        return self._cameras.get(name or DEFAULT_NAME, self._cameras[DEFAULT_NAME])

    def add_camera(self, camera: CameraState) -> None:
        """Add a camera that a pass makes, as the light camera of a depth map."""
        self._cameras[camera.name] = camera

    def light(self, name: str) -> LightState:
        return self._lights.get(name, self._lights[DEFAULT_NAME])

    def viewport(self, name: str | None) -> Rect:
        """Compute the rectangle of a viewport in the window; the whole window for None."""
        nodes = {v.name: v for v in self.project.assets.viewports}
        return compute_viewport_rect(self.project, nodes.get(name), self.window)
