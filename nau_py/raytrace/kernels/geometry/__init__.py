"""The surface at a hit and its textures."""
