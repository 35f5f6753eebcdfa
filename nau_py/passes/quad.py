"""Class ``quad``: fill the viewport with a texture or a material (docs/format.md, 4.4)."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from nau_py.graph.contract import Access
from nau_py.model.library import DEFAULT_LIBRARY, qualify_name
from nau_py.model.linked import Project
from nau_py.model.node import Attr, Child, Node
from nau_py.model.pass_classes import MaterialReference
from nau_py.model.passes import Pass
from nau_py.passes.access import add_maps, add_material, add_process, add_target, texture
from nau_py.passes.drawing import begin_drawing, draw_context, draw_mesh, run_process
from nau_py.passes.frame import FrameContext
from nau_py.passes.registry import PassClass, register_pass
from nau_py.passes.report import PassReport
from nau_py.scene.material import RenderMaterial, TextureBinding, make_default_material
from nau_py.scene.primitives import make_quad
from nau_py.scene.readers.model_material import QUAD_MATERIAL


class QuadTexture(Node):
    """A texture to fill the viewport with."""

    name: Annotated[
        str | None, Attr(doc="Texture.", required=True, ref="texture", library="fromLibrary")
    ] = None
    fromLibrary: Annotated[str | None, Attr(doc="Library.", ref="library")] = None


class QuadPass(Pass):
    """Fills its viewport with a texture or a material; the material wins."""

    texture: Annotated[QuadTexture | None, Child(QuadTexture)] = None
    material: Annotated[MaterialReference | None, Child(MaterialReference)] = None


@register_pass("quad")
class QuadClass(PassClass):
    """Draws one full-viewport quad."""

    model = QuadPass

    def access(self, project: Project, pass_: Pass) -> Access:
        access = Access()
        if isinstance(pass_, QuadPass):
            if pass_.material is not None:
                library = pass_.material.fromLibrary or DEFAULT_LIBRARY
                add_material(access, project, library, pass_.material.name or "")
            elif pass_.texture is not None:
                access.add_read(texture(pass_.texture.name, pass_.texture.fromLibrary))
        add_maps(access, project, pass_)
        add_process(access, pass_)
        add_target(access, project, pass_, clears=True)
        return access

    def material(self, pass_: Pass, frame: FrameContext) -> RenderMaterial:
        """Return the material of the quad: ``material``, ``texture``, or a mapped ``__Quad``."""
        table = frame.world.materials
        if isinstance(pass_, QuadPass) and pass_.material is not None:
            library = pass_.material.fromLibrary or DEFAULT_LIBRARY
            found = table.get(library, pass_.material.name or "")
            if found is not None:
                return found
        plain = table.get(DEFAULT_LIBRARY, QUAD_MATERIAL) or make_default_material(
            frame.project, QUAD_MATERIAL
        )
        if isinstance(pass_, QuadPass) and pass_.texture is not None:
            library = pass_.texture.fromLibrary or DEFAULT_LIBRARY
            name = qualify_name(pass_.texture.name or "", library)
            return replace(plain, textures={0: TextureBinding(name)})
        return frame.session.pass_materials(pass_)[QUAD_MATERIAL] or plain

    def execute(self, pass_: Pass, frame: FrameContext) -> PassReport:
        view = begin_drawing(pass_, frame)
        run_process(pass_.preProcess, frame)
        draw_mesh(make_quad(), self.material(pass_, frame), draw_context(pass_, frame, view))
        frame.session.resources.barrier()
        run_process(pass_.postProcess, frame)
        return PassReport(pixels=view.pixels)
