"""How wrong heat maps, boxes and masks are."""

from __future__ import annotations

import torch
from torch.nn import functional


def heat_loss(logits: torch.Tensor, heat: torch.Tensor) -> torch.Tensor:
    """Of heat maps, per object: cells that are easy count less (squared), and so do those beside a peak (to the fourth)."""
    chance = torch.sigmoid(logits)
    peak = heat == 1
    found = (1 - chance) ** 2 * functional.logsigmoid(logits)
    empty = (1 - heat) ** 4 * chance**2 * functional.logsigmoid(-logits)
    each: torch.Tensor = -torch.where(peak, found, empty).sum() / peak.sum().clamp(min=1)
    return each


def number_loss(said: torch.Tensor, wanted: torch.Tensor) -> torch.Tensor:
    """Mean distance of numbers (N, NUMBERS), summed over numbers; velocity counts a tenth. 0 of none."""
    if not len(said):
        return said.sum()
    apart = (said - wanted).abs()
    return apart[:, :8].sum(dim=1).mean() + 0.1 * apart[:, 8:].sum(dim=1).mean()


def focal(logits: torch.Tensor, wanted: torch.Tensor) -> torch.Tensor:
    """Of each yes or no: what is easy counts less (squared); as Lin et al. have it, without weights of classes."""
    plain = functional.binary_cross_entropy_with_logits(logits, wanted, reduction="none")
    each: torch.Tensor = (1 - torch.exp(-plain)) ** 2 * plain
    return each


def missed(logits: torch.Tensor, masks: torch.Tensor) -> torch.Tensor:
    """1 - Dice of each class that is there, so that small things count as much as roads."""
    chance = torch.sigmoid(logits)
    there = masks.sum(dim=(0, 2, 3))
    both = (chance * masks).sum(dim=(0, 2, 3))
    dice = (2 * both + 1) / (chance.sum(dim=(0, 2, 3)) + there + 1)
    mean: torch.Tensor = ((1 - dice) * (there > 0)).sum() / (there > 0).sum().clamp(min=1)
    return mean


def mask_loss(kind: str, logits: torch.Tensor, masks: torch.Tensor) -> torch.Tensor:
    """`dice`: cross entropy and `missed`; `focal`: summed over classes, the mean of cells."""
    if kind == "focal":
        return focal(logits, masks).mean(dim=(0, 2, 3)).sum()
    return functional.binary_cross_entropy_with_logits(logits, masks) + missed(logits, masks)
