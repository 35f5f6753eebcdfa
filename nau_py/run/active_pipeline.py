"""The active pipeline of a run: pipelines that end, and their successors (docs/format.md, 11.2)."""

from __future__ import annotations

from nau_py.model.linked import Project
from nau_py.model.pipeline import Pipeline
from nau_py.run.pipeline_choice import choose_pipeline


class ActivePipeline:
    """Selects the active pipeline for a frame.

    Nau starts with the default pipeline. A pipeline ends when its test fails and, in mode
    ``RUN_ALL``, with its ``frameCount``-th frame; then the next in file order is active, with
    frames counted from 0 again. The run ends with the last pipeline. A pipeline that the caller
    names is the only one and has no last frame. Raises :class:`~nau_py.ProjectError` for an unknown
    name.
    """

    def __init__(self, project: Project, name: str | None) -> None:
        first = choose_pipeline(project, name)
        declared = project.pipelines
        self._pipelines = [first]
        self._counted = False
        if name is None:
            self._pipelines += declared[declared.index(first) + 1 :]
            pipelines = project.file.pipelines
            self._counted = pipelines is not None and pipelines.mode == "RUN_ALL"
        self._at = 0
        self._reason = ""

    @property
    def pipeline(self) -> Pipeline:
        """The active pipeline."""
        return self._pipelines[self._at]

    @property
    def over(self) -> bool:
        """True once the active pipeline has drawn its last frame."""
        return bool(self._reason)

    @property
    def ended(self) -> bool:
        """True once the last pipeline has drawn its last frame."""
        return self.over and self._at == len(self._pipelines) - 1

    @property
    def reason(self) -> str:
        """The reason why the run has ended; empty while there are more frames."""
        return f"pipeline '{self.pipeline.name}' has ended: {self._reason}" if self.ended else ""

    def end(self, reason: str) -> None:
        """Make this frame the last of the active pipeline."""
        self._reason = reason

    def is_last_frame(self, count: int) -> bool:
        """Return True if the pipeline's frame ``count``, from 0, is the last of ``frameCount``."""
        limit = self.pipeline.frameCount or 0
        return self._counted and limit > 0 and count + 1 == limit

    def advance(self) -> bool:
        """Activate the next pipeline if this one is over; return True if it was."""
        if not self.over or self.ended:
            return False
        self._at += 1
        self._reason = ""
        return True

    def restart(self) -> None:
        """Activate the first pipeline again."""
        self._at, self._reason = 0, ""
