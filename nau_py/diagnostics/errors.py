"""Exceptions of nau_py.

::

    NauError                 base of every error of this package
    ├── ProjectError         the project is wrong: the diagnostics give the places
    ├── DeviceError          no usable OpenGL driver
    ├── ShaderError          a GLSL program does not compile or link
    ├── ProgramError         a ray program failed, or returned a wrong type
    └── OutputError          a result cannot be written
"""

from __future__ import annotations

from collections.abc import Iterable

from nau_py.diagnostics.diagnostic import Diagnostic


class NauError(Exception):
    """Base class of errors, with the diagnostics that explain them."""

    def __init__(self, diagnostics: Diagnostic | Iterable[Diagnostic]) -> None:
        listed = [diagnostics] if isinstance(diagnostics, Diagnostic) else list(diagnostics)
        super().__init__("\n".join(str(d) for d in listed))
        self.diagnostics = listed


class ProjectError(NauError):
    """The project is wrong."""


class DeviceError(NauError):
    """There is no usable OpenGL driver."""


class ShaderError(NauError):
    """A GLSL program does not compile or link."""


class ProgramError(NauError):
    """A ray program failed."""


class OutputError(NauError):
    """A result cannot be written."""
