"""rules.accuracy: each fault of <accuracy> and <effects> with its place and message."""

from __future__ import annotations

import pytest

import nau_py
from tests.conftest import PROJECTS, Folder
from tests.rules.test_rules import pointed_at

PROJECT = """\
<project name="P" width="8" height="8">
<assets><cameras><camera name="C"/></cameras></assets>
<pipelines default="A">
<pipeline name="A"><pass name="trace" class="raytrace"><camera name="C"/>
<rtEntryPoint><rayGen file="builtin" proc="pinhole"/></rtEntryPoint></pass></pipeline>
<pipeline name="B"><pass name="draw" class="quad"/></pipeline>
</pipelines>
{block}
</project>
"""


def findings(folder: Folder, block: str) -> list[str]:
    folder.write("project.xml", PROJECT.format(block=block))
    project = folder.load()
    return [
        f"{d.rule} {d.severity} `{pointed_at(d, project.sources)}` {d.message}"
        for d in nau_py.lint(project)
        if d.rule.startswith("A") or d.rule in ("S001", "S002", "S004", "R013", "V001", "V005")
    ]


@pytest.mark.parametrize(
    "block, expected",
    [
        (
            '<accuracy><knob name="ssp" values="1"/></accuracy>',
            "A001 error `ssp` there is no knob 'ssp'; there is 'spp', 'depth', 'light-samples', "
            "'target-error', 'mask', 'scale', 'filter', 'format', or PASS/ATTRIBUTE (did you mean "
            "'spp'?)",
        ),
        (
            '<accuracy><knob name="trase/MAX_DEPTH" values="1"/></accuracy>',
            "A001 error `trase` knob 'trase/MAX_DEPTH': there is no pass 'trase'; there is 'trace' "
            "(did you mean 'trace'?)",
        ),
        (
            '<accuracy><knob name="trace/MAX_DEPHT" values="1"/></accuracy>',
            "A001 error `trace` knob 'trace/MAX_DEPHT': a pass has no attribute 'MAX_DEPHT' of one "
            "component (did you mean 'MAX_DEPTH'?)",
        ),
        (
            '<accuracy><knob name="trace/material/near" values="1"/></accuracy>',
            "A001 error `trace` knob 'trace/material/near': pass 'trace' has no such number of a "
            "selector; it has none",
        ),
        (
            '<accuracy><knob name="spp" values="4, 0"/></accuracy>',
            "A002 error `4,` values of knob 'spp': 0 is out of range: legal is 1 and more",
        ),
        (
            '<accuracy><knob name="depth" values="1 2.5"/></accuracy>',
            "A002 error `1` values of knob 'depth': 2.5 is no whole number",
        ),
        (
            '<accuracy><knob name="scale" values="0.5, 2"/></accuracy>',
            "A002 error `0.5,` values of knob 'scale': 2 is out of range: legal is 0.01 to 1",
        ),
        (
            '<accuracy><knob name="format" values="haf"/></accuracy>',
            "A002 error `haf` values of knob 'format': 'haf' is none of '8-bit', 'half', 'float' (did "
            "you mean 'half'?)",
        ),
        (
            '<accuracy><knob name="spp" values="4, 4"/></accuracy>',
            "A002 error `4,` values of knob 'spp': 4 is there twice",
        ),
        (
            '<accuracy><knob name="spp" values="many"/></accuracy>',
            "A002 error `many` values of knob 'spp': 'many' is no number",
        ),
        (
            '<accuracy><knob name="mask" values="all"/></accuracy>',
            "A003 error `mask` knob 'mask' needs a mask; the raytrace pass has none: pipeline 'A'",
        ),
        (
            '<accuracy pipeline="B"><knob name="spp" values="1"/></accuracy>',
            "A003 error `spp` knob 'spp' needs a raytrace pass; the pipeline has none: pipeline 'B'",
        ),
        (
            '<accuracy runs="1"/>',
            "A004 error `1` runs is 1; at least 2 give a spread",
        ),
        (
            '<accuracy reference="16"><knob name="spp" values="1, 16"/></accuracy>',
            "A004 error `16` reference is 16; it must be more than the greatest spp, 16",
        ),
        (
            '<accuracy><knob name="spp" values="1"/><knob name="spp" values="2"/></accuracy>',
            "A005 warning `spp` knob 'spp' is given twice; the last one counts",
        ),
        (
            '<effects simulate="shadow, mirrors"/>',
            "A006 error `shadow,` simulate of <effects>: there is no effect 'mirrors'; there is "
            "'reflection', 'refraction', 'transparency', 'shadow', 'penumbra', 'occlusion', "
            "'indirect', 'caustics', 'depth_of_field', 'fluorescence', 'auto', 'all', 'none'",
        ),
        (
            "<effects/>",
            "S004 error `effects` <effects> needs the attribute 'simulate'",
        ),
        (
            '<accuracy><knob values="1"/></accuracy>',
            "S004 error `knob` <knob> needs the attribute 'name'",
        ),
        (
            '<accuracy combine="some"/>',
            "V005 error `some` attribute 'combine' of <accuracy> is 'some'; it takes 'each', 'all'",
        ),
    ],
)
def test_one_fault(folder: Folder, block: str, expected: str) -> None:
    assert findings(folder, block) == [expected]


def test_good_blocks_have_no_finding(folder: Folder) -> None:
    block = (
        '<effects simulate="reflection, shadow"/><accuracy reference="64" runs="3" combine="all">'
        '<knob name="spp" values="1, 4"/><knob name="trace/MAX_DEPTH" values="1 2"/>'
        '<knob name="scale" values="0.5"/></accuracy>'
    )
    assert findings(folder, block) == []


def test_yaml_says_the_same(folder: Folder) -> None:
    """In the idiom of YAML, with positions."""
    folder.write(
        "project.yaml",
        (PROJECTS / "selective" / "project.yaml").read_text()
        + "\naccuracy:\n  - {name: ssp, values: 1}\neffects: {simulate: mirror}\n",
    )
    project = folder.load("project.yaml")
    found = {d.rule: d for d in nau_py.lint(project) if d.rule.startswith("A")}
    assert set(found) == {"A001", "A006"}
    line = project.sources[found["A001"].location.file].splitlines()[
        found["A001"].location.line - 1
    ]
    assert "ssp" in line
