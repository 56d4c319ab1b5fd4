"""What several views say of the same ground becomes one."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import nn


class MaxFusion(nn.Module):
    """The greatest of each feature: no matter how many views, nor in which order."""

    def forward(self, stacks: Sequence[torch.Tensor]) -> torch.Tensor:
        """(E, C, h, w) of one stack (views, C, h, w) for each ego, its own view first."""
        return torch.stack([stack.amax(dim=0) for stack in stacks])


class AxialFusion(nn.Module):
    """Attention among the views and within windows (neighbours), then among the views and across windows (the same place of each, far
    away), and the greatest of what comes out."""

    def __init__(self, channels: int, heads: int, window: int) -> None:
        super().__init__()
        self.window = window
        self.near = AttentionBlock(channels, heads)
        self.far = AttentionBlock(channels, heads)

    def forward(self, stacks: Sequence[torch.Tensor]) -> torch.Tensor:
        """As `MaxFusion`."""
        return torch.stack([self._one(stack) for stack in stacks])

    def _one(self, stack: torch.Tensor) -> torch.Tensor:
        views, channels, height, width = stack.shape
        rows, columns, side = height // self.window, width // self.window, self.window
        # Each line is a set of tokens that attend to one another: (sets, tokens, C).
        tokens = stack.reshape(views, channels, rows, side, columns, side)
        tokens = tokens.permute(2, 4, 0, 3, 5, 1).reshape(rows * columns, views * side * side, channels)
        tokens = self.near(tokens).reshape(rows, columns, views, side, side, channels)
        tokens = tokens.permute(3, 4, 2, 0, 1, 5).reshape(side * side, views * rows * columns, channels)
        tokens = self.far(tokens).reshape(side, side, views, rows, columns, channels)
        pictures: torch.Tensor = tokens.permute(2, 5, 3, 0, 4, 1).reshape(views, channels, height, width)
        return pictures.amax(dim=0)


class AttentionBlock(nn.Module):
    """Attention and a small network, each added to what came in."""

    def __init__(self, channels: int, heads: int) -> None:
        super().__init__()
        self.before = nn.LayerNorm(channels)
        self.attention = nn.MultiheadAttention(channels, heads, batch_first=True)
        self.network = nn.Sequential(
            nn.LayerNorm(channels), nn.Linear(channels, 2 * channels), nn.GELU(), nn.Linear(2 * channels, channels)
        )

    def forward(self, tokens: torch.Tensor) -> torch.Tensor:
        """(sets, tokens, C)."""
        normal = self.before(tokens)
        tokens = tokens + self.attention(normal, normal, normal, need_weights=False)[0]
        grown: torch.Tensor = tokens + self.network(tokens)
        return grown
