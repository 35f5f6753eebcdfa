"""Every rule id in the package is in the catalogue, and every rule of the catalogue is used."""

from __future__ import annotations

import ast
import re
from collections import Counter
from pathlib import Path

import pytest

import nau_py
from nau_py.diagnostics.catalogue import RULES, Severity, rule
from nau_py.rules.loading import load_rules
from tests.conftest import ROOT
from tools.reference import rules_page

PACKAGE = Path(nau_py.__file__).parent
RULE_ID = re.compile(r"[A-Z]\d{3}")
NUMBERED = {f"R{number:03}" for number in range(1, 16)}
"""Rules that :mod:`nau_py.rules.references` numbers by the kind of name."""


def written_ids() -> Counter[str]:
    """Count the rule ids in the code: string literals, and names of rules other than their
    definition."""
    found: Counter[str] = Counter()
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                text = node.value
            elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
                text = node.id
            else:
                continue
            if RULE_ID.fullmatch(text):
                found[text] += 1
    return found


def test_every_id_is_registered() -> None:
    load_rules()
    assert set(written_ids()) - set(RULES) == set()


def test_every_rule_is_used() -> None:
    """The registration writes the id once; some place must emit it."""
    load_rules()
    ids = written_ids()
    assert [id_ for id_ in RULES if ids[id_] < 2 and id_ not in NUMBERED] == []


def test_every_rule_explains_itself() -> None:
    load_rules()
    for entry in RULES.values():
        assert entry.title
        assert entry.explanation.endswith(".")
        assert entry.bad
        assert entry.good
        assert entry.bad != entry.good


def test_an_id_is_registered_once() -> None:
    load_rules()
    with pytest.raises(ValueError, match="rule D101 is registered twice"):
        rule("D101", Severity.ERROR, "Other", "Other.", "a", "b")


def test_the_rules_page_is_up_to_date() -> None:
    page = ROOT / "docs" / "rules.md"
    assert page.read_text() == rules_page(), "run scripts/reference"
