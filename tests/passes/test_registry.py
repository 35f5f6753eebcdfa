"""Registration of pass classes and the state of their passes (nau_py.passes.registry, .state)."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from nau_py.model.attribute import number
from nau_py.model.attributes import PARAMETERS
from nau_py.model.pass_classes import PASS_CLASSES
from nau_py.model.values import DataType
from nau_py.passes.registry import PassClass, pass_classes, register_pass
from nau_py.passes.state import PassStates, Stateless
from nau_py.rules.engine import lint
from tests.conftest import Folder

PROJECT = """\
<project name="P" width="8" height="8">
 <assets><attributes>{attribute}</attributes></assets>
 <pipelines><pipeline name="Q"><pass name="a" class="{a}">{inner}</pass>
 <pass name="b" class="{b}">{inner}</pass></pipeline></pipelines>
</project>
"""


@pytest.fixture(autouse=True)
def restored() -> Iterator[None]:
    """Forget what a test has registered."""
    tables: tuple[dict[object, object], ...] = (PASS_CLASSES, PARAMETERS, pass_classes())  # type: ignore[assignment]
    before = [dict(table) for table in tables]
    yield
    for table, entries in zip(tables, before):
        table.clear()
        table.update(entries)


def tone(name: str, default: float) -> type[PassClass]:
    class Tone(PassClass):
        """Changes tones."""

        parameters = (number("GAIN", DataType.FLOAT, default, "Factor.", maximum=default),)

    return register_pass(name)(Tone)


def test_a_name_is_registered_once() -> None:
    with pytest.raises(ValueError, match="pass class 'quad' is registered twice"):
        tone("quad", 1.0)


def test_a_parameter_that_every_pass_has() -> None:
    class Clear(PassClass):
        parameters = (number("DEPTH_CLEAR", DataType.FLOAT, 1.0),)

    with pytest.raises(ValueError, match="'clear': every pass has an attribute 'DEPTH_CLEAR'"):
        register_pass("clear")(Clear)


def test_two_classes_with_a_parameter_of_one_name(folder: Folder) -> None:
    """Each pass has the default and the range of its own class."""
    tone("soft", 2.0)
    tone("hard", 8.0)
    folder.write("project.xml", PROJECT.format(attribute="", a="soft", b="hard", inner=""))
    project = folder.load()
    passes = project.pipelines[0].passes
    assert [project.value(p, "PASS", "GAIN") for p in passes] == [(2.0,), (8.0,)]
    assert [type(p).__name__ for p in passes] == ["TonePass", "TonePass"]
    text = '<GAIN value="4"/>'
    folder.write("project.xml", PROJECT.format(attribute="", a="soft", b="hard", inner=text))
    loaded = folder.load()
    assert [p.get("GAIN") for p in loaded.pipelines[0].passes] == [(4.0,), (4.0,)]
    errors = [d.message for d in lint(loaded, {}) if d.rule == "V006"]
    assert errors == ["<GAIN> of <pass> is 4; it must be at most 2"]


def test_a_user_attribute_of_that_name_belongs_to_every_pass(folder: Folder) -> None:
    tone("soft", 2.0)
    attribute = '<attribute name="GAIN" type="PASS" data="INT" value="5"/>'
    folder.write("project.xml", PROJECT.format(attribute=attribute, a="soft", b="quad", inner=""))
    project = folder.load()
    soft, quad = project.pipelines[0].passes
    assert project.value(soft, "PASS", "GAIN") == (2.0,)
    assert project.value(quad, "PASS", "GAIN") == (5,)


class Kept(Stateless):
    """State that notes when it is closed."""

    def __init__(self) -> None:
        self.closed = False

    def close(self) -> None:
        self.closed = True


def test_state_is_made_once_and_closed() -> None:
    states = PassStates()
    first = states.get("a", "x", Kept)
    assert states.get("a", "x", Kept) is first
    other = states.get("a", "y", Kept)
    assert other is not first
    assert first.closed
    assert list(states) == [states["a"]]
    states.close()
    assert other.closed
    assert list(states) == []
