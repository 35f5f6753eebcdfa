"""Materials as passes draw them: resolved to names and values, nothing on the GPU."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path

from nau_py.model.library import DEFAULT_LIBRARY, qualify_name
from nau_py.model.linked import Project
from nau_py.model.material import ImageUnits, Material, ValueOf
from nau_py.model.node import Setting
from nau_py.model.texture import ArrayOfTextures
from nau_py.model.values import Scalar
from nau_py.scene.readers.model_material import ModelMaterial, default_colours

OLD_DEFAULT = DEFAULT_LIBRARY.lstrip("_")
Settings = dict[str, Setting]
Colours = dict[str, tuple[float, ...]]


@dataclass(frozen=True, slots=True)
class TextureBinding:
    """A texture on a unit: ``lib::name``, or the path of an image file of a model."""

    texture: str
    sampler: tuple[tuple[str, tuple[Scalar, ...]], ...] = ()
    path: Path | None = None


@dataclass(frozen=True, slots=True)
class ImageBinding:
    """A texture on an image unit."""

    texture: str
    settings: tuple[tuple[str, tuple[Scalar, ...]], ...] = ()


@dataclass(frozen=True, slots=True)
class BufferBinding:
    """A buffer on a binding point."""

    buffer: str
    type: str
    point: int


@dataclass(frozen=True, slots=True)
class UniformSource:
    """A ``valueof``; ``library`` is searched for the textures that it names."""

    uniform: str
    type: str
    context: str
    component: str
    id: int
    block: str
    library: str
    node: ValueOf = field(compare=False, hash=False, repr=False)


@dataclass(slots=True)
class RenderMaterial:
    """A material as a pass draws it. ``program`` is (library, shader name)."""

    name: str
    library: str
    colours: Colours
    textures: dict[int, TextureBinding] = field(default_factory=dict)
    images: dict[int, ImageBinding] = field(default_factory=dict)
    buffers: list[BufferBinding] = field(default_factory=list)
    texture_arrays: list[tuple[int, ...]] = field(default_factory=list)
    """Units of each array of textures, by position in the material."""
    image_arrays: list[tuple[int, ...]] = field(default_factory=list)
    """Image units of each array of images, by position in the material."""
    state: dict[str, tuple[Scalar, ...]] = field(default_factory=dict)
    program: tuple[str, str] = (DEFAULT_LIBRARY, "dirLightDifAmbPix")
    uniforms: tuple[UniformSource, ...] = ()

    @property
    def names(self) -> set[str]:
        """Names by which raytrace passes find it: alone, and after its library.

        Old projects write the default library's name without underscores.
        """
        libraries = {self.library} | ({OLD_DEFAULT} if self.library == DEFAULT_LIBRARY else set())
        joined = {f"{lib}{sign}{self.name}" for lib in libraries for sign in (":", "::")}
        return {self.name} | joined

    def clone(self, library: str) -> RenderMaterial:
        """Copy the material for an injection map.

        Sampler settings, image settings and image arrays are lost, as in Nau (4.7).
        """
        return replace(
            self,
            library=library,
            colours=dict(self.colours),
            textures={u: replace(b, sampler=()) for u, b in self.textures.items()},
            images={
                u: replace(b, settings=())
                for u, b in self.images.items()
                if not any(u in array for array in self.image_arrays)
            },
            texture_arrays=list(self.texture_arrays),
            image_arrays=[],
            buffers=list(self.buffers),
            state=dict(self.state),
        )

    @property
    def order(self) -> int:
        """Drawing layer. A material with a negative one is not drawn."""
        return int(self.state.get("ORDER", (0,))[0])

    @property
    def enabled(self) -> bool:
        return self.order >= 0


def list_parts(settings: Settings) -> tuple[tuple[str, tuple[Scalar, ...]], ...]:
    return tuple((name, setting.parts) for name, setting in settings.items())


def list_uniform_sources(values: list[ValueOf], library: str) -> tuple[UniformSource, ...]:
    """List the sources of a material's uniforms, without incomplete ones, which lint reports."""
    return tuple(
        UniformSource(
            v.uniform,
            v.type,
            v.context or "CURRENT",
            v.component,
            v.id or 0,
            v.block or "",
            library,
            v,
        )
        for v in values
        if v.uniform and v.type and v.component
    )


def make_default_material(project: Project, name: str) -> RenderMaterial:
    """Copy ``__nauDefault`` as ``name``, in the default library."""
    found = project.material(DEFAULT_LIBRARY, "__nauDefault")
    colours = default_colours()
    material = RenderMaterial(name, DEFAULT_LIBRARY, colours)
    if found is not None and found[1].shader is not None:
        material.uniforms = list_uniform_sources(found[1].shader.values, DEFAULT_LIBRARY)
    return material


def make_model_material(project: Project, source: ModelMaterial) -> RenderMaterial:
    """Make the material of a model file."""
    material = make_default_material(project, source.name)
    material.colours |= source.colours
    for unit, path in sorted(source.textures.items()):
        material.textures[unit] = TextureBinding(str(path), path=path)
    return material


def make_library_material(project: Project, library: str, node: Material) -> RenderMaterial:
    """Make the material that a library file defines (docs/format.md, 6.8)."""
    material = make_default_material(project, node.name or "")
    material.library = library
    if node.color is not None:
        for name in node.color.settings:
            values = project.value(node.color, "COLOR", name)
            material.colours[name] = tuple(float(v) for v in values)
    for unit in node.textures:
        if unit.name is not None and unit.UNIT is not None:
            material.textures[unit.UNIT] = TextureBinding(
                qualify_name(unit.name, library), list_parts(unit.settings)
            )
    for image in node.imageTextures:
        if image.texture is not None and image.UNIT is not None:
            material.images[image.UNIT] = ImageBinding(
                qualify_name(image.texture, library), list_parts(image.settings)
            )
    for images in node.arraysOfImageTexture:
        _bind_images(project, material, library, images)
    for array in node.arraysOfTextures:
        _bind_array(project, material, library, array.name, array.firstUnit)
    buffers = project.names("buffer")
    for bound in node.buffers:
        name = qualify_name(bound.name or "", library)
        if name not in buffers and bound.fromLibrary:
            name = qualify_name(bound.name or "", bound.fromLibrary)
        kind = str((bound.get("TYPE") or ("SHADER_STORAGE",))[0])
        point = int(project.value(bound, "BUFFER_BINDING", "BINDING_POINT")[0])
        material.buffers.append(BufferBinding(name, kind, max(point, 0)))
    state_name = (node.state.name if node.state else None) or node.name or ""
    state = project.state(library, state_name)
    if state is not None:
        material.state = {name: project.value(state, "STATE", name) for name in state.settings}
    if node.shader is not None and node.shader.name:
        material.program = (library, node.shader.name)
        material.uniforms = list_uniform_sources(node.shader.values, library)
    return material


def _bind_images(
    project: Project, material: RenderMaterial, library: str, node: ImageUnits
) -> None:
    full = qualify_name(node.textureArray or "", library)
    array = project.names("texture array").get(full)
    if isinstance(array, ArrayOfTextures) and node.FIRST_UNIT is not None:
        for index in range(count_textures(project, array)):
            binding = ImageBinding(f"{full}_{index}", list_parts(node.settings))
            material.images[node.FIRST_UNIT + index] = binding
        material.image_arrays.append(units(node.FIRST_UNIT, count_textures(project, array)))


def units(first: int, count: int) -> tuple[int, ...]:
    return tuple(range(first, first + count))


def count_textures(project: Project, array: ArrayOfTextures) -> int:
    """Return the number of textures of an array."""
    return int(project.value(array, "ARRAY_OF_TEXTURES", "TEXTURE_COUNT")[0])


def _bind_array(
    project: Project, material: RenderMaterial, library: str, name: str | None, first: int | None
) -> None:
    full = qualify_name(name or "", library)
    array = project.names("texture array").get(full)
    if not isinstance(array, ArrayOfTextures) or first is None:
        return
    for index in range(count_textures(project, array)):
        material.textures[first + index] = TextureBinding(f"{full}_{index}")
    material.texture_arrays.append(units(first, count_textures(project, array)))
