"""Voxels: means of their points, then sparse convolutions down to an eighth of the resolution, heights stacked (Zhou and Tuzel, "VoxelNet",
2018; Yan et al., "SECOND", 2018)."""

from __future__ import annotations

import torch
from torch import nn

from convoy_baseline.encoders.points import in_cells
from convoy_baseline.grid import Grid
from convoy_baseline.inputs import Inputs
from convoy_baseline.sparse import Kernel, Residual, Sites, SparseBlock, Three, rules, sites_after
from convoy_baseline.sums import group_sums

STRIDE = 8
DOWN = Kernel(stride=(2, 2, 2))
LAST_DOWN = Kernel(stride=(2, 2, 2), padding=(0, 1, 1))
OUT = Kernel(size=(3, 1, 1), stride=(2, 1, 1), padding=(0, 0, 0))


class VoxelEncoder(nn.Module):
    """Four levels of channels, each with two residual blocks, the later three at half the resolution of the one before."""

    def __init__(
        self, grid: Grid, height_m: tuple[float, float], voxel_height_m: float, most: int, channels: tuple[int, ...]
    ) -> None:
        super().__init__()
        self.grid, self.height_m, self.most = grid, height_m, most
        self.levels = round((height_m[1] - height_m[0]) / voxel_height_m)
        self.first = SparseBlock(5, channels[0], Kernel())
        self.blocks = nn.ModuleList(nn.ModuleList([Residual(width), Residual(width)]) for width in channels)
        self.kernels = (DOWN, DOWN, LAST_DOWN)
        self.down = nn.ModuleList(
            SparseBlock(channels[i], channels[i + 1], kernel) for i, kernel in enumerate(self.kernels)
        )
        self.out = SparseBlock(channels[-1], channels[-1], OUT)

    @property
    def shape(self) -> Three:
        """Of the voxels: one level more than there are, which makes two of 40 after all strides."""
        return self.levels + 1, self.grid.cells, self.grid.cells

    @property
    def shape_after(self) -> Three:
        """Of what comes out, before heights are stacked."""
        shape = self.shape
        for kernel in (*self.kernels, OUT):
            shape = kernel.shape_after(shape)
        return shape

    def forward(self, inputs: Inputs) -> torch.Tensor:
        """(V, C * heights, rows / 8, columns / 8)."""
        found = in_cells(inputs.points.float(), inputs.point_view, self.grid, self.height_m, self.levels, self.most)
        area = self.grid.cells**2
        level = torch.div(found.keys, area, rounding_mode="floor")
        view, level = torch.div(level, self.levels, rounding_mode="floor"), level % self.levels
        keys = (view * self.shape[0] + level) * area + found.keys % area
        sites = Sites(keys, inputs.views, self.shape)
        if not len(keys):
            return self._empty(inputs)
        features = group_sums(found.points, found.counts) / found.counts[:, None]
        features[:, :2] = features[:, :2] / self.grid.half_m
        by = rules(sites, sites, Kernel())
        features = self.first(features, by, len(keys))
        for i, blocks in enumerate(self.blocks):
            if i:
                kernel = self.kernels[i - 1]
                after = sites_after(sites, kernel)
                features = self.down[i - 1](features, rules(sites, after, kernel), len(after.keys))
                sites, by = after, rules(after, after, Kernel())
            for block in blocks:
                features = block(features, by)
        after = sites_after(sites, OUT)
        features = self.out(features, rules(sites, after, OUT), len(after.keys))
        return after.dense(features).flatten(1, 2)

    def _empty(self, inputs: Inputs) -> torch.Tensor:
        levels, rows, columns = self.shape_after
        channels = self.out.norm.num_features
        return torch.zeros(inputs.views, channels * levels, rows, columns, device=inputs.points.device)
