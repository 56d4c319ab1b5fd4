"""Partners' features in the ego's grid, by the exact poses of both. Places are f32, whatever precision features have: bf16 has 8 bits,
half a metre at 60 m."""

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


def places(ego_from_view: torch.Tensor, half_m: float, rows: int, columns: int) -> torch.Tensor:
    """(L, rows, columns, 2) f32: where in partners' pictures the ego's cells are, -1 to 1 within."""
    theta = sampling_theta(ego_from_view, half_m)
    with torch.autocast(theta.device.type, enabled=False):
        return functional.affine_grid(theta, [len(theta), 1, rows, columns], align_corners=False)


def warp(features: torch.Tensor, ego_from_view: torch.Tensor, half_m: float) -> torch.Tensor:
    """Features (L, C, h, w) of partners in the ego's cells, bilinear; zero where a partner's grid does not reach."""
    where = places(ego_from_view, half_m, *features.shape[2:])
    with torch.autocast(features.device.type, enabled=False):
        moved = functional.grid_sample(
            features.float(), where, mode="bilinear", padding_mode="zeros", align_corners=False
        )
    return moved.to(features.dtype)


def reach(ego_from_view: torch.Tensor, half_m: float, rows: int, columns: int) -> torch.Tensor:
    """(L, rows, columns) bool: which of the ego's cells have their middle in a partner's grid."""
    return (places(ego_from_view, half_m, rows, columns).abs() <= 1).all(dim=-1)
