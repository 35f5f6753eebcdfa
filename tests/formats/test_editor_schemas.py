"""formats.json_schema, formats.xsd: output of nau-fmt is valid, misspelt names are not."""

from __future__ import annotations

import io
import json
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from lxml import etree
from ruamel.yaml import YAML

from nau_py.formats.json_schema import json_schema
from nau_py.formats.load import is_library, load_library, load_project
from nau_py.formats.write import format_node
from nau_py.formats.xsd import xsd
from nau_py.model.attributes import Registry
from nau_py.model.pass_classes import PASS_CLASSES
from tests.conftest import PROJECTS, ROOT, Folder

FILES = sorted([*PROJECTS.glob("**/project.*"), *(ROOT / "materials").glob("*.mlib")])


@cache
def schemas() -> tuple[Any, Any, Any]:
    """XSD, and JSON Schema of projects and of libraries."""
    registry = Registry()
    found = [json.loads(json_schema(registry, library)) for library in (False, True)]
    for schema in found:
        jsonschema.Draft202012Validator.check_schema(schema)
    validators = [jsonschema.Draft202012Validator(s) for s in found]
    return etree.XMLSchema(etree.fromstring(xsd(registry).encode())), *validators


def texts(path: Path) -> tuple[str, str, bool]:
    """The file as clean XML and as YAML, and whether it is a library."""
    library = is_library(path)
    loaded = load_library(path) if library else load_project(path)
    node = loaded.libraries[-1] if library else loaded.file
    xml, yaml = (format_node(node, loaded.registry, style) for style in ("xml", "yaml"))
    return xml, yaml, library


def yaml_errors(text: str, library: bool = False) -> list[str]:
    data = YAML(typ="safe").load(io.StringIO(text))
    return [e.message for e in schemas()[2 if library else 1].iter_errors(data)]


def xml_valid(text: str) -> bool:
    return bool(schemas()[0].validate(etree.fromstring(text.encode())))


@pytest.mark.parametrize("path", FILES, ids=lambda p: f"{p.parent.name}/{p.name}")
def test_samples_are_valid(path: Path) -> None:
    xml, yaml, library = texts(path)
    assert xml_valid(xml), schemas()[0].error_log
    assert yaml_errors(yaml, library) == []


@pytest.mark.parametrize(
    "old, new",
    [
        ("<POSITION x=", "<POSITON x="),
        ('<light name="Sun">', '<light nmae="Sun">'),
        ('TYPE="PERSPECTIVE"', 'TYPE="PERSPECTIVE" /><projektion TYPE="ORTHO"'),
        ('value="COMPARE_REF_TO_TEXTURE"', 'value="COMPARE"'),
        ('type="CLOSEST_HIT" ', 'type="CLOSEST_HIT" kind="x" '),
    ],
)
def test_mistyped_xml_is_not(old: str, new: str) -> None:
    xml = texts(PROJECTS / "selective" / "project.xml")[0]
    assert old in xml
    assert not xml_valid(xml.replace(old, new, 1))


@pytest.mark.parametrize(
    "old, new",
    [
        ("  cameras:", "  camera:"),
        ("COMPARE_REF_TO_TEXTURE", "COMPARE"),
        ("type: CLOSEST_HIT", "type: CLOSEST"),
        ("          rayGen:", "          raygen:"),
    ],
)
def test_mistyped_yaml_is_not(old: str, new: str) -> None:
    yaml = texts(PROJECTS / "selective" / "project.xml")[1]
    assert old in yaml
    assert yaml_errors(yaml.replace(old, new, 1)) != []


def test_every_pass_class_is_known() -> None:
    """A pass of each class alone, and one of a class that takes other children."""
    head = '<project name="P"><pipelines><pipeline name="P">{}</pipeline></pipelines></project>'
    for name in PASS_CLASSES:
        assert xml_valid(head.format(f'<pass name="p" class="{name}"/>'))
    inner = '<pass name="p" class="compute"><material name="m" fromLibrary="L" dimX="4"/></pass>'
    assert xml_valid(head.format(inner))
    data = {"name": "P", "pipelines": [{"name": "A", "pass": [{"name": "p", "class": "quad"}]}]}
    assert list(schemas()[1].iter_errors(data)) == []


def test_the_command_writes_them(folder: Folder) -> None:
    from typer.testing import CliRunner

    from nau_py.cli.fmt import app

    for kind, mark in (
        ("json", "nau_py project"),
        ("json-library", "library"),
        ("xsd", "xs:schema"),
    ):
        file = folder.path / kind
        done = CliRunner().invoke(app, ["--schema", kind, "-o", str(file)])
        assert done.exit_code == 0
        assert mark in file.read_text()
    assert CliRunner().invoke(app, []).exit_code == 2
