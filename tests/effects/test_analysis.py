"""What data calls for, without rendering anything."""

from __future__ import annotations

from pathlib import Path

import pytest

from nau_py.diagnostics.location import Location
from nau_py.effects.analysis import find_causes, find_opaque_materials
from nau_py.effects.decision import EXACT, UNKNOWN, decide_effects
from nau_py.effects.facts import (
    LightFacts,
    MaterialFacts,
    PassFacts,
    ProgramFacts,
    find_sent_kinds,
)
from nau_py.model.effects import EFFECTS, parse_effects

HERE = Location("project.xml", 7, 3)


def built_in(*names: str) -> tuple[ProgramFacts, ...]:
    return tuple(ProgramFacts(name, HERE, name) for name in names)


def facts(
    closest: str, any_hit: str = "", alpha: float = 1.0, emission: float = 0.0, **more: object
) -> PassFacts:
    """A pass over one material, and a lamp of another."""
    material = MaterialFacts(
        "M",
        built_in(closest),
        built_in(any_hit) if any_hit else (),
        {"SPECULAR": (0.5, 0.5, 0.5, 1.0), "DIFFUSE": (1.0, 1.0, 1.0, 1.0)},
        alpha,
    )
    lamp = MaterialFacts("Lamp", built_in("path"), (), {"EMISSION": (emission,) * 3})
    return PassFacts((material, lamp), **more)  # type: ignore[arg-type]


def effects(found: PassFacts) -> set[str]:
    return {name for name, causes in find_causes(found).items() if causes}


SUN = LightFacts("Sun", HERE)
PANEL = LightFacts("Panel", HERE, has_area=True)


@pytest.mark.parametrize(
    "found, expected",
    [
        (facts("mirror"), {"reflection"}),
        (facts("dielectric"), {"reflection", "refraction"}),
        (facts("emission"), set()),
        (facts("ambient_occlusion"), {"occlusion"}),
        # simple shading asks for shadows only where the pass has rays for them
        (facts("lambert", lights=(SUN,)), {"shadow"}),
        (facts("direct", lights=(SUN, PANEL)), {"shadow", "penumbra"}),
        (facts("emission", "alpha_test", 0.2), {"transparency"}),
        (facts("emission", "alpha_test", 0.3), set()),
        (facts("emission", "transparency", 0.3), {"transparency"}),
        (facts("emission", "stochastic_alpha", 1.0), set()),
        (facts("path", max_depth=4), {"indirect"}),
        (facts("dielectric", emission=5.0, max_depth=4),
         {"reflection", "refraction", "indirect", "shadow", "caustics"}),
        (facts("emission", generate=ProgramFacts("thin_lens", HERE, "thin_lens"), aperture=0.1,
               camera="C", camera_location=HERE), {"depth_of_field"}),
        (facts("emission", generate=ProgramFacts("thin_lens", HERE, "thin_lens"), aperture=0.0,
               camera="C", camera_location=HERE), set()),
    ],
)  # fmt: skip
def test_causes_of_a_scene(found: PassFacts, expected: set[str]) -> None:
    light = {"shadow"} if any(m.name == "Lamp" for m in found.materials) and found.lights else set()
    assert effects(found) == expected | light


def test_a_mirror_that_shows_nothing_calls_for_nothing() -> None:
    dark = MaterialFacts("Dark", built_in("mirror"), (), {"SPECULAR": (0.0, 0.0, 0.0)})
    assert effects(PassFacts((dark,))) == set()


def test_causes_name_material_and_place() -> None:
    cause = find_causes(facts("mirror"))["reflection"][0]
    assert (cause.what, cause.location, cause.material) == ("material 'M'", HERE, "M")


def test_fluorescence_needs_a_matrix() -> None:
    glow = {"FLUORESCENCE_BLUE": (0.0, 0.4, 0.0)}
    for colours, expected in (({}, False), (glow, True)):
        found = PassFacts(
            (MaterialFacts("M", built_in("fluorescent"), (), dict(colours)),), max_depth=3
        )
        assert ("fluorescence" in effects(found)) == expected


def test_opaque_materials_need_no_any_hit() -> None:
    """By the least alpha of their texture, and of DIFFUSE where that counts."""
    cards = [
        MaterialFacts("A", (), built_in("alpha_test"), {}, 0.26),
        MaterialFacts("B", (), built_in("alpha_test"), {}, 0.25),
        MaterialFacts("C", (), built_in("transparency"), {"DIFFUSE": (1, 1, 1, 0.5)}, 1.0),
        MaterialFacts("D", (), built_in("transparency"), {"DIFFUSE": (1, 1, 1, 1)}, 1.0),
        MaterialFacts("E", (), (), {}, 0.0),
        MaterialFacts("F", (), (ProgramFacts("mine", HERE),), {}, 1.0),
    ]
    assert find_opaque_materials(PassFacts(tuple(cards))) == {0, 3}


def test_kinds_of_a_python_program(tmp_path: Path) -> None:
    """By reading: helpers of the file count, other functions and other calls do not."""
    file = tmp_path / "mine.py"
    file.write_text(
        "raise RuntimeError('this file must not be run')\n"
        "def helper(hits):\n    return hits.trace('Radiance', 0, kind='refraction')\n"
        "def glass(hits):\n    a = hits.trace('Radiance', 0, kind='reflection')\n"
        "    return a + helper(hits)\n"
        "def lit(hits):\n    return hits.trace('Shadow', 0)\n"
        "def plain(hits):\n    return hits.other(kind='occlusion')\n"
    )
    assert find_sent_kinds(file, "glass") == {"reflection", "refraction"}
    assert find_sent_kinds(file, "__closesthit__glass") == {"reflection", "refraction"}
    assert find_sent_kinds(file, "lit") == {"shadow"}
    assert find_sent_kinds(file, "plain") == frozenset()
    assert find_sent_kinds(file, "absent") == frozenset()
    file.write_text("def plain(hits):\n    return hits.trace('R', 0, kind='occlusion')\n")
    assert find_sent_kinds(file, "plain") == {"occlusion"}
    assert find_sent_kinds(tmp_path / "none.py", "plain") == frozenset()


def test_a_python_program_calls_for_what_it_sends() -> None:
    sends = ProgramFacts("'glass' of mine.py", HERE, "", frozenset({"reflection", "mine"}))
    found = find_causes(PassFacts((MaterialFacts("M", (sends,)),)))
    assert [c.what for c in found["reflection"]] == ["material 'M' by 'glass' of mine.py"]
    assert effects(PassFacts((MaterialFacts("M", (sends,)),))) == {"reflection"}


def test_decisions() -> None:
    calls = find_causes(facts("mirror", lights=(SUN,)))
    auto = {d.effect: d for d in decide_effects(None, calls, 1e-4, "--effects")}
    assert auto["reflection"].simulated
    assert "0.0001" in auto["reflection"].bound
    assert not auto["refraction"].simulated
    assert (auto["refraction"].reason, auto["refraction"].bound) == ("nothing calls for it", EXACT)
    everything = decide_effects(parse_effects("all"), calls, 0.0, "--effects")
    assert all(d.simulated and d.bound == EXACT for d in everything)
    listed = {
        d.effect: d for d in decide_effects(parse_effects("shadow"), calls, 1e-4, "--effects")
    }
    assert listed["shadow"].simulated
    assert listed["reflection"].reason == "--effects leaves it out"
    assert listed["reflection"].bound == UNKNOWN
    assert listed["caustics"].bound == EXACT


def test_lists_of_effects() -> None:
    assert parse_effects("auto") is None
    assert parse_effects(" all ") == frozenset(EFFECTS)
    assert parse_effects("none") == frozenset()
    assert parse_effects("shadow, reflection") == {"shadow", "reflection"}
    with pytest.raises(ValueError, match=r"no effect 'shadows'; .*did you mean 'shadow'"):
        parse_effects("shadows")
