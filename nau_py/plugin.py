"""The names that a plug-in imports: pass classes, lint rules, mesh readers (docs/extending.md).

Importing this module loads neither OpenGL nor Embree, since linting loads plug-ins.
"""

from __future__ import annotations

from nau_py.diagnostics.catalogue import ERROR, NOTE, WARNING, rule
from nau_py.diagnostics.diagnostic import Change, Diagnostic, Fix, Part, error, warning
from nau_py.diagnostics.errors import NauError
from nau_py.graph.contract import Access
from nau_py.model.attribute import Attribute, choice, flag, number, vector
from nau_py.model.linked import Project
from nau_py.model.passes import Pass
from nau_py.model.values import DataType
from nau_py.passes.access import add_maps, add_process, add_target, buffer, texture
from nau_py.passes.drawing import (
    begin_drawing,
    draw_scenes,
    pass_value,
    resolve_view,
    run_process,
)
from nau_py.passes.frame import FrameContext, Session, View
from nau_py.passes.registry import PassClass, register_pass
from nau_py.passes.report import PassReport
from nau_py.passes.state import PassState
from nau_py.rules.registry import LintContext, check
from nau_py.scene.mesh import Group, Mesh, SceneObject, pad4
from nau_py.scene.readers.model_error import ModelError
from nau_py.scene.readers.model_material import ModelMaterial

__all__ = [
    "ERROR",
    "NOTE",
    "WARNING",
    "Access",
    "Attribute",
    "Change",
    "DataType",
    "Diagnostic",
    "Fix",
    "FrameContext",
    "Group",
    "LintContext",
    "Mesh",
    "ModelError",
    "ModelMaterial",
    "NauError",
    "Part",
    "Pass",
    "PassClass",
    "PassReport",
    "PassState",
    "Project",
    "SceneObject",
    "Session",
    "View",
    "add_maps",
    "add_process",
    "add_target",
    "begin_drawing",
    "buffer",
    "check",
    "choice",
    "draw_scenes",
    "error",
    "flag",
    "number",
    "pad4",
    "pass_value",
    "register_pass",
    "resolve_view",
    "rule",
    "run_process",
    "texture",
    "vector",
    "warning",
]
