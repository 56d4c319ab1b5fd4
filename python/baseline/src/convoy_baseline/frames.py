"""Keyframes of a store: pictures of all agents, what each vehicle as an ego has to find, and who is heard by whom."""

from __future__ import annotations

import math
from dataclasses import dataclass

import convoy
import numpy as np
from convoy.samples import flat
from torch.utils.data import Dataset

from convoy_baseline.grid import Array, Grid
from convoy_baseline.pictures import Picture, pictures
from convoy_baseline.raster import rasterise
from convoy_baseline.settings import SENSORS, Settings
from convoy_baseline.sweeps import points

STAGES = ("simulate-and-log", "render-sensors", "bev-gt", "postprocess-valid")
Key = tuple[int, int]
"""Scene, frame."""


@dataclass(frozen=True)
class View:
    """What an agent saw at a moment."""

    agent: str
    raster: Array | None
    """(3, H, W) u8: `rasterise`; None if points are kept."""
    world_from_agent: Array
    pictures: tuple[Picture, ...] = ()
    """Of its cameras, if the model looks through them."""
    points: Array | None = None
    """(N, 5) f32: `sweeps.points`."""

    @property
    def is_rsu(self) -> bool:
        """Whether a road-side unit saw it."""
        return self.agent.startswith("rsu")


@dataclass(frozen=True)
class Truth:
    """What an ego has to find."""

    boxes: Array
    """(N, 9) f32 in its frame."""
    labels: Array
    """(N,) i64, of the model's classes."""
    difficulty: Array
    seen_by_ego: Array
    masks: Array
    """(C, H, W) bool."""
    wide: Wide | None = None
    """Masks as far as the store has them, where views are turned by any angle."""


@dataclass(frozen=True)
class Wide:
    """Masks of more ground than the model looks at."""

    masks: Array
    """(C, h, w) bool."""
    cell_m: float


@dataclass(frozen=True, eq=False)
class Keyframe:
    """A moment of a scene."""

    scene: int
    number: int
    views: tuple[View, ...]
    """Vehicles, then RSUs."""
    egos: tuple[int, ...]
    """Which of the views are those of vehicles."""
    truths: tuple[Truth, ...]
    """One for each ego."""


class Keyframes(Dataset[Keyframe]):
    """All keyframes of a split. Whoever reads without workers keeps what was read once: 50 kB of each agent and 230 kB more of each ego
    at 128 x 128 cells, 86 kB of each picture of 128 x 224 pixels."""

    def __init__(
        self, dataset: convoy.Dataset, split: str, settings: Settings, keep: bool = True, share: float = 1.0
    ) -> None:
        """Of the scenes only a `share` of 1 / n is taken: every n-th, so that all towns are among them."""
        self.dataset, self.settings, self.keep = dataset, settings, keep
        self.keys: list[Key] = []
        for scene in dataset.scenes(split, STAGES)[:: every_nth(share)]:
            step = math.lcm(settings.every, scene.label_every_n_frames)
            self.keys += [(scene.number, frame) for frame in range(0, scene.frames, step)]
        if not self.keys:
            raise convoy.StoreError(
                f"there is no keyframe: split {split}, stages {', '.join(STAGES)}",
                do="`convoy status` says which scenes are finished",
                file=dataset.location,
            )
        self._kept: dict[int, Keyframe] = {}

    def __len__(self) -> int:
        return len(self.keys)

    def __getitem__(self, number: int) -> Keyframe:
        if number not in self._kept:
            keyframe = self._read(*self.keys[number])
            if not self.keep:
                return keyframe
            self._kept[number] = keyframe
        return self._kept[number]

    def classes(self) -> tuple[str, ...]:
        """Names of the masks."""
        scene, frame = self.keys[0]
        moment = self.dataset.scene(scene).frame(frame)
        return moment.agent(moment.agents[0]).bev().classes

    def mask_cell_m(self) -> float:
        """Cells of the store's masks."""
        scene, frame = self.keys[0]
        moment = self.dataset.scene(scene).frame(frame)
        return float(moment.agent(moment.agents[0]).bev().cell_m)

    def present(self) -> Array:
        """(keyframes, K) bool: which of the model's classes have a box in each."""
        found = np.zeros((len(self.keys), len(self.settings.classes)), bool)
        for row, (scene, number) in enumerate(self.keys):
            labels = self.dataset.scene(scene).frame(number).boxes(valid=True).label
            names = {convoy.CLASSES[label] for label in labels if label >= 0}
            found[row] = [name in names for name in self.settings.classes]
        return found

    def views(self, scene: int, number: int) -> tuple[View, ...]:
        """What all agents saw at any frame that has sweeps."""
        frame = self.dataset.scene(scene).frame(number)
        return tuple(self._view(frame.agent(name)) for name in frame.agents)

    def _view(self, agent: convoy.Agent) -> View:
        settings = self.settings
        has_lidar, has_camera = (sensor in settings.sensors for sensor in SENSORS)
        seen = pictures(agent, settings.picture_height, settings.picture_width) if has_camera else ()
        if not has_lidar:
            return View(agent.name, None, agent.pose, seen)
        found = points(agent, settings.sweeps, settings.beams)
        if settings.keeps_points:
            return View(agent.name, None, agent.pose, seen, found)
        return View(agent.name, rasterise(found, settings.grid), agent.pose, seen)

    def _read(self, scene: int, number: int) -> Keyframe:
        views = self.views(scene, number)
        frame = self.dataset.scene(scene).frame(number)
        egos = tuple(i for i, view in enumerate(views) if not view.is_rsu)
        return Keyframe(
            scene, number, views, egos, tuple(truth(frame, views[ego].agent, self.settings) for ego in egos)
        )


def every_nth(share: float) -> int:
    """The n of a share of 1 / n."""
    if not 0 < share <= 1 or abs(1 / share - round(1 / share)) > 1e-6:
        raise ValueError(f"share {share}: expected 1 / n, such as 0.125")
    return round(1 / share)


def truth(frame: convoy.Frame, ego: str, settings: Settings) -> Truth:
    """What the ego has to find: objects that it or anybody in its communication range has seen, whatever the mode. The ego itself is
    one of them only if settings want it."""
    agent = frame.agent(ego)
    boxes = agent.boxes()
    boxes = boxes if settings.itself else boxes[boxes.id != agent.id]
    seen = frame.cooperative(ego, "x2x", settings.comm_range_m, settings.elevation_m).seen_by(boxes.id)
    number = np.array([settings.classes.index(c) if c in settings.classes else -1 for c in (*convoy.CLASSES, "")])
    labels = number[boxes.label]
    kept = seen.any(axis=0) & (labels >= 0)
    local = boxes[kept].transformed(convoy.invert(agent.pose))
    bev = agent.bev()
    masks = coarsened(bev.masks, bev.cell_m, settings.mask_grid)
    wide = Wide(bev.masks, bev.cell_m) if settings.augment == "any" else None
    return Truth(flat(local), labels[kept], local.difficulty, seen[0, kept], masks, wide)


def coarsened(masks: Array, cell_m: float, grid: Grid) -> Array:
    """Masks (C, h, w) of the store in the model's cells: true where more than half of a cell is, or, if they are no whole number of the
    store's, where their middle is. The store's grid must be at least as large."""
    if masks.shape[1] * cell_m < 2 * grid.half_m - 1e-6:
        raise ValueError(
            f"masks of {masks.shape[1]} cells of {cell_m} m do not become {grid.cells} cells of {grid.cell_m} m: choose other ones"
        )
    ratio = round(grid.cell_m / cell_m)
    margin = masks.shape[1] - grid.cells * ratio
    if abs(ratio * cell_m - grid.cell_m) > 1e-9 or ratio < 1 or margin < 0 or margin % 2:
        return sampled(Wide(masks, cell_m), grid, np.eye(4))
    inner = masks[:, margin // 2 : margin // 2 + grid.cells * ratio, margin // 2 : margin // 2 + grid.cells * ratio]
    parts = inner.reshape(len(masks), grid.cells, ratio, grid.cells, ratio)
    more: Array = parts.mean(axis=(2, 4), dtype=np.float32) > 0.5 if ratio > 1 else inner
    return more


def sampled(wide: Wide, grid: Grid, move: Array) -> Array:
    """Masks (C, H, W) on a grid of ground that was moved by a 4 x 4: what is at the middle of each cell; false outside."""
    rows, columns = np.mgrid[0 : grid.cells, 0 : grid.cells]
    x, y = grid.center_of(rows, columns)
    back = np.linalg.inv(move)
    before = np.stack([x, y], axis=-1) @ back[:2, :2].T + back[:2, 3]
    source = Grid(wide.masks.shape[1], wide.cell_m)
    row, column = source.cell_of(before)
    inside = (row >= 0) & (row < source.cells) & (column >= 0) & (column < source.cells)
    last = source.cells - 1
    found: Array = wide.masks[:, row.clip(0, last), column.clip(0, last)] & inside
    return found
