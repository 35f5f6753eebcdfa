"""Kinds of ray programs, as projects name them."""

from __future__ import annotations

from typing import Final

RAY_GENERATION: Final = "ray generation"
CLOSEST_HIT: Final = "CLOSEST_HIT"
ANY_HIT: Final = "ANY_HIT"
MISS: Final = "MISS"
EXCEPTION: Final = "exception"
