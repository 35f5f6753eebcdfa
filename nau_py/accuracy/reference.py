"""References: many samples a pixel, kept from run to run by what they depend on."""

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
"""Renders with different seeds that a reference is the mean of: from their difference its own
error is known."""
FIRST_SEED = 1_000_003
"""Far from the seeds of candidates, so that no candidate is a part of the reference."""
KEPT = 24
"""References in the cache; the oldest go."""


def content_key(bench: Bench, candidate: Candidate, spp: int, device: str) -> str:
    """What the reference depends on, as a hash: files, settings, size, frame, this package, the
    OpenGL driver."""
    digest = hashlib.sha256()
    said = (
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
    digest.update(repr(said).encode())
    package = Path(nau_py.version.__file__).parent
    own = (p for p in package.rglob("*") if p.suffix != ".pyc")
    for path in [*sorted(own), *sorted(used_files(bench.project))]:
        if path.is_file():
            digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def reference(
    bench: Bench,
    candidate: Candidate,
    spp: int,
    device: str,
    told: Callable[[float], None],
    keep: bool = True,
) -> Reference:
    """Render ``candidate`` with ``spp`` samples a pixel in all, or take it from the cache."""
    folder = make_cache_folder("references") if keep else None
    path = None if folder is None else folder / f"{content_key(bench, candidate, spp, device)}.npz"
    rays = bool(pick_raytrace_passes(bench.pipeline.passes))
    label = candidate.but("spp", spp).label if rays else candidate.label
    batch = candidate.but("spp", -(-spp // BATCHES)) if rays else candidate
    if path is not None and path.is_file():
        found = _load(path, spp, label)
        if found is not None:
            told(1.0)
            return found
    seeds = [FIRST_SEED + bench.options.seed + k for k in range(BATCHES)]
    moments, _ = bench.pictures(batch, seeds, lambda done, part: told((done + part) / BATCHES))
    own = Candidate((("spp", 1), ("mask", "project"))) if candidate["mask"] else None
    mask = bench.pictures(own, [0], lambda done, part: None)[1] if own else None
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
        return None  # it is rendered anew, and written over


def _save(path: Path, made: Reference) -> None:
    """Keep a reference; where that cannot be, the next run renders it again."""
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
