"""What egos found, and files of it that `convoy evaluate` reads: boxes as Parquet, masks as archives."""

from __future__ import annotations

import os
import pathlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from convoy_baseline.conditions import Condition
from convoy_baseline.frames import Keyframe
from convoy_baseline.grid import Array, Grid


@dataclass(frozen=True)
class Found:
    """What an ego found under a condition."""

    condition: Condition
    keyframe: Keyframe
    ego: int
    """Which of the keyframe's egos."""
    partners: int
    """How many it heard."""
    boxes: Array
    """(N, 9) in its frame."""
    labels: Array
    scores: Array
    masks: Array
    """(C, H, W) f32, 0 to 1."""
    bytes_heard: int = 0
    """What all its partners sent of this frame."""

    @property
    def agent(self) -> str:
        """The ego's name."""
        return self.keyframe.views[self.keyframe.egos[self.ego]].agent


class Writer:
    """Collects boxes as rows in the world. Where nothing was found, a row without a box says that it was looked for."""

    def __init__(self, classes: Sequence[str]) -> None:
        self.classes = classes
        self.parts: list[pa.Table] = []
        self.heard: dict[str, tuple[int, int, int]] = {}
        """Of each condition: samples, partners and bytes heard."""

    def take(self, found: Found) -> None:
        """Adds them."""
        samples, partners, sent = self.heard.get(found.condition.name, (0, 0, 0))
        self.heard[found.condition.name] = samples + 1, partners + found.partners, sent + found.bytes_heard
        view = found.keyframe.views[found.keyframe.egos[found.ego]]
        boxes = found.boxes.astype(np.float64)
        world = view.world_from_agent
        half = (boxes[:, 6] + np.arctan2(world[1, 0], world[0, 0])) / 2
        count = max(len(boxes), 1)
        nothing = len(boxes) == 0
        columns = {
            "scene": pa.array(np.full(count, found.keyframe.scene, np.uint32)),
            "frame": pa.array(np.full(count, found.keyframe.number, np.uint32)),
            "agent": pa.array([view.agent] * count, pa.string()),
            "mode": pa.array([found.condition.mode] * count, pa.string()),
            "class": pa.array([None] if nothing else [self.classes[label] for label in found.labels], pa.string()),
            "score": pa.array([None] if nothing else found.scores.astype(np.float32), pa.float32()),
            "center_m": lists(boxes[:, :3] @ world[:3, :3].T + world[:3, 3]),
            "size_m": lists(boxes[:, 3:6]),
            "quaternion": lists(np.column_stack([np.cos(half), 0 * half, 0 * half, np.sin(half)])),
            "velocity_mps": lists(np.column_stack([boxes[:, 7:9], 0 * half]) @ world[:3, :3].T),
        }
        self.parts.append(pa.table(columns))

    def write(self, path: pathlib.Path) -> None:
        """Writes them, replacing what is there as a whole."""
        beside = path.with_name(path.name + ".new")
        pq.write_table(pa.concat_tables(self.parts), beside, compression="zstd")
        os.replace(beside, path)


def lists(values: Array) -> pa.Array:
    """A column of rows (N, k); of one that is null where there are none."""
    if not len(values):
        return pa.array([None], pa.list_(pa.float64(), values.shape[1]))
    return pa.FixedSizeListArray.from_arrays(pa.array(np.ascontiguousarray(values).ravel()), values.shape[1])


class MaskWriter:
    """Writes masks as `FOLDER/MODE/SCENE/AGENT.npz`, a scene as soon as the next one begins."""

    def __init__(self, folder: pathlib.Path, grid: Grid, store_cell_m: float) -> None:
        """Cells that are no whole number of the store's become the store's, by their middles."""
        self.folder, self.cell_m = folder, grid.cell_m
        self.source: tuple[Array, Array] | None = None
        ratio = round(grid.cell_m / store_cell_m)
        if ratio < 1 or abs(ratio * store_cell_m - grid.cell_m) > 1e-9 or grid.cells * ratio % 2:
            self.cell_m = store_cell_m
            fine = Grid(2 * int(grid.half_m / store_cell_m + 1e-9), store_cell_m)
            x, y = fine.center_of(*np.mgrid[0 : fine.cells, 0 : fine.cells])
            self.source = grid.cell_of(np.stack([x, y], axis=-1))
        self.scene = -1
        self.kept: dict[tuple[str, str], dict[str, Array]] = {}

    def take(self, found: Found) -> None:
        """Keeps those of an ego."""
        if not len(found.masks):  # Not every model finds masks.
            return
        if found.keyframe.scene != self.scene:
            self.close()
            self.scene = found.keyframe.scene
        masks = found.masks if self.source is None else found.masks[:, self.source[0], self.source[1]]
        of_ego = self.kept.setdefault((found.condition.mode, found.agent), {})
        of_ego[f"{found.keyframe.number:04d}"] = tenths(masks)

    def close(self) -> None:
        """Writes what is kept."""
        for (mode, agent), frames in self.kept.items():
            path = self.folder / mode / f"{self.scene:04d}" / f"{agent}.npz"
            path.parent.mkdir(parents=True, exist_ok=True)
            np.savez_compressed(path, cell_m=np.array(self.cell_m), **frames)  # type: ignore[arg-type]
        self.kept = {}


def tenths(scores: Array) -> Array:
    """Scores as u8 that reach just the same of the thresholds 0.1, 0.2, ..., 0.9: others are never asked for, and few values are small
    files."""
    steps = np.arange(1, 10, dtype=np.float32) / np.float32(10)
    reached = np.searchsorted(steps, scores.astype(np.float32), side="right")
    as_bytes: Array = np.array([0, *(255 * k // 10 + 2 for k in range(1, 10))], np.uint8)[reached]
    return as_bytes
