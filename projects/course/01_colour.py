"""Step 1: rays find surfaces, surfaces have colours. ``camera`` and ``sky`` are in common.py."""


def colour(hits):
    """Closest hit: the material's DIFFUSE colour, the same for all hits."""
    return hits.color("DIFFUSE")
