"""Facts that the analysis reads: materials with their programs, lights, camera. Only data."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from pathlib import Path

from nau_py.diagnostics.location import Location
from nau_py.raytrace.programs.source import parse_program, strip_decoration

Colour = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class ProgramFacts:
    """A program of a material or of the pass. ``proc``: its built-in name, or "" for a program of
    a file; ``sends``: the kinds of rays that a Python program names in its calls of ``trace``."""

    label: str
    location: Location
    proc: str = ""
    sends: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class MaterialFacts:
    """A material of the traced geometry. ``closest`` and ``any_hit``: its programs, all ray types;
    ``colours`` by attribute; ``texture_alpha``: the least alpha of its texture, 0 to 1."""

    name: str
    closest: tuple[ProgramFacts, ...] = ()
    any_hit: tuple[ProgramFacts, ...] = ()
    colours: dict[str, Colour] = field(default_factory=dict)
    texture_alpha: float = 1.0

    def strength(self, attribute: str) -> float:
        """Return the largest of the first three components of a colour; 0 for an unknown one."""
        return max(self.colours.get(attribute, (0.0,))[:3], default=0.0)

    @property
    def alpha(self) -> float:
        """Least alpha of texture and DIFFUSE."""
        diffuse = self.colours.get("DIFFUSE", (1.0,) * 4)
        return self.texture_alpha * (diffuse[3] if len(diffuse) > 3 else 1.0)


@dataclass(frozen=True, slots=True)
class LightFacts:
    """A light of the pass. ``has_area``: its shape has a size above 0."""

    name: str
    location: Location
    has_area: bool = False


@dataclass(frozen=True, slots=True)
class PassFacts:
    """A raytrace pass. ``ray_types``: names, in order; ``generate``: the ray generation."""

    materials: tuple[MaterialFacts, ...]
    lights: tuple[LightFacts, ...] = ()
    camera: str = ""
    camera_location: Location | None = None
    aperture: float = 0.0
    generate: ProgramFacts | None = None
    misses: tuple[ProgramFacts, ...] = ()
    ray_types: tuple[str, ...] = ()
    max_depth: int = 1

    @property
    def programs(self) -> list[tuple[MaterialFacts | None, ProgramFacts]]:
        """Programs that can send rays, each with its material."""
        own = [self.generate] if self.generate else []
        found: list[tuple[MaterialFacts | None, ProgramFacts]] = [
            (None, p) for p in (*own, *self.misses)
        ]
        return found + [(m, p) for m in self.materials for p in (*m.closest, *m.any_hit)]


def find_sent_kinds(path: Path, proc: str) -> frozenset[str]:
    """Find the kinds of rays that a Python program names in its calls of ``trace``, also in the
    functions of its file that it calls. Reads the file, runs nothing; empty if it cannot be parsed.
    """
    tree = parse_program(path)
    if tree is None:
        return frozenset()
    functions = {n.name: n for n in tree.body if isinstance(n, ast.FunctionDef)}
    found: set[str] = set()
    todo = [proc, strip_decoration(proc)]
    done: set[str] = set()
    while todo:
        name = todo.pop()
        if name in done or name not in functions:
            continue
        done.add(name)
        for node in ast.walk(functions[name]):
            if isinstance(node, ast.Name):
                todo.append(node.id)
            elif isinstance(node, ast.Call):
                found |= _named(node)
    return frozenset(found)


def _named(call: ast.Call) -> set[str]:
    """Return the kind, else the ray type, of a call of ``trace``."""
    if not (isinstance(call.func, ast.Attribute) and call.func.attr == "trace"):
        return set()
    given = {k.arg: k.value for k in call.keywords}
    node = given.get("kind") or (call.args[0] if call.args else None)
    return {node.value.lower()} if _is_text(node) else set()  # type: ignore[union-attr]


def _is_text(node: ast.expr | None) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)
