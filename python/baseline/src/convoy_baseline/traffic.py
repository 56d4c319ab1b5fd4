"""What goes over the air: bytes that a partner sends of a frame, and boxes of partners among an ego's own."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from convoy_baseline.augment import moved_boxes
from convoy_baseline.batch import Link
from convoy_baseline.examples import points_of
from convoy_baseline.frames import View
from convoy_baseline.grid import Array, Grid
from convoy_baseline.settings import Settings
from convoy_baseline.targets import apart

FEATURE_BYTES = 2
POINT_BYTES, AGED_POINT_BYTES = 16, 20
BOX_BYTES = 9 * 4 + 4 + 1
"""Features as f16, each cell and channel; points as f32 x, y, z, intensity, and age if there are earlier sweeps; boxes as nine f32, a
score and a class. Nothing is compressed."""
ITSELF_M = 1.5
"""What partners find so near the ego's origin is the ego."""

Boxes = tuple[Array, Array, Array]
"""Boxes (N, 9), labels and scores."""


def bytes_of(settings: Settings, view: View, boxes: Boxes | None) -> int:
    """What a partner sends that saw a view, and found boxes in it."""
    if settings.cooperation == "late":
        return BOX_BYTES * (0 if boxes is None else len(boxes[0]))
    if settings.cooperation == "early":
        return len(points_of(view)) * (AGED_POINT_BYTES if settings.sweeps else POINT_BYTES)
    return FEATURE_BYTES * settings.fused_channels * settings.feature_grid.cells**2


def together(own: Boxes, heard: Sequence[tuple[Link, Boxes]], grid: Grid, most: int) -> Boxes:
    """An ego's boxes and those of partners in its frame, without the ego itself; of two of a class that stand in one another, the surer."""
    parts = [own]
    for link, (boxes, labels, scores) in heard:
        here = moved_boxes(boxes, link.ego_from_view)
        kept = grid.has(here) & (np.linalg.norm(here[:, :2], axis=1) > ITSELF_M)
        parts.append((here[kept], labels[kept], scores[kept]))
    boxes, labels, scores = (np.concatenate(part) for part in zip(*parts, strict=True))
    surest = np.argsort(-scores, kind="stable")
    kept = surest[apart(boxes[surest], labels[surest])][:most]
    return boxes[kept], labels[kept], scores[kept]
