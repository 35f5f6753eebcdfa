"""Ogre mesh XML (docs/format.md, 10.5): submeshes, shared geometry, poses and their animation.

Skeletons are ignored: Nau keeps them, but moves nothing by them.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from lxml import etree

from nau_py.scene.mesh import F32, U32, Group, Mesh, SceneObject
from nau_py.scene.poses import PoseTrack
from nau_py.scene.readers.model_error import ModelError
from nau_py.scene.readers.registry import Model

OGRE_MATERIAL = "Default Ogre Material"
_ATTRIBUTES = {
    "positions": ("position", "xyz"),
    "normals": ("normal", "xyz"),
    "tangents": ("tangent", "xyz"),
    "bitangents": ("bitangent", "xyz"),
}


def load_ogre(path: Path) -> Model:
    """Load the objects of a mesh file: one for each submesh with its own geometry.

    The meshes carry their pose animation. Every attribute has w = 1, as Nau reads it. Raises
    :class:`~nau_py.scene.readers.model_error.ModelError`.
    """
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False)
    try:
        root = etree.parse(str(path), parser).getroot()
    except (OSError, etree.XMLSyntaxError) as problem:
        line = problem.lineno or 0 if isinstance(problem, etree.XMLSyntaxError) else 0
        raise ModelError(str(problem), line) from None
    name = etree.QName(root).localname
    if name != "mesh":
        raise ModelError(f"its root element is <{name}>, not an Ogre <mesh>", _source_line(root))
    shared = root.find("sharedgeometry")
    objects: list[SceneObject] = []
    common: Mesh | None = None
    if shared is not None:
        common = Mesh(_read_vertices(shared), [])
        objects.append(SceneObject("Unnamed_shared", common))
    for index, submesh in enumerate(root.iterfind("submeshes/submesh")):
        group = Group(submesh.get("material") or OGRE_MATERIAL, _read_faces(submesh))
        if submesh.get("usesharedvertices", "true") == "true":
            if common is None:
                raise ModelError(
                    "a submesh uses shared geometry, of which there is none", _source_line(submesh)
                )
            common.groups.append(group)
        else:
            geometry = submesh.find("geometry")
            if geometry is None:
                raise ModelError("a submesh has no <geometry>", _source_line(submesh))
            objects.append(SceneObject(f"Unnamed_{index}", Mesh(_read_vertices(geometry), [group])))
    for item in objects:
        for group in item.mesh.groups:
            if group.indices.size and int(group.indices.max()) >= item.mesh.vertex_count:
                raise ModelError(
                    f"a face has vertex {int(group.indices.max())} of {item.mesh.vertex_count}"
                )
    _add_poses(root, objects)
    return objects, []


def _source_line(node: Any) -> int:
    return int(node.sourceline or 0)


def _parse_number(node: Any, name: str, default: str | None = None) -> float:
    text = node.get(name, default)
    try:
        return float(text)
    except (TypeError, ValueError):
        raise ModelError(
            f"<{node.tag}> has {name}='{text}', which is no number", _source_line(node)
        ) from None


def _read_vertices(geometry: Any) -> dict[str, F32]:
    found: dict[str, F32] = {}
    for buffer in geometry.iterfind("vertexbuffer"):
        vertices = buffer.findall("vertex")
        for flag, (name, axes) in _ATTRIBUTES.items():
            if buffer.get(flag) == "true":
                nodes = (v.find(name) for v in vertices)
                found[name] = _read_rows(nodes, axes, len(vertices))
        for k in range(int(_parse_number(buffer, "texture_coords", "0"))):
            nodes = (next(iter(v.findall("texcoord")[k:]), None) for v in vertices)
            found[f"texCoord{k}"] = _read_rows(nodes, "uvw", len(vertices))
    if "position" not in found:
        raise ModelError("a geometry has no positions", _source_line(geometry))
    return found


def _read_rows(nodes: Iterator[Any], axes: str, count: int) -> F32:
    values = np.zeros((count, 4), np.float32)
    values[:, 3] = 1
    for row, node in enumerate(nodes):
        if node is not None:
            values[row, :3] = [_parse_number(node, a, "0" if a == "w" else None) for a in axes]
    return values


def _read_faces(submesh: Any) -> U32:
    kind = submesh.get("operationtype", "triangle_list")
    faces = submesh.findall("faces/face")
    first = [_parse_number(f, "v1") for f in faces]
    if kind not in ("triangle_strip", "triangle_fan"):
        rows = [(a, _parse_number(f, "v2"), _parse_number(f, "v3")) for a, f in zip(first, faces)]
        return np.array(rows, np.uint32).reshape(-1, 3)
    # the first face of a strip or fan may give all three corners, the others one each
    if faces and faces[0].get("v2") is not None:
        first[1:1] = [_parse_number(faces[0], "v2"), _parse_number(faces[0], "v3")]
    v = np.array(first, np.uint32)
    k = np.arange(max(len(v) - 2, 0))
    if kind == "triangle_fan":
        return np.stack([np.zeros_like(v[k]) + v[:1], v[k + 1], v[k + 2]], axis=1)
    odd = k % 2
    return np.stack([v[k], v[k + 1 + odd], v[k + 2 - odd]], axis=1)


def _add_poses(root: Any, objects: list[SceneObject]) -> None:
    """Give the meshes their tracks of the first animation, which Nau makes the active one.

    Pose numbers count within a submesh.
    """
    offsets: list[list[F32]] = [[] for _ in objects]
    for pose in root.iterfind("poses/pose"):
        target = int(_parse_number(pose, "index")) if pose.get("target") == "submesh" else 0
        if not 0 <= target < len(objects):
            raise ModelError(f"a pose names submesh {target} of {len(objects)}", _source_line(pose))
        moved = np.zeros((objects[target].mesh.vertex_count, 3), np.float32)
        for offset in pose.iterfind("poseoffset"):
            vertex = int(_parse_number(offset, "index"))
            if 0 <= vertex < len(moved):
                moved[vertex] = [_parse_number(offset, a) for a in "xyz"]
        offsets[target].append(moved)
    animation = root.find("animations/animation")
    if animation is None or not any(offsets):
        return
    length = _parse_number(animation, "length")
    for track in animation.iterfind("tracks/track"):
        target = int(_parse_number(track, "index"))
        if not 0 <= target < len(objects) or not offsets[target]:
            continue
        frames = sorted(
            track.iterfind("keyframes/keyframe"), key=lambda f: _parse_number(f, "time")
        )
        influences = np.zeros((len(frames), len(offsets[target])))
        for row, frame in enumerate(frames):
            for ref in frame.iterfind("poseref"):
                pose = int(_parse_number(ref, "poseindex"))
                if 0 <= pose < influences.shape[1]:
                    influences[row, pose] = _parse_number(ref, "influence")
        times = np.array([_parse_number(f, "time") for f in frames])
        poses = PoseTrack(np.stack(offsets[target]), times, influences, length)
        objects[target].mesh.poses = poses
