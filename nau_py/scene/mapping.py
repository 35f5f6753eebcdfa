"""Materials that a pass draws with, by material name (docs/format.md, 4.6 and 4.7)."""

from __future__ import annotations

from dataclasses import replace

from nau_py.model.library import DEFAULT_LIBRARY, qualify_name
from nau_py.model.linked import Project
from nau_py.model.maps import InjectedColor, InjectionMap, match_pattern
from nau_py.model.node import Configured
from nau_py.model.passes import Pass
from nau_py.model.texture import Texture
from nau_py.scene.material import (
    BufferBinding,
    ImageBinding,
    RenderMaterial,
    TextureBinding,
    list_parts,
    make_library_material,
)

_FLAGS = {
    "ambient": "AMBIENT",
    "diffuse": "DIFFUSE",
    "specular": "SPECULAR",
    "emission": "EMISSION",
    "shininess": "SHININESS",
}


class MaterialTable:
    """All materials of files and models by (library, name). The first definition stays."""

    def __init__(self, project: Project) -> None:
        self.project = project
        self._materials: dict[tuple[str, str], RenderMaterial] = {}
        for library in project.libraries:
            for node in library.materials:
                if library.name and node.name:
                    key = (library.name, node.name)
                    if key not in self._materials:
                        self._materials[key] = make_library_material(project, library.name, node)

    def add(self, material: RenderMaterial) -> None:
        """Add a material of a model, unless the name is taken."""
        self._materials.setdefault((material.library, material.name), material)

    def get(self, library: str, name: str) -> RenderMaterial | None:
        return self._materials.get((library, name))

    def default_names(self) -> list[str]:
        """List the names in the default library, in order of definition."""
        return [name for library, name in self._materials if library == DEFAULT_LIBRARY]

    def for_pass(self, pass_: Pass, pipeline: str, texture_filter: str = "") -> PassMaterials:
        """Collect the materials of ``pass_``.

        ``texture_filter``: NEAREST or LINEAR, for image textures that have no filter of their own.
        """
        return PassMaterials(self, pass_, pipeline, texture_filter)


class PassMaterials:
    """The materials of one pass: injection maps, then material maps, which override them."""

    def __init__(
        self, table: MaterialTable, pass_: Pass, pipeline: str, texture_filter: str = ""
    ) -> None:
        self._table = table
        self._filter = texture_filter
        self._filtered: dict[str, RenderMaterial] = {}
        self._library = f"{pipeline}#{pass_.name}"
        self._mapped: dict[str, RenderMaterial] = {}
        self._everything: RenderMaterial | None = None
        for injection in pass_.injectionMaps:
            for name in table.default_names():
                if injection.toMaterial and match_pattern(injection.toMaterial, name):
                    self._inject(name, injection)
        for map_ in pass_.materialMaps:
            target = table.get(map_.toLibrary or DEFAULT_LIBRARY, map_.toMaterial or "")
            if target is None or not map_.fromMaterial:
                continue
            if map_.fromMaterial == "*":
                self._everything = target
                self._mapped.clear()
            for name in table.default_names():
                if match_pattern(map_.fromMaterial, name):
                    self._mapped[name] = target

    def __getitem__(self, name: str) -> RenderMaterial | None:
        """Return the material to draw geometry of material ``name`` with."""
        found = self._mapped.get(name) or self._everything
        found = found or self._table.get(DEFAULT_LIBRARY, name)
        if not self._filter or found is None:
            return found
        if name not in self._filtered:
            textures = {unit: self._with_filter(b) for unit, b in found.textures.items()}
            self._filtered[name] = replace(found, textures=textures)
        return self._filtered[name]

    def _with_filter(self, binding: TextureBinding) -> TextureBinding:
        given = {name for name, _ in binding.sampler}
        node = self._table.project.names("texture").get(binding.texture)
        image = binding.path is not None or (isinstance(node, Texture) and node.filename)
        if not image or given & {"MAG_FILTER", "MIN_FILTER"}:
            return binding
        more = (("MAG_FILTER", (self._filter,)), ("MIN_FILTER", (self._filter,)))
        return replace(binding, sampler=(*binding.sampler, *more))

    def _inject(self, name: str, injection: InjectionMap) -> None:
        clone = self._mapped.get(name)
        if clone is None:
            original = self._table.get(DEFAULT_LIBRARY, name)
            if original is None:
                return
            clone = self._mapped[name] = original.clone(self._library)
        project = self._table.project
        if injection.state is not None:
            state = project.state(injection.state.fromLibrary or "", injection.state.name or "")
            if state is not None:
                clone.state = {k: project.value(state, "STATE", k) for k in state.settings}
        if injection.shader is not None:
            source = self._table.get(
                injection.shader.fromLibrary or "", injection.shader.fromMaterial or ""
            )
            if source is not None:
                clone.program, clone.uniforms = source.program, source.uniforms
        for texture in injection.textures:
            if texture.toUnit is not None:
                clone.textures[texture.toUnit] = TextureBinding(
                    qualify_name(texture.name or "", texture.fromLibrary or ""),
                    list_parts(texture.settings),
                )
        for image in injection.imageTextures:
            if image.toUnit is not None:
                clone.images[image.toUnit] = ImageBinding(
                    qualify_name(image.texture or "", image.fromLibrary or ""),
                    list_parts(image.settings),
                )
        for bound in injection.buffers:
            clone.buffers.append(self._buffer(bound, bound.name, bound.fromLibrary))
        if injection.color is not None:
            self._inject_color(clone, injection.color)

    def _buffer(self, node: Configured, name: str | None, library: str | None) -> BufferBinding:
        project = self._table.project
        kind = str((node.get("TYPE") or ("SHADER_STORAGE",))[0])
        point = int(project.value(node, "BUFFER_BINDING", "BINDING_POINT")[0])
        return BufferBinding(qualify_name(name or "", library or ""), kind, max(point, 0))

    def _inject_color(self, clone: RenderMaterial, color: InjectedColor) -> None:
        source = self._table.get(color.fromLibrary or "", color.fromMaterial or "")
        if source is None:
            return
        flags = [key for key in _FLAGS if getattr(color, key) is not None]
        wanted = (
            [_FLAGS[k] for k in flags if getattr(color, k) == "true"]
            if flags
            else list(_FLAGS.values())
        )
        for name in wanted:
            clone.colours[name] = source.colours[name]
