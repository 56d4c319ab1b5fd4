"""How wrong a model is."""

from __future__ import annotations

import torch

from convoy_baseline.examples import Targets
from convoy_baseline.heads.losses import mask_loss
from convoy_baseline.model import Model, Said
from convoy_baseline.settings import Settings


def loss(model: Model, said: Said, targets: Targets, settings: Settings) -> dict[str, torch.Tensor]:
    """Parts of it, and `all` of them weighted, of what a model says."""
    parts: dict[str, torch.Tensor] = {}
    if model.boxes is not None:
        parts |= model.boxes.loss(said.boxes, targets)
    if said.masks is not None:
        parts["masks"] = mask_loss(settings.mask_loss, said.masks, targets.masks)
    weights = {"boxes": settings.box_weight, "masks": settings.mask_weight}
    parts["all"] = torch.stack([weights.get(name, 1.0) * part for name, part in parts.items()]).sum()
    return parts
