"""The path tracer: camera rays, packets of paths, the film.

One tile of a launch takes these steps, named as in the wavefront integrator of pbrt-v4:

1. ``camera.start_camera_path`` generates the camera ray of each sample;
2. ``packet.trace_packet`` follows up to 16 paths to their ends. Each round of ``advance_packet``
   intersects the rays (``intersect_paths``), runs miss, any-hit and closest-hit programs
   (``run_programs.run_hit_programs``), and traces the shadow rays that shading queued
   (``trace_shadow_rays``);
3. ``film.update_film`` adds the samples to the estimates of the pixels.

``integrator.py`` has the loops over the paths of a tile. ``deferred.py`` and ``hit_arrays.py``
serve programs that are written in Python: their paths leave the packet and are continued later.
"""
