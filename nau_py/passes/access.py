"""Resources that materials, targets and process items make a pass read and write."""

from __future__ import annotations

from nau_py.graph.contract import Access
from nau_py.graph.resource import WINDOW, Resource
from nau_py.model.library import DEFAULT_LIBRARY, qualify_name
from nau_py.model.linked import Project
from nau_py.model.maps import InjectionMap
from nau_py.model.material import BufferUnit
from nau_py.model.passes import Pass, ProcessBuffer, ProcessTexture


def texture(name: str | None, library: str | None) -> Resource:
    """Return the texture ``name`` of ``library``, of the default library where it is None."""
    return Resource("texture", qualify_name(name or "", library or DEFAULT_LIBRARY))


def buffer(name: str | None, library: str | None) -> Resource:
    """Return the buffer ``name`` of ``library``, of the default library where it is None."""
    return Resource("buffer", qualify_name(name or "", library or DEFAULT_LIBRARY))


def buffer_of(project: Project, unit: BufferUnit, library: str) -> Resource:
    """Return the buffer that a material binds: of its own library, else of ``fromLibrary``."""
    own = buffer(unit.name, library)
    if unit.fromLibrary and own.name not in project.names("buffer"):
        return buffer(unit.name, unit.fromLibrary)
    return own


def add_material(access: Access, project: Project, library: str, name: str) -> None:
    """Add what drawing with a material reads and writes beside the target."""
    found = project.material(library, name)
    if found is None:
        return
    material = found[1]
    for unit in material.textures:
        access.add_read(texture(unit.name, library))
    for image in material.imageTextures:
        mode = str((image.get("ACCESS") or ("WRITE_ONLY",))[0])
        resource = texture(image.texture, library)
        if mode != "WRITE_ONLY":
            access.add_read(resource)
        if mode != "READ_ONLY":
            access.add_write(resource)
    for bound in material.buffers:
        resource = buffer_of(project, bound, library)
        access.add_read(resource)
        if (bound.get("TYPE") or ("SHADER_STORAGE",))[0] != "UNIFORM":
            access.add_write(resource)


def _add_injection(access: Access, map_: InjectionMap) -> None:
    for item in map_.textures:
        access.add_read(texture(item.name, item.fromLibrary))
    for image in map_.imageTextures:
        resource = texture(image.texture, image.fromLibrary)
        access.add_read(resource)
        access.add_write(resource)
    for bound in map_.buffers:
        resource = buffer(bound.name, bound.fromLibrary)
        access.add_read(resource)
        access.add_write(resource)


def add_maps(access: Access, project: Project, pass_: Pass) -> None:
    """Add what the material and injection maps of a pass read and write."""
    for injection in pass_.injectionMaps:
        _add_injection(access, injection)
    for map_ in pass_.materialMaps:
        add_material(access, project, map_.toLibrary or DEFAULT_LIBRARY, map_.toMaterial or "")


def add_commands(access: Access, pass_: Pass) -> None:
    """Add the buffer of indirect draw commands; drawing writes the number of indices into it."""
    if pass_.scenes is not None and pass_.scenes.drawIndirectBuffer:
        resource = Resource("buffer", pass_.scenes.drawIndirectBuffer)
        access.add_read(resource)
        access.add_write(resource)


def add_process(access: Access, pass_: Pass) -> None:
    """Add what pre- and post-process items read and write."""
    for item in [*pass_.preProcess, *pass_.postProcess]:
        if isinstance(item, ProcessTexture):
            resource = texture(item.name, item.fromLibrary)
            access.add_read(resource)
            access.add_write(resource)
        elif isinstance(item, ProcessBuffer):
            access.add_write(buffer(item.name, item.fromLibrary))


def add_target(access: Access, project: Project, pass_: Pass, clears: bool) -> None:
    """Add the textures that a pass draws into, or the window.

    ``clears``: passes of the class clear their target first, unless COLOR_CLEAR or DEPTH_CLEAR are
    false.
    """
    if pass_.renderTarget is None:
        access.add_write(WINDOW)
        return
    owner = project.target_of(pass_)
    if owner is None:
        if pass_.renderTarget.sameas:  # the earlier pass draws into the window
            access.add_write(WINDOW)
        return
    library, target = owner
    colour = clears and bool((pass_.get("COLOR_CLEAR") or (True,))[0])
    depth = clears and bool((pass_.get("DEPTH_CLEAR") or (True,))[0])
    whole = pass_.viewport is None and not pass_.viewports
    for name in target.texture_names:
        resource = texture(name, library)
        cleared = depth if name == target.depth_name else colour
        if resource not in access.writes:
            access.add_write(resource)
        if cleared and whole:
            access.replaces.append(resource)
        elif clears and not cleared and resource not in access.reads:
            access.add_read(resource)
            access.keeps.append(resource)
