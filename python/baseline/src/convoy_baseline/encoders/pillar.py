"""Pillars: a small network looks at each point, the greatest of each cell's points is the cell's (Lang et al., "PointPillars", 2019)."""

from __future__ import annotations

import torch
from torch import nn
from torch.nn import functional

from convoy_baseline.encoders.points import in_cells
from convoy_baseline.encoders.raster import Scales
from convoy_baseline.grid import Grid
from convoy_baseline.inputs import Inputs
from convoy_baseline.sparse import RowNorm
from convoy_baseline.sums import group_greatest, group_sums


class PillarEncoder(nn.Module):
    """Pillars, then `Scales`."""

    def __init__(self, grid: Grid, height_m: tuple[float, float], most: int, channels: int, width: int) -> None:
        super().__init__()
        self.grid, self.height_m, self.most, self.channels = grid, height_m, most, channels
        self.look = nn.Linear(10, channels, bias=False)
        self.norm = RowNorm(channels)
        self.scales = Scales(channels, width)

    def forward(self, inputs: Inputs) -> torch.Tensor:
        """(V, 2 width, rows / 2, columns / 2)."""
        grid, views = self.grid, inputs.views
        found = in_cells(inputs.points.float(), inputs.point_view, grid, self.height_m, 1, self.most)
        ground = torch.zeros(views * grid.cells**2, self.channels, device=inputs.points.device)
        if len(found.points):
            mean = group_sums(found.points[:, :3], found.counts) / found.counts[:, None]
            cell = found.keys % grid.cells**2
            middle = grid.half_m - grid.cell_m * (
                0.5 + torch.stack([torch.div(cell, grid.cells, rounding_mode="floor"), cell % grid.cells], dim=1)
            )
            group = found.group
            about = torch.cat(
                [
                    found.points[:, :2] / grid.half_m,
                    found.points[:, 2:],
                    found.points[:, :3] - mean[group],
                    found.points[:, :2] - middle[group],
                ],
                dim=1,
            )
            seen = functional.relu(self.norm(self.look(about).float()))
            ground = ground.index_copy(0, found.keys, group_greatest(seen, found.counts))
        pictures = ground.view(views, grid.cells, grid.cells, self.channels).permute(0, 3, 1, 2)
        joined: torch.Tensor = self.scales(pictures)
        return joined
