"""Partners' features in the ego's grid, by the exact poses of both."""

from __future__ import annotations

import torch
from torch.nn import functional


def sampling_theta(ego_from_view: torch.Tensor, half_m: float) -> torch.Tensor:
    """(L, 2, 3) for `affine_grid`, of poses (L, 4, 4).

    Pictures have row 0 at x = half and column 0 at y = half, so that their normalised coordinates are -y / half (to the right) and
    -x / half (down). What the ego wants at (x, y) is in the partner's picture at view_from_ego (x, y).
    """
    view_from_ego = torch.linalg.inv(ego_from_view.double())
    turn, shift = view_from_ego[:, :2, :2], view_from_ego[:, :2, 3] / half_m
    right = torch.stack([turn[:, 1, 1], turn[:, 1, 0], -shift[:, 1]], dim=1)
    down = torch.stack([turn[:, 0, 1], turn[:, 0, 0], -shift[:, 0]], dim=1)
    return torch.stack([right, down], dim=1).float()


def warp(features: torch.Tensor, ego_from_view: torch.Tensor, half_m: float) -> torch.Tensor:
    """Features (L, C, h, w) of partners in the ego's cells, bilinear; zero where a partner's grid does not reach."""
    theta = sampling_theta(ego_from_view, half_m).to(features)
    places = functional.affine_grid(theta, list(features.shape), align_corners=False)
    return functional.grid_sample(features, places, mode="bilinear", padding_mode="zeros", align_corners=False)
