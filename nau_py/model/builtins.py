"""The ray programs that nau_py brings (``file="builtin"``): names, kinds and what they do.

Only the names: lint knows them without loading the engine. A test holds the list to the engine's.
"""

from __future__ import annotations

from typing import Final

RAY_GENERATION: Final = "ray generation"
CLOSEST_HIT: Final = "CLOSEST_HIT"
ANY_HIT: Final = "ANY_HIT"
MISS: Final = "MISS"
EXCEPTION: Final = "exception"

BUILTIN_PROGRAMS: dict[str, tuple[str, str]] = {
    "pinhole": (
        RAY_GENERATION,
        "One ray through each sample of the pass camera, of the first ray type; stratified jitter.",
    ),
    "lambert": (
        CLOSEST_HIT,
        "The default look: diffuse by the first light, with shadow rays where the pass has a "
        "ray type called Shadow, plus 0.3 of the diffuse colour, times the texture of unit 0.",
    ),
    "emission": (CLOSEST_HIT, "The EMISSION colour."),
    "mirror": (CLOSEST_HIT, "SPECULAR times what the mirror direction sees."),
    "alpha_test": (ANY_HIT, "Ignores hits where the texture of unit 0 has alpha up to 0.25."),
    "background": (MISS, "The clear colour of the render target."),
    "unoccluded": (MISS, "1: nothing was in the way."),
    "magenta": (EXCEPTION, "Paints failed samples magenta."),
}
