"""Knobs applied to a project: the nodes and the attribute that a knob sets, and its values."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite

from nau_py.diagnostics.suggest import format_names, suggest_name
from nau_py.model.accuracy import KNOBS
from nau_py.model.linked import Project
from nau_py.model.mask import MaskPass
from nau_py.model.node import Node, Setting
from nau_py.model.passes import Pass
from nau_py.model.raytrace import RaytracePass
from nau_py.model.schema import schema_of

Value = float | int | str


class IdleKnob(ValueError):
    """Raised for a knob that has no effect on the pipeline."""


@dataclass(frozen=True, slots=True)
class KnobTarget:
    """The nodes that a knob sets, their attribute, and the values that it accepts."""

    nodes: tuple[Node, ...] = ()
    attribute: str = ""
    whole: bool = False
    words: tuple[str, ...] = ()
    low: float = -float("inf")
    high: float = float("inf")

    def parse(self, text: str) -> Value:
        """Read a value of the knob. Raises ValueError with the legal values."""
        if self.words:
            if text not in self.words:
                raise ValueError(
                    f"'{text}' is none of {format_names(self.words)}"
                    f"{suggest_name(text, list(self.words))}"
                )
            return text
        try:
            number = float(text)
        except ValueError:
            raise ValueError(f"'{text}' is no number") from None
        if not isfinite(number) or not self.low <= number <= self.high:
            most = f" to {self.high:g}" if isfinite(self.high) else " and more"
            raise ValueError(f"{text} is out of range: legal is {self.low:g}{most}")
        if self.whole and number != int(number):
            raise ValueError(f"{text} is no whole number")
        return int(number) if self.whole else number

    def parse_values(self, text: str) -> tuple[Value, ...]:
        """Read a list of values, separated by commas or blanks. Raises ValueError."""
        parts = re.split(r"[\s,]+", text.strip()) if text.strip() else []
        if not parts:
            raise ValueError("it has no value")
        values = tuple(self.parse(part) for part in parts)
        doubled = next((v for i, v in enumerate(values) if v in values[:i]), None)
        if doubled is not None:
            raise ValueError(f"{doubled} is there twice")
        return values

    def set(self, value: Value) -> None:
        """Write a value into the nodes."""
        for node in self.nodes:
            if isinstance(node, Pass):
                node.settings[self.attribute] = Setting((value,))
            else:
                setattr(node, self.attribute, value)

    def get(self, project: Project) -> Value | None:
        """Return the value in the project; None if no node sets it."""
        for node in self.nodes:
            if isinstance(node, Pass):
                found = project.value(node, "PASS", self.attribute)[0]
                return found if isinstance(found, int | float | str) else None
            value = getattr(node, self.attribute)
            if value is not None:
                return project.number(value)
        return None


def pick_raytrace_passes(passes: list[Pass]) -> list[RaytracePass]:
    """Return the raytrace passes among ``passes``."""
    return [p for p in passes if isinstance(p, RaytracePass)]


def find_knob_target(project: Project, passes: list[Pass], name: str) -> KnobTarget:
    """Find the nodes that the knob ``name`` sets in the pipeline of ``passes``.

    Raises LookupError for an unknown knob, :class:`IdleKnob` for one without effect.
    """
    kind = KNOBS.get(name)
    if kind is None:
        if "/" in name:
            return _target_of_path(project, passes, name)
        known = list(KNOBS)
        raise LookupError(
            f"there is no knob '{name}'; there is {format_names(known)}, or PASS/ATTRIBUTE"
            f"{suggest_name(name, known)}"
        )
    if name in ("scale", "filter"):
        return KnobTarget(words=kind.words, low=kind.low, high=kind.high)
    rays = pick_raytrace_passes(passes)
    if not rays:
        raise IdleKnob(f"knob '{name}' needs a raytrace pass; the pipeline has none")
    if name == "mask" and not any(p.mask for p in rays):
        raise IdleKnob("knob 'mask' needs a mask; the raytrace pass has none")
    if not kind.attribute:
        return KnobTarget(words=kind.words)
    return _pass_attribute(project, tuple(rays), kind.attribute)


def _pass_attribute(project: Project, nodes: tuple[Pass, ...], name: str) -> KnobTarget:
    attribute = project.registry["PASS"].attributes[name]
    low = -float("inf") if attribute.minimum is None else attribute.minimum
    high = float("inf") if attribute.maximum is None else attribute.maximum
    return KnobTarget(nodes, name, attribute.type.is_integer, attribute.values, low, high)


def _target_of_path(project: Project, passes: list[Pass], name: str) -> KnobTarget:
    first, *rest = name.split("/")
    found = [p for p in passes if p.name == first]
    if not found:
        known = [p.name for p in passes if p.name]
        raise LookupError(
            f"knob '{name}': there is no pass '{first}'; there is {format_names(known)}"
            f"{suggest_name(first, known)}"
        )
    if len(rest) == 1:
        writable = [a for a in project.registry["PASS"] if not a.readonly]
        names = [a.name for a in writable if a.type.components == 1]
        if rest[0] not in names:
            raise LookupError(
                f"knob '{name}': a pass has no attribute '{rest[0]}' of one component"
                f"{suggest_name(rest[0], names)}"
            )
        return _pass_attribute(project, tuple(found), rest[0])
    if len(rest) == 2:
        nodes = tuple(_selectors(found[0], rest[0], rest[1]))
        if nodes:
            return KnobTarget(nodes, rest[1])
        numbers = sorted(set(_selector_numbers(found[0])))
        raise LookupError(
            f"knob '{name}': pass '{first}' has no such number of a selector; it has "
            f"{format_names([f'{first}/{n}' for n in numbers])}"
        )
    raise LookupError(f"knob '{name}': write PASS/ATTRIBUTE or PASS/SELECTOR/ATTRIBUTE")


def _walk_selectors(pass_: Pass) -> Iterator[Node]:
    if isinstance(pass_, MaskPass):
        for top in pass_.select:
            yield from top.walk()


def _selectors(pass_: Pass, tag: str, attribute: str) -> list[Node]:
    """List the selectors ``tag`` of a mask pass that set the number ``attribute``."""
    return [
        node
        for node in _walk_selectors(pass_)
        if node.tag == tag and isinstance(getattr(node, attribute, None), int | float)
    ]


def _selector_numbers(pass_: Pass) -> Iterator[str]:
    for node in _walk_selectors(pass_):
        for attribute in schema_of(type(node)).attributes:
            if isinstance(attribute.of(node), int | float):
                yield f"{node.tag}/{attribute.name}"
