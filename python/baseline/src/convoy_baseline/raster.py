"""A sweep as a picture from above, in the frame of the agent that took it."""

from __future__ import annotations

import numpy as np
import torch

from convoy_baseline.grid import Array, Grid

SLICES = 8
LOWEST_M = -0.9
SLICE_M = 0.6
"""Heights above the agent's origin, which is on the ground; what is lower or higher is in the first or last slice."""
CHANNELS = SLICES + 2


def rasterise(points: Array, grid: Grid) -> Array:
    """(3, H, W) u8 of points (P, 4): x, y, z in the agent's frame and intensity. A bit for each slice that has a point; 32 times
    the logarithm to base 2 of 1 + the number of points; 255 times their mean intensity."""
    points = points[grid.has(points)]
    rows, columns = grid.cell_of(points)
    cell = rows * grid.cells + columns
    level = np.clip(np.floor((points[:, 2] - LOWEST_M) / SLICE_M), 0, SLICES - 1).astype(np.int64)
    filled = np.zeros((grid.cells**2, SLICES), bool)
    filled[cell, level] = True
    count = np.bincount(cell, minlength=grid.cells**2)
    light = np.bincount(cell, weights=points[:, 3], minlength=grid.cells**2) / np.maximum(count, 1)
    layers = [
        np.packbits(filled, axis=1, bitorder="little")[:, 0],
        np.minimum(32 * np.log2(1 + count), 255),
        np.clip(255 * light, 0, 255),
    ]
    return np.stack(layers).astype(np.uint8).reshape(3, grid.cells, grid.cells)


def unpack(rasters: torch.Tensor) -> torch.Tensor:
    """(V, CHANNELS, H, W) f32, 0 to 1, of rasters (V, 3, H, W) u8."""
    bit = torch.arange(SLICES, dtype=torch.uint8, device=rasters.device).view(1, SLICES, 1, 1)
    slices = (rasters[:, :1] >> bit) & 1
    return torch.cat([slices.float(), rasters[:, 1:].float() / 255], dim=1)
