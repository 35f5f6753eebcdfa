"""The frame loop, its clock, what it captures and what it reports."""

from nau_py.run.renderer import Frame, Renderer

__all__ = ["Frame", "Renderer"]
