"""nau_py: hybrid rendering from project files.

>>> project = nau_py.load("projects/selective/project.xml")
>>> for finding in nau_py.lint(project): ...
>>> frame = nau_py.Renderer(project).render()
>>> frame.image.shape
(1024, 1024, 4)
"""

from __future__ import annotations

import gc
from importlib import import_module
from typing import TYPE_CHECKING, Any

# Modules and classes are no garbage: to look for it meanwhile takes a tenth of the start.
_collects_garbage = gc.isenabled()
gc.disable()

from nau_py.api import lint, load, plan
from nau_py.diagnostics.diagnostic import Diagnostic, Severity
from nau_py.diagnostics.errors import (
    DeviceError,
    NauError,
    OutputError,
    ProgramError,
    ProjectError,
    ShaderError,
)
from nau_py.diagnostics.location import Location
from nau_py.model.linked import Project
from nau_py.version import __version__

if _collects_garbage:
    gc.enable()

if TYPE_CHECKING:
    from nau_py.graph import Plan
    from nau_py.passes.frame import RunOptions
    from nau_py.run.frame import Frame
    from nau_py.run.renderer import Renderer

__all__ = [
    "DeviceError",
    "Diagnostic",
    "Frame",
    "Location",
    "NauError",
    "OutputError",
    "Plan",
    "ProgramError",
    "Project",
    "ProjectError",
    "Renderer",
    "RunOptions",
    "Severity",
    "ShaderError",
    "__version__",
    "lint",
    "load",
    "plan",
]

_LAZY = {
    "Frame": "nau_py.run.frame",
    "Plan": "nau_py.graph",
    "Renderer": "nau_py.run.renderer",
    "RunOptions": "nau_py.passes.frame",
}


def __getattr__(name: str) -> Any:
    """Import the modules that run projects at first use, so that linting starts fast."""
    if name in _LAZY:
        return getattr(import_module(_LAZY[name]), name)
    raise AttributeError(f"module 'nau_py' has no attribute '{name}'")
