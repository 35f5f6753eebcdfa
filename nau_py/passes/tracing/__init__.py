"""Parts of the raytrace pass (``passes/raytrace.py``), which import Embree and the kernels.

- ``steps.py``: the steps of ``execute``, one function each;
- ``state.py``: geometry, programs and textures that a pass keeps from frame to frame;
- ``programs.py``: loading the programs of a pass, and the rule of trust;
- ``scene.py``: the scene of a frame: materials, lights and parameters as values;
- ``textures.py``: input textures and the mask, image files, and the target that colours go to;
- ``effects.py``: effects that the scene calls for, and the report of them;
- ``material_shading.py``: the built-in program ``material``, which shades hits with GLSL.
"""
