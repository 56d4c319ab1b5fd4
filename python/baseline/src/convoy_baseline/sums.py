"""Sums over groups: the same bits each time on one device, where `index_add` on a GPU adds in any order."""

from __future__ import annotations

from typing import Any

import torch

ROWS_AT_ONCE = 1 << 19
"""So many rows of spread features are in memory at a time."""


def group_sums(values: torch.Tensor, counts: torch.Tensor) -> torch.Tensor:
    """(G, C): sums of rows (N, C) that lie group by group, of which there are `counts` (G,), in each at least one."""
    return torch.segment_reduce(values.float(), "sum", lengths=counts, axis=0, unsafe=True)


def group_greatest(values: torch.Tensor, counts: torch.Tensor) -> torch.Tensor:
    """The greatest of each column, likewise."""
    return torch.segment_reduce(values.float(), "max", lengths=counts, axis=0, unsafe=True)


class Splat(torch.autograd.Function):
    """Sums of features (P, C, rows, columns), each as much as depth (P, D, rows, columns) says, over `cell` (P, D, rows, columns),
    -1 for none: (cells, C) f32. The product of depths and features is never held as a whole."""

    @staticmethod
    def forward(ctx: Any, depth: torch.Tensor, features: torch.Tensor, cell: torch.Tensor, cells: int) -> torch.Tensor:
        ctx.save_for_backward(depth, features, cell)
        ground = features.new_zeros(cells, features.shape[1])
        of_pixel = features.permute(0, 2, 3, 1).flatten(0, 2)
        flat, part = cell.flatten(), depth.flatten()
        kept = (flat >= 0).nonzero()[:, 0]
        kept = kept[torch.sort(flat[kept], stable=True).indices]
        pixels, bins = depth.shape[2] * depth.shape[3], depth.shape[1]
        for some in torch.split(kept, ROWS_AT_ONCE):
            picture = torch.div(some, bins * pixels, rounding_mode="floor")
            rows = of_pixel[picture * pixels + some % pixels] * part[some, None]
            there, counts = torch.unique_consecutive(flat[some], return_counts=True)
            ground[there] += group_sums(rows, counts)
        return ground

    @staticmethod
    def backward(ctx: Any, *grads: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor, None, None]:
        depth, features, cell = ctx.saved_tensors
        of_ground = torch.cat([grads[0], grads[0].new_zeros(1, grads[0].shape[1])])  # The last row is that of cell -1.
        to_depth, to_features = torch.empty_like(depth), torch.zeros_like(features)
        for d in range(depth.shape[1]):
            here = of_ground[cell[:, d]].permute(0, 3, 1, 2)
            to_depth[:, d] = (here * features).sum(dim=1)
            to_features += here * depth[:, d, None]
        return to_depth, to_features, None, None
