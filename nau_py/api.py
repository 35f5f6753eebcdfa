"""The functions behind the public names: load, lint, plan."""

from __future__ import annotations

from pathlib import Path

from nau_py.diagnostics.diagnostic import Diagnostic, Severity
from nau_py.formats import load_project
from nau_py.graph import Plan, make_plan
from nau_py.model.linked import Project
from nau_py.passes import pass_classes
from nau_py.raytrace.programs import catalogue  # noqa: F401  (adds attributes to materials)
from nau_py.rules.engine import lint as find_faults
from nau_py.run.pipeline_choice import choose_pipeline
from nau_py.scene.names import list_default_materials


def load(path: str | Path) -> Project:
    """Read a project file, XML or YAML, with its material libraries.

    Never raises for the content of the file: :func:`lint` reports it.
    """
    return load_project(path)


def _project_html(project: Project) -> str:
    from nau_py.reporting.notebook import project_html

    return project_html(project)


# Notebooks call this method. The model itself makes no HTML.
Project._repr_html_ = _project_html  # type: ignore[attr-defined]


def lint(project: Project, models: bool = False) -> list[Diagnostic]:
    """Return every finding about ``project``, in file and line order. Executes nothing of it.

    ``models``: load its models too, once nothing else is an error, and add their faults: vertices
    that are not finite, faces that rays leave out, coordinates too large.
    """
    found = find_faults(project, pass_classes(), list_default_materials(project))
    if models and project.file.tag and not any(d.severity is Severity.ERROR for d in found):
        from nau_py.passes.models import model_faults

        found += model_faults(project)
    return found


def plan(project: Project, pipeline: str | None = None) -> Plan:
    """Return the plan of a pipeline (default: the project's own). Needs no GL context.

    Raises :class:`nau_py.ProjectError` for a pipeline that does not exist.
    """
    return make_plan(project, choose_pipeline(project, pipeline), pass_classes())
