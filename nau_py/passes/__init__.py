"""Pass classes, one file each: parameters, what a pass reads and writes, faults, execution.

Importing a file registers its class (:func:`nau_py.passes.registry.register_pass`), as importing a
plug-in does. Files of classes import neither OpenGL nor Embree at the top: both arrive with the
frame that a pass executes in, so that linting and planning stay quick.
"""

# isort: off
# in the order in which messages and the reference list the classes
from nau_py.passes import default, quad, depthmap, geometry_plugin, profiler  # noqa: F401
from nau_py.passes import ray_query, compute, mask, raytrace, mesh  # noqa: F401

# isort: on
from nau_py.passes.registry import pass_classes

__all__ = ["pass_classes"]
