"""Rays through Embree, any-hit programs, visibility and shadow rays."""
