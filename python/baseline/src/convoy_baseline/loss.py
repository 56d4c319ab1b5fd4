"""How wrong a model is."""

from __future__ import annotations

import torch
from torch.nn import functional

from convoy_baseline.examples import Targets
from convoy_baseline.settings import Settings


def loss(
    heat: torch.Tensor, numbers: torch.Tensor, masks: torch.Tensor, targets: Targets, settings: Settings
) -> dict[str, torch.Tensor]:
    """Parts of it, and `all` of them weighted, of what `Model` says."""
    parts = {
        "heat": focal(heat, targets.heat),
        "boxes": off(numbers, targets),
        "masks": functional.binary_cross_entropy_with_logits(masks, targets.masks) + missed(masks, targets.masks),
    }
    parts["all"] = parts["heat"] + settings.box_weight * parts["boxes"] + settings.mask_weight * parts["masks"]
    return parts


def focal(logits: torch.Tensor, heat: torch.Tensor) -> torch.Tensor:
    """Of heat maps, per object: cells that are easy count less (squared), and so do those beside a peak (to the fourth)."""
    chance = torch.sigmoid(logits)
    peak = heat == 1
    found = (1 - chance) ** 2 * functional.logsigmoid(logits)
    empty = (1 - heat) ** 4 * chance**2 * functional.logsigmoid(-logits)
    return -torch.where(peak, found, empty).sum() / peak.sum().clamp(min=1)


def off(numbers: torch.Tensor, targets: Targets) -> torch.Tensor:
    """Mean distance of the numbers at the cells of objects, summed over numbers; velocity counts a tenth."""
    if not len(targets.box_cell):
        return numbers.sum() * 0
    said = numbers.flatten(2)[targets.box_ego, :, targets.box_cell]
    apart = (said - targets.box_numbers).abs()
    return apart[:, :8].sum(dim=1).mean() + 0.1 * apart[:, 8:].sum(dim=1).mean()


def missed(logits: torch.Tensor, masks: torch.Tensor) -> torch.Tensor:
    """1 - Dice of each class that is there, so that small things count as much as roads."""
    chance = torch.sigmoid(logits)
    there = masks.sum(dim=(0, 2, 3))
    both = (chance * masks).sum(dim=(0, 2, 3))
    dice = (2 * both + 1) / (chance.sum(dim=(0, 2, 3)) + there + 1)
    mean: torch.Tensor = ((1 - dice) * (there > 0)).sum() / (there > 0).sum().clamp(min=1)
    return mean
