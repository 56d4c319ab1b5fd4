"""Labels made wrong on purpose: what learns from them must score badly, or else the score says nothing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from convoy_baseline.examples import Spoil
from convoy_baseline.frames import Truth
from convoy_baseline.grid import Array


def shuffled(truth: Truth, draw: np.random.Generator) -> Truth:
    """Boxes stand where no object is: each is turned around the ego by an angle of its own. Masks are turned and mirrored as a whole."""
    angle = draw.uniform(0, 2 * np.pi, len(truth.boxes))
    boxes = truth.boxes.copy()
    boxes[:, 0] = np.cos(angle) * truth.boxes[:, 0] - np.sin(angle) * truth.boxes[:, 1]
    boxes[:, 1] = np.sin(angle) * truth.boxes[:, 0] + np.cos(angle) * truth.boxes[:, 1]
    turns = int(draw.integers(1, 4))
    return _with_masks(replace(truth, boxes=boxes), lambda masks: np.rot90(masks, turns, axes=(-2, -1)))


def mirrored(truth: Truth, draw: np.random.Generator) -> Truth:
    """Left is right: y, yaw and masks, while the points stay as they are."""
    del draw
    boxes = truth.boxes * np.array([1, -1, 1, 1, 1, 1, -1, 1, -1], np.float32)
    return _with_masks(replace(truth, boxes=boxes), lambda masks: masks[..., ::-1])


def _with_masks(truth: Truth, change: Callable[[Array], Array]) -> Truth:
    wide = None if truth.wide is None else replace(truth.wide, masks=change(truth.wide.masks))
    return replace(truth, masks=change(truth.masks), wide=wide)


SPOILS: dict[str, Spoil] = {"shuffled": shuffled, "mirrored": mirrored}
