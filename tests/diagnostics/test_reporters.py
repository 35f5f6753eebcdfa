"""Reporters: text with a caret, JSON, SARIF against an independent model of the standard."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
from sarif_pydantic.sarif import Sarif

import nau_py
from nau_py.diagnostics.reporters import must_fail, to_json, to_sarif, to_text
from tests.conftest import Folder

BAD = """\
<project name="P" widht=3>
\t<pipelines><pipeline name="Q">
\t\t<pass name="a" class="quads"/>
\t</pipeline></pipelines>
</project>
"""


@pytest.fixture
def project(folder: Folder) -> nau_py.Project:
    folder.write("project.xml", BAD)
    return folder.load()


def test_text_shows_the_line_and_a_caret(
    project: nau_py.Project, monkeypatch: pytest.MonkeyPatch, folder: Folder
) -> None:
    monkeypatch.chdir(folder.path)
    lines = to_text(nau_py.lint(project), project.sources).splitlines()
    assert lines[0].startswith("project.xml:1:25: error[S002]: attribute 'widht' (='3')")
    assert lines[1:3] == [
        '    1 | <project name="P" widht=3>',
        "                                ^",
    ]
    # the caret stands under the value even behind tabs, which are shown four wide
    assert lines[4] == '    3 |         <pass name="a" class="quads"/>'
    assert lines[5].index("^") == lines[4].index("quads")


def test_json_has_every_field(project: nau_py.Project) -> None:
    first = json.loads(to_json(nau_py.lint(project)))[0]
    assert (first["rule"], first["severity"], first["line"], first["column"]) == (
        "S002",
        "error",
        1,
        25,
    )
    assert "did you mean 'width'?" in first["message"]


def test_sarif_is_valid(project: nau_py.Project) -> None:
    text = to_sarif(nau_py.lint(project), "1.0")
    run = Sarif.model_validate_json(text).runs[0]
    assert run.results is not None
    assert [r.rule_id for r in run.results] == ["S002", "P001"]
    place = json.loads(text)["runs"][0]["results"][0]["locations"][0]["physicalLocation"]
    assert place["region"] == {"startLine": 1, "startColumn": 25}


@pytest.mark.skipif("NAU_SARIF_SCHEMA" not in os.environ, reason="NAU_SARIF_SCHEMA is not set")
def test_sarif_against_the_published_schema(project: nau_py.Project) -> None:
    import jsonschema

    schema = json.loads(Path(os.environ["NAU_SARIF_SCHEMA"]).read_text())
    jsonschema.validate(json.loads(to_sarif(nau_py.lint(project), "1.0")), schema)


def test_strict_counts_warnings(folder: Folder) -> None:
    folder.write(
        "project.xml",
        '<project name="P"><pipelines><pipeline name="Q" default="1">'
        '<pass name="a"/></pipeline></pipelines></project>',
    )
    found = nau_py.lint(folder.load())
    assert [str(d.severity) for d in found] == ["warning"]
    assert not must_fail(found, strict=False)
    assert must_fail(found, strict=True)
