"""Cameras with changed values, evaluated as the file would be: in the order of the elements."""

from __future__ import annotations

import copy

from nau_py.model.camera import Camera
from nau_py.model.linked import Project
from nau_py.model.node import Setting
from nau_py.model.values import Scalar
from nau_py.scene.camera import CameraState, make_camera_state
from nau_py.viewer.controls import Values, parts_of


def camera_node(project: Project, name: str) -> Camera | None:
    return next((c for c in project.assets.cameras if c.name == name), None)


def camera_with(project: Project, name: str, values: Values) -> CameraState | None:
    """Return the state of a camera with the ``values`` of its controls; None for an unknown name.

    The project does not change.
    """
    node = camera_node(project, name)
    if node is None:
        return None
    changed = copy.copy(node)
    changed.settings = dict(node.settings)
    if node.projection is not None:
        changed.projection = copy.copy(node.projection)
        changed.projection.settings = dict(node.projection.settings)
    for key, parts in values.items():
        type_, context, component = parts_of(key)
        if type_ == "CAMERA" and context == name:
            _put(changed, component, parts)
    return make_camera_state(project, changed, name)


def _put(camera: Camera, component: str, parts: tuple[Scalar, ...]) -> None:
    """Set a component at the place where saving writes it: at its own place, or before all."""
    inline = camera.projection.settings if camera.projection is not None else {}
    if component in inline or (camera.projection is not None and len(parts) == 1):
        inline[component] = Setting(parts)
    elif component in camera.settings:
        camera.settings[component] = Setting(parts)
    else:
        camera.settings = {component: Setting(parts)} | camera.settings


def aims_from_position(camera: Camera) -> bool:
    """Return True if LOOK_AT_POINT comes after POSITION in the file, and is seen from there."""
    order = [*camera.settings]
    if "POSITION" not in order:
        return True  # it would be written before all
    return order.index("POSITION") < order.index("LOOK_AT_POINT")
