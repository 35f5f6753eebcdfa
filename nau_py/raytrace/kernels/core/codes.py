"""Codes of the built-in programs in the tables of a scene, by the names that projects use."""

from __future__ import annotations

NONE = 0
LAMBERT, EMISSION, MIRROR, GLOSSY, DIELECTRIC, DIRECT = 1, 2, 3, 4, 5, 6
AMBIENT_OCCLUSION, PATH_TRACE, FLUORESCENT, PHONG, BLINN_PHONG = 7, 8, 9, 10, 11
ALPHA_TEST, STOCHASTIC_ALPHA, TRANSPARENCY, ONE_SIDED = 1, 2, 3, 4
BACKGROUND, UNOCCLUDED = 1, 2

CLOSEST_CODES = {
    "lambert": LAMBERT,
    "phong": PHONG,
    "blinn_phong": BLINN_PHONG,
    "emission": EMISSION,
    "mirror": MIRROR,
    "glossy": GLOSSY,
    "dielectric": DIELECTRIC,
    "direct": DIRECT,
    "ambient_occlusion": AMBIENT_OCCLUSION,
    "path": PATH_TRACE,
    "fluorescent": FLUORESCENT,
}
ANY_HIT_CODES = {
    "alpha_test": ALPHA_TEST,
    "stochastic_alpha": STOCHASTIC_ALPHA,
    "transparency": TRANSPARENCY,
    "one_sided": ONE_SIDED,
}
MISS_CODES = {"background": BACKGROUND, "unoccluded": UNOCCLUDED}
