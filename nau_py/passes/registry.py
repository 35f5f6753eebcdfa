"""The pass classes that nau_py has, built in and from plug-ins.

A plug-in is an entry point of the group ``nau_py.passes`` whose name is the pass class and whose
object is a :class:`PassClass` (docs/extending.md).
"""

from __future__ import annotations

from functools import lru_cache
from typing import Protocol

from nau_py.graph.contract import Access
from nau_py.model.linked import Project
from nau_py.model.passes import Pass
from nau_py.passes.frame import FrameContext
from nau_py.passes.report import PassReport
from nau_py.plugins import PASSES, loaded


class PassClass(Protocol):
    """One pass class: a pure half for planning and a half that runs."""

    def access(self, project: Project, pass_: Pass) -> Access:
        """What ``pass_`` reads and writes. Pure."""
        ...

    def execute(self, pass_: Pass, frame: FrameContext) -> PassReport:
        """Run ``pass_`` once; return the work it did."""
        ...


@lru_cache(maxsize=1)
def pass_classes() -> dict[str, PassClass]:
    """Pass classes by name."""
    from nau_py.passes.compute import ComputeClass
    from nau_py.passes.default import DefaultClass
    from nau_py.passes.depthmap import DepthmapClass
    from nau_py.passes.geometry_plugin import GeometryPluginClass
    from nau_py.passes.mask import MaskClass
    from nau_py.passes.profiler import ProfilerClass
    from nau_py.passes.quad import QuadClass
    from nau_py.passes.ray_query import RayQueryClass
    from nau_py.passes.raytrace import RaytraceClass

    raytrace, query, depthmap = RaytraceClass(), RayQueryClass(), DepthmapClass()
    found: dict[str, PassClass] = {
        "default": DefaultClass(),
        "quad": QuadClass(),
        "depthmap": depthmap,
        "depthmap2": depthmap,
        "geometryPI": GeometryPluginClass(),
        "profiler": ProfilerClass(),
        "optixPrime": query,
        "embree": query,
        "compute": ComputeClass(),
        "mask": MaskClass(),
        "raytrace": raytrace,
        "rt": raytrace,
        "optix": raytrace,
    }
    return loaded(PASSES) | found
