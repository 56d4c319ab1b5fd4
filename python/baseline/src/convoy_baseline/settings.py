"""What a model is and how it is trained: a TOML file, kept in every checkpoint."""

from __future__ import annotations

import dataclasses
import pathlib
import tomllib
from dataclasses import dataclass
from typing import Any

from convoy import CLASSES, MODES

from convoy_baseline.grid import Grid

FUSIONS = ("max", "axial")
SENSORS = ("lidar", "camera")


@dataclass(frozen=True)
class Settings:
    """Every key has a default: the small benchmark on two cores."""

    cells: int = 128
    """Rows and columns of the ground that is looked at; a multiple of 4."""
    cell_m: float = 0.8
    sensors: tuple[str, ...] = ("lidar",)
    """By which agents see: lidars, cameras, or both."""
    width: int = 16
    """Channels of the first scale."""
    picture_height: int = 128
    picture_width: int = 224
    """To so many pixels pictures are made small; multiples of 8."""
    depth_m: tuple[float, float] = (2.0, 58.0)
    depth_bins: int = 28
    """Between which depths what cameras see is lifted, and in how many steps."""
    fusion: str = "max"
    window: int = 8
    """Of axial attention, in cells of features."""
    heads: int = 4
    classes: tuple[str, ...] = ("car", "truck", "bus")
    """What is found as boxes; masks are of all classes that the store has."""
    every: int = 10
    """Keyframes are frames 0, n, 2 n, ..."""
    comm_range_m: float = 80.0
    elevation_m: float = 4.8
    drop_out: float = 0.5
    """The chance that a partner is not heard, in training."""
    steps: int = 2000
    frames_a_step: int = 1
    """Each with all its vehicles as egos."""
    rate: float = 2e-3
    """Highest learning rate."""
    weight_decay: float = 1e-2
    mask_weight: float = 1.0
    box_weight: float = 0.25

    def __post_init__(self) -> None:
        if unknown := set(self.classes) - set(CLASSES):
            raise ValueError(f"no classes: {', '.join(sorted(unknown))}; expected some of {', '.join(CLASSES)}")
        if self.fusion not in FUSIONS:
            raise ValueError(f"fusion {self.fusion!r}: expected one of {', '.join(FUSIONS)}")
        if not self.sensors or set(self.sensors) - set(SENSORS) or len(set(self.sensors)) < len(self.sensors):
            raise ValueError(f"sensors {self.sensors}: expected one of {', '.join(SENSORS)}, or both")
        if self.picture_height % 8 or self.picture_width % 8 or min(self.picture_height, self.picture_width) < 8:
            raise ValueError("picture_height, picture_width: expected multiples of 8")
        if len(self.depth_m) != 2 or not 0 < self.depth_m[0] < self.depth_m[1] or self.depth_bins < 1:
            raise ValueError("expected depth_m of two ascending depths above 0; depth_bins from 1")
        if self.cells % 4 or self.cells < 4:
            raise ValueError(f"cells {self.cells}: expected a multiple of 4")
        if not 0 <= self.drop_out < 1 or min(self.steps, self.frames_a_step, self.width, self.every) < 1:
            raise ValueError("expected drop_out from 0 to below 1; steps, frames_a_step, width and every from 1")

    @property
    def grid(self) -> Grid:
        """Of the pictures and masks."""
        return Grid(self.cells, self.cell_m)

    @property
    def feature_grid(self) -> Grid:
        """Of features and boxes."""
        return self.grid.coarser(2)


def parse(values: dict[str, Any], source: str) -> Settings:
    """Settings of a table; keys that do not exist are errors."""
    known = {field.name for field in dataclasses.fields(Settings)}
    if unknown := set(values) - known:
        raise ValueError(
            f"{source}: no such keys: {', '.join(sorted(unknown))}; expected some of {', '.join(sorted(known))}"
        )
    values = {name: tuple(value) if isinstance(value, list) else value for name, value in values.items()}
    try:
        return Settings(**values)
    except (TypeError, ValueError) as fault:
        raise ValueError(f"{source}: {fault}") from fault


def read(path: str | pathlib.Path) -> Settings:
    """Settings of the table `[model]` of a file."""
    with open(path, "rb") as file:
        return parse(tomllib.load(file).get("model", {}), str(path))


def check_mode(mode: str) -> str:
    """The mode, if there is such a one."""
    if mode not in MODES:
        raise ValueError(f"mode {mode!r}: expected one of {', '.join(MODES)}")
    return mode
