"""Points sorted into the cells that they lie in."""

from __future__ import annotations

from dataclasses import dataclass

import torch

from convoy_baseline.encoders.camera import cells
from convoy_baseline.grid import Grid


@dataclass(frozen=True)
class Sorted:
    """Points cell by cell."""

    points: torch.Tensor
    """(N, 5): x, y, z, intensity, age."""
    keys: torch.Tensor
    """(G,): which cells there are, ascending: (view * levels + level) * cells of the ground + cell."""
    counts: torch.Tensor
    """(G,): how many points each has."""

    @property
    def group(self) -> torch.Tensor:
        """(N,): which of the cells each point is in."""
        return torch.repeat_interleave(torch.arange(len(self.counts), device=self.counts.device), self.counts)


def in_cells(
    points: torch.Tensor, view: torch.Tensor, grid: Grid, height_m: tuple[float, float], levels: int, most: int
) -> Sorted:
    """Points (N, 5) of views (N,), of each cell the first `most`; those outside the grid or its height are left out."""
    low, high = height_m
    ground = cells(points, grid)
    level = torch.floor((points[:, 2] - low) * (levels / (high - low))).long()
    kept = ((ground >= 0) & (level >= 0) & (level < levels)).nonzero()[:, 0]
    key = (view[kept] * levels + level[kept]) * grid.cells**2 + ground[kept]
    key, order = torch.sort(key, stable=True)
    kept = kept[order]
    keys, counts = torch.unique_consecutive(key, return_counts=True)
    first = torch.repeat_interleave(counts.cumsum(0) - counts, counts)
    early = torch.arange(len(key), device=key.device) - first < most
    return Sorted(points[kept[early]], keys, counts.clamp(max=most))
