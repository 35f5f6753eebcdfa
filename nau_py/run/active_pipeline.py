"""Whose turn it is: pipelines that end, and the ones after them (docs/format.md, 11.2)."""

from __future__ import annotations

from nau_py.model.linked import Project
from nau_py.model.pipeline import Pipeline
from nau_py.run.pipeline_choice import choose_pipeline


class Turns:
    """The pipelines of a run.

    Nau starts with the default one. A pipeline ends where its test says no and, in mode
    ``RUN_ALL``, with its ``frameCount``-th frame; then the next in file order has its turn, with
    frames counted from 0 again. The run ends with the last. Where the caller names a pipeline,
    there is only that one and it has no last frame.
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
        self._why = ""

    @property
    def pipeline(self) -> Pipeline:
        """The one whose turn it is."""
        return self._pipelines[self._at]

    @property
    def over(self) -> bool:
        """Whether this one has drawn its last frame."""
        return bool(self._why)

    @property
    def ended(self) -> bool:
        """Whether the last one has ended."""
        return self.over and self._at == len(self._pipelines) - 1

    @property
    def why(self) -> str:
        """Why there are no more frames; empty while there are."""
        return f"pipeline '{self.pipeline.name}' has ended: {self._why}" if self.ended else ""

    def end(self, why: str) -> None:
        """Let this frame be the pipeline's last."""
        self._why = why

    def is_last_frame(self, count: int) -> bool:
        """Whether the pipeline's frame ``count``, from 0, is the last of its ``frameCount``."""
        limit = self.pipeline.frameCount or 0
        return self._counted and limit > 0 and count + 1 == limit

    def advance(self) -> bool:
        """Go on to the next pipeline if this one has ended; whether that is so."""
        if not self.over or self.ended:
            return False
        self._at += 1
        self._why = ""
        return True

    def restart(self) -> None:
        """Begin with the first again."""
        self._at, self._why = 0, ""
