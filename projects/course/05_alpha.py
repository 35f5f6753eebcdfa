"""Step 5: any hit. Holes of an alpha texture are no surface."""


def solid(hits):
    """Any hit: the grilles' holes let rays through."""
    return hits.texture(0)[:, 3] > 0.25
