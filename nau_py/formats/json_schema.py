"""JSON Schema 2020-12 of the YAML form, for editors.

Derived from the description of each class (:mod:`nau_py.model.schema`). It restricts the place of
elements and keys; lint checks references and ranges.
"""

from __future__ import annotations

import json
from typing import Any

from nau_py.formats.settings import list_keys
from nau_py.model.attribute import Attribute
from nau_py.model.attributes import Registry
from nau_py.model.library import MaterialLibrary
from nau_py.model.node import Choice, Node
from nau_py.model.project import ProjectFile
from nau_py.model.schema import ChildField, NodeSchema, SettingsField, schema_of

ID = "https://nau-py.invalid/schema/{}-1.json"
_SCALAR = {"type": ["string", "number", "boolean"]}
Schema = dict[str, Any]


def _scalar(values: tuple[str, ...], doc: str) -> Schema:
    found: Schema = {"enum": list(values)} if values else dict(_SCALAR)
    return found | ({"description": doc} if doc else {})


def _ref(cls: type[Node]) -> Schema:
    return {"$ref": f"#/$defs/{cls.__name__}"}


def _chosen(choice: Choice) -> Schema:
    """Choose one definition by the value of an attribute."""
    key = choice.attribute
    chosen = [
        {"if": {"properties": {key: {"const": name}}, "required": [key]}, "then": _ref(cls)}
        for name, cls in choice.classes.items()
    ]
    default = _ref(choice.classes[choice.default])
    usual = {"if": {"not": {"required": [key]}}, "then": default}
    return {"type": "object", "allOf": [*chosen, usual]}


def _add(properties: dict[str, Schema], key: str, form: Schema) -> None:
    """Add a form of a key to those it has: a stage is a file name or a list of files."""
    before = properties.get(key)
    properties[key] = form if before is None else {"anyOf": [before, form]}


class _Definitions:
    """Definitions of every class reached so far."""

    def __init__(self, registry: Registry) -> None:
        self.registry = registry
        self.definitions: dict[str, Schema] = {}

    def define(self, cls: type[Node]) -> Schema:
        """Define a class, if it is new, and return the reference to it."""
        if cls.__name__ not in self.definitions:
            self.definitions[cls.__name__] = {}  # taken: a class may hold itself
            self.definitions[cls.__name__] = self._class(schema_of(cls))
        return _ref(cls)

    def _class(self, schema: NodeSchema) -> Schema:
        properties: dict[str, Schema] = {}
        for attribute in schema.attributes:
            _add(properties, attribute.name, _scalar(attribute.values, attribute.doc))
        forms = schema.each_content(self._children, self._settings)
        for key, form in [pair for listed in forms for pair in listed]:
            _add(properties, key, form)
        for part in schema.inline:
            for key, form in self._settings(part):
                properties.setdefault(key, form)
        whole: Schema = {
            "type": "object",
            "description": schema.doc,
            "properties": properties,
            # a project can add attributes to a set
            "additionalProperties": bool(schema.settings or schema.inline),
        }
        required = [a.name for a in schema.attributes if a.required]
        if required:
            whole["required"] = required
        short = self._short(schema)
        return {"anyOf": [whole, *short]} if short else whole

    def _short(self, schema: NodeSchema) -> list[Schema]:
        """Forms of a node that has only its first attribute, or only its sole list."""
        found: list[Schema] = []
        if schema.attributes:
            found.append(_scalar(schema.attributes[0].values, ""))
        lists = schema.plain_lists
        if len(lists) == 1:
            found.append({"type": "array", "items": self._item(lists[0])})
        return found

    def _item(self, part: ChildField) -> Schema:
        if part.mixed:
            return {"anyOf": [self._one(tag, cls) for tag, cls in part.classes.items()]}
        if part.choice is not None:
            for cls in part.alternatives:
                self.define(cls)
            return _chosen(part.choice)
        return self.define(part.cls)

    def _one(self, tag: str, cls: type[Node]) -> Schema:
        return {
            "type": "object",
            "properties": {tag: {"anyOf": [self.define(cls), {"type": "null"}]}},
            "required": [tag],
            "additionalProperties": False,
        }

    def _children(self, part: ChildField) -> list[tuple[str, Schema]]:
        if not part.many:
            return [(part.tag, {"anyOf": [self.define(part.cls), {"type": "null"}]})]
        if part.mixed and not part.wrapper:
            for cls in part.classes.values():
                self.define(cls)
            return [(tag, {"type": ["array", "object"]}) for tag in part.classes]
        listed: Schema = {"type": "array", "items": self._item(part)}
        forms: list[Schema] = [listed, {"type": "null"}]
        if part.wrapper:
            forms.append({"type": "object", "properties": {"items": listed}, "required": ["items"]})
        return [(part.wrapper or part.tag, {"anyOf": forms, "description": part.doc})]

    def _settings(self, part: SettingsField) -> list[tuple[str, Schema]]:
        writable = [a for a in part.known(self.registry) if not a.readonly]
        return [(attribute.name, self._setting(attribute)) for attribute in writable]

    def _setting(self, attribute: Attribute) -> Schema:
        keys = list_keys(attribute)
        one = _scalar(attribute.values if len(keys) == 1 else (), "")
        by_key: Schema = {"type": "object", "properties": dict.fromkeys(keys, _SCALAR)}
        forms: list[Schema] = [one, by_key, {"type": "array", "items": by_key}]
        if len(keys) > 1:
            forms.append({"type": "array", "items": _SCALAR, "maxItems": len(keys)})
        return {"anyOf": forms, "description": attribute.doc}


def json_schema(registry: Registry, library: bool = False) -> str:
    """Write the JSON Schema of projects, or of material libraries."""
    cls: type[Node] = MaterialLibrary if library else ProjectFile
    made = _Definitions(registry)
    root = made.define(cls)
    name = "library" if library else "project"
    whole = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": ID.format(name),
        "title": f"nau_py {name}",
        **root,
        "$defs": made.definitions,
    }
    return json.dumps(whole, indent=1) + "\n"
