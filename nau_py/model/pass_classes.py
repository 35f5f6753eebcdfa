"""Models of pass classes, chosen by ``class``.

:mod:`nau_py.passes` declares them: the model of a pass class is in the file of the class, unless
several rooms need it.
"""

from __future__ import annotations

from typing import Annotated

from nau_py.model.attribute import Attribute
from nau_py.model.attributes import BUILT_IN, PARAMETERS
from nau_py.model.node import Attr, Node
from nau_py.model.passes import Pass


class OtherPass(Pass):
    """A pass of a class that nau_py does not have."""


class MaterialReference(Node):
    """A material of a library."""

    name: Annotated[
        str | None, Attr(doc="Material.", required=True, ref="material", library="fromLibrary")
    ] = None
    fromLibrary: Annotated[str | None, Attr(doc="Library.", required=True, ref="library")] = None


PASS_CLASSES: dict[str, type[Pass]] = {}
"""Model of each declared pass class, by the value of ``class``."""


def declare_pass_class(
    name: str, model: type[Pass], parameters: tuple[Attribute, ...] = ()
) -> None:
    """Declare a pass class: the model of its element, and the attributes that only it has.

    Raises ValueError for a name that is taken, and for a parameter that every pass has.
    """
    if name in PASS_CLASSES:
        raise ValueError(f"pass class '{name}' is registered twice")
    shared = [p.name for p in parameters if p.name in BUILT_IN["PASS"]]
    if shared:
        raise ValueError(f"pass class '{name}': every pass has an attribute '{shared[0]}'")
    PASS_CLASSES[name] = model
    if parameters:
        PARAMETERS[model] = parameters
