"""What views saw, as tensors of a batch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
import torch

from convoy_baseline.frames import View


@dataclass(frozen=True)
class Inputs:
    """Of V views; pictures of all of them in one list, as they may have different numbers of cameras."""

    rasters: torch.Tensor
    """(V, 3, H, W) u8: sweeps from above (`rasterise`), nothing without lidars."""
    pictures: torch.Tensor
    """(P, 3, h, w) u8."""
    picture_view: torch.Tensor
    """(P,): whose each picture is."""
    intrinsics: torch.Tensor
    """(P, 3, 3)."""
    view_from_optical: torch.Tensor
    """(P, 4, 4)."""

    def to(self, device: torch.device) -> Inputs:
        """The same on a device."""
        return Inputs(*(getattr(self, field.name).to(device) for field in fields(self)))


def gathered(views: Sequence[View]) -> Inputs:
    """Of views of one or several keyframes."""
    owners = [(v, picture) for v, view in enumerate(views) for picture in view.pictures]
    pictures = [picture.rgb for _, picture in owners]
    return Inputs(
        torch.from_numpy(np.stack([view.raster for view in views])),
        torch.from_numpy(np.stack(pictures)) if pictures else torch.zeros(0, 3, 1, 1, dtype=torch.uint8),
        torch.tensor([v for v, _ in owners], dtype=torch.long),
        _matrices([picture.intrinsics for _, picture in owners], 3),
        _matrices([picture.agent_from_optical for _, picture in owners], 4),
    )


def _matrices(found: Sequence[np.ndarray], size: int) -> torch.Tensor:
    return torch.from_numpy(np.array(found, np.float32).reshape(-1, size, size))
