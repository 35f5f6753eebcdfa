"""Compiled kernels (numba, cached on disk, no fast-math): everything that is done once a ray.

Arithmetic is float64 on scalars; arrays hold float32. A kernel's result for a ray depends on that
ray alone, so pictures do not depend on tiles or threads.
"""
