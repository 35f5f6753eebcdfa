"""Diagnostics as text, JSON and SARIF 2.1.0."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any
from urllib.parse import quote

from nau_py.diagnostics.catalogue import RULES
from nau_py.diagnostics.diagnostic import Diagnostic, Severity
from nau_py.diagnostics.location import Location

_TAB = 4


def format_path(file: str) -> str:
    """Return a path relative to the working directory if it is below it."""
    try:
        return str(Path(file).resolve().relative_to(Path.cwd()))
    except ValueError:
        return file


def _excerpt(location: Location, sources: Mapping[str, str]) -> list[str]:
    text = sources.get(location.file)
    if text is None and location.line:
        try:
            text = Path(location.file).read_text("utf-8", "replace")
        except OSError:
            return []
    lines = (text or "").splitlines()
    if not 0 < location.line <= len(lines):
        return []
    raw = lines[location.line - 1]
    before = raw[: max(location.column - 1, 0)].expandtabs(_TAB)
    number = f"{location.line:>5} | "
    return [number + raw.expandtabs(_TAB).rstrip(), " " * (len(number) + len(before)) + "^"]


def format_lines(diagnostic: Diagnostic, sources: Mapping[str, str]) -> list[str]:
    """Write ``file:line:col: severity[rule]: message``, the source line, and a caret."""
    where = diagnostic.location
    place = Location(format_path(where.file), where.line, where.column) if where.file else where
    head = f"{place}: " if where.file else ""
    first = f"{head}{diagnostic.severity}[{diagnostic.rule}]: {diagnostic.message}"
    return [first, *_excerpt(where, sources)]


def to_text(diagnostics: Iterable[Diagnostic], sources: Mapping[str, str]) -> str:
    """Write all findings as text, one after the other."""
    return "".join(line + "\n" for d in diagnostics for line in format_lines(d, sources))


def _place(location: Location) -> dict[str, Any]:
    return {
        "file": format_path(location.file),
        "line": location.line,
        "column": location.column,
    }


def to_json(diagnostics: Iterable[Diagnostic]) -> str:
    """Write a list of ``{rule, severity, file, line, column, message, related}``."""
    listed = [
        {
            "rule": d.rule,
            "severity": str(d.severity),
            **_place(d.location),
            "message": d.message,
            "related": [{**_place(where), "message": text} for where, text in d.related],
        }
        for d in diagnostics
    ]
    return json.dumps(listed, indent=2, ensure_ascii=False) + "\n"


def _uri(file: str) -> str:
    path = Path(format_path(file))
    return path.as_uri() if path.is_absolute() else quote(path.as_posix())


def _sarif_location(location: Location) -> dict[str, Any]:
    physical: dict[str, Any] = {"artifactLocation": {"uri": _uri(location.file)}}
    if location.line:
        physical["region"] = {
            "startLine": location.line,
            "startColumn": max(location.column, 1),
        }
    return {"physicalLocation": physical}


def _sarif_rule(id_: str) -> dict[str, Any]:
    """Describe a rule. A plug-in may emit findings of a rule that it did not register."""
    rule = RULES.get(id_)
    if rule is None:
        return {"id": id_}
    return {
        "id": rule.id,
        "name": "".join(w for w in rule.title.title() if w.isalnum()),
        "shortDescription": {"text": rule.title},
        "fullDescription": {"text": rule.explanation},
        "defaultConfiguration": {"level": str(rule.severity)},
    }


def to_sarif(diagnostics: Iterable[Diagnostic], version: str) -> str:
    """Write SARIF 2.1.0 (OASIS), with the rules that have findings."""
    listed = list(diagnostics)
    used = sorted({d.rule for d in listed})
    results = []
    for d in listed:
        result: dict[str, Any] = {
            "ruleId": d.rule,
            "ruleIndex": used.index(d.rule),
            "level": str(d.severity),
            "message": {"text": d.message},
        }
        if d.location.file:
            result["locations"] = [_sarif_location(d.location)]
        if d.related:
            result["relatedLocations"] = [
                {"id": i, "message": {"text": text}, **_sarif_location(where)}
                for i, (where, text) in enumerate(d.related)
            ]
        results.append(result)
    driver = {
        "name": "nau-lint",
        "version": version,
        "informationUri": "https://pypi.org/project/nau_py/",
        "rules": [_sarif_rule(id_) for id_ in used],
    }
    document = {
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{"tool": {"driver": driver}, "results": results}],
    }
    return json.dumps(document, indent=2, ensure_ascii=False) + "\n"


def must_fail(diagnostics: Iterable[Diagnostic], strict: bool) -> bool:
    """Return True if a run must fail: an error, or with ``strict`` a warning."""
    bad = {Severity.ERROR, Severity.WARNING} if strict else {Severity.ERROR}
    return any(d.severity in bad for d in diagnostics)
