"""Wavefront OBJ and MTL by Nau's rules (nau-format.md, 10.2)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from nau_py.paths import resolve
from nau_py.scene.mesh import F32, U32, Group, Mesh, pad4, triangle_tangents
from nau_py.scene.model_material import ModelMaterial
from nau_py.scene.smooth import smooth_normals

DEFAULT_MATERIAL = "DefaultOBJMaterial"
I64 = NDArray[np.int64]


class ModelError(Exception):
    """A model file cannot be read; ``line`` is 0 where no line is to blame."""

    def __init__(self, message: str, line: int = 0) -> None:
        super().__init__(message)
        self.line = line


@dataclass(slots=True)
class _Faces:
    """Corners (v, vt, vn; -1: absent) of all triangles, (m, 3, 3), and the key of each."""

    corners: I64
    keys: list[str]
    key_of: I64


def _numbers(rows: list[bytes], width: int, what: str) -> NDArray[np.float64]:
    """The first ``width`` numbers after the keyword of each row, (n, width); short rows get 0."""
    if not rows:
        return np.zeros((0, width))
    split = [row.split()[1:] for row in rows]
    if any(len(s) < width for s in split):
        split = [s + [b"0"] * (width - len(s)) for s in split]
    try:
        return np.array([s[:width] for s in split], dtype="S32").astype(np.float64)
    except ValueError as error:
        raise ModelError(f"a '{what}' line holds something that is not a number: {error}") from None


def _corner(token: bytes, counts: tuple[int, int, int], line: int) -> tuple[int, int, int]:
    parts = token.split(b"/")
    found = [-1, -1, -1]
    for slot, part in enumerate(parts[:3]):
        if not part:
            continue
        try:
            index = int(part)
        except ValueError:
            raise ModelError(f"face corner '{token.decode('latin-1')}' is no index", line) from None
        index = index - 1 if index > 0 else counts[slot] + index
        if not 0 <= index < counts[slot]:
            raise ModelError(
                f"face corner '{token.decode('latin-1')}' names vertex {part.decode()} of "
                f"{counts[slot]}",
                line,
            )
        found[slot] = index
    return found[0], found[1], found[2]


def _read_lines(path: Path) -> list[bytes]:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ModelError(f"cannot be read: {error.strerror}") from None
    return data.replace(b"\\\n", b" ").splitlines()


def _faces(
    lines: list[bytes],
    faces_at: list[int],
    states: list[tuple[int, str]],
    counts_at: list[tuple[int, int, int]],
) -> _Faces:
    """Fan-triangulated faces. ``states`` holds (first face, key) changes in file order."""
    corners: list[tuple[int, int, int]] = []
    owner: list[int] = []
    cache: dict[bytes, tuple[int, int, int]] = {}
    for index, line in enumerate(faces_at):
        tokens = lines[line].split()[1:]
        counts = counts_at[index]
        if len(tokens) < 3:
            continue
        listed = []
        for token in tokens:
            corner = cache.get(token)
            if corner is None or b"-" in token:
                corner = _corner(token, counts, line + 1)
                cache[token] = corner
            listed.append(corner)
        for k in range(1, len(listed) - 1):
            corners += (listed[0], listed[k], listed[k + 1])
            owner.append(index)
    starts = np.array([first for first, _ in states])
    keys = [key for _, key in states]
    which = np.searchsorted(starts, np.array(owner, np.int64), side="right") - 1
    return _Faces(np.array(corners, np.int64).reshape(-1, 3, 3), keys, which)


def load_obj(path: Path) -> tuple[Mesh, list[ModelMaterial]]:
    """The mesh of an OBJ file and the materials of its MTL files.

    Groups are ordered by Nau's ``<group>-<material>`` keys in byte order and joined by material.
    Raises :class:`ModelError`.
    """
    lines = _read_lines(path)
    rows: dict[bytes, list[bytes]] = {b"v": [], b"vn": [], b"vt": []}
    materials: list[ModelMaterial] = []
    states: list[tuple[int, str]] = [(0, "default\x00" + DEFAULT_MATERIAL)]
    group, material, has_library = "default", DEFAULT_MATERIAL, False
    faces_at: list[int] = []
    counts_at: list[tuple[int, int, int]] = []
    for number, line in enumerate(lines):
        stripped = line.lstrip()
        first = stripped[:1]
        if first == b"v":
            keyword = stripped.split(None, 1)[0]
            if keyword in rows:
                rows[keyword].append(stripped)
        elif first == b"f":
            faces_at.append(number)
            counts_at.append((len(rows[b"v"]), len(rows[b"vt"]), len(rows[b"vn"])))
        elif first in (b"g", b"u", b"m"):
            words = stripped.decode("utf-8", "replace").split(None, 1)
            value = words[1].strip() if len(words) > 1 else ""
            if first == b"m":
                has_library = True
                materials += load_mtl(path, value)
                continue
            if first == b"g":
                group = value
            else:
                material = value
            states.append((len(faces_at), f"{group}\x00{material}"))
    faces = _faces(lines, faces_at, states, counts_at)
    if not has_library:
        faces.keys = [key.split("\x00")[0] + "\x00" + DEFAULT_MATERIAL for key in faces.keys]
    if not len(faces.corners):
        raise ModelError("holds no face")
    return _build(rows, faces), materials


def _build(rows: dict[bytes, list[bytes]], faces: _Faces) -> Mesh:
    v = _numbers(rows[b"v"], 3, "v")
    vt = _numbers(rows[b"vt"], 2, "vt")
    vn = _numbers(rows[b"vn"], 3, "vn")
    flat = faces.corners.reshape(-1, 3)
    unique, inverse = _unique_corners(flat, (len(v), len(vt), len(vn)))
    triangles: U32 = inverse.reshape(-1, 3).astype(np.uint32)
    attributes: dict[str, F32] = {"position": pad4(v[unique[:, 0]], 1.0)}
    if len(vn):
        normals = np.vstack([vn, np.zeros((1, 3))])[unique[:, 2]]
        attributes["normal"] = pad4(normals, 0.0)
    else:
        corner_normals = smooth_normals(v, faces.corners[:, :, 0])
        keyed = np.column_stack([unique[inverse], np.round(corner_normals, 5).view(np.int64)])
        _, first, again = np.unique(keyed, axis=0, return_index=True, return_inverse=True)
        unique = unique[inverse][first]
        triangles = again.reshape(-1, 3).astype(np.uint32)
        attributes = {
            "position": pad4(v[unique[:, 0]], 1.0),
            "normal": pad4(corner_normals[first], 0.0),
        }
    if len(vt):
        uv = np.vstack([vt, np.zeros((1, 2))])[unique[:, 1]]
        attributes["texCoord0"] = pad4(uv, 0.0)
        attributes["tangent"] = triangle_tangents(
            attributes["position"], attributes["texCoord0"], triangles
        )
    return Mesh(attributes, _groups(faces, triangles))


def _unique_corners(flat: I64, counts: tuple[int, int, int]) -> tuple[I64, I64]:
    """Distinct (v, vt, vn) triples in order of first use, and the triple of each corner."""
    key = (flat[:, 0] * (counts[1] + 1) + flat[:, 1] + 1) * (counts[2] + 1) + flat[:, 2] + 1
    _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    order = np.argsort(first, kind="stable")
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return flat[first[order]], rank[inverse]


def _groups(faces: _Faces, triangles: U32) -> list[Group]:
    """Triangles by material: keys in byte order, groups of one material joined."""
    parts: dict[str, list[U32]] = {}
    used = np.unique(faces.key_of)
    by_key: dict[str, list[int]] = {}
    for index in used:
        by_key.setdefault(faces.keys[index], []).append(int(index))
    for key in sorted(by_key, key=lambda k: k.replace("\x00", "-").encode()):
        chosen = np.isin(faces.key_of, by_key[key])
        parts.setdefault(key.split("\x00")[1], []).append(triangles[chosen])
    return [Group(name, np.concatenate(listed)) for name, listed in parts.items()]


_COLOURS = {"Kd": "DIFFUSE", "Ks": "SPECULAR", "Ka": "AMBIENT", "Ke": "EMISSION"}
_MAPS = {"map_Kd": 0, "map_Ka": 3, "map_Ks": 4}
_OTHER_MAP, _BUMP = 5, 1


def load_mtl(obj: Path, name: str) -> list[ModelMaterial]:
    """The materials of the library ``name`` that ``obj`` names. Raises :class:`ModelError`."""
    found = resolve(obj.parent, name)
    if not found.exists:
        raise ModelError(f"names the material library '{name}', which does not exist")
    materials: list[ModelMaterial] = []
    for number, line in enumerate(_read_lines(found.best), 1):
        words = line.decode("utf-8", "replace").split()
        if not words or words[0].startswith("#"):
            continue
        if words[0].startswith("n"):
            materials.append(ModelMaterial(words[1] if len(words) > 1 else "", {"SHININESS": (0,)}))
        elif materials:
            try:
                _mtl_line(materials[-1], words, found.best.parent)
            except (ValueError, IndexError):
                text = " ".join(words)
                raise ModelError(f"{found.best.name}:{number}: '{text}' holds no number") from None
    return materials


def _mtl_line(material: ModelMaterial, words: list[str], folder: Path) -> None:
    keyword = words[0]
    if keyword in _COLOURS:
        r, g, b = (float(w) for w in (words[1:4] if len(words) > 3 else [words[1]] * 3))
        material.colours[_COLOURS[keyword]] = (r, g, b, 1.0)
    elif keyword == "Ns":
        material.colours["SHININESS"] = (float(words[1]) * 128.0 / 1000.0,)
    elif keyword == "Pr":
        roughness = max(float(words[1]), 1e-4)
        material.colours["SHININESS"] = (2.0 / roughness**2 - 2.0,)
    elif (keyword.startswith(("map_", "b"))) and len(words) > 1:
        unit = _BUMP if keyword.startswith("b") else _MAPS.get(keyword, _OTHER_MAP)
        material.textures[unit] = resolve(folder, words[1]).best
