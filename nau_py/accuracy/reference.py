"""References: pictures of many samples a pixel, cached by their inputs."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import nau_py.version
from nau_py.accuracy.candidate import Candidate
from nau_py.accuracy.measure import Bench, Reference
from nau_py.model.knob import pick_raytrace_passes
from nau_py.process.cache_folder import make_cache_folder
from nau_py.process.files import write_bytes
from nau_py.run.used_files import used_files

BATCHES = 2
"""Renders with different seeds that are averaged; their difference gives the error of the mean."""
FIRST_SEED = 1_000_003
"""First seed, far from those of candidates: no candidate is a part of the reference."""
KEPT = 24
"""Largest number of references in the cache; the oldest are removed."""


def hash_content(bench: Bench, candidate: Candidate, spp: int, device: str) -> str:
    """Hash the inputs of a reference: files, settings, size, frame, this package, the OpenGL
    driver."""
    digest = hashlib.sha256()
    inputs = (
        nau_py.version.__version__,
        device,
        bench.pipeline.name,
        bench.size,
        bench.frame,
        candidate.values,
        spp,
        BATCHES,
        bench.options.seed,
        bench.options.effects,
        bench.options.texture_filter,
    )
    digest.update(repr(inputs).encode())
    package = Path(nau_py.version.__file__).parent
    own = (p for p in package.rglob("*") if p.suffix != ".pyc")
    for path in [*sorted(own), *sorted(used_files(bench.project))]:
        if path.is_file():
            digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def render_reference(
    bench: Bench,
    candidate: Candidate,
    spp: int,
    device: str,
    report_part: Callable[[float], None],
    keep: bool = True,
) -> Reference:
    """Render ``candidate`` with ``spp`` samples a pixel in all, or take it from the cache."""
    folder = make_cache_folder("references") if keep else None
    path = None if folder is None else folder / f"{hash_content(bench, candidate, spp, device)}.npz"
    rays = bool(pick_raytrace_passes(bench.pipeline.passes))
    label = candidate.with_value("spp", spp).label if rays else candidate.label
    batch = candidate.with_value("spp", -(-spp // BATCHES)) if rays else candidate
    if path is not None and path.is_file():
        found = _load(path, spp, label)
        if found is not None:
            report_part(1.0)
            return found
    seeds = [FIRST_SEED + bench.options.seed + k for k in range(BATCHES)]
    moments, _ = bench.average_pictures(
        batch, seeds, lambda done, part: report_part((done + part) / BATCHES)
    )
    own = Candidate((("spp", 1), ("mask", "project"))) if candidate["mask"] else None
    mask = bench.average_pictures(own, [0], lambda done, part: None)[1] if own else None
    made = Reference(moments.mean, moments.variance / BATCHES, mask, spp, label)
    if path is not None:
        _save(path, made)
    return made


def _load(path: Path, spp: int, label: str) -> Reference | None:
    try:
        with np.load(path) as data:
            mask = data.get("mask")
            return Reference(
                data["mean"].astype(np.float64),
                data["variance"].astype(np.float64),
                mask,
                spp,
                label,
                cached=True,
            )
    except (OSError, ValueError, KeyError, EOFError):
        return None  # it is rendered again


def _save(path: Path, made: Reference) -> None:
    """Write a reference into the cache; errors are ignored, the next run renders it again."""
    stream = io.BytesIO()
    arrays: dict[str, Any] = {
        "mean": made.mean.astype(np.float32),
        "variance": made.variance.astype(np.float32),
    }
    if made.mask is not None:
        arrays["mask"] = made.mask
    np.savez(stream, **arrays)
    try:
        write_bytes(path, stream.getvalue())
        old = sorted(path.parent.glob("*.npz"), key=lambda p: p.stat().st_mtime)[:-KEPT]
        for other in old:
            other.unlink(missing_ok=True)
    except OSError:
        return
