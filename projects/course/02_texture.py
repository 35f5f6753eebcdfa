"""Step 2: texture coordinates are interpolated at hits; textures are read with them."""


def textured(hits):
    """Closest hit: DIFFUSE times the texture of unit 0, white if there is none."""
    return hits.color("DIFFUSE") * hits.texture(0)[:, :3]
