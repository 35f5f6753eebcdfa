"""Parameters that a project's ``interface`` lets a user change (docs/format.md, 4.8), by name."""

from __future__ import annotations

from dataclasses import dataclass

from nau_py.diagnostics.diagnostic import error
from nau_py.diagnostics.errors import ProjectError
from nau_py.diagnostics.suggest import format_names, suggest_name
from nau_py.model.attribute import Attribute
from nau_py.model.interface import InterfaceVariable
from nau_py.model.linked import Project


@dataclass(frozen=True, slots=True)
class Parameter:
    """A variable of the interface: ``name`` is its label, and its window's before it where labels
    repeat."""

    name: str
    node: InterfaceVariable
    attribute: Attribute


def parameters(project: Project) -> list[Parameter]:
    """Return the variables whose attribute takes numbers, in file order."""
    interface = project.file.interface
    found: list[tuple[str, str, InterfaceVariable, Attribute]] = []
    for window in interface.windows if interface else []:
        for node in window.variables:
            set_ = project.registry.get(node.type or "")
            attribute = set_.get(node.component or "") if set_ else None
            if attribute is not None and attribute.type.is_number and node.label:
                found.append((window.label or "", node.label, node, attribute))
    labels = [label for _, label, _, _ in found]
    return [
        Parameter(label if labels.count(label) == 1 else f"{window}/{label}", node, attribute)
        for window, label, node, attribute in found
    ]


def parse(project: Project, name: str, text: str) -> tuple[Parameter, list[float]]:
    """Return the parameter called ``name``, and the numbers in ``text``. Raises
    :class:`~nau_py.ProjectError` for an unknown name and for illegal numbers."""
    known = parameters(project)
    where = project.file.location
    chosen = next((p for p in known if p.name == name), None)
    if chosen is None:
        names = [p.name for p in known]
        there = (
            f"there is {format_names(names)}{suggest_name(name, names)}"
            if names
            else "it offers none"
        )
        raise ProjectError(
            error("R020", where, f"the project offers no parameter '{name}': {there}")
        )
    wanted = chosen.attribute.type.components
    try:
        numbers = [float(part) for part in text.replace(",", " ").split()]
    except ValueError:
        numbers = []
    whole = not chosen.attribute.type.is_integer or all(n == int(n) for n in numbers)
    if len(numbers) != wanted or not whole:
        kind = "whole number" if chosen.attribute.type.is_integer else "number"
        message = f"parameter '{name}' is '{text}'; {wanted} {kind}{'s' * (wanted > 1)} expected"
        raise ProjectError(error("R020", chosen.node.where("component"), message))
    low, high = chosen.attribute.minimum, chosen.attribute.maximum
    for number in numbers:
        if (low is not None and number < low) or (high is not None and number > high):
            message = f"parameter '{name}' is {number:g}; legal is {_range(low, high)}"
            raise ProjectError(error("R020", chosen.node.where("component"), message))
    return chosen, numbers


def _range(low: float | None, high: float | None) -> str:
    if low is None:
        return f"up to {high:g}"
    return f"{low:g} and more" if high is None else f"{low:g} to {high:g}"
