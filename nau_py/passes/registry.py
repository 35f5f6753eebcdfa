"""The registry of pass classes: one base class, one call that registers, one table."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import ClassVar, TypeVar

from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.graph.contract import Access
from nau_py.model.attribute import Attribute
from nau_py.model.linked import Project
from nau_py.model.pass_classes import declare_pass_class
from nau_py.model.passes import Pass
from nau_py.passes.frame import FrameContext, Session
from nau_py.passes.report import PassReport
from nau_py.passes.state import PassState, Stateless
from nau_py.plugins import PASSES, load_plugins


class PassClass:
    """A pass class: the parameters, data flow, faults and execution of its passes.

    The docstring of a class becomes its documentation in the reference and in editors.
    """

    model: ClassVar[type[Pass] | None] = None
    """Model of the element, where the class has child elements of its own; else a plain pass."""
    parameters: ClassVar[tuple[Attribute, ...]] = ()
    """Attributes of PASS that only passes of this class have, written as child tags."""

    def access(self, project: Project, pass_: Pass) -> Access:
        """Return what ``pass_`` reads and writes. Pure: planning and linting call it."""
        raise NotImplementedError

    def faults(self, project: Project, pass_: Pass) -> Iterable[Diagnostic]:
        """Return the errors and warnings that reading the project shows. Pure: linting calls it."""
        return ()

    def prepare(self, pass_: Pass, session: Session) -> PassState:
        """Make the state that ``pass_`` keeps from frame to frame.

        ``frame.session.state(pass_, self.prepare)`` calls it once a session. Raises
        :class:`~nau_py.NauError`.
        """
        return Stateless()

    def execute(self, pass_: Pass, frame: FrameContext) -> PassReport:
        """Run ``pass_`` once and return the work it did. Raises :class:`~nau_py.NauError`."""
        raise NotImplementedError


C = TypeVar("C", bound=type[PassClass])
_CLASSES: dict[str, PassClass] = {}


def register_pass(*names: str) -> Callable[[C], C]:
    """Register a pass class under ``names``, the values of ``class`` in a project.

    Raises ValueError for a name that is taken, and for a parameter that every pass has.
    """

    def register(class_: C) -> C:
        model = class_.model or _plain_model(class_)
        instance = class_()
        for name in names:
            declare_pass_class(name, model, class_.parameters)
            _CLASSES[name] = instance
        return class_

    return register


def _plain_model(class_: type[PassClass]) -> type[Pass]:
    """Return a model without children of its own, documented as the class is. ``ToneClass`` and
    ``Tone`` have the model ``TonePass``."""
    namespace = {"__doc__": class_.__doc__, "__module__": class_.__module__}
    return type(f"{class_.__name__.removesuffix('Class')}Pass", (Pass,), namespace)


def pass_classes() -> dict[str, PassClass]:
    """Return the registered pass classes by name, those of plug-ins included."""
    load_plugins(PASSES)
    return _CLASSES
