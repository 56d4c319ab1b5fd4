"""What views saw, as tensors of a batch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
import torch

from convoy_baseline.frames import View
from convoy_baseline.grid import Grid
from convoy_baseline.raster import rasterise


@dataclass(frozen=True)
class Inputs:
    """Of V views; pictures of all of them in one list, as they may have different numbers of cameras."""

    views: int
    """V."""
    rasters: torch.Tensor
    """(V, 3, H, W) u8: sweeps from above (`rasterise`), nothing without lidars; (V, 3, 0, 0) where points are looked at."""
    points: torch.Tensor
    """(N, 5): x, y, z, intensity, age in s, of all views one after another."""
    point_view: torch.Tensor
    """(N,): whose each point is."""
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
        tensors = [getattr(self, field.name).to(device) for field in fields(self) if field.name != "views"]
        return Inputs(self.views, *tensors)


def gathered(views: Sequence[View], raster_grid: Grid | None = None) -> Inputs:
    """Of views of one or several keyframes; of those that have points only, rasters are made if there is a grid for them."""
    owners = [(v, picture) for v, view in enumerate(views) for picture in view.pictures]
    pictures = [picture.rgb for _, picture in owners]
    clouds = [np.zeros((0, 5), np.float32) if view.points is None else view.points for view in views]
    none = np.zeros((3, 0, 0), np.uint8)
    if raster_grid is None:
        rasters = [none if view.raster is None else view.raster for view in views]
    else:
        rasters = [
            rasterise(cloud, raster_grid) if view.raster is None else view.raster
            for view, cloud in zip(views, clouds, strict=True)
        ]
    return Inputs(
        len(views),
        torch.from_numpy(np.stack(rasters)),
        torch.from_numpy(np.concatenate(clouds)),
        torch.from_numpy(np.repeat(np.arange(len(clouds)), [len(cloud) for cloud in clouds])),
        torch.from_numpy(np.stack(pictures)) if pictures else torch.zeros(0, 3, 32, 32, dtype=torch.uint8),
        torch.tensor([v for v, _ in owners], dtype=torch.long),
        _matrices([picture.intrinsics for _, picture in owners], 3),
        _matrices([picture.agent_from_optical for _, picture in owners], 4),
    )


def _matrices(found: Sequence[np.ndarray], size: int) -> torch.Tensor:
    return torch.from_numpy(np.array(found, np.float32).reshape(-1, size, size))
