"""Class ``mask``: draws the visible surfaces and writes the weight of each pixel."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from nau_py.diagnostics.diagnostic import Diagnostic, error
from nau_py.diagnostics.suggest import format_names, suggest_fix, suggest_name
from nau_py.graph.contract import Access
from nau_py.model.library import DEFAULT_LIBRARY
from nau_py.model.linked import Project
from nau_py.model.mask import MaskPass, PropertySelector, ShadowBorderSelector, TextureSelector
from nau_py.model.passes import Pass
from nau_py.passes.access import add_process, add_target, texture
from nau_py.passes.drawing import begin_drawing, camera_context, draw_objects, run_process
from nau_py.passes.frame import FrameContext, View
from nau_py.passes.registry import PassClass, register_pass
from nau_py.passes.report import PassReport
from nau_py.raytrace.selection.weights import VisibleSurfaces, compute_weights
from nau_py.scene.transforms import to_unit_cube

if TYPE_CHECKING:
    from nau_py.scene.material import RenderMaterial

ITEM_MATERIAL = "__item"
MASK_FORMATS = ["RGBA32F", "RGBA16F"]
"""Texel formats that hold a world position and a weight."""


@register_pass("mask")
class MaskClass(PassClass):
    """Writes world position and weight of each pixel into its render target."""

    model = MaskPass

    def faults(self, project: Project, pass_: Pass) -> Iterator[Diagnostic]:
        """Yield a target that cannot hold weights, and properties that no material has."""
        assert isinstance(pass_, MaskPass)
        owned = project.target_of(pass_)
        colors = owned[1].colors if owned else []
        label = f"mask pass '{pass_.name}'"
        if not colors:
            message = f"{label} needs a <renderTarget> with a colour texture"
            yield error("P003", pass_.location, message)
        elif (colors[0].internalFormat or "RGBA") not in MASK_FORMATS:
            yield error(
                "P003",
                colors[0].where("internalFormat"),
                f"{label} writes positions to '{colors[0].name}', of format "
                f"'{colors[0].internalFormat or 'RGBA'}'; {format_names(MASK_FORMATS)} holds them",
            )
        known = [a.name for a in project.registry["COLOR"]]
        for node in pass_.all_selectors():
            if isinstance(node, PropertySelector) and node.name and node.name not in known:
                yield error(
                    "P003",
                    node.where("name"),
                    f"{label}: materials have no '{node.name}'; there is {format_names(known)}"
                    f"{suggest_name(node.name, known)}",
                    suggest_fix(node.where("name"), node.name, known),
                )

    def access(self, project: Project, pass_: Pass) -> Access:
        access = Access()
        if isinstance(pass_, MaskPass):
            for node in pass_.all_selectors():
                name = None
                if isinstance(node, TextureSelector):
                    name = node.name
                elif isinstance(node, ShadowBorderSelector):
                    name = node.texture
                if name:
                    access.add_read(texture(name, None))
        add_process(access, pass_)
        add_target(access, project, pass_, clears=True)
        return access

    def execute(self, pass_: Pass, frame: FrameContext) -> PassReport:
        assert isinstance(pass_, MaskPass)
        view = begin_drawing(pass_, frame, frame.world.camera(pass_.camera_name))
        target = view.target
        target.clear_color((0.0, 0.0, 0.0, 0.0))
        run_process(pass_.preProcess, frame)
        drawn = frame.session.pass_materials(pass_)
        numbered: dict[str, RenderMaterial] = {}
        names: list[str] = []

        def numbered_material(name: str) -> RenderMaterial | None:
            source = drawn[name]
            if source is None or name in numbered:
                return numbered.get(name)
            names.append(name)
            numbered[name] = self._item(frame, source, len(names))
            return numbered[name]

        objects = frame.world.objects(pass_.scene_names)
        draw_objects(objects, numbered_material, camera_context(pass_, frame, view))
        image = target.textures[target.colors[0].name]
        seen = np.asarray(image.read(), np.float32)
        visible = self._visible(pass_, frame, view, seen, [(n, drawn[n]) for n in names])
        chosen = compute_weights(pass_.select, visible)
        image.write(np.dstack([seen[..., :3], chosen]))
        run_process(pass_.postProcess, frame)
        selected = int((chosen > 0).sum())
        note = f"{selected} of {chosen.size} pixels selected"
        return PassReport(pixels=view.pixels, notes=(note,))

    def _item(self, frame: FrameContext, source: RenderMaterial, number: int) -> RenderMaterial:
        """Return the material of the item shader: the state of ``source``, ``number`` as colour."""
        plain = frame.world.materials.get(DEFAULT_LIBRARY, ITEM_MATERIAL)
        assert plain is not None
        state = {k: v for k, v in source.state.items() if k not in ("BLEND", "ALPHA_TEST")}
        return replace(plain, colours={"EMISSION": (float(number), 0.0, 0.0, 1.0)}, state=state)

    def _visible(
        self,
        pass_: MaskPass,
        frame: FrameContext,
        view: View,
        seen: NDArray[np.float32],
        materials: list[tuple[str, RenderMaterial | None]],
    ) -> VisibleSurfaces:
        """Return the input of the selectors. ``seen``: position and item number of each pixel,
        (height, width, 4), row 0 at the bottom."""
        visible = VisibleSurfaces(
            seen[..., :3],
            np.rint(seen[..., 3]).astype(np.int32) - 1,
            [(name, dict(m.colours) if m else {}) for name, m in materials],
            view.camera.position,
        )
        for node in pass_.all_selectors():
            name = node.name if isinstance(node, TextureSelector) else None
            if isinstance(node, ShadowBorderSelector):
                name = node.texture
                visible.cameras[node.camera or ""] = _unit_cube(frame, node.camera)
            if name:
                found = frame.session.resources.texture(name)
                if found is not None:
                    visible.textures[name] = found.read_values()
        return visible


def _unit_cube(frame: FrameContext, name: str | None) -> NDArray[np.float64]:
    """Return the matrix from world space to the unit cube of a camera as it last drew, (4, 4)."""
    camera = frame.world.camera(name)
    rect = frame.session.camera_rects.get(camera.name) or frame.world.viewport(camera.viewport)
    projection = camera.projection_matrix(rect.aspect)
    return np.asarray(to_unit_cube() @ projection @ camera.view_matrix(), np.float64)
