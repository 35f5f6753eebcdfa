"""Rules of findings that only a run reports: drivers, shaders, models, scripts, ray programs.

The rooms that run a project emit these findings. Reports and the reference page need the texts
without importing those rooms, so the rules are registered here.
"""

from __future__ import annotations

from nau_py.diagnostics.catalogue import ERROR, WARNING, rule

D101 = rule(
    "D101",
    ERROR,
    "No OpenGL driver",
    "Running needs OpenGL 4.5; Mesa's software driver is enough.",
    "a machine without libegl1",
    "apt-get install libegl1 libgl1 libgl1-mesa-dri",
)
D102 = rule(
    "D102",
    ERROR,
    "No such instruction set",
    "The environment variable NAU_EMBREE_ISA holds Embree to one instruction set. It must be one "
    "of Embree's names, and the processor must have it.",
    "NAU_EMBREE_ISA=sse2",
    "NAU_EMBREE_ISA=avx2",
)
E001 = rule(
    "E001",
    ERROR,
    "Pass failed",
    "A pass failed for a reason that no other rule covers.",
    "a plug-in pass that raises",
    "a plug-in pass that raises NauError with a diagnostic",
)
E002 = rule(
    "E002",
    ERROR,
    "Output cannot be written",
    "The file could not be written, or its ending is unknown.",
    "nau-run p.xml -o picture.gif",
    "nau-run p.xml -o picture.png",
)
E003 = rule(
    "E003",
    WARNING,
    "No picture",
    "No pass of the pipeline draws into the window or a two-dimensional texture.",
    "<pipeline name='P'></pipeline>",
    "<pipeline name='P'><pass name='draw'/></pipeline>",
)
E005 = rule(
    "E005",
    ERROR,
    "Plug-in cannot be loaded",
    "A package that adds a pass class, rules, a reader or ray programs does not import.",
    "a plug-in of another version of nau_py",
    "pip install --upgrade, or pip uninstall, that package",
)
E004 = rule(
    "E004",
    ERROR,
    "No mask to show",
    "`--show-mask` tints the pixels that a raytrace pass selects; the pipeline has none with a "
    "mask.",
    "nau-run project.xml --show-mask",
    "--pipeline with a masked raytrace pass",
)
B001 = rule(
    "B001",
    ERROR,
    "Buffer file unreadable",
    "The initial content of a buffer could not be read.",
    "<file name='data.txt'/> holding words",
    "<file name='data.txt'/> holding numbers",
)
B002 = rule(
    "B002",
    ERROR,
    "Draw command too short",
    "Drawing indices takes five numbers of 4 bytes: count, instances, first index, base "
    "vertex, base instance; without indices four: count, instances, first, base instance.",
    "<scenes drawIndirectBuffer='L::b'> with <SIZE value='4'/>",
    "<SIZE value='20'/>",
)
G001 = rule(
    "G001",
    ERROR,
    "GLSL error",
    "The driver rejects a shader; the place is in the shader file.",
    "outColor = colour; // undeclared",
    "uniform vec4 colour; … outColor = colour;",
)
G002 = rule(
    "G002",
    ERROR,
    "Shader file unreadable",
    "A shader file could not be read.",
    "ps='shaders' (a folder)",
    "ps='shaders/lit.frag'",
)
G003 = rule(
    "G003",
    ERROR,
    "Shader does not link",
    "The stages of a program do not fit together.",
    "out vec4 v; (vertex) and in vec3 v; (fragment)",
    "out vec3 v; and in vec3 v;",
)
G005 = rule(
    "G005",
    WARNING,
    "GLSL accepted with changes",
    "Some drivers reject this source. nau_py rewrites it and reports each change.",
    "in vec4 eye; (fragment) where the vertex stage has out vec3 eye;",
    "in vec3 eye;",
)
G004 = rule(
    "G004",
    ERROR,
    "OpenGL extension missing",
    "A shader needs an extension that this driver does not have, or mesh stages, for which "
    "nau_py does not use GL_NV_mesh_shader.",
    "<shader name='s' ms='a.mesh' ps='a.frag'/>",
    "<shader name='s' vs='a.vert' ps='a.frag'/>",
)
L001 = rule(
    "L001",
    WARNING,
    "Lua is not installed",
    "Scripts run with the extra `lua`; without it passes run as if they had no scripts.",
    "<preScript file='a.lua' script='f'/> after pip install nau_py",
    "pip install 'nau_py[lua]'",
)
L008 = rule(
    "L008",
    WARNING,
    "Lua script failed",
    "The file does not load, or a function raised an error, ran too long or used too much "
    "memory. As in Nau, its functions are not called again, and its tests count as false.",
    "function f() return nothing.x end",
    "function f() return true end",
)
L009 = rule(
    "L009",
    WARNING,
    "Lua script tried to write a file",
    "Scripts of a project must not write files; nau-run writes the picture and the targets.",
    "saveTexture('L::colour')",
    "nau-run project.xml --targets out",
)
M001 = rule(
    "M001",
    ERROR,
    "Model unreadable",
    "A model file could not be read; the message gives the reason.",
    "f 1 2 9 in an OBJ with 3 vertices",
    "f 1 2 3",
)
M003 = rule(
    "M003",
    WARNING,
    "Vertices not finite",
    "Faces with such vertices are dropped.",
    "v nan 0 0",
    "v 0 0 0",
)
M004 = rule(
    "M004",
    WARNING,
    "Model texture missing",
    "The material is drawn without the texture.",
    "map_Kd gone.png",
    "map_Kd wood.png",
)
M005 = rule(
    "M005",
    WARNING,
    "Faces left out of ray tracing",
    "They have no area, are the same as later ones, or lie where no ray can hit them well. "
    "Rasterisation still draws them.",
    "f 1 1 2",
    "f 1 2 3",
)
M006 = rule(
    "M006",
    WARNING,
    "Coordinates too large for their features",
    "Single precision rounds the coordinates by more than a ten-thousandth of the smallest "
    "triangle: shapes and shadows there are uncertain.",
    "v 10000000.1 0 0",
    "v 0.1 0 0, and TRANSLATE for the scene",
)
P010 = rule(
    "P010",
    ERROR,
    "Render target incomplete",
    "The driver cannot make such a target, or not in that size.",
    "<SIZE width='99999' height='8'/>",
    "<SIZE width='1024' height='8'/>",
)
P011 = rule(
    "P011",
    ERROR,
    "Ray buffer missing",
    "A pass of class optixPrime or embree reads rays from a buffer and writes hits into one; "
    "both need a size.",
    "<rays buffer='L::rays' queryType='ANY'/> without SIZE or DIM",
    "<buffer name='rays'><SIZE value='3200'/></buffer>",
)
R020 = rule(
    "R020",
    ERROR,
    "Parameter cannot be set",
    "`--set NAME=VALUE` sets a value that the <interface> of the project offers; name and value "
    "are checked.",
    "nau-run project.xml --set Aperture=wide",
    "nau-run project.xml --set Aperture=0.2",
)
T010 = rule(
    "T010",
    ERROR,
    "Ray program raised",
    "A program raised an exception; the place is its own source line.",
    "def shade(hits): return hits.nothing",
    "def shade(hits): return hits.color('DIFFUSE')",
)
T011 = rule(
    "T011",
    ERROR,
    "Ray program returned a wrong type",
    "Shape or type differ from the expected ones.",
    "def shade(hits): return 'red'",
    "def shade(hits): return [1.0, 0.0, 0.0]",
)
T012 = rule(
    "T012",
    ERROR,
    "Ray program not trusted",
    "Programs load from the project's folder, its libraries' folders and the package; "
    "--allow-programs DIR adds one.",
    "file='/elsewhere/shade.py'",
    "file='programs/shade.py'",
)
T014 = rule(
    "T014",
    WARNING,
    "Samples that are not finite",
    "They are dropped, or replaced by the exception program, and counted.",
    "return light / distance",
    "return light / np.maximum(distance, 1e-6)",
)
