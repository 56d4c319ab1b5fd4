"""What a model is and how it is trained: a TOML file, kept in every checkpoint. Every key has a default: those of the smallest model."""

from __future__ import annotations

import dataclasses
import pathlib
import tomllib
from dataclasses import dataclass
from typing import Any

from convoy import CLASSES, MODES

from convoy_baseline.grid import Grid

CHOICES = {
    "fusion": ("max", "axial"),
    "cooperation": ("features", "early", "late"),
    "lidar_encoder": ("raster", "pillar", "voxel"),
    "picture_encoder": ("plain", "residual", "swin_t"),
    "decoder": ("plain", "pyramid"),
    "box_head": ("peaks", "queries"),
    "mask_loss": ("dice", "focal"),
    "augment": ("quarters", "any"),
}
SENSORS = ("lidar", "camera")
TASKS = ("boxes", "masks")
STRIDES = {"raster": 2, "pillar": 2, "voxel": 8}
"""How many cells of a lidar encoder become one of its features, along either side."""


@dataclass(frozen=True)
class GroundSettings:
    """Which ground is looked at."""

    cells: int = 128
    """Rows and columns of the ground that is looked at, as the lidar encoder divides it; a multiple of 4, of 16 for `voxel`."""
    cell_m: float = 0.8
    mask_cells: int = 0
    mask_cell_m: float = 0.0
    """Masks' own grid; 0 for both: `cells` and `cell_m`."""


@dataclass(frozen=True)
class SensorSettings:
    """What is seen."""

    sensors: tuple[str, ...] = ("lidar",)
    """By which agents see: lidars, cameras, or both."""
    beams: int = 0
    """To about so many beams lidars are thinned; 0: all."""
    sweeps: int = 0
    """How many earlier sweeps of the same agent are added, with their age."""
    sweeps_drawn: int = 0
    """How many of these, drawn at random, a step of training has; 0: all."""
    picture_height: int = 128
    picture_width: int = 224
    """To so many pixels pictures are made small; multiples of 8, of 32 for `residual` and `swin_t`."""


@dataclass(frozen=True)
class EncoderSettings:
    """What becomes features, and how."""

    width: int = 16
    """Channels of the first scale of `raster`, `pillar`, `plain` and `residual`."""
    lidar_encoder: str = "raster"
    height_m: tuple[float, float] = (-3.0, 5.0)
    """Which heights above the agent's origin points of pillars and voxels have."""
    cell_points: int = 10
    """How many points of a voxel count; of a pillar, which is as high as all, eight times as many."""
    voxel_height_m: float = 0.2
    voxel_channels: tuple[int, ...] = (16, 32, 64, 128)
    pillar_channels: int = 64
    picture_encoder: str = "plain"
    picture_channels: int = 256
    """Of the pyramid of `swin_t`."""
    picture_weights: str = ""
    """A file with weights of torchvision's Swin-T to begin with."""
    depth_m: tuple[float, float] = (2.0, 58.0)
    depth_bins: int = 28
    """Between which depths what cameras see is lifted, and in how many steps."""
    camera_channels: int = 0
    """Of what is lifted; 0: 2 x `width`."""
    channels: int = 0
    """Of lidar and cameras joined; 0: 2 x `width`."""


@dataclass(frozen=True)
class CooperationSettings:
    """Who is heard, and what they say."""

    cooperation: str = "features"
    """What partners send: `features`, points (`early`), or boxes (`late`)."""
    fusion: str = "max"
    """Of features: the greatest (CoopDet3D), or attention and then the greatest (CoBEVFusion)."""
    window: int = 8
    """Of axial attention, in cells of features."""
    heads: int = 4
    comm_range_m: float = 80.0
    elevation_m: float = 4.8
    drop_out: float = 0.5
    """The chance that a partner is not heard, in training."""


@dataclass(frozen=True)
class HeadSettings:
    """What is found."""

    tasks: tuple[str, ...] = TASKS
    classes: tuple[str, ...] = ("car", "truck", "bus")
    """What is found as boxes; masks are of all classes that the store has."""
    decoder: str = "plain"
    decoder_channels: tuple[int, ...] = (128, 256)
    pyramid_channels: int = 512
    """Of `pyramid`: two stages of convolutions, then both brought to one resolution."""
    box_head: str = "peaks"
    query_count: int = 200
    query_channels: int = 128
    """Of `queries`: so many peaks ask all cells once more (TransFusion)."""
    mask_channels: int = 0
    """0: `width`."""
    mask_loss: str = "dice"


@dataclass(frozen=True)
class TrainingSettings:
    """How it is learnt."""

    every: int = 10
    """Keyframes are frames 0, n, 2 n, ..."""
    itself: bool = False
    """Whether the ego itself is to be found where others have seen it, as SimBEV2X's metrics want it."""
    steps: int = 2000
    frames_a_step: int = 1
    """Each with all its vehicles as egos."""
    rate: float = 2e-3
    """Highest learning rate."""
    weight_decay: float = 1e-2
    average: float = 0.0
    """Of weights: how much of the average stays at each step; 0: none, the last weights predict."""
    balanced: bool = False
    """Whether keyframes are drawn so that each class is as frequent as the others."""
    augment: str = "quarters"
    """By which turns views are moved: quarters, which leave rasters exact, or any within `turn_deg`, with `scale` and `shift_m`."""
    turn_deg: float = 45.0
    scale: tuple[float, float] = (0.9, 1.1)
    shift_m: float = 0.5
    """Standard deviation, of x and y."""
    picture_scale: tuple[float, float] = (1.0, 1.0)
    picture_turn_deg: float = 0.0
    """Pictures are zoomed and turned about their middles at random, their intrinsics with them."""
    mask_weight: float = 1.0
    box_weight: float = 0.25


@dataclass(frozen=True)
class Settings(TrainingSettings, HeadSettings, CooperationSettings, EncoderSettings, SensorSettings, GroundSettings):
    """All of it."""

    def __post_init__(self) -> None:
        for name, choices in CHOICES.items():
            if getattr(self, name) not in choices:
                raise ValueError(f"{name} {getattr(self, name)!r}: expected one of {', '.join(choices)}")
        for name, chosen, known in (("sensors", self.sensors, SENSORS), ("tasks", self.tasks, TASKS)):
            if not chosen or set(chosen) - set(known) or len(set(chosen)) < len(chosen):
                raise ValueError(f"{name} {chosen}: expected one of {', '.join(known)}, or both")
        if unknown := set(self.classes) - set(CLASSES):
            raise ValueError(f"no classes: {', '.join(sorted(unknown))}; expected some of {', '.join(CLASSES)}")
        self._check_sizes()
        if self.cooperation == "early" and self.sensors != ("lidar",):
            raise ValueError('cooperation "early": expected sensors = ["lidar"], as partners send points')
        if self.cooperation == "late" and "boxes" not in self.tasks:
            raise ValueError('cooperation "late": expected boxes among the tasks, as partners send them')

    def _check_sizes(self) -> None:
        pixels = 8 if self.picture_encoder == "plain" else 32
        if (
            self.picture_height % pixels
            or self.picture_width % pixels
            or min(self.picture_height, self.picture_width) < 8
        ):
            raise ValueError(f"picture_height, picture_width: expected multiples of {pixels}")
        for name in ("depth_m", "height_m", "scale", "picture_scale"):
            values = getattr(self, name)
            if len(values) != 2 or values[0] > values[1] or (name != "height_m" and values[0] <= 0):
                raise ValueError(f"{name} {values}: expected two ascending numbers, above 0 unless they are heights")
        if self.depth_bins < 1 or self.depth_m[0] == self.depth_m[1]:
            raise ValueError("expected depth_m of two depths that differ; depth_bins from 1")
        block = 2 * self.stride
        if self.cells % block or self.cells < block:
            raise ValueError(f"cells {self.cells}: expected a multiple of {block}")
        if (self.mask_cells > 0) != (self.mask_cell_m > 0):
            raise ValueError("expected both mask_cells and mask_cell_m, or neither")
        if len(self.voxel_channels) != 4 or len(self.decoder_channels) != 2 or self.pyramid_channels % 2:
            raise ValueError("expected four voxel_channels, two decoder_channels, and pyramid_channels that are even")
        if self.lidar_encoder == "voxel" and round((self.height_m[1] - self.height_m[0]) / self.voxel_height_m) < 38:
            raise ValueError("height_m, voxel_height_m: expected 38 voxels above one another or more")
        if not 0 <= self.drop_out < 1 or not 0 <= self.average < 1:
            raise ValueError("expected drop_out and average from 0 to below 1")
        counts = ("steps", "frames_a_step", "width", "every", "cell_points", "query_count", "window", "heads")
        if min(getattr(self, name) for name in counts) < 1:
            raise ValueError(f"expected {', '.join(counts)} from 1")
        if min(self.beams, self.sweeps, self.sweeps_drawn) < 0 or self.sweeps_drawn > self.sweeps:
            raise ValueError("expected beams and sweeps from 0, and sweeps_drawn not above sweeps")
        if self.fusion == "axial" and self.fused_channels % self.heads:
            raise ValueError(f"heads {self.heads}: expected a divisor of {self.fused_channels} channels")

    @property
    def stride(self) -> int:
        """From `cells` to features; 2 where cameras are alone."""
        return STRIDES[self.lidar_encoder] if "lidar" in self.sensors else 2

    @property
    def grid(self) -> Grid:
        """Of rasters, pillars or voxels."""
        return Grid(self.cells, self.cell_m)

    @property
    def feature_grid(self) -> Grid:
        """Of features and boxes."""
        return self.grid.coarser(self.stride)

    @property
    def mask_grid(self) -> Grid:
        """Of masks."""
        return Grid(self.mask_cells, self.mask_cell_m) if self.mask_cells else self.grid

    @property
    def lidar_channels(self) -> int:
        """Of what a lidar saw; those of two heights of voxels are stacked."""
        return 2 * self.voxel_channels[-1] if self.lidar_encoder == "voxel" else 2 * self.width

    @property
    def lifted_channels(self) -> int:
        """Of what cameras saw."""
        return self.camera_channels or 2 * self.width

    @property
    def fused_channels(self) -> int:
        """Of what an agent saw, and sends."""
        if len(self.sensors) > 1:
            return self.channels or 2 * self.width
        return self.lidar_channels if self.sensors == ("lidar",) else self.lifted_channels

    @property
    def keeps_points(self) -> bool:
        """Whether points are needed in a step, not rasters that were made before."""
        plain = self.lidar_encoder == "raster" and self.augment == "quarters" and self.cooperation != "early"
        return "lidar" in self.sensors and not (plain and not self.sweeps)


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
    """Settings of the table `[model]` of a file, over those of its `base`."""
    return read_with_mode(path)[0]


def read_with_mode(path: str | pathlib.Path) -> tuple[Settings, str | None]:
    """The same, and the `mode` that the file says a model is to learn in."""
    table = _layered(pathlib.Path(path), ())
    mode = table.get("mode")
    return parse(table.get("model", {}), str(path)), None if mode is None else check_mode(str(mode))


def _layered(path: pathlib.Path, above: tuple[pathlib.Path, ...]) -> dict[str, Any]:
    if path.resolve() in above:
        raise ValueError(f"{path}: base is a circle: expected a file that does not lead back here")
    with open(path, "rb") as file:
        try:
            table = tomllib.load(file)
        except tomllib.TOMLDecodeError as fault:
            raise ValueError(f"{path}: {fault}") from fault
    if unknown := set(table) - {"base", "mode", "model"}:
        raise ValueError(f"{path}: no such keys: {', '.join(sorted(unknown))}; expected base, mode or [model]")
    if "base" not in table:
        return table
    below = _layered(path.parent / str(table.pop("base")), (*above, path.resolve()))
    return {**below, **table, "model": {**below.get("model", {}), **table.get("model", {})}}


def check_mode(mode: str) -> str:
    """The mode, if there is such a one."""
    if mode not in MODES:
        raise ValueError(f"mode {mode!r}: expected one of {', '.join(MODES)}")
    return mode
