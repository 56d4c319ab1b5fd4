"""A frame of a scene, and an agent in it."""

from __future__ import annotations

import functools
import io
import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from convoy.boxes import CLASSES, DIFFICULTIES, Boxes
from convoy.errors import StoreError
from convoy.poses import Array, Sensor, rotation_from_rpy, transform

if TYPE_CHECKING:
    from convoy.cooperation import Cooperative
    from convoy.dataset import Scene

_BOX = ["agent", "id", "class", "corners_m", "center_m", "size_m", "rpy_rad", "velocity_mps"]
_SEEN = ["agent", "id", "num_lidar_pts", "num_radar_pts", "valid_flag", "difficulty"]
_NAMES = "a sensor's name is that of its file in sensors/AGENT: see Agent.sensors"


@dataclass(frozen=True)
class Bev:
    """BEV masks: row 0 is ahead, column 0 is left."""

    masks: Array
    """(C, H, W) bool."""
    classes: tuple[str, ...]
    """Names of the C channels."""
    cell_m: float

    def __repr__(self) -> str:
        count, rows, columns = self.masks.shape
        return f"Bev({count} classes, {rows} x {columns} cells of {self.cell_m:g} m)"

    def cell(self, points_agent: Array) -> tuple[Array, Array]:
        """Row and column of places (..., 2 or more) in the agent's frame, x ahead and y left; they may lie outside. Masks turn
        with the agent's yaw alone: on a slope give places that are turned so."""
        half = self.masks.shape[1] / 2
        rows = np.floor(half - points_agent[..., 0] / self.cell_m).astype(np.int64)
        columns = np.floor(self.masks.shape[2] / 2 - points_agent[..., 1] / self.cell_m).astype(np.int64)
        return rows, columns


@dataclass(frozen=True)
class Occupancy:
    """A grid of voxels: axes are forward, left, up."""

    tags: Array
    """(X, Y, Z) u8: semantic tags, 0 is free."""
    origin_m: Array
    """(3,): the corner of cell (0, 0, 0), from the agent's origin along the agent's axes."""
    voxel_m: float

    def __repr__(self) -> str:
        shape = " x ".join(str(cells) for cells in self.tags.shape)
        return f"Occupancy({shape} voxels of {self.voxel_m:g} m)"


@dataclass(frozen=True)
class Camera:
    """A picture, not decoded yet."""

    sensor: Sensor
    encoded: bytes
    """As it is in the table: JPEG (RGB) or PNG."""
    kind: str
    _agent: Agent

    def __repr__(self) -> str:
        about = self.sensor
        return f"Camera({self.kind}-{about.name} of {self._agent.name}, {about.width} x {about.height} pixels)"

    @property
    def intrinsics(self) -> Array:
        """3 x 3."""
        assert self.sensor.intrinsics is not None
        return self.sensor.intrinsics

    @property
    def agent_from_camera(self) -> Array:
        """4 x 4, from the optical frame: x right, y down, z forward."""
        return self.sensor.agent_from_sensor

    def image(self) -> Array:
        """(H, W, 3) u8: red, green, blue. Decoded by Pillow."""
        try:
            from PIL import Image
        except ImportError as fault:
            raise ImportError("pictures are decoded by Pillow: pip install pillow") from fault
        try:
            with Image.open(io.BytesIO(self.encoded)) as picture:
                return np.asarray(picture.convert("RGB"))
        except (OSError, ValueError, SyntaxError) as fault:
            raise self._agent.fault(
                f"is no picture ({fault})", f"{self._agent.frame.scene._files.verify} says what is damaged", f"{self.kind}-{self.sensor.name}"
            ) from fault

    def depth(self) -> Array:
        """(H, W) f64 of kind `DPT`: planar depth, m (of fisheyes along the ray)."""
        self._only("DPT")
        pixels = self.image().astype(np.int64)
        metres: Array = (pixels[..., 0] + (pixels[..., 1] << 8) + (pixels[..., 2] << 16)) * (1000.0 / (2**24 - 1))
        return metres

    def instances(self) -> tuple[Array, Array]:
        """Of kind `IST`: tags (H, W) u8 and object ids (H, W) u16."""
        self._only("IST")
        pixels = self.image()
        return pixels[..., 0], pixels[..., 1].astype(np.uint16) | (pixels[..., 2].astype(np.uint16) << 8)

    def _only(self, kind: str) -> None:
        if self.kind != kind:
            raise ValueError(f"this is a picture of kind {self.kind}: ask for camera(name, {kind!r})")


@dataclass(frozen=True)
class Frame:
    """One moment of a scene."""

    scene: Scene
    number: int

    def __repr__(self) -> str:
        return f"Frame({self.number} of scene {self.scene.number}, {self.time_s:.2f} s, {len(self.agents)} agents)"

    @property
    def time_s(self) -> float:
        """Time since frame 0, s."""
        return self.number * 0.05

    @property
    def agents(self) -> tuple[str, ...]:
        """Vehicles, then RSUs."""
        return self.scene.agents

    def agent(self, name: str) -> Agent:
        """One of them."""
        if name not in self.agents:
            raise self.scene.fault(
                f"it has {', '.join(self.agents)}", "choose one of these", frame=self.number, agent=name
            )
        return Agent(self, name)

    def boxes(self, valid: bool = False) -> Boxes:
        """Boxes of all agents' lists, merged, in the world; only those that somebody saw with `valid`. Counts of points are those
        of all agents."""
        columns = [*_BOX[1:], *_SEEN[2:]]
        table = self._labels("tracks_frames", columns)
        boxes = _boxes(table, table)
        return boxes[boxes.valid] if valid else boxes

    def cooperative(
        self, ego: str, mode: str = "x2x", comm_range_m: float = 80.0, elevation_m: float = 4.8
    ) -> Cooperative:
        """What the ego has with all whom it may hear: `none`, `x2v` (vehicles), `x2i` (RSUs) or `x2x` (both) whose origins are
        within the range (in 3-D) and not farther than the elevation above or below."""
        from convoy.cooperation import cooperate

        return cooperate(self, ego, mode, comm_range_m, elevation_m)

    def plot_bev(
        self, ego: str | None = None, *, radius_m: float = 60.0, lidar: str | None = "LIDAR", ax: Any = None
    ) -> Any:
        """Draws the frame from above by matplotlib, the ego (by default the first agent) in the middle, ahead is up: points
        of all agents, each in its colour, map lines, and boxes by who saw them: the ego, only others, nobody. Lights and
        signs are left out. Without points where `lidar` is None. Gives the axes."""
        from convoy.plots import bev

        return bev(self, ego, radius_m=radius_m, lidar=lidar, ax=ax)

    def _labels(self, table: str, columns: list[str], agent: str | None = None) -> pa.Table:
        every = self.scene.label_every_n_frames
        if self.number % every:
            raise self.scene.fault(
                f"labels are at frames 0, {every}, {2 * every}, ...",
                "choose one of these",
                frame=self.number,
                agent=agent,
            )
        try:
            rows = self.scene._files.at_frame(self.scene.key(f"{table}.parquet"), self.number, columns)
        except StoreError as fault:
            fault.at(frame=self.number, agent=agent)
            raise
        return rows if agent is None else rows.filter(pc.equal(rows["agent"], agent))


@dataclass(frozen=True)
class Agent:
    """A vehicle or RSU at one moment."""

    frame: Frame
    name: str

    def __repr__(self) -> str:
        sensors = len(self.sensors)
        return (
            f"Agent({self.name}, frame {self.frame.number} of scene {self.frame.scene.number}, {sensors} sensor tables)"
        )

    @property
    def id(self) -> int:
        """Its object id."""
        return int(self._state["id"])

    @property
    def is_rsu(self) -> bool:
        """Whether it is a road-side unit."""
        return self.name.startswith("rsu")

    @property
    def pose(self) -> Array:
        """world_from_agent: 4 x 4, f64."""
        found: Array = self._state["pose"][self.frame.number]
        return found

    @property
    def velocity(self) -> Array:
        """(3,) in the world, m/s."""
        found: Array = self._state["velocity"][self.frame.number]
        return found

    @property
    def angular_velocity(self) -> Array:
        """(3,) in the world, rad/s."""
        found: Array = self._state["turning"][self.frame.number]
        return found

    @property
    def sensors(self) -> tuple[str, ...]:
        """Names of its sensors' tables: `LIDAR`, `RGB-CAM_FRONT`, ..."""
        return self.frame.scene._sensors[self.name]

    def sensor(self, name: str) -> Sensor:
        """Where a sensor sits and what it is, by its table's name."""
        files = self.frame.scene._files
        about = self._guard(name, lambda: files.metadata(self._key(name))).get(b"sensor")
        if about is None:
            raise self.fault("its table describes no sensor", _NAMES, name)
        return _parse(about)

    def lidar(self, name: str = "LIDAR") -> Array:
        """A sweep as a structured array (fields x, y, z, intensity, ring, id, tag, ...) in the sensor's frame."""
        return self._readings(name)

    def semantic_lidar(self, name: str = "SEG-LIDAR") -> Array:
        """A sweep without loss and noise, likewise."""
        return self._readings(name)

    def points(self, name: str = "LIDAR", columns: tuple[str, ...] = ("intensity",)) -> Array:
        """(P, 3 + columns) f32: a sweep in the agent's frame, with further columns as they are."""
        return self._points(name, columns, np.eye(4))

    def _points(self, name: str, columns: tuple[str, ...], frame_from_agent: Array) -> Array:
        """The same in another frame."""
        table = self._row(name, ["x", "y", "z", *columns])
        if missing := {"x", "y", "z", *columns} - set(table.column_names):
            raise self.fault(f"has no column {', '.join(sorted(missing))}", "see Agent.lidar().dtype", name)
        points = np.stack([_list(table, column).astype(np.float32) for column in ("x", "y", "z", *columns)], axis=1)
        frame_from_sensor = frame_from_agent @ self.sensor(name).agent_from_sensor
        points[:, :3] = transform(frame_from_sensor, points[:, :3].astype(np.float64))
        return points

    def radar(self, name: str = "RAD_FRONT") -> Array:
        """Returns as a structured array: depth, azimuth, altitude, velocity, ..."""
        return self._readings(name)

    def camera(self, name: str, kind: str = "RGB") -> Camera:
        """A picture of a camera: `RGB`, `SEG`, `IST` or `DPT`."""
        table = self._row(f"{kind}-{name}", ["image"])
        return Camera(self.sensor(f"{kind}-{name}"), table["image"][0].as_py(), kind, self)

    def flow(self, camera: str) -> Array:
        """(H, W, 2) f32: motion to the right and up since the last frame; the picture is 2 units wide and high."""
        table = self._row(f"FLW-{camera}", None)
        shape = (table["height"][0].as_py(), table["width"][0].as_py())
        return np.stack([_list(table, column).astype(np.float32).reshape(shape) for column in ("dx", "dy")], axis=2)

    def gnss(self, name: str = "GNSS") -> dict[str, Any]:
        """A fix."""
        return self._record(f"sensors/{self.name}/{name}", name)

    def imu(self, name: str = "IMU") -> dict[str, Any]:
        """A reading."""
        return self._record(f"sensors/{self.name}/{name}", name)

    def boxes_2d(self) -> list[dict[str, Any]]:
        """Boxes in its pictures, if they were asked for."""
        rows = self._rows(f"sensors/{self.name}/boxes_2d", "boxes_2d")
        return list(rows.to_pylist())

    def hd_map(self) -> dict[str, Any]:
        """The lane that it is in and what comes ahead."""
        names = self.frame.scene._files.parquet(
            self.frame.scene.key("hd_map.parquet"), lambda file: list(file.schema_arrow.names)
        )
        rows = self.frame._labels("hd_map", names, self.name).to_pylist()
        if not rows:
            raise self.fault("it has no map record", f"{self.frame.scene._files.verify} says what is damaged", "hd_map")
        record: dict[str, Any] = rows[0]
        return record

    def boxes(self, valid: bool = False) -> Boxes:
        """Its own list, in the world; `boxes().transformed(invert(agent.pose))` is in its own frame. It holds the agent itself;
        only what its own sensors saw with `valid`."""
        table = self.frame._labels("boxes", _BOX, self.name)
        seen = self.frame._labels("boxes_valid", _SEEN, self.name)
        if table["id"] != seen["id"]:
            raise self.fault(
                "boxes and boxes_valid have other rows", f"{self.frame.scene._files.go_on} makes stale stages again", "boxes"
            )
        boxes = _boxes(table, seen)
        return boxes[boxes.valid] if valid else boxes

    def bev(self, classes: tuple[str, ...] | None = None) -> Bev:
        """Masks of all classes, or of some, in this order."""
        about = self._archive("bev")
        names = tuple(about["classes"])
        masks = self._member("bev")
        if classes is not None:
            if unknown := set(classes) - set(names):
                raise self.fault(
                    f"has no {', '.join(sorted(unknown))}: it has {', '.join(names)}", "choose of these", "bev"
                )
            masks, names = masks[[names.index(name) for name in classes]], classes
        return Bev(masks, names, float(about["cell_m"]))

    def occupancy(self, filled: bool = True) -> Occupancy:
        """Tags of voxels, with the insides of closed objects or without. With `occupancy.sparse` there is one grid, which this
        makes of its list."""
        scene = self.frame.scene
        sparse = scene._files.has(scene.key(f"occupancy_cells/{self.name}.npz"))
        kind = "occupancy_cells" if sparse else "occupancy_filled" if filled else "occupancy"
        about, tags = self._archive(kind), self._member(kind)
        voxel = float(about["voxel_m"])
        if sparse:
            across = round(2 * about["range_m"] / voxel)
            grid = np.zeros((across, across, round((about["upper_m"] - about["lower_m"]) / voxel)), np.uint8)
            grid[tags[:, 0], tags[:, 1], tags[:, 2]] = tags[:, 3]
            tags = grid
        corner = np.array([-about["range_m"], -about["range_m"], about["lower_m"] + about.get("mount_z_m", 0.0)])
        return Occupancy(tags, corner, voxel)

    def array(self, kind: str) -> Array:
        """Any other array of docs/schema.md: `bev_ids`, `occupancy_flow`, ..."""
        return self._member(kind)

    def plot_cameras(self, names: list[str] | None = None, *, reach_m: float = 60.0, axes: Any = None) -> Any:
        """Draws its colour images by matplotlib, with boxes up to `reach_m` away that it saw, and in another colour those
        that only others saw: these are hidden from it. Gives the axes."""
        from convoy.plots import cameras

        return cameras(self, names, reach_m=reach_m, axes=axes)

    def fault(self, what: str, do: str, sensor: str | None = None) -> StoreError:
        """A fault at this agent and frame."""
        return self.frame.scene.fault(what, do, frame=self.frame.number, agent=self.name, sensor=sensor)

    @property
    def _state(self) -> Mapping[str, Array]:
        return self.frame.scene._poses[self.name]

    def _key(self, name: str) -> str:
        return self.frame.scene.key(f"sensors/{self.name}/{name}.parquet")

    def _row(self, name: str, columns: list[str] | None) -> pa.Table:
        about = self.sensor(name)
        index = self._index(about.every_n_frames, name)
        if columns is not None:
            # What a lidar has depends on its settings.
            known = self._guard(
                name,
                lambda: self.frame.scene._files.parquet(self._key(name), lambda file: set(file.schema_arrow.names)),
            )
            columns = [column for column in columns if column in known]
        return self._guard(name, lambda: self.frame.scene._files.row(self._key(name), index, columns))

    def _readings(self, name: str) -> Array:
        table = self._row(name, None)
        lists = [n for n in table.column_names if pa.types.is_list(table.schema.field(n).type)]
        columns = {column: _list(table, column) for column in lists}
        if not columns:
            raise self.fault("is no table of points", _NAMES, name)
        count = len(next(iter(columns.values())))
        points = np.empty(count, dtype=[(column, values.dtype) for column, values in columns.items()])
        for column, values in columns.items():
            points[column] = values
        return points

    def _record(self, table: str, sensor: str) -> dict[str, Any]:
        self._index(self.sensor(sensor).every_n_frames, sensor)
        rows = self._rows(table, sensor).to_pylist()
        if not rows:
            raise self.fault("has no row of this frame", f"{self.frame.scene._files.verify} says what is damaged", sensor)
        record: dict[str, Any] = rows[0]
        return record

    def _rows(self, table: str, sensor: str) -> pa.Table:
        files, key = self.frame.scene._files, self.frame.scene.key(f"{table}.parquet")

        def read() -> pa.Table:
            names = files.parquet(key, lambda file: list(file.schema_arrow.names))
            return files.at_frame(key, self.frame.number, names)

        return self._guard(sensor, read)

    def _archive(self, kind: str) -> dict[str, Any]:
        files, key = self.frame.scene._files, self.frame.scene.key(f"{kind}/{self.name}.npz")
        about: dict[str, Any] = self._guard(kind, lambda: files.comment(key))
        return about

    def _member(self, kind: str) -> Array:
        self._index(int(self._archive(kind).get("every_n_frames", 1)), kind)
        files, key = self.frame.scene._files, self.frame.scene.key(f"{kind}/{self.name}.npz")
        array: Array = self._guard(kind, lambda: files.member(key, self.frame.number))
        return array

    def _index(self, every: int, sensor: str) -> int:
        index, rest = divmod(self.frame.number, every)
        if rest:
            raise self.fault(f"it is at frames 0, {every}, {2 * every}, ...", "choose one of these", sensor)
        return index

    def _guard(self, sensor: str, read: Any) -> Any:
        try:
            return read()
        except StoreError as fault:
            fault.at(frame=self.frame.number, agent=self.name, sensor=sensor)
            raise


@functools.lru_cache(maxsize=4096)
def _parse(about: bytes) -> Sensor:
    return Sensor.parse(json.loads(about))


def _list(table: pa.Table, column: str) -> Array:
    """The list of a table's one row."""
    values: Array = table[column].combine_chunks().values.to_numpy(zero_copy_only=False)
    return values


def _stack(table: pa.Table, column: str, width: int) -> Array:
    """Lists of equal length as rows."""
    if table.num_rows == 0:
        return np.zeros((0, width))
    rows: Array = pc.list_flatten(table[column]).to_numpy().astype(np.float64).reshape(-1, width)
    return rows


@functools.cache
def _value_set(names: tuple[str, ...]) -> pa.Array:
    """Made once: `pa.array` looks for pandas each time."""
    return pa.array(names)


def _index_of(table: pa.Table, column: str, names: tuple[str, ...]) -> Array:
    found: Array = pc.fill_null(pc.index_in(table[column], value_set=_value_set(names)), -1).to_numpy().astype(np.int64)
    return found


def _boxes(table: pa.Table, seen: pa.Table) -> Boxes:
    count = {name: seen[name].to_numpy().astype(np.int64) for name in ("num_lidar_pts", "num_radar_pts")}
    return Boxes(
        id=table["id"].to_numpy(),
        label=_index_of(table, "class", CLASSES),
        center=_stack(table, "center_m", 3),
        size=_stack(table, "size_m", 3),
        rotation=rotation_from_rpy(_stack(table, "rpy_rad", 3)),
        corners=_stack(table, "corners_m", 24).reshape(-1, 8, 3),
        velocity=_stack(table, "velocity_mps", 3),
        num_lidar_pts=count["num_lidar_pts"],
        num_radar_pts=count["num_radar_pts"],
        valid=seen["valid_flag"].to_numpy(zero_copy_only=False).astype(bool),
        difficulty=_index_of(seen, "difficulty", DIFFICULTIES),
    )
