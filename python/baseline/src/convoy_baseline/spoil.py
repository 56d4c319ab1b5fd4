"""Labels made wrong on purpose: what learns from them must score badly, or else the score says nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from convoy_baseline.examples import Spoil
from convoy_baseline.frames import Truth


def shuffled(truth: Truth, draw: np.random.Generator) -> Truth:
    """Boxes stand where no object is: each is turned around the ego by an angle of its own. Masks are turned and mirrored as a whole."""
    angle = draw.uniform(0, 2 * np.pi, len(truth.boxes))
    boxes = truth.boxes.copy()
    boxes[:, 0] = np.cos(angle) * truth.boxes[:, 0] - np.sin(angle) * truth.boxes[:, 1]
    boxes[:, 1] = np.sin(angle) * truth.boxes[:, 0] + np.cos(angle) * truth.boxes[:, 1]
    masks = np.rot90(truth.masks, int(draw.integers(1, 4)), axes=(-2, -1))
    return replace(truth, boxes=boxes, masks=masks)


def mirrored(truth: Truth, draw: np.random.Generator) -> Truth:
    """Left is right: y, yaw and masks, while the points stay as they are."""
    del draw
    boxes = truth.boxes * np.array([1, -1, 1, 1, 1, 1, -1, 1, -1], np.float32)
    return replace(truth, boxes=boxes, masks=truth.masks[..., ::-1])


SPOILS: dict[str, Spoil] = {"shuffled": shuffled, "mirrored": mirrored}
