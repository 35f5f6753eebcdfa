"""Ray tracing: from the texels of a mask to the colours of pixels. No OpenGL.

A mask becomes rays on this path; each line names the file and the function to read next:

1. ``passes/raytrace.py``, ``RaytraceClass.execute``: the steps of a frame.
2. ``selection/pixels.py``, ``select_pixels``: texels with a weight above 0 become pixels
   (``selection/__init__.py`` describes how selectors become weights).
3. ``tracing/dispatch.py``, ``run_launch``: pixels become tiles, which run on threads.
4. ``tracing/launch.py``, ``RayLaunch.trace_tile``: the steps of a tile.
5. ``kernels/path/integrator.py``, ``trace_samples``: the loop over the samples of a tile, compiled.
6. ``kernels/path/camera.py``, ``start_camera_path``: a sample becomes a camera ray.
7. ``kernels/path/packet.py``, ``advance_packet``: up to 16 rays are intersected, shaded, continued.
8. ``kernels/intersect/embree.py``, ``intersect_packet``: Embree finds the closest hits.
9. ``kernels/path/run_programs.py``, ``run_hit_programs``: miss, any-hit and closest-hit programs.
10. ``kernels/path/film.py``, ``update_film``: samples become means and errors of pixels.

``programs/`` describes the built-in ray programs; ``ptx/`` runs programs compiled for OptiX.
"""
