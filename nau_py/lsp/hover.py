"""Hover text: the reference's entry for a word, and the place where a name is defined."""

from __future__ import annotations

from nau_py.lsp.complete import Grammar
from nau_py.lsp.place import Entry, Leaf, Place, attributes, children, enter
from nau_py.lsp.symbols import Symbols
from nau_py.model.attribute import Attribute
from nau_py.model.values import format_scalar
from nau_py.syntax.cursor import CursorKind


def describe_word(grammar: Grammar, symbols: Symbols | None, offset: int) -> str | None:
    """Describe the word at a character in Markdown; None for an unknown word."""
    about = _describe_entry(grammar, offset)
    name = _describe_name(symbols, str(grammar.path), offset) if symbols is not None else None
    parts = [part for part in (name, about) if part]
    return "\n\n".join(parts) or None


def _describe_name(symbols: Symbols, file: str, offset: int) -> str | None:
    symbol = symbols.find_symbol(file, offset)
    if symbol is None:
        return None
    defined, used = symbols.find_same(symbol)
    if not defined:
        return None
    where = ", ".join(str(s.location) for s in defined)
    times = f"used {len(used)} time{'s' * (len(used) != 1)}"
    return f"**{symbol.kind} `{symbol.name}`** — defined at {where}, {times}"


def _describe_entry(grammar: Grammar, offset: int) -> str | None:
    cursor = grammar.locate_cursor(offset)
    registry = grammar.names.registry
    word = grammar.text[cursor.begin : cursor.end].rstrip(":")
    if cursor.kind is CursorKind.CHILD and not cursor.path:
        return None
    place = grammar.find_place(cursor.path)
    if place is None:
        return None
    name = cursor.name if cursor.kind is CursorKind.VALUE else word
    if cursor.kind is not CursorKind.CHILD:
        entry = next((e for e in attributes(place, registry) if e.name == name), None)
        if entry is not None:
            return _format_entry(entry, "attribute")
    found = next((e for e in children(place, registry) if e.name == name), None)
    if found is not None:
        return _format_entry(found, "element")
    inner = enter(place, name, {}, registry)  # the old dialect's spelling
    return _format_class(inner, name)


def _format_class(place: Place | None, name: str) -> str | None:
    if place is None or isinstance(place, Leaf):
        return None
    doc = (getattr(getattr(place, "cls", None), "__doc__", None) or "").strip()
    return f"**element `{name}`**\n\n{' '.join(doc.split())}" if doc else None


def _format_entry(entry: Entry, what: str) -> str:
    lines = [f"**{what} `{entry.name}`**" + (" (required)" if entry.required else "")]
    if entry.doc:
        lines.append(entry.doc)
    if entry.attribute is not None:
        lines.append(_format_attribute(entry.attribute))
    elif entry.attr is not None:
        if entry.attr.values:
            lines.append("One of " + ", ".join(f"`{v}`" for v in entry.attr.values) + ".")
        elif entry.attr.ref:
            lines.append(f"Name of a {entry.attr.ref}.")
        elif entry.attr.file:
            lines.append(f"Path of a {entry.attr.file} file.")
    return "\n\n".join(lines)


def _format_attribute(attribute: Attribute) -> str:
    words = [f"{attribute.type.value}"]
    if attribute.default:
        words.append("default " + " ".join(format_scalar(p) for p in attribute.default))
    if attribute.values:
        words.append("one of " + ", ".join(f"`{v}`" for v in attribute.values))
    if attribute.minimum is not None or attribute.maximum is not None:
        low = "" if attribute.minimum is None else f"{attribute.minimum:g}"
        high = "" if attribute.maximum is None else f"{attribute.maximum:g}"
        one = f"at least {low}" if low else f"at most {high}"
        words.append(f"from {low} to {high}" if low and high else one)
    return "; ".join(words) + "."
