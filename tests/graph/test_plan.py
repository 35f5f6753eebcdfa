"""Dependencies, order, pruning and reasons, without a GL context."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from nau_py.graph.contract import Access
from nau_py.graph.plan import Plan, make_plan
from nau_py.graph.resource import WINDOW, Resource
from nau_py.model.linked import Project
from nau_py.model.passes import Mode, Pass
from nau_py.model.pipeline import Pipeline
from nau_py.model.project import ProjectFile


class Table:
    """A contract that reads what each pass touches from a table: "a+b>c" reads a, b, writes c."""

    def __init__(self, table: Mapping[str, str]) -> None:
        self.table = table

    def access(self, project: Project, pass_: Pass) -> Access:
        reads, _, writes = self.table[pass_.name or ""].partition(">")
        replaced = [w.removesuffix("!") for w in writes.split("+") if w.endswith("!")]
        return Access(
            [resource(r) for r in reads.split("+") if r],
            [resource(w.removesuffix("!")) for w in writes.split("+") if w],
            [resource(r) for r in replaced],
        )


def resource(name: str) -> Resource:
    return WINDOW if name == "W" else Resource("texture", name)


def plan(
    tmp: object = None, /, modes: Mapping[str, str] = {}, everything: bool = False, **table: str
) -> Plan:
    from pathlib import Path

    passes: list[Pass] = [
        Pass(name=n, mode=Mode(value=modes[n]) if n in modes else None) for n in table
    ]
    project = Project(Path("p.xml"), ProjectFile(name="P"))
    pipeline = Pipeline(name="Q", passes=passes)
    return make_plan(project, pipeline, {"default": Table(table)}, everything=everything)


def running(made: Plan) -> str:
    return " ".join(step.name for step in made.running)


def test_hazards() -> None:
    made = plan(a=">t", b="t>u", c="u>t", d="t>W")
    edges = {(e.earlier, e.later, e.resource.name, e.hazard) for e in made.dependencies.edges}
    assert edges == {
        (0, 1, "t", "read after write"),
        (1, 2, "u", "read after write"),
        (1, 2, "t", "write after read"),
        (0, 2, "t", "write after write"),
        (2, 3, "t", "read after write"),
    }
    assert all(e.earlier < e.later for e in made.dependencies.edges)
    assert [step.name for step in made.steps] == ["a", "b", "c", "d"]


@pytest.mark.parametrize(
    "table, kept",
    [
        ({"a": ">t", "b": "t>W"}, "a b"),
        ({"a": ">t", "b": ">u", "c": "t>W"}, "a c"),
        ({"a": ">t", "b": "t>u", "c": "u>v", "d": ">W"}, "d"),
        ({"a": ">t", "b": ">t!", "c": "t>W"}, "b c"),  # b clears what a drew
        ({"a": ">t", "b": ">t", "c": "t>W"}, "a b c"),  # b draws over it
        ({"a": "t>W", "b": ">t"}, "a b"),  # b writes what a reads in the next frame
        ({"a": "x>t", "b": "t>W", "c": "t>x"}, "a b c"),  # a loop through two frames
        ({"a": ">t", "b": "t>u"}, "a b"),  # no window: the last written target is the picture
        ({"a": ">W", "b": ">"}, "a"),
    ],
)
def test_pruning(table: dict[str, str], kept: str) -> None:
    assert running(plan(**table)) == kept


def test_reasons_name_the_resources() -> None:
    reasons = {s.name: s.reason for s in plan(a=">t+u", b=">", c=">W").steps}
    assert reasons == {
        "a": "nothing that the picture needs reads what it writes (texture t, texture u)",
        "b": "it writes nothing",
        "c": "",
    }


def test_dont_run_is_left_out_and_feeds_nobody() -> None:
    made = plan(a=">t", b="t>u", c="u>W", modes={"b": "DONT_RUN"})
    assert running(made) == "c"
    assert [s.reason for s in made.steps][1] == "its mode is DONT_RUN"


def test_run_once_keeps_what_was_drawn_before() -> None:
    made = plan(a=">t", b=">t!", c="t>W", modes={"b": "RUN_ONCE"})
    assert running(made) == "a b c"


def test_everything_keeps_all_writers() -> None:
    assert running(plan(a=">t", b=">W", everything=True)) == "a b"
