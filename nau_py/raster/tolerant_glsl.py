"""Changes to GLSL that some drivers accept and others reject, so that both accept it.

Nau's projects were written on NVIDIA's driver, which is less strict than the standard. The changes
are tried only if the driver rejects the text. Each keeps the numbers of the lines.
"""

from __future__ import annotations

import re
from itertools import pairwise

HIGHEST = 450
"""Newest version that an OpenGL 4.5 context compiles."""
_RESERVED = ("input", "output")
"""Words that GLSL reserves (4.50 specification, 3.6) and that projects use as names."""
_VERSION = re.compile(r"^([ \t]*#[ \t]*version[ \t]+)(\d+)", re.MULTILINE)
_LAYOUT_PARAMETER = re.compile(r"([(,]\s*)layout\s*\([^)]*\)\s*(?=\w+\s+\w)")
_LAYOUT_FUNCTION = re.compile(
    r"^[ \t]*\w+[ \t]+(?P<name>\w+)[ \t]*\((?P<given>[^{;]*\blayout\b[^{;]*)\)\s*\{", re.MULTILINE
)
_INTERFACE = re.compile(
    r"^(?P<head>[ \t]*(?:layout\s*\([^)]*\)\s*)?(?:flat\s+|smooth\s+|noperspective\s+)?"
    r"(?P<way>in|out)[ \t]+)(?P<type>\w+)(?P<gap>[ \t]+)(?P<name>\w+)(?P<rest>[ \t]*[;\[])",
    re.MULTILINE,
)
_UNIFORM = re.compile(r"^[ \t]*uniform[ \t]+(?P<type>\w+)[ \t]+(?P<names>[\w \t,]+);", re.MULTILINE)
_BRACES = re.compile(r"=\s*\{")
ORDER = ("vs", "tc", "te", "gs", "ps")


def rename_word(name: str) -> str:
    """Return the name that replaces a reserved word."""
    return f"nau_{name}"


def adapt_stages(texts: dict[str, str]) -> tuple[dict[str, str], list[str]]:
    """Change the stages; return them with a note for each change. Without notes nothing helps."""
    changed = dict(texts)
    notes: list[str] = []
    for stage, text in texts.items():
        changed[stage] = _adapt_stage(text, stage, notes)
    _match_input_types(changed, notes)
    _match_uniform_types(changed, notes)
    return changed, notes


def _adapt_stage(text: str, stage: str, notes: list[str]) -> str:
    code = _blank_comments(text)
    version = _VERSION.search(code)
    number = int(version[2]) if version else 110
    wanted = number
    if number > HIGHEST:
        wanted = HIGHEST
    elif number < 420 and _BRACES.search(code):
        wanted = 420
    if wanted != number:
        text = _VERSION.sub(rf"\g<1>{wanted}", text, count=1)
        notes.append(f"stage {stage}: #version {number} became {wanted}")
    for word in _RESERVED:
        if re.search(rf"\b{word}\b", code):
            text = re.sub(rf"\b{word}\b", rename_word(word), text)
            notes.append(f"stage {stage}: the reserved word '{word}' became a name")
    if _LAYOUT_PARAMETER.search(code):
        text = _remove_dead_functions(text, stage, notes)
        if _LAYOUT_PARAMETER.search(_blank_comments(text)):
            text = _LAYOUT_PARAMETER.sub(r"\1", text)
            notes.append(f"stage {stage}: layout() of a function parameter was left out")
    return text


def _remove_dead_functions(text: str, stage: str, notes: list[str]) -> str:
    """Blank out functions with layout() parameters that are never called."""
    code = _blank_comments(text)
    for match in list(_LAYOUT_FUNCTION.finditer(code)):
        name = match["name"]
        if len(re.findall(rf"\b{name}\b", code)) > 1:
            continue
        depth, end = 1, match.end()
        while depth and end < len(code):
            depth += {"{": 1, "}": -1}.get(code[end], 0)
            end += 1
        blank = re.sub(r"[^\n]", " ", text[match.start() : end])
        text = text[: match.start()] + blank + text[end:]
        notes.append(f"stage {stage}: the function '{name}', which nobody calls, was left out")
    return text


def _match_input_types(texts: dict[str, str], notes: list[str]) -> None:
    """Give the inputs of the fragment stage the types of the outputs before it."""
    stages = [s for s in ORDER if s in texts]
    for before, after in pairwise(stages):
        if after != "ps":
            continue  # arrays of vertices
        given = {
            m["name"]: m["type"]
            for m in _INTERFACE.finditer(_blank_comments(texts[before]))
            if m["way"] == "out"
        }

        def same(match: re.Match[str], given: dict[str, str] = given) -> str:
            name, type_ = match["name"], match["type"]
            if match["way"] != "in" or given.get(name, type_) == type_:
                return match[0]
            notes.append(f"input '{name}' of stage ps became {given[name]}, as stage vs gives it")
            return f"{match['head']}{given[name]}{match['gap']}{name}{match['rest']}"

        texts[after] = _INTERFACE.sub(same, texts[after])


def _match_uniform_types(texts: dict[str, str], notes: list[str]) -> None:
    """Remove unused uniforms that two stages declare with different types."""
    types: dict[str, dict[str, str]] = {}
    for stage, text in texts.items():
        for match in _UNIFORM.finditer(_blank_comments(text)):
            for name in match["names"].split(","):
                types.setdefault(name.strip(), {})[stage] = match["type"]
    for name, listed in types.items():
        if len(set(listed.values())) < 2:
            continue
        for stage in listed:
            uses = len(re.findall(rf"\b{name}\b", _blank_comments(texts[stage])))
            if uses == 1:
                texts[stage] = _UNIFORM.sub(lambda m, n=name: _remove_name(m, n), texts[stage])  # type: ignore[misc]
                notes.append(f"stage {stage}: the unused uniform '{name}' was left out")


def _remove_name(declaration: re.Match[str], name: str) -> str:
    """Remove ``name`` from a declaration of uniforms."""
    names = [n.strip() for n in declaration["names"].split(",")]
    if name not in names:
        return declaration[0]
    rest = ", ".join(n for n in names if n != name)
    return f"uniform {declaration['type']} {rest};" if rest else ""


def _blank_comments(text: str) -> str:
    """Replace comments by spaces, keeping line numbers."""

    def blank(match: re.Match[str]) -> str:
        return re.sub(r"[^\n]", " ", match[0])

    return re.sub(r"//[^\n]*|/\*.*?\*/", blank, text, flags=re.DOTALL)
