"""Pictures as features of the ground: each pixel's feature is spread along its ray by a guess of its depth (Philion and Fidler, "Lift,
Splat, Shoot", ECCV 2020). Places and sums are f32 under autocast, too."""

from __future__ import annotations

import torch
from torch import nn

from convoy_baseline.encoders.pictures import STRIDE, Plain, Residual, Swin
from convoy_baseline.grid import Grid
from convoy_baseline.inputs import Inputs
from convoy_baseline.layers import block
from convoy_baseline.sums import Splat


class Lift(nn.Module):
    """Of pictures (P, 3, h, w) to (V, C, rows, columns) in the frames of V views. What is seen falls on cells of half the size, which
    convolutions make into whole ones."""

    depths_m: torch.Tensor

    def __init__(
        self, grid: Grid, depths_m: tuple[float, float], bins: int, encoder: Plain | Residual | Swin, channels: int
    ) -> None:
        super().__init__()
        self.grid, self.channels = Grid(2 * grid.cells, grid.cell_m / 2), channels
        near, far = depths_m
        middles = near + (torch.arange(bins) + 0.5) * ((far - near) / bins)
        self.register_buffer("depths_m", middles, persistent=False)
        self.encoder = encoder
        self.said = nn.Conv2d(encoder.channels, bins + channels, 1)
        self.ground = nn.Sequential(
            block(channels, channels), block(channels, channels, stride=2), block(channels, channels)
        )

    def forward(self, inputs: Inputs) -> torch.Tensor:
        """All of them; what lies outside a view's grid is lost."""
        if len(inputs.pictures):
            splat = self._splat(inputs)
        else:
            splat = torch.zeros(
                inputs.views, self.channels, self.grid.cells, self.grid.cells, device=inputs.pictures.device
            )
        ground: torch.Tensor = self.ground(splat)
        return ground

    def _splat(self, inputs: Inputs) -> torch.Tensor:
        said = self.said(self.encoder(inputs.pictures.float() / 255))
        bins = len(self.depths_m)
        with torch.autocast(said.device.type, enabled=False):
            depth, features = said[:, :bins].float().softmax(dim=1), said[:, bins:].float()
            places = frustum(inputs.intrinsics, inputs.view_from_optical, self.depths_m, *said.shape[2:])
            cell = cells(places, self.grid)
            return splatted(depth, features, cell, inputs.picture_view, inputs.views, self.grid)


def frustum(
    intrinsics: torch.Tensor, view_from_optical: torch.Tensor, depths_m: torch.Tensor, rows: int, columns: int
) -> torch.Tensor:
    """(P, D, rows, columns, 3): where features would be at each depth, in the views' frames."""
    along = (torch.arange(columns, device=intrinsics.device) + 0.5) * STRIDE
    down = (torch.arange(rows, device=intrinsics.device) + 0.5) * STRIDE
    pixels = torch.stack(
        [
            along.expand(rows, columns),
            down[:, None].expand(rows, columns),
            torch.ones_like(along).expand(rows, columns),
        ],
        dim=-1,
    )
    rays = torch.einsum("pij,rcj->prci", torch.linalg.inv(intrinsics), pixels)
    optical = rays[:, None] * depths_m.view(1, -1, 1, 1, 1)
    turned = torch.einsum("pij,pdrcj->pdrci", view_from_optical[:, :3, :3], optical)
    return turned + view_from_optical[:, None, None, None, :3, 3]


def cells(places: torch.Tensor, grid: Grid) -> torch.Tensor:
    """The cells of places, row by row; -1 outside the grid."""
    found = torch.floor(grid.cells / 2 - places[..., :2] / grid.cell_m).long()
    inside = ((found >= 0) & (found < grid.cells)).all(dim=-1)
    return torch.where(inside, found[..., 0] * grid.cells + found[..., 1], -1)


def splatted(
    depth: torch.Tensor, features: torch.Tensor, cell: torch.Tensor, view: torch.Tensor, views: int, grid: Grid
) -> torch.Tensor:
    """Sums of features (P, C, rows, columns), each as much as depth (P, D, rows, columns) says, over cells: f32."""
    of_view = torch.where(cell >= 0, cell + view.view(-1, 1, 1, 1) * grid.cells**2, -1)
    ground: torch.Tensor = Splat.apply(depth.float(), features.float(), of_view, views * grid.cells**2)  # type: ignore[no-untyped-call]
    return ground.view(views, grid.cells, grid.cells, -1).permute(0, 3, 1, 2)
