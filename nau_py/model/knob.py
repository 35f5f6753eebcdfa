"""What a knob turns in a project, and which values it can take."""

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


class NothingToTurn(ValueError):
    """The pipeline has nothing that the knob could turn."""


@dataclass(frozen=True, slots=True)
class Subject:
    """What a knob turns in a project: the nodes that have it, and its attribute."""

    nodes: tuple[Node, ...] = ()
    attribute: str = ""
    whole: bool = False
    words: tuple[str, ...] = ()
    low: float = -float("inf")
    high: float = float("inf")

    def parse(self, text: str) -> Value:
        """A value of the knob. Raises ValueError, which says what is legal."""
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

    def ladder(self, text: str) -> tuple[Value, ...]:
        """The values of a list, by commas or blanks. Raises ValueError."""
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
        """The value that the project gives; None where its nodes give none."""
        for node in self.nodes:
            if isinstance(node, Pass):
                found = project.value(node, "PASS", self.attribute)[0]
                return found if isinstance(found, int | float | str) else None
            value = getattr(node, self.attribute)
            if value is not None:
                return project.number(value)
        return None


def traced(passes: list[Pass]) -> list[RaytracePass]:
    """The raytrace passes among ``passes``."""
    return [p for p in passes if isinstance(p, RaytracePass)]


def subject(project: Project, passes: list[Pass], name: str) -> Subject:
    """What the knob ``name`` turns in the pipeline of ``passes``.

    Raises LookupError for a knob that does not exist, :class:`NothingToTurn` for one that is idle
    there.
    """
    kind = KNOBS.get(name)
    if kind is None:
        if "/" in name:
            return _by_path(project, passes, name)
        known = list(KNOBS)
        raise LookupError(
            f"there is no knob '{name}'; there is {format_names(known)}, or PASS/ATTRIBUTE"
            f"{suggest_name(name, known)}"
        )
    if name in ("scale", "filter"):
        return Subject(words=kind.words, low=kind.low, high=kind.high)
    rays = traced(passes)
    if not rays:
        raise NothingToTurn(f"knob '{name}' needs a raytrace pass; the pipeline has none")
    if name == "mask" and not any(p.mask for p in rays):
        raise NothingToTurn("knob 'mask' needs a mask; the raytrace pass has none")
    if not kind.attribute:
        return Subject(words=kind.words)
    return _pass_attribute(project, tuple(rays), kind.attribute)


def _pass_attribute(project: Project, nodes: tuple[Pass, ...], name: str) -> Subject:
    attribute = project.registry["PASS"].attributes[name]
    low = -float("inf") if attribute.minimum is None else attribute.minimum
    high = float("inf") if attribute.maximum is None else attribute.maximum
    return Subject(nodes, name, attribute.type.is_integer, attribute.values, low, high)


def _by_path(project: Project, passes: list[Pass], name: str) -> Subject:
    first, *rest = name.split("/")
    found = [p for p in passes if p.name == first]
    if not found:
        known = [p.name for p in passes if p.name]
        raise LookupError(
            f"knob '{name}': there is no pass '{first}'; there is {format_names(known)}"
            f"{suggest_name(first, known)}"
        )
    if len(rest) == 1:
        wanted = [a for a in project.registry["PASS"] if not a.readonly]
        names = [a.name for a in wanted if a.type.components == 1]
        if rest[0] not in names:
            raise LookupError(
                f"knob '{name}': a pass has no attribute '{rest[0]}' of one component"
                f"{suggest_name(rest[0], names)}"
            )
        return _pass_attribute(project, tuple(found), rest[0])
    if len(rest) == 2:
        nodes = tuple(_selectors(found[0], rest[0], rest[1]))
        if nodes:
            return Subject(nodes, rest[1])
        numbers = sorted(set(_numbers(found[0])))
        raise LookupError(
            f"knob '{name}': pass '{first}' has no such number of a selector; it has "
            f"{format_names([f'{first}/{n}' for n in numbers])}"
        )
    raise LookupError(f"knob '{name}': write PASS/ATTRIBUTE or PASS/SELECTOR/ATTRIBUTE")


def _chosen(pass_: Pass) -> Iterator[Node]:
    if isinstance(pass_, MaskPass):
        for top in pass_.select:
            yield from top.walk()


def _selectors(pass_: Pass, tag: str, attribute: str) -> list[Node]:
    """The selectors ``tag`` of a mask pass that give the number ``attribute``."""
    return [
        node
        for node in _chosen(pass_)
        if node.tag == tag and isinstance(getattr(node, attribute, None), int | float)
    ]


def _numbers(pass_: Pass) -> Iterator[str]:
    for node in _chosen(pass_):
        for attribute in schema_of(type(node)).attributes:
            if isinstance(attribute.of(node), int | float):
                yield f"{node.tag}/{attribute.name}"
