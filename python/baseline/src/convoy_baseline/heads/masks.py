"""Masks on a grid of their own."""

from __future__ import annotations

import torch
from torch import nn
from torch.nn import functional

from convoy_baseline.grid import Grid
from convoy_baseline.layers import RARE, bias_of, block


class MaskHead(nn.Module):
    """Features are read where masks have cells, then two convolutions say what is there."""

    def __init__(self, channels: int, width: int, classes: int, features: Grid, masks: Grid) -> None:
        super().__init__()
        self.ratio, self.cells = masks.half_m / features.half_m, masks.cells
        self.steps = nn.Sequential(block(channels, width), block(width, width))
        self.masks = nn.Conv2d(width, classes, 1)
        nn.init.constant_(bias_of(self.masks), RARE)

    def forward(self, known: torch.Tensor) -> torch.Tensor:
        """Logits (E, C, H, W)."""
        with torch.autocast(known.device.type, enabled=False):
            theta = torch.tensor([[self.ratio, 0.0, 0.0], [0.0, self.ratio, 0.0]], device=known.device)
            where = functional.affine_grid(
                theta.expand(len(known), 2, 3), [len(known), 1, self.cells, self.cells], align_corners=False
            )
            finer = functional.grid_sample(known.float(), where, padding_mode="border", align_corners=False)
        found: torch.Tensor = self.masks(self.steps(finer.to(known.dtype)))
        return found.float()
