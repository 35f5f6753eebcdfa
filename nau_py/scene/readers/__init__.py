"""Readers of mesh formats, one file a format."""
