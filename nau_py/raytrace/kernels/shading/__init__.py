"""Scattering, lights and the built-in closest-hit programs."""
