"""Boxes as heat maps and numbers beside their peaks, and back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from torch.nn import functional

from convoy_baseline.grid import Array, Grid

NUMBERS = 10
"""dx, dy (cells, from the cell's middle), z (m), log of length, width and height, sine and cosine of the yaw, velocity x, y (m/s)."""


@dataclass(frozen=True)
class Peaks:
    """What is to be found in one ego's grid."""

    heat: Array
    """(K, h, w) f32: 1 at the cell of an object's centre, less around it."""
    cell: Array
    """(N,) i64: the cells of the objects, row by row."""
    labels: Array
    """(N,) i64: their classes."""
    numbers: Array
    """(N, NUMBERS) f32: their boxes."""


def encode(boxes: Array, labels: Array, classes: int, grid: Grid) -> Peaks:
    """Of boxes (N, 9) in the ego's frame, as `convoy.DetectionSamples` has them; those whose centres are outside are left out."""
    inside = grid.has(boxes)
    boxes, labels = boxes[inside].astype(np.float64), labels[inside]
    rows, columns = grid.cell_of(boxes)
    x, y = grid.center_of(rows, columns)
    numbers = np.column_stack(
        [
            (boxes[:, 0] - x) / grid.cell_m,
            (boxes[:, 1] - y) / grid.cell_m,
            boxes[:, 2],
            np.log(boxes[:, 3:6]),
            np.sin(boxes[:, 6]),
            np.cos(boxes[:, 6]),
            boxes[:, 7:9],
        ]
    )
    heat = np.zeros((classes, grid.cells, grid.cells), np.float32)
    spread = np.maximum(np.sqrt(boxes[:, 3] * boxes[:, 4]) / grid.cell_m / 4, 0.6)
    for row, column, label, sigma in zip(rows, columns, labels, spread, strict=True):
        reach = int(np.ceil(3 * sigma))
        top, left = max(row - reach, 0), max(column - reach, 0)
        patch = heat[label, top : row + reach + 1, left : column + reach + 1]
        down, right = np.ogrid[top - row : top - row + patch.shape[0], left - column : left - column + patch.shape[1]]
        np.maximum(patch, np.exp(-(down**2 + right**2) / (2 * sigma**2)), out=patch)
    return Peaks(heat, rows * grid.cells + columns, labels, numbers.astype(np.float32))


def decode(
    heat: torch.Tensor, numbers: torch.Tensor, grid: Grid, most: int, least_score: float
) -> tuple[Array, Array, Array]:
    """Boxes (N, 9) in the ego's frame, labels (N,), scores (N,), the surest first, of one ego's heat map (K, h, w; 0 to 1) and
    numbers (NUMBERS, h, w). Peaks are cells that no neighbour surpasses; of two of a class that stand in one another, the surer."""
    highest = functional.max_pool2d(heat[None], 3, stride=1, padding=1)[0]
    peaks = torch.where(heat == highest, heat, torch.zeros_like(heat)).flatten()
    score, index = (part.cpu().numpy() for part in peaks.topk(min(most, peaks.numel())))
    score, index = score[score >= least_score], index[score >= least_score]
    label, cell = np.divmod(index, grid.cells**2)
    found = numbers.flatten(1)[:, torch.from_numpy(cell).to(numbers.device)].T.double().cpu().numpy()
    boxes = boxes_at(cell, found, grid)
    kept = apart(boxes, label)
    return boxes[kept], label[kept], score[kept]


def boxes_at(cell: Array, numbers: Array, grid: Grid) -> Array:
    """Boxes (N, 9) of numbers (N, NUMBERS) that are said of cells (N,)."""
    x, y = grid.center_of(*np.divmod(cell, grid.cells))
    return np.column_stack(
        [
            x + numbers[:, 0] * grid.cell_m,
            y + numbers[:, 1] * grid.cell_m,
            numbers[:, 2],
            np.exp(np.clip(numbers[:, 3:6], -3, 4)),
            np.arctan2(numbers[:, 6], numbers[:, 7]),
            numbers[:, 8:10],
        ]
    )


def apart(boxes: Array, label: Array) -> Array:
    """Indices of boxes whose centres keep half a width's distance from all surer ones of their class."""
    kept: list[int] = []
    for i in range(len(boxes)):
        rivals = [k for k in kept if label[k] == label[i]]
        distance = np.linalg.norm(boxes[rivals, :2] - boxes[i, :2], axis=1)
        if not (distance < np.maximum(boxes[rivals, 4], boxes[i, 4]) / 2).any():
            kept.append(i)
    return np.array(kept, dtype=np.int64)
