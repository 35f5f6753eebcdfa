"""Rays: acceleration structure, sampling, offsets, programs, the wavefront. No GL."""
