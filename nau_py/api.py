"""The functions behind the public names: load, lint, plan."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from nau_py.diagnostics.diagnostic import Diagnostic, Severity
from nau_py.model.linked import Project
from nau_py.passes import pass_classes

if TYPE_CHECKING:
    from nau_py.graph import Plan


def load(path: str | Path) -> Project:
    """Read a project file, XML or YAML, with its material libraries.

    Never raises for what the file says: :func:`lint` reports it.
    """
    from nau_py.formats import load_project

    return load_project(path)


def lint(project: Project, models: bool = False) -> list[Diagnostic]:
    """Every finding about ``project``, in file and line order. Executes nothing of it.

    ``models``: load its models too, once nothing else is an error, and add what is wrong with
    them: vertices that are not finite, faces that rays leave out, coordinates too large.
    """
    from nau_py.rules.engine import lint as run
    from nau_py.scene.names import default_material_names

    found = run(project, pass_classes(), default_material_names(project))
    if models and project.file.tag and not any(d.severity is Severity.ERROR for d in found):
        from nau_py.passes.models import model_faults

        found += model_faults(project)
    return found


def plan(project: Project, pipeline: str | None = None) -> Plan:
    """The plan of a pipeline (default: the project's own). Needs no GL context.

    Raises :class:`nau_py.ProjectError` for a pipeline that does not exist.
    """
    from nau_py.graph import make_plan
    from nau_py.run.pipeline_choice import choose_pipeline

    return make_plan(project, choose_pipeline(project, pipeline), pass_classes())
