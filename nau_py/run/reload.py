"""Hot reload: follow the files of a project, and render again after a change.

A changed shader is compiled again and a changed ray program loaded again; any other change loads
the whole project. After an error the last good state stays, and the error is raised.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from nau_py.diagnostics.errors import NauError
from nau_py.model.linked import Project
from nau_py.process.file_watch import FileWatch
from nau_py.run.frame import Frame
from nau_py.run.renderer import Renderer
from nau_py.run.used_files import PROGRAM, SHADER, used_files


class HotReload:
    """Project that is rendered again when its files change; :attr:`watch` follows them.

    ``load`` reads the project; ``make`` makes a renderer for it, and raises
    :class:`~nau_py.NauError` for a wrong one. ``frame``: the frame to render. ``own``: file
    that is written from the pictures, which is not followed.
    """

    def __init__(
        self,
        path: Path,
        load: Callable[[Path], Project],
        make: Callable[[Project], Renderer],
        frame: int = 0,
        own: Path | None = None,
    ) -> None:
        self._own = own.resolve() if own is not None else None
        self.path, self._load, self._make, self._frame = path, load, make, frame
        self.project = load(path)
        self.renderer: Renderer | None = None
        self._sound = False
        """True if the last rendering succeeded: only then a part of it may be exchanged."""
        self.watch = FileWatch()
        self._follow(self.project)

    def _follow(self, project: Project) -> None:
        """Follow the files of ``project``, and those of the one that is shown."""
        kinds = used_files(self.project) | used_files(project)
        if self._own is not None:
            kinds.pop(self._own, None)
        self.watch.follow(kinds)

    def start(self) -> Frame:
        """Render for the first time. Raises :class:`~nau_py.NauError`."""
        return self._whole(self.project)

    def render(self, changed: dict[Path, str]) -> Frame:
        """Take in what has changed, and render. Raises :class:`~nau_py.NauError`."""
        kinds = set(changed.values())
        if self.renderer is None or not self._sound or not kinds <= {SHADER, PROGRAM}:
            return self._reload()
        self._sound = False
        if SHADER in kinds:
            self.renderer.reload_shaders({p for p, kind in changed.items() if kind == SHADER})
        if PROGRAM in kinds:
            self._follow(self.project)  # programs may import new files
            self.renderer.reload_ray_programs()
        frame = self.renderer.again()
        self._sound = True
        return frame

    def _reload(self) -> Frame:
        project = self._load(self.path)
        self._follow(project)
        return self._whole(project)

    def _whole(self, project: Project) -> Frame:
        self._sound = False
        renderer = self._make(project)
        try:
            frame = renderer.render(self._frame)
        except NauError:
            renderer.close()
            raise
        if self.renderer is not None:
            self.renderer.close()
        self.project, self.renderer, self._sound = project, renderer, True
        self._follow(project)
        return frame

    def close(self) -> None:
        if self.renderer is not None:
            self.renderer.close()
