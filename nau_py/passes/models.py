"""Faults of a project's models, found without drawing."""

from __future__ import annotations

from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.model.linked import Project
from nau_py.model.raytrace import RaytracePass
from nau_py.raytrace.tracing.face_faults import find_face_faults
from nau_py.raytrace.tracing.geometry import gather_triangles
from nau_py.scene.world import World


def model_faults(project: Project) -> list[Diagnostic]:
    """Load every model of the project; return its faults, and the faces that rays leave out.

    Needs neither OpenGL nor Embree; executes nothing.
    """
    world = World(project, project.size)
    found = list(world.diagnostics)
    for pipeline in project.pipelines:
        for pass_ in pipeline.passes:
            if isinstance(pass_, RaytracePass):
                objects = world.objects(pass_.scene_names)
                found += find_face_faults(pass_, objects, gather_triangles(objects).dropped)
    return found
