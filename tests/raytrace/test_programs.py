"""Programs that fail, return the wrong thing, or must not be loaded."""

from __future__ import annotations

import numpy as np
import pytest

import nau_py
from nau_py.raytrace.programs.catalogue import BUILTIN_PROGRAMS, CODES, FUNCTIONS
from tests.conftest import Folder, RayProject

USER = """\
<rtDefaultMaterial><rayType name="Radiance">
<rtProgram type="CLOSEST_HIT" file="prog.py" proc="shade" />
{more}
</rayType></rtDefaultMaterial>
"""
ANY_HIT = '<rtProgram type="ANY_HIT" file="prog.py" proc="test" />'


@pytest.fixture
def wall(folder: Folder) -> Folder:
    """A quad that fills the view, material ``Wall``."""
    folder.mtl("scene", {"Wall": {"Kd": "1 0 0"}})
    folder.obj("scene", [("Wall", [(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)])])
    return folder


def fails(project: nau_py.Project, **options: object) -> nau_py.Diagnostic:
    with pytest.raises(nau_py.NauError) as caught:
        nau_py.Renderer(project, options=nau_py.RunOptions(**options)).render()  # type: ignore[arg-type]
    return caught.value.diagnostics[0]


def test_the_listed_builtins_are_the_engines() -> None:
    engine = {(n, k) for table in (CODES, FUNCTIONS) for k, names in table.items() for n in names}
    engine.add(("material", "CLOSEST_HIT"))  # made by the pass: it needs OpenGL
    assert engine == {(p.name, p.kind) for p in BUILTIN_PROGRAMS.values()}


@pytest.mark.parametrize(
    "body, words",
    [
        ("return np.ones((3, 7))", "returned an array of shape (3, 7); (3072, 3) or (3072, 4)"),
        ("return 'red'", "returned str; numbers of shape (3072, 3) are expected"),
        ("return None", "returned NoneType; numbers of shape (3072, 3) are expected"),
        ("return [[1, 2], [3]]", "returned list; numbers"),
    ],
)
def test_wrong_results_name_project_pass_material_and_proc(
    wall: Folder, ray_project: RayProject, body: str, words: str
) -> None:
    wall.write("prog.py", f"import numpy as np\n\n\ndef shade(hits):\n    {body}\n")
    found = fails(ray_project(USER.format(more="")))
    assert found.rule == "T011"
    label = (
        "project 'Rays', pass 'trace', material 'Wall', CLOSEST_HIT program 'shade' of ray "
        "type 'Radiance' "
    )
    assert found.message.startswith(label + words)
    assert (found.location.file, found.location.line) == (str(wall.path / "prog.py"), 4)


def test_an_exception_is_shown_at_its_own_line(wall: Folder, ray_project: RayProject) -> None:
    wall.write(
        "prog.py",
        "def helper(hits):\n    return hits.nothing\n\n\n"
        "def shade(hits):\n    return helper(hits)\n",
    )
    found = fails(ray_project(USER.format(more="")))
    assert found.rule == "T010"
    assert found.location.line == 2
    assert "material 'Wall'" in found.message
    assert "raised AttributeError: 'Hits' object has no attribute 'nothing'" in found.message


def test_any_hit_must_return_booleans(wall: Folder, ray_project: RayProject) -> None:
    wall.write(
        "prog.py",
        "def shade(hits):\n    return hits.color('DIFFUSE')\n\n\n"
        "def test(hits):\n    return hits.u\n",
    )
    found = fails(ray_project(USER.format(more=ANY_HIT)))
    assert found.rule == "T011"
    assert "bool of shape (3072,) is expected (True accepts the hit)" in found.message


def test_a_ray_type_that_does_not_exist(wall: Folder, ray_project: RayProject) -> None:
    wall.write("prog.py", "def shade(hits):\n    return hits.trace('Shadwo', hits.normal)\n")
    found = fails(ray_project(USER.format(more="")))
    assert "ray type 'Shadwo' is not one of the pass: Radiance" in found.message


@pytest.mark.parametrize(
    "text, words",
    [("def shade(hits:\n", "was never closed"), ("import nowhere_at_all\n", "nowhere_at_all")],
)
def test_a_file_that_does_not_load(
    wall: Folder, ray_project: RayProject, text: str, words: str
) -> None:
    wall.write("prog.py", text + "\n\ndef shade(hits): ...\n" if "import" in text else text)
    found = fails(ray_project(USER.format(more="")))
    assert found.rule == "T010"
    assert found.location.file == str(wall.path / "prog.py")
    assert words in found.message


def test_programs_load_only_from_trusted_folders(
    wall: Folder, ray_project: RayProject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    other = tmp_path_factory.mktemp("other")
    (other / "prog.py").write_text("def shade(hits):\n    return hits.color('DIFFUSE')\n")
    programs = USER.format(more="").replace("prog.py", str(other / "prog.py"))
    found = fails(ray_project(programs))
    assert found.rule == "T012"
    assert f"allow it with --allow-programs {other}" in found.message
    options = nau_py.RunOptions(allow_programs=(str(other),))
    frame = nau_py.Renderer(ray_project(programs), options=options).render()
    assert frame.targets["L::out"][20, 30].tolist() == [1, 0, 0, 1]


def test_no_programs_refuses_files_but_not_builtins(wall: Folder, ray_project: RayProject) -> None:
    wall.write("prog.py", "def shade(hits):\n    return 1\n")
    assert fails(ray_project(USER.format(more="")), no_programs=True).rule == "T012"
    nau_py.Renderer(ray_project(), options=nau_py.RunOptions(no_programs=True)).render()


def test_a_ptx_runs_through_the_python_file_beside_it(
    wall: Folder, ray_project: RayProject
) -> None:
    wall.write("prog.ptx", "// compiled elsewhere")
    wall.write("prog.py", "def shade(hits):\n    return hits.color('DIFFUSE') * 0.5\n")
    programs = (
        USER.format(more="")
        .replace("prog.py", "prog.ptx")
        .replace('proc="shade"', 'proc="__closesthit__shade"')
    )
    frame = nau_py.Renderer(ray_project(programs)).render()
    assert frame.targets["L::out"][20, 30].tolist() == [0.5, 0, 0, 1]


def test_samples_that_are_not_finite_are_counted_and_dropped(
    wall: Folder, ray_project: RayProject
) -> None:
    wall.write(
        "prog.py",
        "import numpy as np\n\n\ndef shade(hits):\n"
        "    out = np.ones((len(hits), 3))\n"
        "    out[hits.rays.sample == 1] = np.nan\n    return out\n",
    )
    frame = nau_py.Renderer(ray_project(USER.format(more=""), spp=4)).render()
    assert frame.report["nonfinite"] == 64 * 48
    assert any("T014" in w and "3072 samples" in w for w in frame.report["warnings"])
    np.testing.assert_array_equal(frame.targets["L::out"], 1)


def test_prefixes_and_exact_names_bind_programs(folder: Folder, ray_project: RayProject) -> None:
    """Exact entry, then the first prefix in byte order, then the default (docs/format.md, 7.1)."""
    names = ["GradeA", "GradeB", "Grade", "Other"]
    folder.mtl("scene", {n: {} for n in names})
    folder.obj(
        "scene",
        [
            (n, [(x, -1, 0), (x + 1, -1, 0), (x + 1, 1, 0), (x, 1, 0)])
            for n, x in zip(names, (-2, -1, 0, 1))
        ],
    )
    folder.write("prog.py", "".join(f"def p{k}(hits):\n    return [{k}, 0, 0]\n" for k in range(4)))

    def entry(tag: str, attributes: str, k: int) -> str:
        return (
            f'<{tag} {attributes}><rayType name="Radiance"><rtProgram type="CLOSEST_HIT" '
            f'file="prog.py" proc="p{k}"/></rayType></{tag}>'
        )

    programs = (
        entry("rtDefaultMaterial", "", 0)
        + "<rtMaterialMap>"
        + (
            entry("rtMap", 'to="Grade*"', 1)
            + entry("rtMap", 'to="GradeB"', 2)
            + entry("rtMap", 'to="GradeA*"', 3)
        )
        + "</rtMaterialMap>"
    )
    frame = nau_py.Renderer(ray_project(programs)).render()
    row = frame.targets["L::out"][24, :, 0]
    columns = [int(32 + (x + 0.5) * 24 / (3 * np.tan(np.radians(30)))) for x in (-2, -1, 0, 1)]
    assert [row[c] for c in columns] == [1, 2, 1, 0]


def test_numpy_warnings_of_programs_are_counted_not_printed(
    wall: Folder, ray_project: RayProject
) -> None:
    wall.write(
        "prog.py",
        "import numpy as np\n\n\ndef shade(hits):\n"
        "    return np.ones((len(hits), 3)) / (hits.rays.sample % 2)[:, None]\n",
    )
    frame = nau_py.Renderer(ray_project(USER.format(more=""), spp=4)).render()
    assert frame.report["nonfinite"] == 2 * 64 * 48
    np.testing.assert_array_equal(frame.targets["L::out"], 1)


def test_the_exception_program_paints_what_failed(wall: Folder, ray_project: RayProject) -> None:
    wall.write(
        "prog.py",
        "import numpy as np\n\n\ndef shade(hits):\n"
        "    return np.where(hits.position[:, :1] > 0, np.nan, 1.0) * np.ones(3)\n",
    )
    project = ray_project(USER.format(more=""))
    text = (wall.path / "project.xml").read_text()
    wall.write(
        "project.xml",
        text.replace(
            "</rtEntryPoint>", '<exception file="builtin" proc="magenta" /></rtEntryPoint>'
        ),
    )
    project = wall.load()
    out = nau_py.Renderer(project).render().targets["L::out"]
    assert out[20, 60].tolist() == [1, 0, 1, 1]
    assert out[20, 3].tolist() == [1, 1, 1, 1]


def test_inputs_are_read_by_pixel(wall: Folder, ray_project: RayProject) -> None:
    """A texture input, (n, channels) at the pixels of the batch."""
    wall.write("prog.py", "def camera(launch):\n    return launch.input('ramp')[:, :3] * 2\n")
    wall.write(
        "v.vert",
        "#version 330\nin vec4 position;\nvoid main() { gl_Position = position; }\n",
    )
    wall.write(
        "f.frag",
        "#version 330\nout vec4 c;\nvoid main() { c = vec4(gl_FragCoord.xy, 0.5, 1.0); }\n",
    )
    wall.write(
        "m.mlib",
        '<materialLib name="M"><renderTargets><renderTarget name="r"><SIZE width="64" height="48"/>'
        '<colors><color name="ramp" internalFormat="RGBA32F"/></colors></renderTarget>'
        '</renderTargets><shaders><shader name="s" vs="v.vert" ps="f.frag"/></shaders><materials>'
        '<material name="m"><shader name="s"/></material></materials></materialLib>',
    )
    ray_project()
    text = (wall.path / "project.xml").read_text()
    text = text.replace("</materialLibs>", '<materialLib filename="m.mlib"/></materialLibs>')
    text = text.replace(
        '<pass name="trace"',
        '<pass name="draw" class="quad"><renderTarget name="r" fromLibrary="M"/>'
        '<material name="m" fromLibrary="M"/></pass><pass name="trace"',
    )
    text = text.replace(
        '<rtEntryPoint><rayGen file="builtin" proc="pinhole" />',
        '<rtInput><buffer var="ramp" texture="M::ramp"/></rtInput>'
        '<rtEntryPoint><rayGen file="prog.py" proc="camera" />',
    )
    wall.write("project.xml", text)
    out = nau_py.Renderer(wall.load()).render().targets["L::out"]
    assert out[47, 0].tolist() == [1, 1, 1, 1]  # lower left
    assert out[0, 63].tolist() == [127, 95, 1, 1]  # upper right


def test_any_hit_of_the_project_is_the_built_in_one(wall: Folder, ray_project: RayProject) -> None:
    """The same test written in Python: the same bits, for eye and shadow rays."""
    texels = np.zeros((8, 8, 4), np.uint8)
    texels[::2, :, 3] = 255
    wall.image("card.png", texels)
    wall.mtl("scene", {"Card": {"Kd": "1 0 0", "map_Kd": "card.png"}, "Wall": {"Kd": "0 1 0"}})
    wall.obj(
        "scene",
        [
            ("Card", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]),
            ("Wall", [(-3, -3, -1), (3, -3, -1), (3, 3, -1), (-3, 3, -1)]),
        ],
    )
    wall.write("prog.py", "def alpha_test(hits):\n    return hits.texture(0)[:, 3] > 0.25\n")
    found = []
    for file in ("builtin", "prog.py"):
        any_hit = f'<rtProgram type="ANY_HIT" file="{file}" proc="alpha_test" />'
        programs = (
            '<rtDefaultMaterial><rayType name="Radiance"><rtProgram type="CLOSEST_HIT" '
            f'file="builtin" proc="lambert" />{any_hit}</rayType><rayType name="Shadow">'
            '<rtProgram type="MISS" file="builtin" proc="unoccluded" />'
            f"{any_hit}</rayType></rtDefaultMaterial>"
        )
        frame = nau_py.Renderer(ray_project(programs, light=(0.2, -0.3, -1), spp=4)).render()
        found.append((frame.targets["L::out"], frame.report["totals"]["rays"]))
    np.testing.assert_array_equal(found[0][0], found[1][0])
    assert found[0][1] == found[1][1]
