"""Attribute sets of all object types, and the user attributes of a project."""

from __future__ import annotations

from collections.abc import Iterable

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
from nau_py.plugins import PASSES, load_plugins

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


def declare_attributes(type_: str, attributes: Iterable[Attribute]) -> None:
    """Add attributes that a part of nau_py reads to the set of ``type_``, before projects are read.

    Raises ValueError for a name that another attribute has.
    """
    known = BUILT_IN[type_].attributes
    for attribute in attributes:
        if known.setdefault(attribute.name, attribute) != attribute:
            raise ValueError(f"{type_} has another attribute '{attribute.name}' already")


OBJECT_TYPES = tuple(name for name in BUILT_IN if name != "TEXTURE_SAMPLER")


PARAMETERS: dict[type, tuple[Attribute, ...]] = {}
"""Attributes of PASS that only the passes of one model have, by model
(:func:`nau_py.model.pass_classes.declare_pass_class`)."""


class Registry:
    """The attribute sets of one project: the built-in ones, the parameters of pass classes and the
    user attributes of the project."""

    def __init__(self) -> None:
        load_plugins(PASSES)
        self._common = {name: set_.copy() for name, set_ in BUILT_IN.items()}
        self._whole = {name: set_.copy() for name, set_ in BUILT_IN.items()}
        for parameters in PARAMETERS.values():
            for parameter in parameters:
                self._whole["PASS"].attributes.setdefault(parameter.name, parameter)
        self._of: dict[type, AttributeSet] = {}
        self.user: list[tuple[str, str]] = []

    def __getitem__(self, type_: str) -> AttributeSet:
        """Return the attributes that any object of ``type_`` has: of PASS, those of all classes."""
        return self._whole[type_]

    def get(self, type_: str) -> AttributeSet | None:
        """Return the attributes of ``type_``, or None for an unknown type."""
        return self._whole.get(type_)

    def common(self, type_: str) -> AttributeSet | None:
        """Return the attributes that every object of ``type_`` has; None for an unknown type."""
        return self._common.get(type_)

    def of(self, model: type, type_: str) -> AttributeSet:
        """Return the attributes that nodes of ``model`` have: the parameters of a pass class, and
        those that every object of ``type_`` has."""
        if type_ != "PASS":
            return self._common[type_]
        found = self._of.get(model)
        if found is None:
            own = {p.name: p for p in PARAMETERS.get(model, ())}
            found = AttributeSet(type_, self._common[type_].attributes | own)
            self._of[model] = found
        return found

    def add(self, type_: str, attribute: Attribute) -> None:
        """Declare a user attribute of ``type_``, a key of :data:`BUILT_IN`."""
        self._common[type_].attributes[attribute.name] = attribute
        self._whole[type_].attributes[attribute.name] = attribute
        self._of.clear()
        self.user.append((type_, attribute.name))
