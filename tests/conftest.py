"""Small projects for tests: written to a folder, loaded and rendered as a user's would be."""

from __future__ import annotations

import copy
import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import nau_py
import nau_py.scene.readers.loading  # registers the readers
from nau_py.scene.readers.registry import READERS, Model

ROOT = Path(__file__).parent.parent
PROJECTS = ROOT / "projects"


def heed_interrupts() -> None:
    """For a child process that a test will interrupt: shells start background jobs, the test run
    perhaps among them, with the signal ignored, and children inherit that."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


class Folder:
    """A project folder in the making."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def write(self, name: str, text: str) -> Path:
        file = self.path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
        return file

    def obj(self, name: str, quads: list[tuple[str, list[tuple[float, float, float]]]]) -> None:
        """Quads (material, four corners counter-clockwise), texture coordinates 0..1."""
        lines = [f"mtllib {name}.mtl", "vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1"]
        for index, (material, corners) in enumerate(quads):
            lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in corners]
            lines.append(f"usemtl {material}")
            base = 4 * index
            lines.append("f " + " ".join(f"{base + k}/{k}" for k in range(1, 5)))
        self.write(f"{name}.obj", "\n".join(lines) + "\n")

    def mtl(self, name: str, materials: dict[str, dict[str, str]]) -> None:
        lines = []
        for material, entries in materials.items():
            lines += [f"newmtl {material}", *(f"{k} {v}" for k, v in entries.items())]
        self.write(f"{name}.mtl", "\n".join(lines) + "\n")

    def image(self, name: str, texels: np.ndarray[Any, Any]) -> None:
        """Save an image; row 0 of ``texels`` is its top row."""
        Image.fromarray(texels).save(self.path / name)

    def load(self, name: str = "project.xml") -> nau_py.Project:
        return nau_py.load(self.path / name)


@pytest.fixture(scope="session", autouse=True)
def plaza() -> Iterator[None]:
    """Read the OBJ file of the plaza once: a hundred tests draw it, and reading takes half a second."""
    read = READERS[".obj"]
    kept: dict[bool, Model] = {}

    def read_once(path: Path, swap_yz: bool) -> Model:
        if Path(os.path.abspath(path)) != PROJECTS / "models" / "plaza" / "plaza.obj":
            return read(path, swap_yz)
        if swap_yz not in kept:
            kept[swap_yz] = read(path, swap_yz)
        return copy.deepcopy(kept[swap_yz])

    READERS[".obj"] = read_once
    yield
    READERS[".obj"] = read


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    return Folder(tmp_path)


LIBRARY = """\
<materialLib name="L">
  <renderTargets>
    <renderTarget name="rt">
      <SIZE width="{w}" height="{h}" />
      <CLEAR_VALUES r="0" g="0" b="0.25" a="0" />
      <colors><color name="out" internalFormat="RGBA32F" /></colors>
    </renderTarget>
  </renderTargets>
</materialLib>
"""

RAY_PROJECT = """\
<project name="Rays" width="{w}" height="{h}">
  <assets>
    <scenes><scene name="S"><file name="scene.obj" /></scene></scenes>
    <lights><light name="Sun"><DIRECTION x="{lx}" y="{ly}" z="{lz}" /></light></lights>
    <cameras>
      <camera name="C">
        <projection TYPE="PERSPECTIVE" FOV="60" NEAR="0.1" FAR="100" />
        {camera}
      </camera>
    </cameras>
    <materialLibs><materialLib filename="lib.mlib" /></materialLibs>
  </assets>
  <pipelines>
    <pipeline name="P">
      <pass name="trace" class="raytrace">
        <camera name="C" />
        <scenes><scene name="S" /></scenes>
        <lights><light name="Sun" /></lights>
        <renderTarget name="rt" fromLibrary="L" />
        <RAYS_PER_PIXEL value="{spp}" />
        <MAX_DEPTH value="3" />
        <rtEntryPoint><rayGen file="builtin" proc="pinhole" /></rtEntryPoint>
        {programs}
      </pass>
    </pipeline>
  </pipelines>
</project>
"""

LAMBERT = """\
<rtDefaultMaterial>
  <rayType name="Radiance">
    <rtProgram type="CLOSEST_HIT" file="builtin" proc="lambert" />
    <rtProgram type="MISS" file="builtin" proc="background" />
  </rayType>
  <rayType name="Shadow"><rtProgram type="MISS" file="builtin" proc="unoccluded" /></rayType>
</rtDefaultMaterial>
"""

RayProject = Callable[..., nau_py.Project]


@pytest.fixture
def ray_project(folder: Folder) -> RayProject:
    """A project with one raytrace pass over ``scene.obj`` into the float target ``L::out``."""

    def make(
        programs: str = LAMBERT,
        camera: str = '<POSITION x="0" y="0" z="3" />',
        light: tuple[float, float, float] = (0, -1, 0),
        size: tuple[int, int] = (64, 48),
        spp: int = 1,
    ) -> nau_py.Project:
        w, h = size
        folder.write("lib.mlib", LIBRARY.format(w=w, h=h))
        text = RAY_PROJECT.format(
            w=w,
            h=h,
            lx=light[0],
            ly=light[1],
            lz=light[2],
            camera=camera,
            spp=spp,
            programs=programs,
        )
        folder.write("project.xml", text)
        return folder.load()

    return make


def pixel_rays(
    size: tuple[int, int], position: tuple[float, float, float], fov: float = 60.0
) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Analytic rays through pixel centres of a camera that looks along -z, float64 (h, w, 3).

    Row 0 at the top, as in ``Frame.targets``. Directions are not normalised (z = -1).
    """
    w, h = size
    half = np.tan(np.radians(fov) / 2)
    x = ((np.arange(w) + 0.5) / w * 2 - 1) * half * w / h
    y = (1 - (np.arange(h) + 0.5) / h * 2) * half
    direction = np.stack([*np.meshgrid(x, y), np.full((h, w), -1.0)], axis=-1)
    return np.broadcast_to(np.array(position, float), direction.shape), direction


@pytest.fixture(scope="session")
def selective() -> nau_py.Frame:
    """The selective demo at 192 x 192, with its 16 samples a pixel."""
    project = nau_py.load(PROJECTS / "selective" / "project.xml")
    return nau_py.Renderer(project, size=(192, 192)).render()


@pytest.fixture(scope="session")
def half() -> nau_py.Frame:
    """The half-and-half demo at 192 x 192."""
    project = nau_py.load(PROJECTS / "half" / "project.xml")
    return nau_py.Renderer(project, size=(192, 192)).render()
