"""The greatest of each feature: the rule of CoopDet3D."""

from __future__ import annotations

import torch
from torch import nn


def greatest(views: torch.Tensor, known: torch.Tensor) -> torch.Tensor:
    """(E, C, h, w) of views (E, A, C, h, w), of those cells that are known (E, A, h, w) alone; one view of each cell must be."""
    lowest = torch.finfo(views.dtype).min
    return views.masked_fill(~known[:, :, None], lowest).amax(dim=1)


class MaxFusion(nn.Module):
    """No matter how many views, nor in which order."""

    def forward(self, views: torch.Tensor, known: torch.Tensor) -> torch.Tensor:
        """`greatest`."""
        return greatest(views, known)
