"""Counts of a launch: rays by kind, values that are not finite, cycles in Embree."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(slots=True)
class RayCounts:
    """Cost of a tile, or of a launch.

    ``rays``: rays by kind; ``skipped``: rays of effects that are left out, by kind. ``nonfinite``:
    samples that are not finite; ``sources``: for each program or pass that returned such values,
    their number and the first pixel. ``cut_layers``: rays that met more partly transparent hits
    than the limit. ``cycles`` of the processor, and ``traced`` of them in Embree; both are 0 where
    they cannot be counted. ``viewed``: materials, by index, that primary rays met.
    """

    rays: dict[str, int] = field(default_factory=dict)
    nonfinite: int = 0
    cut_layers: int = 0
    sources: dict[str, tuple[int, int]] = field(default_factory=dict)
    cycles: int = 0
    traced: int = 0
    skipped: dict[str, int] = field(default_factory=dict)
    viewed: set[int] = field(default_factory=set)

    def add_rays(self, kind: str, count: int) -> None:
        """Add ``count`` rays of a kind."""
        if count:
            self.rays[kind] = self.rays.get(kind, 0) + count

    def add_source(self, source: str, count: int, pixel: int) -> None:
        """Add ``count`` values of ``source`` that are not finite, the first at ``pixel``."""
        if count:
            before, first = self.sources.get(source, (0, pixel))
            self.sources[source] = (before + count, min(first, pixel))

    def describe_source(self, width: int) -> str:
        """Return the source of the first value that is not finite, as the end of a sentence."""
        found = sorted(self.sources.items(), key=lambda item: item[1][1])
        if not found:
            return ""
        source, (_, pixel) = found[0]
        return f"; the first at pixel ({pixel % width}, {pixel // width}) from {source}"

    def merge(self, other: RayCounts) -> None:
        """Add the counts of another tile."""
        for kind, count in other.rays.items():
            self.add_rays(kind, count)
        for source, (count, pixel) in other.sources.items():
            self.add_source(source, count, pixel)
        self.nonfinite += other.nonfinite
        self.cut_layers += other.cut_layers
        self.cycles += other.cycles
        self.traced += other.traced
        for kind, count in other.skipped.items():
            self.skipped[kind] = self.skipped.get(kind, 0) + count
        self.viewed |= other.viewed

    @property
    def traced_share(self) -> float:
        """Part of the time in Embree, 0 to 1; the rest is shading. 1 if cycles are unknown."""
        return min(self.traced / self.cycles, 1.0) if self.cycles > 0 else 1.0
