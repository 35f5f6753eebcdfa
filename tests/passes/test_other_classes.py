"""Pass classes of single projects: ray queries, the profiler's overlay, the plug-in's plane."""

from __future__ import annotations

import numpy as np
import pytest

import nau_py
from tests.conftest import Folder

QUERY = """\
<project name="P" width="8" height="8"><assets>
 <scenes><scene name="Wall"><geometry name="w" type="SQUARE"/></scene></scenes>
 <materialLibs><materialLib filename="lib.mlib"/></materialLibs></assets>
<pipelines><pipeline name="Q"><pass name="ask" class="{kind}">
 <scene name="Wall"/><rays buffer="L::rays" queryType="{query}"/><hits buffer="L::hits"/>{count}
</pass></pipeline></pipelines></project>
"""
LIBRARY = """\
<materialLib name="L"><buffers>
 <buffer name="rays"><SIZE value="{size}"/><file name="rays.txt"/><structure>
  <field value="FLOAT"/></structure></buffer>
 <buffer name="hits"><SIZE value="{hits}"/></buffer>
</buffers></materialLib>
"""
RAYS = [  # origin, tmin, direction, tmax; the square lies in y = 0, -1..1
    (0.5, 2, 0.25, 0, 0, -1, 0, 10),
    (0.5, 2, 0.25, 0, 0, -2, 0, 10),
    (3, 2, 0, 0, 0, -1, 0, 10),
    (0, 2, 0, 0, 0, -1, 0, 1.5),
    (0, 2, 0, 3, 0, -1, 0, 10),
    (0, 2, 0, 0.5, 0, -1, 0, 10),
    (0, 2, 0, 0, 0, -1, 0, -1),
]
DISTANCES = [2, 1, -1, -1, -1, 2, -1]


@pytest.mark.parametrize("kind", ["embree", "optixPrime"])
@pytest.mark.parametrize("query", ["ANY", "CLOSEST"])
def test_ray_queries(folder: Folder, kind: str, query: str) -> None:
    """t in lengths of the direction between tmin and tmax; t < 0 for a miss."""
    folder.write("rays.txt", " ".join(str(float(v)) for ray in RAYS for v in ray))
    folder.write("lib.mlib", LIBRARY.format(size=32 * len(RAYS), hits=16 * len(RAYS)))
    folder.write("project.xml", QUERY.format(kind=kind, query=query, count=""))
    renderer = nau_py.Renderer(folder.load(), keep_targets=True)
    frame = renderer.render()
    raw = renderer.session.resources.buffer("L::hits").read()
    hits = np.frombuffer(raw, [("t", "f4"), ("id", "i4"), ("u", "f4"), ("v", "f4")])
    np.testing.assert_allclose(hits["t"], DISTANCES)
    assert frame.report["totals"]["rays"] == {"query": len(RAYS)}
    world = renderer.session.world.objects(["Wall"])[0].mesh
    corners = world.positions[world.groups[0].indices[hits["id"][0]], :3]
    u, v = hits["u"][0], hits["v"][0]
    point = (1 - u - v) * corners[0] + u * corners[1] + v * corners[2]
    np.testing.assert_allclose(point, [0.5, 0, 0.25], atol=1e-6)


def test_fewer_rays_than_there_is_room_for(folder: Folder) -> None:
    folder.write("rays.txt", " ".join(str(float(v)) for ray in RAYS for v in ray))
    folder.write("lib.mlib", LIBRARY.format(size=32 * len(RAYS), hits=16 * len(RAYS)))
    count = '<rayCount value="2"/>'
    folder.write("project.xml", QUERY.format(kind="embree", query="ANY", count=count))
    frame = nau_py.Renderer(folder.load(), keep_targets=True).render()
    assert frame.report["totals"]["rays"] == {"query": 2}


def test_a_query_without_a_buffer_is_named(folder: Folder) -> None:
    folder.write("lib.mlib", LIBRARY.format(size=0, hits=64))
    folder.write("rays.txt", "")
    folder.write("project.xml", QUERY.format(kind="embree", query="ANY", count=""))
    with pytest.raises(nau_py.NauError, match=r"P011.*pass 'ask': buffer 'L::rays' has no size"):
        nau_py.Renderer(folder.load(), keep_targets=True).render()


OVERLAY = """\
<project name="P" width="256" height="64"><assets>
 <scenes><scene name="S"><geometry name="b" type="BOX"/></scene></scenes>
 <viewports><viewport name="V"><CLEAR_COLOR r="0" g="0" b="0.5"/></viewport></viewports>
 <cameras><camera name="C"><viewport name="V"/><POSITION x="0" y="0" z="50"/></camera></cameras>
</assets><pipelines><pipeline name="Q">
 <pass name="draw" class="default"><scenes><scene name="S"/></scenes><camera name="C"/></pass>
 <pass name="times" class="profiler"/></pipeline></pipelines></project>
"""


def test_the_profiler_writes_over_the_picture(folder: Folder) -> None:
    """White text in the upper left, two lines of it; elsewhere the picture is as it was."""
    folder.write("project.xml", OVERLAY)
    frame = nau_py.Renderer(folder.load()).render()
    white = (frame.image[..., :3] == 255).all(axis=-1)
    rows = np.flatnonzero(white.any(axis=1))
    assert 100 < white.sum() < 1500
    assert rows.min() >= 8
    assert rows.max() < 40
    assert (np.diff(rows) > 1).any()  # a gap between the lines
    folder.write("project.xml", OVERLAY.replace('<pass name="times" class="profiler"/>', ""))
    plain = nau_py.Renderer(folder.load()).render()
    np.testing.assert_array_equal(frame.image[~white], plain.image[~white])


def test_the_plug_in_brings_a_plane(folder: Folder) -> None:
    """A square of side 2 seen from 4 above, 90 degrees: half the picture's width, centred."""
    text = OVERLAY.replace('class="default"', 'class="geometryPI"')
    text = text.replace('<pass name="times" class="profiler"/>', "").replace("256", "64")
    text = text.replace('<scenes><scene name="S"/></scenes>', "")
    text = text.replace(
        '<POSITION x="0" y="0" z="50"/>',
        '<projection TYPE="PERSPECTIVE" FOV="90" NEAR="1" FAR="10"/><POSITION x="0" y="2" z="0"/>'
        '<VIEW x="0" y="-1" z="0"/><UP x="0" y="0" z="-1"/>',
    )
    folder.write("project.xml", text)
    frame = nau_py.Renderer(folder.load()).render()
    drawn = frame.image[..., :3].max(axis=-1) > 0
    expected = np.zeros((64, 64), bool)
    expected[16:48, 16:48] = True
    np.testing.assert_array_equal(drawn, expected)


def test_a_mesh_pass_names_the_extension(folder: Folder) -> None:
    folder.write("project.xml", OVERLAY.replace('class="profiler"', 'class="mesh"'))
    with pytest.raises(nau_py.ProjectError, match="GL_NV_mesh_shader"):
        nau_py.Renderer(folder.load())
