"""Every registered object type with its attribute set, and the user attributes of a project."""

from __future__ import annotations

from nau_py.model.attribute import Attribute, AttributeSet
from nau_py.model.attributes import (
    bindings,
    camera,
    color,
    light,
    passes,
    physics,
    renderer,
    scene,
    state,
    texture,
    viewport,
)

BUILT_IN: dict[str, AttributeSet] = {
    set_.type: set_
    for set_ in (
        camera.CAMERA,
        light.LIGHT,
        viewport.VIEWPORT,
        color.COLOR,
        state.STATE,
        texture.TEXTURE,
        texture.TEXTURE_MATERIAL,
        texture.ARRAY_OF_TEXTURES,
        bindings.SAMPLER,
        bindings.TEXTURE_BINDING,
        bindings.IMAGE_TEXTURE,
        bindings.ARRAY_OF_TEXTURES_BINDING,
        bindings.ARRAY_OF_IMAGE_TEXTURES,
        bindings.BUFFER,
        bindings.BUFFER_MATERIAL,
        bindings.BUFFER_BINDING,
        passes.PASS,
        passes.PRE_TEXTURE,
        passes.POST_TEXTURE,
        passes.PRE_BUFFER,
        passes.POST_BUFFER,
        passes.RENDER_TARGET,
        renderer.RENDERER,
        scene.SCENE,
        scene.SCENE_OBJECT,
        scene.SPHERE,
        scene.GRID,
        physics.PHYSICS_MANAGER,
        physics.PHYSICS_MATERIAL,
    )
}
"""Attribute sets by type. ``TEXTURE_SAMPLER`` is the only one that a ``valueof`` cannot name."""

OBJECT_TYPES = tuple(name for name in BUILT_IN if name != "TEXTURE_SAMPLER")


class Registry:
    """The attribute sets of one project: the built-in ones and its user attributes."""

    def __init__(self) -> None:
        self._sets = {name: set_.copy() for name, set_ in BUILT_IN.items()}
        self.user: list[tuple[str, str]] = []

    def __getitem__(self, type_: str) -> AttributeSet:
        return self._sets[type_]

    def get(self, type_: str) -> AttributeSet | None:
        return self._sets.get(type_)

    def add(self, type_: str, attribute: Attribute) -> None:
        """Declare a user attribute of ``type_``, a key of :data:`BUILT_IN`."""
        self._sets[type_].attributes[attribute.name] = attribute
        self.user.append((type_, attribute.name))
