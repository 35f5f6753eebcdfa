"""Tracing: the host side of a launch, from the selected pixels to their estimates.

``dispatch.run_launch`` splits the pixels into tiles and runs them on threads;
``launch.RayLaunch.trace_tile`` has the steps of a tile: generate camera rays, trace and shade them,
update the estimates. The other modules, in the order in which a launch needs them:

- ``geometry.py``, ``accelerator.py``: triangles of the pass, and Embree's scenes of them;
- ``materials.py``, ``ray_texture.py``, ``scene_tables.py``: tables that the kernels read;
- ``program_loader.py``: programs of the project, and checks of their results;
- ``camera_rays.py``: the camera as kernels read it;
- ``thread_tracer.py``, ``tile_memory.py``: kernels over the paths of a tile, and their memory;
- ``deferred_programs.py``: Python programs between the kernels, with the batches that they get
  (``ray_batch.py``, ``hit_batch.py``, ``random.py``), and ``main_thread.py`` for OpenGL;
- ``estimate.py``, ``counts.py``: means, errors and costs;
- ``adaptive.py``: further launches until the errors meet a target.
"""
