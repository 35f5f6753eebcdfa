"""A whole project: the project file, its libraries, and the names that they define."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from nau_py.diagnostics.problem import Problem
from nau_py.model.attribute import Attribute
from nau_py.model.attributes import Registry
from nau_py.model.library import DEFAULT_LIBRARY, MaterialLibrary
from nau_py.model.material import Material
from nau_py.model.node import Configured, Node
from nau_py.model.passes import Pass
from nau_py.model.physics import PhysicsLibrary
from nau_py.model.pipeline import Pipeline
from nau_py.model.project import Assets, ProjectFile
from nau_py.model.shader import Shader
from nau_py.model.state import State
from nau_py.model.target import RenderTarget
from nau_py.model.values import Scalar

DEFAULT_SIZE = (640, 360)
"""Window size, pixels, of a project without one (Nau's composer)."""


@dataclass(slots=True)
class Project:
    """A project file with its libraries. Only data: nothing has been executed.

    ``libraries[0]`` is the built-in library; the others follow in load order.
    """

    path: Path
    file: ProjectFile
    registry: Registry = field(default_factory=Registry)
    libraries: list[MaterialLibrary] = field(default_factory=list)
    physics: list[PhysicsLibrary] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)
    sources: dict[str, str] = field(default_factory=dict)
    """Text of every file read, by the name used in locations."""
    _defaults: dict[tuple[type[Node], str, str], tuple[Scalar, ...]] = field(
        default_factory=dict, repr=False, compare=False
    )

    @property
    def name(self) -> str:
        """Name of the project, or of its file if it has none."""
        return self.file.name or self.path.stem

    @property
    def folder(self) -> Path:
        """Folder of the project file."""
        return self.path.parent

    @property
    def assets(self) -> Assets:
        """The assets; empty if the file has none."""
        return self.file.assets or Assets()

    @property
    def pipelines(self) -> list[Pipeline]:
        """All pipelines in file order."""
        return self.file.pipelines.pipelines if self.file.pipelines else []

    @property
    def size(self) -> tuple[int, int]:
        """Return window width and height, pixels (docs/format.md, 3.1)."""
        width, height = self.file.width, self.file.height
        if width is None or height is None:
            return DEFAULT_SIZE
        return (width, height) if width > 0 and height > 0 else (512, 512)

    @property
    def default_pipeline(self) -> Pipeline | None:
        """The pipeline to start with: the named one, else the first."""
        name = self.file.pipelines.default if self.file.pipelines else None
        if name is not None:
            return self.pipeline(name)
        return self.pipelines[0] if self.pipelines else None

    def pipeline(self, name: str) -> Pipeline | None:
        """Find a pipeline."""
        return next((p for p in self.pipelines if p.name == name), None)

    @property
    def constants(self) -> dict[str, float]:
        """Values of constants and aliases by name."""
        named = [*self.assets.constants, *self.assets.aliases]
        return {c.name: c.value for c in named if c.name is not None and c.value is not None}

    def number(self, value: Scalar | None, default: float = 0.0) -> float:
        """Return a number, or the value of the constant that ``value`` names, or ``default``."""
        if isinstance(value, str):
            return self.constants.get(value, default)
        return default if value is None else float(value)

    def value(self, node: Configured, type_: str, name: str) -> tuple[Scalar, ...]:
        """Return attribute ``name`` of ``node``, of the set ``type_``: as written, or its default.

        Constants are resolved. A VEC4 that is written with three components gets a fourth of 0.
        """
        parts = node.get(name)
        if parts is None:
            return self.default(type_, name, type(node))
        return self._resolved(self._attribute(type(node), type_, name), parts)

    def _attribute(self, model: type[Node], type_: str, name: str) -> Attribute:
        own = self.registry.of(model, type_).get(name)
        return own or self.registry[type_].attributes[name]

    def default(self, type_: str, name: str, model: type[Node] = Node) -> tuple[Scalar, ...]:
        """Return the default of an attribute of ``type_``, in nodes of ``model``. The default of a
        user attribute may name a constant."""
        found = self._defaults.get((model, type_, name))
        if found is None:
            attribute = self._attribute(model, type_, name)
            found = self._resolved(attribute, attribute.default) if attribute.default else ()
            self._defaults[model, type_, name] = found
        return found

    def _resolved(self, attribute: Attribute, parts: tuple[Scalar, ...]) -> tuple[Scalar, ...]:
        if not attribute.type.is_number:
            return parts
        numbers = [self.number(p) for p in parts]
        numbers += [0.0] * (attribute.type.components - len(numbers))
        if attribute.type.is_integer:
            return tuple(int(n) for n in numbers)
        return tuple(numbers)

    def _in(self, library: str) -> Iterator[MaterialLibrary]:
        return (lib for lib in self.libraries if lib.name == library)

    def material(self, library: str, name: str) -> tuple[MaterialLibrary, Material] | None:
        """Find a material with its library file."""
        return next(
            ((lib, m) for lib in self._in(library) for m in lib.materials if m.name == name), None
        )

    def shader(self, library: str, name: str) -> tuple[MaterialLibrary, Shader] | None:
        """Find a shader with its library file."""
        return next(
            ((lib, s) for lib in self._in(library) for s in lib.shaders if s.name == name), None
        )

    def state(self, library: str, name: str) -> State | None:
        """Find a state."""
        return next((s for lib in self._in(library) for s in lib.states if s.name == name), None)

    def render_target(self, library: str, name: str) -> RenderTarget | None:
        """Find a render target."""
        return next(
            (t for lib in self._in(library) for t in lib.renderTargets if t.name == name), None
        )

    def target_of_texture(self, texture: str) -> tuple[str, RenderTarget] | None:
        """Find the render target (library name, node) of attachment ``lib::texture``."""
        library, _, name = texture.partition("::")
        for lib in self._in(library):
            for target in lib.renderTargets:
                if name in target.texture_names:
                    return library, target
        return None

    def target_of(self, pass_: Pass) -> tuple[str, RenderTarget] | None:
        """Find the render target (library name, node) of a pass; None for the window.

        ``sameas`` takes the target of the last pass of that name before this one, in any pipeline
        (docs/format.md, 4.3).
        """
        reference = pass_.renderTarget
        if reference is None:
            return None
        if reference.sameas:
            found: Pass | None = None
            for other in (p for pipeline in self.pipelines for p in pipeline.passes):
                if other is pass_:
                    break
                if other.name == reference.sameas:
                    found = other
            return self.target_of(found) if found is not None else None
        library = reference.fromLibrary or ""
        target = self.render_target(library, reference.name or "")
        return (library, target) if target is not None else None

    def names(self, kind: str) -> dict[str, Node]:
        """Map the qualified names of a ``kind`` to their nodes.

        ``kind`` is one of the kinds of :attr:`nau_py.model.node.Attr.ref`.
        """
        plain: dict[str, list[Node]] = {
            "scene": [*self.assets.scenes, *self.assets.cameras],
            "camera": [*self.assets.cameras],
            "light": [*self.assets.lights],
            "viewport": [*self.assets.viewports],
            "pipeline": [*self.pipelines],
        }
        if kind in plain:
            return {n.name: n for n in plain[kind] if n.name}  # type: ignore[attr-defined]
        if kind == "library":
            return {lib.name: lib for lib in self.libraries if lib.name}
        found: dict[str, Node] = {}
        for lib in self.libraries:
            for name, node in _library_names(lib, kind):
                found.setdefault(f"{lib.name}::{name}", node)
        if kind == "buffer":  # physics makes those that take the positions of its particles
            for physics in self.physics:
                for body in physics.materials:
                    if made := body.get("BUFFER"):
                        found.setdefault(str(made[0]), body)
        return found

    def default_materials(self) -> list[str]:
        """List the materials of the default library that files (not models) define."""
        return [m.name for lib in self._in(DEFAULT_LIBRARY) for m in lib.materials if m.name]


def _library_names(lib: MaterialLibrary, kind: str) -> Iterator[tuple[str, Node]]:
    if kind == "texture":
        for target in lib.renderTargets:
            for name in target.texture_names:
                yield name, target
        for texture in lib.textures:
            yield texture.name or "", texture
        for array in lib.arraysOfTextures:
            count = (array.get("TEXTURE_COUNT") or (1,))[0]
            for index in range(int(count) if isinstance(count, int) else 1):
                yield f"{array.name}_{index}", array
        return
    listed: dict[str, list[Node]] = {
        "material": [*lib.materials],
        "shader": [*lib.shaders],
        "state": [*lib.states],
        "render target": [*lib.renderTargets],
        "texture array": [*lib.arraysOfTextures],
        "buffer": [*lib.buffers, *(a for a in lib.arraysOfTextures if a.get("CREATE_BUFFER"))],
    }
    for node in listed[kind]:
        yield node.name or "", node  # type: ignore[attr-defined]
