"""Sparse 3-D convolutions in plain PyTorch, on a CPU and on CUDA: sites are sorted by key, neighbours are found by binary search, and each
place of the kernel is a gather, a matrix product and a scatter to rows that differ, so that sums have the same bits each time."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import torch
from torch import nn
from torch.nn import functional

Three = tuple[int, int, int]
Rules = list[tuple[torch.Tensor, torch.Tensor]]
"""For each place of a kernel: rows that are read, and rows that get what comes of them."""


@dataclass(frozen=True)
class Sites:
    """Which voxels of a number of grids are there."""

    keys: torch.Tensor
    """(N,) i64, ascending: ((grid * levels + level) * rows + row) * columns + column."""
    grids: int
    shape: Three
    """Levels, rows, columns of each."""

    def places(self) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor, torch.Tensor]:
        """Grid, level, row and column of each."""
        levels, rows, columns = self.shape
        column, rest = self.keys % columns, torch.div(self.keys, columns, rounding_mode="floor")
        row, rest = rest % rows, torch.div(rest, rows, rounding_mode="floor")
        return torch.div(rest, levels, rounding_mode="floor"), rest % levels, row, column

    def key_of(
        self, grid: torch.Tensor, level: torch.Tensor, row: torch.Tensor, column: torch.Tensor
    ) -> tuple[torch.Tensor, torch.Tensor]:
        """Keys of places, and which of them lie within."""
        levels, rows, columns = self.shape
        inside = (level >= 0) & (level < levels) & (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
        return ((grid * levels + level) * rows + row) * columns + column, inside

    def dense(self, features: torch.Tensor) -> torch.Tensor:
        """(grids, C, levels, rows, columns) of features (N, C); nothing is zero."""
        whole = features.new_zeros(self.grids * math.prod(self.shape), features.shape[1])
        return whole.index_copy(0, self.keys, features).view(self.grids, *self.shape, -1).permute(0, 4, 1, 2, 3)


@dataclass(frozen=True)
class Kernel:
    """How a convolution steps: over levels, rows and columns."""

    size: Three = (3, 3, 3)
    stride: Three = (1, 1, 1)
    padding: Three = (1, 1, 1)

    @property
    def places(self) -> list[Three]:
        """All of its places, the last axis the fastest."""
        levels, rows, columns = (range(size) for size in self.size)
        return list(itertools.product(levels, rows, columns))

    def shape_after(self, shape: Three) -> Three:
        """How many places there are behind it."""
        after = [
            (n + 2 * p - k) // s + 1 for n, k, s, p in zip(shape, self.size, self.stride, self.padding, strict=True)
        ]
        if min(after) < 1:
            raise ValueError(
                f"a grid of {shape} is too small for a kernel of {self.size}: expected more cells or levels"
            )
        return after[0], after[1], after[2]


def sites_after(sites: Sites, kernel: Kernel) -> Sites:
    """All sites that a strided kernel makes of others: those that see at least one."""
    grid, *place = sites.places()
    after, found = Sites(sites.keys, sites.grids, kernel.shape_after(sites.shape)), []
    for at in kernel.places:
        from_ = [p + pad - k for p, pad, k in zip(place, kernel.padding, at, strict=True)]
        to = [torch.div(f, s, rounding_mode="floor") for f, s in zip(from_, kernel.stride, strict=True)]
        keys, kept = after.key_of(grid, to[0], to[1], to[2])
        for f, s in zip(from_, kernel.stride, strict=True):
            kept = kept & (f % s == 0)
        found.append(keys[kept])
    return Sites(torch.unique(torch.cat(found)), after.grids, after.shape)


def rules(sites: Sites, after: Sites, kernel: Kernel) -> Rules:
    """Who reads whom. With `after` the same sites it is a submanifold convolution: what is empty stays so."""
    grid, *place = after.places()
    found: Rules = []
    for at in kernel.places:
        read = [p * s - pad + k for p, s, pad, k in zip(place, kernel.stride, kernel.padding, at, strict=True)]
        keys, inside = sites.key_of(grid, read[0], read[1], read[2])
        row = torch.searchsorted(sites.keys, keys).clamp(max=max(len(sites.keys) - 1, 0))
        there = inside & (sites.keys[row] == keys) if len(sites.keys) else torch.zeros_like(inside)
        found.append((row[there], there.nonzero()[:, 0]))
    return found


class SparseConv(nn.Module):
    """A convolution without bias, by rules that were worked out before: several of one level share them."""

    def __init__(self, channels: int, out: int, kernel: Kernel) -> None:
        super().__init__()
        self.weight = nn.Parameter(torch.empty(math.prod(kernel.size), channels, out))
        nn.init.normal_(self.weight, std=math.sqrt(2 / (math.prod(kernel.size) * channels)))

    def forward(self, features: torch.Tensor, by: Rules, count: int) -> torch.Tensor:
        """(count, out) of features (N, C). Products are bf16 under autocast, sums are not."""
        kind = features.device.type
        half = torch.get_autocast_dtype(kind) if torch.is_autocast_enabled(kind) else features.dtype
        found: torch.Tensor = Products.apply(features, self.weight, by, count, half)  # type: ignore[no-untyped-call]
        return found


class Products(torch.autograd.Function):
    """Gather, matrix product, scatter of each place of a kernel. No row is written twice by one place, nor read twice, so that plain
    writes do, where `index_add` would add row by row on a CPU and in any order on a GPU."""

    @staticmethod
    def forward(
        ctx: Any, features: torch.Tensor, weight: torch.Tensor, by: Rules, count: int, half: torch.dtype
    ) -> torch.Tensor:
        ctx.save_for_backward(features, weight)
        ctx.by, ctx.half = by, half
        low, weights = features.to(half), weight.to(half)
        found = features.new_zeros(count, weight.shape[2])
        with torch.autocast(features.device.type, enabled=False):
            for one, (read, written) in zip(weights, by, strict=True):
                found[written] += low.index_select(0, read) @ one
        return found

    @staticmethod
    def backward(ctx: Any, *grads: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor, None, None, None]:
        features, weight = ctx.saved_tensors
        low, weights, upstream = features.to(ctx.half), weight.to(ctx.half), grads[0].to(ctx.half)
        to_features, to_weight = torch.zeros_like(features), torch.zeros_like(weight)
        with torch.autocast(features.device.type, enabled=False):
            for place, (read, written) in enumerate(ctx.by):
                of_rows = upstream.index_select(0, written)
                to_features[read] += of_rows @ weights[place].T
                to_weight[place] = low.index_select(0, read).T @ of_rows
        return to_features, to_weight, None, None, None


class RowNorm(nn.BatchNorm1d):
    """Of rows; where there are fewer than two, as in prediction, since one row has no spread."""

    def forward(self, input: torch.Tensor) -> torch.Tensor:
        """(N, C)."""
        if self.training and len(input) < 2:
            return functional.batch_norm(
                input, self.running_mean, self.running_var, self.weight, self.bias, eps=self.eps
            )
        return super().forward(input)


class SparseBlock(nn.Module):
    """Convolution, normalised, without what is negative."""

    def __init__(self, channels: int, out: int, kernel: Kernel) -> None:
        super().__init__()
        self.convolution, self.norm = SparseConv(channels, out, kernel), RowNorm(out)

    def forward(self, features: torch.Tensor, by: Rules, count: int) -> torch.Tensor:
        """As `SparseConv`."""
        return functional.relu(self.norm(self.convolution(features, by, count)))


class Residual(nn.Module):
    """Two convolutions of one level, added to what came in."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.first = SparseBlock(channels, channels, Kernel())
        self.second, self.norm = SparseConv(channels, channels, Kernel()), RowNorm(channels)

    def forward(self, features: torch.Tensor, by: Rules) -> torch.Tensor:
        """(N, C)."""
        count = len(features)
        return functional.relu(features + self.norm(self.second(self.first(features, by, count), by, count)))
