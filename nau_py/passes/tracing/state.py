"""State that a raytrace pass keeps from frame to frame."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from nau_py.model.library import DEFAULT_LIBRARY
from nau_py.model.raytrace import RayMaterial, RaytracePass
from nau_py.passes.frame import Session
from nau_py.passes.tracing.material_shading import MaterialShading
from nau_py.passes.tracing.programs import LoadedPrograms, load_programs
from nau_py.passes.tracing.textures import TextureCache
from nau_py.raytrace.programs.description import CLOSEST_HIT
from nau_py.raytrace.tracing.accelerator import Accelerator
from nau_py.raytrace.tracing.estimate import LaunchResult, PixelEstimates
from nau_py.raytrace.tracing.face_faults import find_face_faults
from nau_py.raytrace.tracing.geometry import RayGeometry, gather_triangles
from nau_py.raytrace.tracing.launch import RayLaunch
from nau_py.raytrace.tracing.main_thread import MainThread
from nau_py.raytrace.tracing.scene_tables import TexelStore
from nau_py.scene.material import RenderMaterial


class TracingState:
    """Geometry, programs, textures and estimates of a raytrace pass (a ``PassState``)."""

    def __init__(self, pass_: RaytracePass, session: Session) -> None:
        self._pass, self._session = pass_, session
        world = session.world
        objects = world.objects(pass_.scene_names)
        self.geometry: RayGeometry = gather_triangles(objects, world.moved)
        session.resources.diagnostics += find_face_faults(pass_, objects, self.geometry.dropped)
        self.accelerator = Accelerator(self.geometry)
        self._moves, self._moved = world.moves, world.moved
        self.texels = TexelStore()
        self.textures = TextureCache(session)
        self.main_thread = MainThread()
        self._materials = session.pass_materials(pass_)
        solid = [o for o in objects if o.mesh.primitive == "TRIANGLES"]
        self.shading = MaterialShading(solid, self._materials, self.main_thread)
        self.label = f"project '{session.project.name}', pass '{pass_.name}'"
        self._compiled = False
        self._estimates: tuple[bytes, PixelEstimates] | None = None
        self.programs: LoadedPrograms
        self.reload_programs()

    def reload_shaders(self, files: set[Path]) -> None:
        """Compile the GLSL programs that shade hits again at the next hit."""
        self.shading.forget()

    def reload_programs(self) -> None:
        """Load the programs of the pass, the first time or again. Raises
        :class:`~nau_py.ProgramError`; the programs loaded before then stay in use."""
        materials = [(name, self.find_programs(name)) for name in self.geometry.materials]
        provided = {(CLOSEST_HIT, "material"): self.shading}
        self.programs = load_programs(self._pass, self._session, materials, provided, self.label)
        self._estimates = None

    def close(self) -> None:
        """Do nothing: geometry and programs are freed with the state."""

    def follow_moves(self) -> None:
        """Rebuild the geometry of objects that have moved since the last frame."""
        world = self._session.world
        if world.moves == self._moves:
            return
        objects, centre = world.objects(self._pass.scene_names), self.geometry.centre
        self.geometry = gather_triangles(objects, world.moved, centre)
        if world.moved == self._moved:
            self.accelerator.rebuild_moving(self.geometry)
        else:
            self.accelerator = Accelerator(self.geometry)
        self._moves, self._moved = world.moves, world.moved
        self._estimates = None

    def compile_once(self, launch: RayLaunch) -> None:
        """Compile the kernels of the pass before its first launch, or load them."""
        if not self._compiled:
            launch.compile_kernels()
            self._compiled = True

    def continue_estimates(self, launch: RayLaunch, pixels: NDArray[np.int64]) -> LaunchResult:
        """Return the result of earlier frames if camera, pixels, lights and materials are the same;
        else an empty one."""
        tables = launch.scene.tables
        parts = [
            launch.generation.camera,
            pixels,
            tables.arrays["lights"],
            tables.arrays["materials"],
        ]
        key = b"".join(part.tobytes() for part in parts)
        if self._estimates is None or self._estimates[0] != key:
            self._estimates = (key, PixelEstimates.empty(len(pixels)))
        return LaunchResult(self._estimates[1])

    def find_material(self, name: str) -> RenderMaterial | None:
        """Return the material that a material group of the scene has in this pass."""
        return self._materials[name] or self._session.world.materials.get(DEFAULT_LIBRARY, name)

    def find_programs(self, name: str) -> RayMaterial | None:
        """Return the node with the programs of a material: its exact entry, that of a prefix, or
        the default's (docs/format.md, 7.1)."""
        material = self._materials[name]
        return self._pass.entry({name} | (material.names if material is not None else set()))
