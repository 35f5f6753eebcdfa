"""Classes ``optixPrime`` and ``embree``: trace a buffer of rays (docs/format.md, 7.3)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import NDArray

from nau_py.diagnostics.diagnostic import error
from nau_py.diagnostics.errors import NauError
from nau_py.graph.contract import Access
from nau_py.model.attribute import number
from nau_py.model.library import qualify_name
from nau_py.model.linked import Project
from nau_py.model.node import Attr, Child, Node
from nau_py.model.passes import Pass, SceneReference
from nau_py.model.values import DataType
from nau_py.passes.access import buffer
from nau_py.passes.frame import FrameContext, Session
from nau_py.passes.registry import PassClass, register_pass
from nau_py.passes.report import PassReport
from nau_py.passes.state import Stateless
from nau_py.raytrace.tracing.geometry import RayGeometry

if TYPE_CHECKING:
    from nau_py.raytrace.tracing.accelerator import Accelerator

RAY_BYTES, HIT_BYTES = 32, 16
"""Layout of a ray: origin, tmin, direction, tmax; of a hit: t, triangle (int32), u, v."""
MISS = -1.0
"""Distance and triangle of a ray without a hit."""


class RayBuffer(Node):
    """A buffer of rays or hits."""

    buffer: Annotated[
        str | None, Attr(doc="Buffer.", required=True, ref="buffer", library="fromLibrary")
    ] = None
    fromLibrary: Annotated[str | None, Attr(doc="Library.", ref="library")] = None
    queryType: Annotated[
        str | None, Attr(doc="Kind of query (rays only).", values=("ANY", "CLOSEST"))
    ] = None


class RayCount(Node):
    """Number of rays: a value, or a place in a buffer."""

    value: Annotated[int | str | None, Attr(DataType.INT, "Rays.", constant=True)] = None
    buffer: Annotated[str | None, Attr(doc="Buffer.", ref="buffer")] = None
    offset: Annotated[int | None, Attr(DataType.UINT, "Byte offset.")] = None


class RayQueryPass(Pass):
    """Traces a buffer of rays into a buffer of hits (classes optixPrime and embree)."""

    scene: Annotated[SceneReference | None, Child(SceneReference)] = None
    rays: Annotated[RayBuffer | None, Child(RayBuffer)] = None
    hits: Annotated[RayBuffer | None, Child(RayBuffer)] = None
    rayCount: Annotated[RayCount | None, Child(RayCount)] = None


@register_pass("optixPrime", "embree")
class RayQueryClass(PassClass):
    """Traces a buffer of rays that shaders have written into a buffer of hits."""

    model = RayQueryPass
    parameters = (number("RAY_COUNT", DataType.INT, -1, "Rays to trace.", unit="rays"),)

    def access(self, project: Project, pass_: Pass) -> Access:
        access = Access()
        if isinstance(pass_, RayQueryPass):
            if pass_.rays is not None:
                access.add_read(buffer(pass_.rays.buffer, pass_.rays.fromLibrary))
            if pass_.rayCount is not None and pass_.rayCount.buffer:
                access.add_read(buffer(pass_.rayCount.buffer, None))
            if pass_.hits is not None:
                access.add_write(buffer(pass_.hits.buffer, pass_.hits.fromLibrary))
        return access

    def prepare(self, pass_: Pass, session: Session) -> RayQueryState:
        assert isinstance(pass_, RayQueryPass)
        return RayQueryState(pass_, session)

    def execute(self, pass_: Pass, frame: FrameContext) -> PassReport:
        if not isinstance(pass_, RayQueryPass) or pass_.rays is None or pass_.hits is None:
            return PassReport()
        rays, hits = _storage(pass_, pass_.rays, frame), _storage(pass_, pass_.hits, frame)
        count = min(_count(pass_, frame, hits.size), rays.size // RAY_BYTES, hits.size // HIT_BYTES)
        if count <= 0:
            return PassReport()
        given = np.frombuffer(rays.read(count * RAY_BYTES), np.float32).reshape(-1, 8)
        accelerator = frame.session.state(pass_, self.prepare).accelerator()
        hits.write(_trace(accelerator, given).tobytes())
        frame.session.resources.barrier()
        return PassReport(rays={"query": count})


class RayQueryState(Stateless):
    """Acceleration structure of the first object of the scene, in object space as in Nau."""

    def __init__(self, pass_: RayQueryPass, session: Session) -> None:
        self._scene = pass_.scene.name or "" if pass_.scene else ""
        self._session = session
        self._version: tuple[int, int] | None = None
        self._accelerator: Accelerator | None = None

    def accelerator(self) -> Accelerator:
        """Return the structure; build it again where the mesh has changed since the last call."""
        from nau_py.raytrace.tracing.accelerator import Accelerator

        objects = self._session.world.objects([self._scene])
        mesh = objects[0].mesh if objects else None
        version = (id(mesh), mesh.version if mesh else 0)
        if self._accelerator is None or self._version != version:
            groups = [g.indices.astype(np.int32) for g in mesh.groups] if mesh else []
            triangles = np.concatenate(groups) if groups else np.zeros((0, 3), np.int32)
            points = mesh.positions[:, :3] if mesh else np.zeros((0, 3), np.float32)
            owner = np.zeros(len(triangles), np.int32)
            points = np.ascontiguousarray(points, np.float32)
            self._accelerator = Accelerator(RayGeometry(points, triangles, owner, [""]))
            self._version = version
        return self._accelerator

    def close(self) -> None:
        """Free the acceleration structure."""
        self._accelerator = None


def _storage(pass_: RayQueryPass, node: RayBuffer, frame: FrameContext) -> Any:
    name = qualify_name(node.buffer or "", node.fromLibrary or "")
    found = frame.session.resources.buffer(name)
    if found is None:
        message = f"pass '{pass_.name}': buffer '{name}' has no size"
        raise NauError(error("P011", node.where("buffer"), message))
    return found


def _count(pass_: RayQueryPass, frame: FrameContext, hit_bytes: int) -> int:
    """Return the number of rays: RAY_COUNT, else ``rayCount``, else the capacity of the hits."""
    if "RAY_COUNT" in pass_.settings:
        return int(frame.project.value(pass_, "PASS", "RAY_COUNT")[0])
    node = pass_.rayCount
    if node is not None and node.buffer:
        storage = frame.session.resources.buffer(node.buffer)
        if storage is not None:
            return int.from_bytes(storage.read(4, offset=node.offset or 0), "little")
    if node is not None and node.value is not None:
        return int(frame.project.number(node.value))
    return hit_bytes // HIT_BYTES


def _trace(accelerator: Accelerator, rays: NDArray[np.float32]) -> NDArray[np.void]:
    """Return the nearest hit of each ray, which is a valid one for ANY too; t < 0 for a miss."""
    origin, near, direction, far = rays[:, :3], rays[:, 3], rays[:, 4:7], rays[:, 7]
    start = origin + direction * np.maximum(near, 0)[:, None]
    found = accelerator.intersect(start, direction, np.maximum(far - near, 0))
    hit = (found.triangle >= 0) & (far >= near)
    result = np.zeros(len(rays), [("t", "<f4"), ("triangle", "<i4"), ("u", "<f4"), ("v", "<f4")])
    result["t"] = np.where(hit, found.t + np.maximum(near, 0), MISS)
    result["triangle"] = np.where(hit, found.triangle, -1)
    result["u"], result["v"] = np.where(hit, found.u, 0), np.where(hit, found.v, 0)
    return result
