"""Renderer whose project has the values of the viewer's controls."""

from __future__ import annotations

from dataclasses import fields

from nau_py.model.linked import Project
from nau_py.model.node import Configured, Setting
from nau_py.model.values import Scalar
from nau_py.passes.frame import Progress
from nau_py.run.frame import Frame
from nau_py.run.renderer import Renderer
from nau_py.viewer.camera import camera_with
from nau_py.viewer.controls import Values, home, parts_of
from nau_py.viewer.request import PictureRequest

COARSE = 0.25
"""Size of the coarse picture relative to the full one."""
COARSE_PIXELS = 96
"""Least pixels of its shorter side."""


class SteeredRenderer:
    """A renderer, the values applied to it, and the number of its last frame (-1 for none)."""

    def __init__(self, renderer: Renderer) -> None:
        self.renderer = renderer
        self.rendered = -1
        self._applied: Values = {}
        self._originals: Values = {}
        """Values of the file for every control that was ever changed."""

    def render(self, request: PictureRequest, seed: int, report: Progress) -> Frame:
        """Render a frame with the values of ``request``; frames before it are rendered first.

        ``report`` is called before each frame, and may raise to cancel.
        """
        self._apply(dict(request.values))
        if self.rendered == request.frame:
            return self.renderer.again(seed)
        first = self.rendered + 1 if self.rendered < request.frame else 0
        self.rendered = -1
        for index in range(first, request.frame + 1):
            report("", index, request.frame)
            frame = self.renderer.render(index)
        self.rendered = request.frame
        return frame

    def _apply(self, values: Values) -> None:
        """Set the values that changed; controls that are no longer changed get the file's."""
        restored = [key for key in self._applied if key not in values]
        wanted = {key: self._originals.get(key, ()) for key in restored} | values
        moved = set()
        for key, value in wanted.items():
            if self._applied.get(key) == value:
                continue
            if key.startswith("CAMERA|"):
                moved.add(parts_of(key)[1])
                continue
            if key not in self._originals:
                self._originals[key] = _read_value(self.renderer, key)
            _set_value(self.renderer, key, value)
        for name in moved:
            _aim_camera(self.renderer, name, values)
        self._applied = dict(values)


def _set_value(renderer: Renderer, key: str, value: tuple[Scalar, ...]) -> None:
    type_, context, component = parts_of(key)
    if type_ == "MASK":
        node = home(renderer.project, key)
        if node is not None:
            setattr(node, component, value[0])
        return
    renderer.set_attribute(type_, context, component, value)


def _aim_camera(renderer: Renderer, name: str, values: Values) -> None:
    """Put a camera where the file would have it with these values."""
    wanted = camera_with(renderer.project, name, values)
    state = renderer.session.world.camera(name)
    if wanted is not None and state.name == name:
        for field_ in fields(state):
            setattr(state, field_.name, getattr(wanted, field_.name))


def _read_value(renderer: Renderer, key: str) -> tuple[Scalar, ...]:
    """Return the value before any change."""
    project = renderer.project
    type_, context, component = parts_of(key)
    node = home(project, key)
    if type_ == "MASK":
        return (getattr(node, component),) if node is not None else (0.0,)
    if type_ == "COLOR":
        library, _, name = context.partition("::")
        material = renderer.session.world.materials.get(library, name)
        return tuple(material.colours[component]) if material is not None else ()
    if isinstance(node, Configured):
        return project.value(node, type_, component)
    return project.default(type_, component)


def shrink_targets(project: Project, size: tuple[int, int]) -> tuple[int, int]:
    """Shrink every render target for a coarse picture; return the window's (width, height)."""
    share = min(max(COARSE, COARSE_PIXELS / min(size)), 1.0)

    def small(number: Scalar) -> int:
        return max(round(project.number(number) * share), 1)

    for library in project.libraries:
        for target in library.renderTargets:
            written = target.settings.get("SIZE")
            if written is not None:
                target.settings["SIZE"] = Setting(tuple(small(p) for p in written.parts))
    return small(size[0]), small(size[1])
