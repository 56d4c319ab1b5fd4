"""Features of a picture from above."""

from __future__ import annotations

import torch
from torch import nn
from torch.nn import functional

from convoy_baseline.inputs import Inputs
from convoy_baseline.layers import block
from convoy_baseline.raster import CHANNELS, unpack


class Scales(nn.Module):
    """Three scales, joined at half the resolution."""

    def __init__(self, channels: int, width: int) -> None:
        super().__init__()
        self.at_full = nn.Sequential(block(channels, width), block(width, width))
        self.at_half = nn.Sequential(block(width, 2 * width, stride=2), block(2 * width, 2 * width))
        self.at_quarter = nn.Sequential(block(2 * width, 4 * width, stride=2), block(4 * width, 4 * width))
        self.up = nn.Conv2d(4 * width, 2 * width, 1)
        self.join = block(2 * width, 2 * width)

    def forward(self, pictures: torch.Tensor) -> torch.Tensor:
        """(V, 2 width, H / 2, W / 2)."""
        half = self.at_half(self.at_full(pictures))
        coarse = functional.interpolate(self.up(self.at_quarter(half)), scale_factor=2.0, mode="nearest")
        joined: torch.Tensor = self.join(half + coarse)
        return joined


class RasterEncoder(nn.Module):
    """`Scales` of rasters."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.scales = Scales(CHANNELS, width)

    def forward(self, inputs: Inputs) -> torch.Tensor:
        """(V, 2 width, rows / 2, columns / 2)."""
        found: torch.Tensor = self.scales(unpack(inputs.rasters))
        return found
