"""The scene of a launch, which all tiles share, and its tables for the kernels."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from math import cos, radians
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.core import tables as t
from nau_py.raytrace.kernels.core.kernel_tables import NONE, PARTIAL, USER
from nau_py.raytrace.kernels.core.layout import dtype_of
from nau_py.raytrace.programs.catalogue import (
    BUILTIN_PROGRAMS,
    CODES,
    find_zeroed_attributes,
)
from nau_py.raytrace.programs.description import ANY_HIT, CLOSEST_HIT, MISS
from nau_py.raytrace.tracing.accelerator import Accelerator
from nau_py.raytrace.tracing.arrays import F32
from nau_py.raytrace.tracing.geometry import RayGeometry
from nau_py.raytrace.tracing.materials import TracedLight, TracedMaterial
from nau_py.raytrace.tracing.program_loader import BoundProgram
from nau_py.raytrace.tracing.ray_texture import RayTexture
from nau_py.raytrace.tracing.simulated import SimulatedEffects
from nau_py.scene.mesh import F64

ProgramTable = dict[tuple[str, str], list[BoundProgram | None]]
"""(ray type, kind) to a program for each material; a MISS has one entry."""


@dataclass(frozen=True, slots=True)
class TraceSettings:
    """Values of the pass: recursion, random seed, and parameters of built-in programs."""

    max_depth: int = 1
    seed: int = 0
    light_samples: int = 1
    occlusion_distance: float = np.inf
    clear_color: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    simulated: SimulatedEffects = field(default_factory=SimulatedEffects)


class Tables:
    """The record of a scene that kernels read, shape (1,), and the arrays that it points to."""

    def __init__(self, record: NDArray[Any], arrays: dict[str, NDArray[Any]]) -> None:
        self.record = record
        self.arrays: dict[str, NDArray[Any]] = {}
        for name, dtype in t.ARRAYS.items():
            array = np.ascontiguousarray(arrays[name], dtype_of(dtype))
            self.arrays[name] = array
            record[name], record[f"{name}_count"] = array.ctypes.data, len(array)


@dataclass
class TracedScene:
    """Geometry, materials, programs and lights of a pass, in one frame."""

    geometry: RayGeometry
    accelerator: Accelerator
    materials: list[TracedMaterial]
    programs: ProgramTable
    lights: list[TracedLight]
    variables: dict[str, NDArray[Any]]
    inputs: dict[str, NDArray[Any]]
    ray_types: list[str]
    settings: TraceSettings
    texels: TexelStore
    tables: Tables = field(init=False)

    def __post_init__(self) -> None:
        self.tables = make_tables(self)

    @property
    def clear_color(self) -> F32:
        return np.array(self.settings.clear_color, np.float32)

    def program(self, ray_type: str, kind: str, material: int) -> BoundProgram | None:
        listed = self.programs.get((ray_type, kind), [])
        return listed[material] if material < len(listed) else None


class TexelStore:
    """The textures of unit 0 in one array, made once a pass."""

    def __init__(self) -> None:
        self._index: dict[int, int] = {}
        self._kept: list[RayTexture] = []
        self._joined: tuple[NDArray[Any], NDArray[np.uint8]] | None = None

    def index(self, texture: RayTexture | None) -> int:
        """Return the index of the record of ``texture``; -1 for none."""
        if texture is None:
            return -1
        if id(texture) not in self._index:
            self._index[id(texture)] = len(self._kept)
            self._kept.append(texture)
            self._joined = None
        return self._index[id(texture)]

    def arrays(self) -> tuple[NDArray[Any], NDArray[np.uint8]]:
        """Return the records, and all texels."""
        if self._joined is None:
            offsets = np.cumsum([0, *(len(x.rgba) for x in self._kept)])
            records = [x.make_record(int(o)) for x, o in zip(self._kept, offsets)]
            self._joined = (
                np.concatenate([np.zeros(0, t.TEXTURE), *records]),
                np.concatenate([np.zeros(0, np.uint8), *(x.rgba for x in self._kept)]),
            )
        return self._joined


@lru_cache(maxsize=64)
def _program_table(program: str, name: str) -> NDArray[np.float64]:
    """Compute a table of a built-in program, once a process."""
    return np.asarray(BUILTIN_PROGRAMS[program].tables[name](), np.float64)


def _program_tables(codes: dict[str, NDArray[Any]]) -> dict[str, NDArray[np.float64]]:
    """Return the tables of all built-in programs; one entry stands for the table of a program that
    no material has."""
    found = {}
    for program in BUILTIN_PROGRAMS.values():
        used = (
            program.kind in codes and CODES[program.kind].get(program.name) in codes[program.kind]
        )
        for name in program.tables:
            found[name] = _program_table(program.name, name) if used else np.ones(1)
    return found


def _material(material: TracedMaterial, store: TexelStore) -> NDArray[Any]:
    """Return the record of a material: its attributes by the names of the fields."""
    made = np.zeros((), t.MATERIAL.dtype)
    for name in made.dtype.names or ():
        if name != "texture":
            values = material.colour(name.upper())
            made[name] = values[: made[name].size] if made[name].ndim else values[0]
    made["texture"] = store.index(material.textures.get(0))
    return made


def _light(light: TracedLight, centre: F64, penumbra: bool) -> NDArray[Any]:
    made = np.zeros((), t.LIGHT)
    v = light.values
    shape = t.SHAPES.index(str(v["SHAPE"][0]))
    made["shape"] = t.POINT if shape >= t.RECTANGLE and not penumbra else shape
    made["position"] = np.array([float(x) for x in v["POSITION"][:3]]) - centre
    made["direction"] = direction = np.array([float(x) for x in v["NORMALIZED_DIRECTION"][:3]])
    made["colour"] = [float(x) for x in v["COLOR"][:3]]
    made["attenuation"] = [float(v[f"{k}_ATT"][0]) for k in ("CONSTANT", "LINEAR", "QUADRATIC")]
    axis = np.array([float(x) for x in v["SPOT_DIRECTION"][:3]])
    made["spot"] = axis / max(float(np.linalg.norm(axis)), 1e-30)
    cutoff = float(v["SPOT_CUTOFF"][0])
    made["cutoff"] = cos(radians(cutoff)) if cutoff != 180.0 else -1.0
    made["exponent"], made["radius"] = float(v["SPOT_EXPONENT"][0]), float(v["RADIUS"][0])
    made["edge_u"] = [float(x) for x in v["EDGE_U"][:3]]
    made["edge_v"] = [float(x) for x in v["EDGE_V"][:3]]
    if made["shape"] == t.DISC:
        first = np.cross(direction, np.eye(3)[int(np.argmin(np.abs(direction)))])
        first *= made["radius"] / max(float(np.linalg.norm(first)), 1e-30)
        made["edge_u"], made["edge_v"] = first, np.cross(direction, first)
    return made


def _emitters(
    geometry: RayGeometry, materials: NDArray[Any]
) -> tuple[NDArray[np.int32], F64, NDArray[np.float64]]:
    """Return the triangles of materials with EMISSION, their cumulative power, and the density over
    area by triangle."""
    strength = materials["emission"].astype(np.float64).sum(axis=1)
    strength = np.where(np.isfinite(strength) & (strength > 0), strength, 0.0)
    density = np.zeros(len(geometry.triangles))
    if not strength.any():
        return np.zeros(0, np.int32), np.zeros(1), density
    chosen = np.flatnonzero(strength[geometry.material] > 0)
    corners = geometry.vertices[geometry.triangles[chosen]].astype(np.float64)
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.sqrt((cross**2).sum(axis=1)) / 2
    power = area * strength[geometry.material[chosen]]
    total = float(power.sum())
    if not total > 0:
        return np.zeros(0, np.int32), np.zeros(1), density
    density[chosen] = power / total / np.where(area > 0, area, 1)
    cdf = np.concatenate([[0.0], np.cumsum(power / total)])
    return chosen.astype(np.int32), cdf, density


def _attribute(values: F32 | None) -> F32:
    return np.zeros((0, 4), np.float32) if values is None else np.ascontiguousarray(values)


def make_tables(scene: TracedScene) -> Tables:
    """Make the tables of ``scene`` that kernels read."""
    geometry, types = scene.geometry, scene.ray_types
    count = max(len(scene.materials), 1)
    simulated = scene.settings.simulated
    materials = np.zeros(count, t.MATERIAL.dtype)
    for index, material in enumerate(scene.materials):
        materials[index] = _material(material, scene.texels)
    if not simulated.fluorescence:
        for name in find_zeroed_attributes("fluorescence"):
            materials[name.lower()] = 0
    codes = {k: np.zeros((len(types), count), np.int8) for k in (CLOSEST_HIT, ANY_HIT)}
    for kind, table in codes.items():
        for row, name in enumerate(types):
            for column, program in enumerate(scene.programs.get((name, kind), [])):
                table[row, column] = program.code if program else 0
    closest, any_hit = codes[CLOSEST_HIT], codes[ANY_HIT]
    geometric = [CODES[ANY_HIT][p.name] for p in BUILTIN_PROGRAMS.values() if p.geometric]
    left_out = ~np.isin(any_hit, geometric)
    if simulated.transparency:
        plain = np.isin(np.arange(count), list(simulated.opaque))
        left_out &= plain[None, :] & (any_hit != USER)
    any_hit[left_out] = NONE
    miss = np.zeros(len(types), np.int8)
    for row, name in enumerate(types):
        program = scene.program(name, MISS, 0)
        miss[row] = program.code if program else 0
    has_any = np.where(any_hit == USER, t.PYTHON, any_hit != NONE)
    partial = (any_hit >= PARTIAL) & (any_hit != USER)
    has_any = np.where(partial, t.PARTIAL, has_any).max(axis=1)
    visibility = ~(closest != 0).any(axis=1)
    deferred = (has_any == t.PYTHON) | (miss == USER) | ~visibility
    shadow = next((k for k, name in enumerate(types) if name.lower() == "shadow"), -1)
    if shadow < 0:  # visibility is that of the radiance type, by its built-in any-hit programs
        deferred = np.zeros(len(types), bool)
    textures, texels = scene.texels.arrays()
    emitters, cdf, density = _emitters(geometry, materials)
    lights = np.zeros(len(scene.lights), t.LIGHT)
    for index, light in enumerate(scene.lights):
        lights[index] = _light(light, geometry.centre, simulated.penumbra)
    made = np.zeros(1, t.SCENE.dtype)
    made["standing"], made["moving"] = scene.accelerator.scene, scene.accelerator.moving
    made["first_moving"], made["material_count"] = geometry.first_moving, count
    made["asks_python"] = any((a == USER).any() for a in (closest, any_hit, miss))
    made["seed"] = scene.settings.seed & 0xFFFFFFFF
    made["max_depth"], made["shadow_type"] = scene.settings.max_depth, shadow
    made["light_samples"] = scene.settings.light_samples
    made["occlusion_distance"] = scene.settings.occlusion_distance
    made["skipped"], made["caustics"] = simulated.skipped_bits, simulated.caustics
    made["negligible"] = simulated.negligible
    made["background"] = scene.settings.clear_color
    return Tables(
        made,
        {
            "vertices": geometry.vertices,
            "triangles": geometry.triangles,
            "owner": geometry.material,
            "normals": _attribute(geometry.normal),
            "uvs": _attribute(geometry.uv),
            "smooth": geometry.smooth,
            "materials": materials,
            "textures": textures,
            "texels": texels,
            "lights": lights,
            "emitters": emitters,
            "emitter_cdf": cdf,
            "emitter_pdf": density,
            **_program_tables(codes),
            "closest": closest,
            "any_hit": any_hit,
            "miss": miss,
            "has_any_hit": has_any.astype(np.int8),
            "visibility": visibility.astype(np.int8),
            "deferred_shadows": deferred.astype(np.int8),
        },
    )
