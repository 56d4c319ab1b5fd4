"""What all heads look at."""

from __future__ import annotations

import torch
from torch import nn

from convoy_baseline.layers import block


class PlainDecoder(nn.Sequential):
    """Two convolutions."""

    def __init__(self, channels: int) -> None:
        super().__init__(block(channels, channels), block(channels, channels))
        self.channels = channels


class PyramidDecoder(nn.Module):
    """Two stages of five convolutions, the second at half the resolution, both brought to the first one's and stacked."""

    def __init__(self, channels: int, stages: tuple[int, ...], out: int) -> None:
        super().__init__()
        near, far = stages
        self.channels = out
        self.near = nn.Sequential(block(channels, near), *(block(near, near) for _ in range(4)))
        self.far = nn.Sequential(block(near, far, stride=2), *(block(far, far) for _ in range(4)))
        self.from_near = nn.Sequential(nn.Conv2d(near, out // 2, 1, bias=False), nn.BatchNorm2d(out // 2), nn.ReLU())
        self.from_far = nn.Sequential(
            nn.ConvTranspose2d(far, out // 2, 2, stride=2, bias=False), nn.BatchNorm2d(out // 2), nn.ReLU()
        )

    def forward(self, fused: torch.Tensor) -> torch.Tensor:
        """(E, out, h, w) of (E, channels, h, w) with even sides."""
        near = self.near(fused)
        return torch.cat([self.from_near(near), self.from_far(self.far(near))], dim=1)
