"""Small ray-traced projects for tests: geometry as XML, materials of a library, programs by name."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import nau_py
from tests.conftest import Folder

LIBRARY = """\
<materialLib name="L">
  <renderTargets><renderTarget name="rt"><SIZE width="{w}" height="{h}" />
    <CLEAR_VALUES r="{clear[0]}" g="{clear[1]}" b="{clear[2]}" a="0" />
    <colors><color name="out" internalFormat="RGBA32F" /></colors></renderTarget></renderTargets>
  <materials>{materials}</materials>
</materialLib>
"""
PROJECT = """\
<project name="Studio" width="{w}" height="{h}"><assets>
  <scenes><scene name="S">{geometry}</scene></scenes>
  <lights>{lights}</lights>
  <cameras><camera name="C">
    <projection TYPE="PERSPECTIVE" FOV="{fov}" NEAR="{near}" FAR="1000" />{camera}
  </camera></cameras>
  <materialLibs><materialLib filename="lib.mlib" /></materialLibs>
</assets><pipelines><pipeline name="P"><pass name="trace" class="raytrace">
  <camera name="C" /><scenes><scene name="S" /></scenes><lights>{pass_lights}</lights>
  <renderTarget name="rt" fromLibrary="L" />
  <RAYS_PER_PIXEL value="{spp}" /><MAX_DEPTH value="{depth}" />{settings}
  <materialMaps>{maps}</materialMaps>
  <rtEntryPoint><rayGen file="builtin" proc="{generate}" /></rtEntryPoint>
  <rtDefaultMaterial><rayType name="Radiance">
    <rtProgram type="CLOSEST_HIT" file="builtin" proc="{default}" />
    <rtProgram type="MISS" file="builtin" proc="background" /></rayType>{shadow}
  </rtDefaultMaterial>
  <rtMaterialMap>{programs}</rtMaterialMap>
</pass></pipeline></pipelines></project>
"""
SHADOW = (
    '<rayType name="Shadow"><rtProgram type="MISS" file="builtin" proc="unoccluded" /></rayType>'
)
F = NDArray[np.floating[Any]]


def program(name: str, closest: str = "", any_hit: str = "") -> str:
    """An rtMap of material ``name``; the any-hit program counts for shadow rays as well."""
    parts = ""
    if closest:
        parts += f'<rtProgram type="CLOSEST_HIT" file="builtin" proc="{closest}" />'
    tested = f'<rtProgram type="ANY_HIT" file="builtin" proc="{any_hit}" />' if any_hit else ""
    found = f'<rtMap to="{name}"><rayType name="Radiance">{parts}{tested}</rayType>'
    if any_hit:
        found += f'<rayType name="Shadow">{tested}</rayType>'
    return found + "</rtMap>"


def colour(name: str, *values: float) -> str:
    """A colour or number of a material."""
    if len(values) == 1:
        return f'<{name} value="{values[0]!r}" />'
    return f"<{name} " + " ".join(f'{k}="{float(v)!r}"' for k, v in zip("rgba", values)) + " />"


def studio(
    folder: Folder,
    geometry: str,
    materials: dict[str, str],
    programs: str = "",
    *,
    default: str = "emission",
    lights: str = "",
    camera: str = '<POSITION x="0" y="0" z="3" />',
    settings: str = "",
    size: tuple[int, int] = (32, 32),
    spp: int = 1,
    depth: int = 8,
    fov: float = 60,
    near: float = 0.1,
    clear: tuple[float, float, float] = (0, 0, 0),
    generate: str = "pinhole",
    shadow: bool = True,
) -> nau_py.Project:
    """A project whose pass ``trace`` fills the float target ``L::out``."""
    import re

    names = re.findall(r'<light name="(\w+)"', lights)
    folder.write(
        "lib.mlib",
        LIBRARY.format(
            w=size[0],
            h=size[1],
            clear=clear,
            materials="".join(
                f'<material name="{name}"><color>{text}</color></material>'
                for name, text in materials.items()
            ),
        ),
    )
    folder.write(
        "project.xml",
        PROJECT.format(
            w=size[0],
            h=size[1],
            geometry=geometry,
            lights=lights,
            pass_lights="".join(f'<light name="{name}" />' for name in names),
            camera=camera,
            settings=settings,
            spp=spp,
            depth=depth,
            fov=fov,
            near=near,
            generate=generate,
            default=default,
            shadow=SHADOW if shadow else "",
            programs=programs,
            maps="".join(
                f'<map fromMaterial="{name}" toLibrary="L" toMaterial="{name}" />'
                for name in materials
            ),
        ),
    )
    return folder.load()


def picture(project: nau_py.Project, **options: Any) -> F:
    """``L::out`` as float64 (height, width, 4), row 0 at the top."""
    renderer = nau_py.Renderer(project, options=nau_py.RunOptions(**options))
    return renderer.render().targets["L::out"].astype(np.float64)


def square(
    name: str, material: str, scale: F | list[float], at: list[float], turn: str = ""
) -> str:
    """A square of half sides ``scale`` in the plane y = 0, normal +y, turned, then moved."""
    return _shape(name, material, "SQUARE", list(scale), at, turn)


def box(name: str, material: str, scale: list[float], at: list[float]) -> str:
    return _shape(name, material, "BOX", scale, at, "")


def sphere(name: str, material: str, radius: float, at: list[float], slices: int = 256) -> str:
    detail = f' SLICES="{slices}" STACKS="{slices // 2}"'
    return _shape(name, material, "SPHERE", [radius] * 3, at, "", detail)


def _shape(
    name: str,
    material: str,
    type_: str,
    scale: list[float],
    at: list[float],
    more: str,
    detail: str = "",
) -> str:
    x, y, z = scale
    return (
        f'<geometry name="{name}" type="{type_}" material="{material}"{detail}>'
        f'<SCALE x="{x!r}" y="{y!r}" z="{z!r}" />{more}'
        f'<TRANSLATE x="{at[0]!r}" y="{at[1]!r}" z="{at[2]!r}" /></geometry>'
    )
