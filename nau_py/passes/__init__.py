"""One file a pass class: what it reads, writes and does.

The reading and writing halves are pure; GL and Embree arrive through the frame that a pass
executes on, so that planning imports neither.
"""

from nau_py.passes.registry import pass_classes

__all__ = ["pass_classes"]
