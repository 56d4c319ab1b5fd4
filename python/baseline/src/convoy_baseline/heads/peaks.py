"""Boxes as peaks of heat maps, with numbers beside them."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import nn

from convoy_baseline.examples import Targets
from convoy_baseline.grid import Array, Grid
from convoy_baseline.heads.losses import heat_loss, number_loss
from convoy_baseline.layers import RARE, head
from convoy_baseline.targets import NUMBERS, decode


@dataclass(frozen=True)
class Peaks:
    """What is said of E egos."""

    heat: torch.Tensor
    """(E, K, h, w): logits."""
    numbers: torch.Tensor
    """(E, NUMBERS, h, w)."""


class PeakHead(nn.Module):
    """A heat map of each class, and numbers of each cell."""

    def __init__(self, channels: int, classes: int, grid: Grid) -> None:
        super().__init__()
        self.grid = grid
        self.heat = head(channels, classes, RARE)
        self.numbers = head(channels, NUMBERS, 0.0)

    def forward(self, known: torch.Tensor) -> Peaks:
        """Of (E, channels, h, w)."""
        return Peaks(self.heat(known).float(), self.numbers(known).float())

    def loss(self, said: Peaks, targets: Targets) -> dict[str, torch.Tensor]:
        """Parts of it."""
        return {"heat": heat_loss(said.heat, targets.heat), "boxes": self._off(said.numbers, targets)}

    def found(self, said: Peaks, ego: int, most: int, least_score: float) -> tuple[Array, Array, Array]:
        """Boxes (N, 9), labels and scores of one ego."""
        return decode(said.heat[ego].sigmoid(), said.numbers[ego], self.grid, most, least_score)

    def _off(self, numbers: torch.Tensor, targets: Targets) -> torch.Tensor:
        at_boxes = numbers.flatten(2)[targets.box_ego, :, targets.box_cell]
        return number_loss(at_boxes, targets.box_numbers) + numbers.sum() * 0
