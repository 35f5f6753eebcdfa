"""GLSL that drivers read differently: what is changed, and that it then compiles and draws."""

from __future__ import annotations

import numpy as np
import pytest

from nau_py.raster.device import get_device
from nau_py.raster.tolerant_glsl import adapt_stages

VERTEX = "#version 330\nin vec4 position;\n{}void main() {{ {} gl_Position = position; }}\n"
FRAGMENT = "#version {}\n{}out vec4 colour;\nvoid main() {{ colour = {}; }}\n"

CASES = {
    "a newer version": (
        VERTEX.format("", ""),
        FRAGMENT.format(460, "", "vec4(1)"),
        "#version 460 became 450",
    ),
    "another type of varying": (
        VERTEX.format("out vec3 eye;\n", "eye = vec3(1, 0, 0);"),
        FRAGMENT.format(330, "in vec4 eye;\n", "vec4(eye.xyz, 1)"),
        "input 'eye' of stage ps became vec3",
    ),
    "an unused uniform of another type": (
        VERTEX.format("uniform vec3 light;\n", "if (light.x > 9.0) return;"),
        FRAGMENT.format(330, "uniform vec4 light, other;\n", "other + vec4(1)"),
        "the unused uniform 'light' was left out",
    ),
    "a reserved word": (
        VERTEX.format("", ""),
        FRAGMENT.format(430, "uniform vec4 input;\n", "input"),
        "the reserved word 'input' became a name",
    ),
    "braces before 4.20": (
        VERTEX.format("", ""),
        FRAGMENT.format(330, "const vec2 k[2] = {vec2(0), vec2(1)};\n", "k[1].xyxy"),
        "#version 330 became 420",
    ),
    "a dead function with layout parameters": (
        VERTEX.format("", ""),
        FRAGMENT.format(
            430,
            "uint f(layout(r32ui) coherent uimage2D g, vec2 p)\n{ if (p.x > 0) { return 1; }\n"
            "return imageAtomicAdd(g, ivec2(0), 1); }\n",
            "vec4(1)",
        ),
        "the function 'f', which nobody calls, was left out",
    ),
    "layout of a parameter": (
        VERTEX.format("", ""),
        FRAGMENT.format(
            430,
            "float f(layout(rgba8) in float x) { return x; }\n",
            "vec4(f(1.0))",
        ),
        "layout() of a function parameter was left out",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_what_a_strict_driver_rejects_is_adapted(name: str) -> None:
    vertex, fragment, said = CASES[name]
    texts, notes = adapt_stages({"vs": vertex, "ps": fragment})
    assert any(said in note for note in notes), notes
    get_device().ctx.program(vertex_shader=texts["vs"], fragment_shader=texts["ps"])
    for stage, text in (("vs", vertex), ("ps", fragment)):
        assert texts[stage].count("\n") == text.count("\n")  # errors keep their lines


def test_right_glsl_is_left_alone() -> None:
    vertex = VERTEX.format("out vec3 eye;\n", "eye = vec3(1);")
    fragment = FRAGMENT.format(330, "in vec3 eye; // input = {\n", "vec4(eye, 1)")
    texts, notes = adapt_stages({"vs": vertex, "ps": fragment})
    assert notes == []
    assert texts == {"vs": vertex, "ps": fragment}


def test_comments_do_not_count() -> None:
    fragment = FRAGMENT.format(330, "/* uniform vec4 input; = { */\n", "vec4(1)")
    assert adapt_stages({"ps": fragment})[1] == []
    assert np.array(fragment) == adapt_stages({"ps": fragment})[0]["ps"]
