"""Intersection of rays with the scene: Embree's calls, any-hit programs, shadow rays.

- ``embree.py``: Embree's C functions for single rays and for packets of 16;
- ``any_hit.py``: the filter function through which Embree runs built-in any-hit programs;
- ``visibility.py``: opacity of a hit, and transmittance along one ray;
- ``shadow_rays.py``: shadow rays collected during shading and traced in packets, light by light;
- ``ray_arrays.py``: the same for arrays of rays that come from Python;
- ``counters.py``: ray counts and cycles of a tile.
"""
