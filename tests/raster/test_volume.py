"""VTK volumes as 3D textures, read by a shader texel by texel."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import nau_py
from nau_py.scene.images import ImageError
from nau_py.scene.volume import load_volume
from tests.conftest import Folder

HEAD = (
    "# vtk DataFile Version 3.0\nsome volume\n{mode}\nDATASET {kind}\nDIMENSIONS 2 3 4\n"
    "ORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA 24\nSCALARS density {type}\nLOOKUP_TABLE default\n"
)
PROJECT = """\
<project name="P" width="2" height="12"><assets><materialLibs><materialLib filename="l.mlib"/>
</materialLibs></assets><pipelines><pipeline name="Q"><pass name="q" class="quad">
<material name="m" fromLibrary="L"/><renderTarget name="rt" fromLibrary="L"/></pass></pipeline>
</pipelines></project>
"""
LIB = """\
<materialLib name="L"><textures><texture name="t" filename="a.vtk"/></textures>
<renderTargets><renderTarget name="rt"><SIZE width="2" height="12"/><colors>
<color name="c" internalFormat="R32F"/></colors></renderTarget></renderTargets>
<shaders><shader name="s" vs="a.vert" ps="a.frag"/></shaders>
<materials><material name="m"><textures><texture name="t" UNIT="0"/></textures><shader name="s"><values>
<valueof uniform="volume" type="TEXTURE_BINDING" context="CURRENT" component="UNIT" id="0"/></values>
</shader></material></materials></materialLib>
"""
FRAG = """\
#version 330
uniform sampler3D volume;
out float c;
void main() {
    ivec2 p = ivec2(gl_FragCoord.xy);
    c = texelFetch(volume, ivec3(p.x, p.y % 3, p.y / 3), 0).r;
}
"""


@pytest.mark.parametrize(
    "mode, type_, values, scale",
    [
        ("BINARY", "unsigned_char", np.arange(24, dtype="u1") * 10, 255),
        ("BINARY", "unsigned_short 1", np.arange(24, dtype="u2") * 1000, 65535),
        ("BINARY", "float", np.arange(24, dtype="f4") / 7 - 1, 1),
        ("ASCII", "float", np.arange(24, dtype="f4") / 8, 1),
    ],
)
def test_shaders_see_a_volume(
    folder: Folder, mode: str, type_: str, values: np.ndarray, scale: float
) -> None:
    """x runs fastest, then y, then z; the file's numbers are big-endian."""
    text = " ".join(map(str, values.tolist())).encode()
    data = values.astype(values.dtype.newbyteorder(">")).tobytes() if mode == "BINARY" else text
    head = HEAD.format(mode=mode, kind="STRUCTURED_POINTS", type=type_)
    (folder.path / "a.vtk").write_bytes(head.encode() + data)
    folder.write(
        "a.vert", "#version 330\nin vec4 position;\nvoid main() { gl_Position = position; }\n"
    )
    folder.write("a.frag", FRAG)
    folder.write("l.mlib", LIB)
    folder.write("project.xml", PROJECT)
    seen = nau_py.Renderer(folder.load(), keep_targets=True).render().targets["L::c"]
    expected = values.astype(float).reshape(12, 2) / scale
    np.testing.assert_allclose(seen[::-1, :, 0], expected, rtol=1e-6)


@pytest.mark.parametrize(
    "old, new, message",
    [
        (b"# vtk", b"# VTX", "does not begin as a VTK file does"),
        (b"STRUCTURED_POINTS", b"POLYDATA", "its data set is 'POLYDATA'"),
        (b"unsigned_char", b"double", "its SCALARS are 'density double'; one of unsigned_char"),
        (b"2 3 4", b"2 3 5", "it holds 24 of 2 x 3 x 5 points"),
        (b"2 3 4", b"2 x 4", "it cannot be decoded"),
    ],
)
def test_faulty_volumes(tmp_path: Path, old: bytes, new: bytes, message: str) -> None:
    head = HEAD.format(mode="BINARY", kind="STRUCTURED_POINTS", type="unsigned_char")
    file = tmp_path / "a.vtk"
    file.write_bytes((head.encode() + bytes(24)).replace(old, new))
    with pytest.raises(ImageError, match=message):
        load_volume(file)
