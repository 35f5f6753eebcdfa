"""Links from a project to other files: named files, procedures of programs, GLSL uniforms."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from nau_py.diagnostics.location import Location
from nau_py.lsp.symbols import Symbol, Symbols
from nau_py.model.linked import Project
from nau_py.model.material import Material
from nau_py.model.node import Node
from nau_py.model.raytrace import BUILTIN, Program
from nau_py.model.schema import AttributeField, schema_of
from nau_py.model.shader import STAGES, Shader
from nau_py.model.walk import walk_nodes
from nau_py.process.paths import resolve
from nau_py.raytrace.programs.neighbours import read_neighbour_imports
from nau_py.raytrace.programs.source import parse_program, stand_in, strip_decoration

_UNIFORM = r"\buniform\b[^;{{}}]*?\b({})\b\s*(?:\[[^\]]*\]\s*)?[;=,]"
_WORD = re.compile(r"\w+")


@dataclass(frozen=True, slots=True)
class SourceLink:
    """A word of a project file, and the places that it refers to."""

    word: Symbol
    targets: tuple[Location, ...]


def find_link(symbols: Symbols, file: str, offset: int) -> SourceLink | None:
    """Return the link at a character of a project file or library; None where there is none."""
    for link in _collect_links(symbols.project, file):
        span = symbols.find_span(link.word)
        if span is not None and span[1] <= offset <= span[2]:
            return link
    return None


def _collect_links(project: Project, file: str) -> Iterator[SourceLink]:
    for node in walk_nodes(project):
        if node.location.file != file:
            continue
        if isinstance(node, Program) and node.file and node.proc:
            yield from _link_procedure(project, node)
        for attribute in schema_of(type(node)).attributes:
            value = attribute.of(node)
            if not attribute.file or not isinstance(value, str):
                continue
            path = _resolve(project, node, attribute, value)
            if path is not None and value != BUILTIN:
                where = node.where(attribute.name)
                yield SourceLink(Symbol("file", value, value, where), (Location(str(path), 1, 1),))
        if isinstance(node, Material):
            yield from _link_uniforms(project, node)


def _resolve(project: Project, node: Node, attribute: AttributeField, value: str) -> Path | None:
    if attribute.file == "program":
        return stand_in(project.folder, value)
    found = resolve(Path(node.where(attribute.name).file or ".").parent, value)
    return found.best if found.exists else None


def _link_procedure(project: Project, node: Program) -> Iterator[SourceLink]:
    path, proc = stand_in(project.folder, node.file or ""), node.proc or ""
    known = list_procedures(path) if path is not None else {}
    place = known.get(proc, known.get(strip_decoration(proc)))
    if place is not None:
        yield SourceLink(Symbol("procedure", proc, proc, node.where("proc")), (place,))


def list_procedures(path: Path) -> dict[str, Location]:
    """Return the functions of a Python file, with their places. The file is not run.

    Functions that the file imports from its neighbours count.
    """
    return _list_procedures(path, frozenset())


def _list_procedures(path: Path, importers: frozenset[Path]) -> dict[str, Location]:
    """List the procedures of a file that ``importers`` import, directly or not."""
    tree = parse_program(path)
    if tree is None:
        return {}
    found: dict[str, Location] = {}
    for name, (other, there) in read_neighbour_imports(tree, path.parent).names.items():
        if other in importers:
            continue
        known = _list_procedures(other, importers | {path})
        if there == "*":
            found |= known
        elif there in known:
            found[name] = known[there]
    functions = (n for n in tree.body if isinstance(n, ast.FunctionDef))
    return found | {n.name: Location(str(path), n.lineno, 1) for n in functions}


def list_shader_files(shader: Shader) -> list[Path]:
    """Return the GLSL files of a shader."""
    folder = Path(shader.location.file).parent
    return [resolve(folder, f).best for stage in STAGES for f in shader.files(stage)]


def _find_shader(project: Project, material: Material) -> Shader | None:
    if material.shader is None:
        return None
    for library in project.libraries:
        if any(m is material for m in library.materials):
            found = project.shader(library.name or "", material.shader.name or "")
            return found[1] if found else None
    return None


def _link_uniforms(project: Project, material: Material) -> Iterator[SourceLink]:
    shader = _find_shader(project, material)
    if shader is None or material.shader is None:
        return
    files = list_shader_files(shader)
    for value in material.shader.values:
        if value.uniform:
            targets = tuple(w for f in files for w in find_uniform(f, value.uniform))
            if targets:
                word = Symbol("uniform", value.uniform, value.uniform, value.where("uniform"))
                yield SourceLink(word, targets)


def find_uniform(path: Path, uniform: str) -> Iterator[Location]:
    """Return the places at which a GLSL file declares a uniform."""
    try:
        text = path.read_text("utf-8", "replace")
    except OSError:
        return
    name = re.split(r"[.\[]", uniform)[0]
    for found in re.finditer(_UNIFORM.format(re.escape(name)), text):
        at = found.start(1)
        yield Location(str(path), text.count("\n", 0, at) + 1, at - text.rfind("\n", 0, at))


def find_bindings(project: Project, path: Path, text: str, offset: int) -> list[Location]:
    """Return the places of a project that use the word at a character of one of its GLSL or
    program files: the sources of a uniform, the bindings of a procedure."""
    word = next((m[0] for m in _WORD.finditer(text) if m.start() <= offset <= m.end()), "")
    found: list[Location] = []
    for node in walk_nodes(project):
        if isinstance(node, Material) and node.shader is not None:
            shader = _find_shader(project, node)
            if shader is not None and path in [f.resolve() for f in list_shader_files(shader)]:
                found += [
                    v.where("uniform")
                    for v in node.shader.values
                    if v.uniform and re.split(r"[.\[]", v.uniform)[0] == word
                ]
        elif isinstance(node, Program) and node.proc and strip_decoration(node.proc) == word:
            source = stand_in(project.folder, node.file or "")
            if source is not None and source.resolve() == path:
                found.append(node.where("proc"))
    return found
