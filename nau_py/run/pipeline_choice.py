"""Choice of the pipeline to run."""

from __future__ import annotations

from nau_py.diagnostics.diagnostic import error
from nau_py.diagnostics.errors import ProjectError
from nau_py.diagnostics.suggest import format_names, suggest_name
from nau_py.model.linked import Project
from nau_py.model.pipeline import Pipeline


def choose_pipeline(project: Project, name: str | None) -> Pipeline:
    """Return the pipeline called ``name``, or the default. Raises :class:`ProjectError`."""
    found = project.pipeline(name) if name is not None else project.default_pipeline
    if found is None:
        known = [p.name or "" for p in project.pipelines]
        wanted = f"pipeline '{name}'" if name is not None else "a pipeline to run"
        where = (
            project.file.pipelines.location if project.file.pipelines else (project.file.location)
        )
        raise ProjectError(
            error(
                "R013",
                where,
                f"project '{project.name}' has no {wanted}; it has {format_names(known)}"
                f"{suggest_name(name or '', known)}",
            )
        )
    return found
