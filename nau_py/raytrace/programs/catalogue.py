"""The ray programs that nau_py brings (``file="builtin"``): names, kinds and what they do.

Only the names: lint knows them without loading the engine. A test holds the list to the engine's.
"""

from __future__ import annotations

from nau_py.raytrace.programs.description import (
    ANY_HIT,
    CLOSEST_HIT,
    EXCEPTION,
    MISS,
    RAY_GENERATION,
)

BUILTIN_PROGRAMS: dict[str, tuple[str, str]] = {
    "pinhole": (
        RAY_GENERATION,
        "One ray through each sample of the pass camera, of the first ray type.",
    ),
    "thin_lens": (
        RAY_GENERATION,
        "As `pinhole`, through a lens of the camera's APERTURE, sharp at FOCUS_DISTANCE.",
    ),
    "lambert": (
        CLOSEST_HIT,
        "The default look: diffuse by the first light, with shadow rays where the pass has a "
        "ray type called Shadow, plus 0.3 of the diffuse colour, times the texture of unit 0.",
    ),
    "phong": (CLOSEST_HIT, "As `lambert`, plus SPECULAR times Phong's highlight of SHININESS."),
    "blinn_phong": (CLOSEST_HIT, "As `phong`, with Blinn's half vector."),
    "direct": (
        CLOSEST_HIT,
        "DIFFUSE times texture, lit by every light of the pass by its SHAPE, with shadows.",
    ),
    "ambient_occlusion": (
        CLOSEST_HIT,
        "DIFFUSE times texture, times the part of the sky that is open within OCCLUSION_DISTANCE.",
    ),
    "path": (
        CLOSEST_HIT,
        "Diffuse path tracing: EMISSION, the pass's lights, emissive triangles by next-event "
        "estimation with multiple importance sampling, Russian roulette from depth 4.",
    ),
    "fluorescent": (
        CLOSEST_HIT,
        "As `path`, with light re-emitted in other bands by FLUORESCENCE_RED, _GREEN and _BLUE.",
    ),
    "material": (
        CLOSEST_HIT,
        "The colour that the material's own GLSL program gives, with the ray's origin for its eye.",
    ),
    "emission": (CLOSEST_HIT, "The EMISSION colour."),
    "mirror": (CLOSEST_HIT, "SPECULAR times what the mirror direction sees."),
    "glossy": (
        CLOSEST_HIT,
        "GGX reflection: SPECULAR as reflectance, ROUGHNESS; multiple scattering added back.",
    ),
    "dielectric": (
        CLOSEST_HIT,
        "Reflection and refraction: Fresnel, Snell, total internal reflection, ABSORPTION, "
        "overlaps by PRIORITY.",
    ),
    "alpha_test": (ANY_HIT, "Ignores hits where the texture of unit 0 has alpha up to 0.25."),
    "stochastic_alpha": (
        ANY_HIT,
        "Accepts hits with the probability of their alpha: texture of unit 0 times DIFFUSE.",
    ),
    "transparency": (
        ANY_HIT,
        "Blends by alpha (texture of unit 0 times DIFFUSE): the rest of the ray goes on.",
    ),
    "one_sided": (ANY_HIT, "Ignores hits on back faces, as rasterisation culls them."),
    "background": (MISS, "The clear colour of the render target."),
    "unoccluded": (MISS, "1: nothing was in the way."),
    "magenta": (EXCEPTION, "Paints failed samples magenta."),
}
