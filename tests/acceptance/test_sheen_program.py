"""A built-in ray program is one file: ``sheen``, and a new one beside it."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys

import numpy as np
import pytest
from numpy.typing import NDArray

import nau_py
from nau_py.raytrace.programs.catalogue import BUILTIN_PROGRAMS
from tests.conftest import ROOT, Folder
from tests.raytrace.studio import F, colour, picture, program, sphere, square, studio

PACKAGE = ROOT / "nau_py"
WHITE = (1.0, 1.0, 1.0)
BLACK = colour("DIFFUSE", 0.0, 0.0, 0.0, 1.0)
FLOOR = square("floor", "Cloth", [9, 1, 9], [0, 0, 0])


# One file


def test_no_other_module_knows_the_program() -> None:
    knowing = {
        str(file.relative_to(PACKAGE))
        for file in PACKAGE.rglob("*")
        if file.suffix != ".pyc"
        and file.is_file()
        and re.search("sheen", file.read_text(errors="ignore"), re.IGNORECASE)
    }
    assert knowing == {"raytrace/programs/builtin/sheen.py"}


NEW_PROGRAM = """\
from nau_py.model.attribute import number
from nau_py.model.values import DataType
from nau_py.raytrace.kernels.core.jit import inner
from nau_py.raytrace.kernels.shading.radiance import add_radiance
from nau_py.raytrace.programs.description import CLOSEST_HIT, BuiltInProgram


@inner
def shade_flat(scene, tile, ray_type, path, hit):
    add_radiance(tile, path, (hit.material.flatness, 0.0, 0.0), 1.0)
    return False


PROGRAM = BuiltInProgram(
    "flat",
    CLOSEST_HIT,
    "One brightness.",
    shade_flat,
    attributes=(number("FLATNESS", DataType.FLOAT, 0.5, "Brightness.", minimum=0.0, maximum=1.0),),
)
"""
USES = """\
import sys
import nau_py
from nau_py.raytrace.kernels.core.tables import MATERIAL
from nau_py.raytrace.programs.catalogue import BUILTIN_PROGRAMS, CODES

assert CODES["CLOSEST_HIT"]["flat"] > 0
assert "flatness" in MATERIAL.dtype.names
from tools.reference import reference_page

assert "| `flat` | CLOSEST_HIT | One brightness. |" in reference_page()
assert "| `FLATNESS` | FLOAT | 0.5 | Brightness. |" in reference_page()
for found in nau_py.lint(nau_py.load(sys.argv[1])):
    print(found.rule, found.message)
assert "numba" not in sys.modules  # lint and reference compile nothing
"""


@pytest.mark.parametrize(
    "name, value, expected",
    [
        ("flat", 0.25, ""),
        ("flatt", 0.25, "T006 .*'flatt'; there is .*did you mean 'flat'"),
        ("flat", 2.0, "V006 .*FLATNESS"),
    ],
)
def test_a_file_makes_a_program(folder: Folder, name: str, value: float, expected: str) -> None:
    """Codes, records, lint and the reference follow from a file that is put beside the others."""
    site = folder.path / "site"
    shutil.copytree(PACKAGE, site / "nau_py", ignore=shutil.ignore_patterns("__pycache__"))
    (site / "nau_py" / "raytrace" / "programs" / "builtin" / "flat.py").write_text(NEW_PROGRAM)
    studio(folder, FLOOR, {"Cloth": colour("FLATNESS", value)}, program("Cloth", name))
    done = subprocess.run(
        [sys.executable, "-c", USES, str(folder.path / "project.xml")],
        env=os.environ | {"PYTHONPATH": f"{site}{os.pathsep}{ROOT}"},
        cwd=folder.path,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert len(lines) == bool(expected)
    assert all(re.search(expected, line) for line in lines)


# Numbers, against a float64 quadrature of the published formulas


def masking(cosine: NDArray[np.float64], r: float) -> NDArray[np.float64]:
    """Λ of Estevez and Kulla, *Production Friendly Microfacet Sheen BRDF*, 2017, table 1."""
    at_0 = (25.3245, 3.32435, 0.16801, -1.27393, -4.85967)
    at_1 = (21.5473, 3.82987, 0.19823, -1.97760, -4.32054)
    k = (1 - r) ** 2
    a, b, c, d, e = (k * x + (1 - k) * y for x, y in zip(at_0, at_1))

    def curve(x: NDArray[np.float64] | float) -> NDArray[np.float64]:
        return np.asarray(a / (1 + b * x**c) + d * x + e)

    low, high = np.minimum(cosine, 0.5), np.maximum(cosine, 0.5)
    found: NDArray[np.float64] = np.where(
        cosine < 0.5, np.exp(curve(low)), np.exp(2 * curve(0.5) - curve(1 - high))
    )
    return found


def brdf(to: NDArray[np.float64], away: NDArray[np.float64], r: float) -> NDArray[np.float64]:
    """Charlie's distribution times visibility, for unit vectors (..., 3) about the normal z."""
    half = to + away
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    sine = np.sqrt(np.maximum(1 - half[..., 2] ** 2, 0))
    density = (2 + 1 / r) * sine ** (1 / r) / (2 * np.pi)
    shadowing = 1 / (1 + masking(to[..., 2], r) + masking(away[..., 2], r))
    found: NDArray[np.float64] = density * shadowing / (4 * to[..., 2] * away[..., 2])
    return found


def directional_albedo(cosine: float, r: float, steps: int = 800) -> float:
    """Integrate BRDF times cosine over the hemisphere: midpoint rule in both angles."""
    polar = ((np.arange(steps) + 0.5) / steps * np.pi / 2)[:, None]
    azimuth = ((np.arange(steps) + 0.5) / steps * np.pi)[None, :]
    to = np.stack(
        np.broadcast_arrays(
            np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)
        ),
        -1,
    )
    away = np.array([np.sqrt(1 - cosine**2), 0, cosine])
    reflected = brdf(to, away, r) * np.cos(polar) * np.sin(polar)
    return float(2 * reflected.sum() * (np.pi / 2 / steps) * (np.pi / steps))


def view(cosine: float) -> str:
    """A camera 3 units from the origin that sees the floor at this cosine."""
    away = np.sqrt(1 - cosine**2)
    return f'<POSITION x="{3 * away}" y="{3 * cosine}" z="0" /><LOOK_AT_POINT x="0" y="0" z="0" />'


def floor(folder: Folder, material: str, cosine: float, spp: int) -> F:
    """Radiance of the floor in a white world, seen at almost one angle."""
    project = studio(
        folder,
        FLOOR,
        {"Cloth": material},
        program("Cloth", "sheen"),
        camera=view(cosine),
        fov=0.1,
        size=(16, 16),
        spp=spp,
        clear=WHITE,
    )
    assert nau_py.lint(project) == []
    return picture(project)[..., :3]


@pytest.mark.parametrize("roughness", [0.1, 0.3, 1.0])
@pytest.mark.parametrize("cosine", [0.9, 0.3, 0.03])
def test_white_world(folder: Folder, roughness: float, cosine: float) -> None:
    """Fibres alone reflect SHEEN times the directional albedo of the formulas, which is below 1."""
    material = BLACK + colour("SHEEN", 1.0, 0.5, 0.0, 1.0) + colour("SHEEN_ROUGHNESS", roughness)
    found = floor(folder, material, cosine, 256).mean(axis=(0, 1))
    expected = directional_albedo(cosine, roughness)
    assert expected < 1
    np.testing.assert_allclose(found, expected * np.array([1, 0.5, 0]), rtol=0.03, atol=2e-4)


@pytest.mark.parametrize("cosine", [0.9, 0.3, 0.03])
def test_white_cloth_loses_no_light(folder: Folder, cosine: float) -> None:
    material = colour("DIFFUSE", *WHITE, 1.0) + colour("SHEEN", *WHITE, 1.0)
    found = floor(folder, material, cosine, 256)
    assert found.mean() == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("cosine", [0.8, 0.2])
def test_light_of_a_lamp(folder: Folder, cosine: float) -> None:
    """A directional light brings π times BRDF times cosine times its colour: without noise."""
    toward = np.array([0.6, 0.64, -0.48])
    lamp = (
        '<light name="Sun">'
        f'<DIRECTION x="{-toward[0]}" y="{-toward[1]}" z="{-toward[2]}" />'
        '<COLOR r="0.8" g="0.8" b="0.8" /></light>'
    )
    project = studio(
        folder,
        FLOOR,
        {"Cloth": BLACK + colour("SHEEN", *WHITE, 1.0) + colour("SHEEN_ROUGHNESS", 0.4)},
        program("Cloth", "sheen"),
        camera=view(cosine),
        lights=lamp,
        fov=0.1,
        size=(4, 4),
        depth=1,
    )
    away = np.array([np.sqrt(1 - cosine**2), 0, cosine])
    expected = np.pi * brdf(toward[[0, 2, 1]], away, 0.4) * toward[1] * 0.8
    np.testing.assert_allclose(picture(project)[..., 0], expected, rtol=2e-3)


@pytest.mark.parametrize("roughness", [0.1, 0.5])
def test_grazing_angles_are_finite(folder: Folder, roughness: float) -> None:
    """A ball shows every angle up to its rim."""
    material = BLACK + colour("SHEEN", *WHITE, 1.0) + colour("SHEEN_ROUGHNESS", roughness)
    project = studio(
        folder,
        sphere("ball", "Cloth", 1.0, [0, 0, 0], 64),
        {"Cloth": material},
        program("Cloth", "sheen"),
        size=(32, 32),
        spp=64,
        fov=36,
        clear=WHITE,
    )
    found = picture(project)[..., 0]
    assert np.isfinite(found).all()
    assert found.min() >= 0
    assert found[8:24, 8:24].max() < 1


def test_attributes_are_those_of_the_file() -> None:
    names = [a.name for a in BUILTIN_PROGRAMS["sheen"].attributes]
    assert names == ["SHEEN", "SHEEN_ROUGHNESS"]
