"""What other people's trainers found, as predictions that `convoy evaluate` reads.

`python -m convoy.results kitti vehicle_0=FOLDER --store STORE --out predictions.parquet`
"""

from __future__ import annotations

import argparse
import math
import os
import pathlib
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from convoy.boxes import CLASSES
from convoy.cooperation import MODES
from convoy.dataset import Dataset
from convoy.errors import StoreError
from convoy.frame import Agent
from convoy.poses import Array, quaternion, rotation_from_rpy, transform

# Names of KITTI's labels; vans are trucks in a store. Of the others nobody knows the class.
_KITTI = {
    "Car": "car",
    "Van": "truck",
    "Truck": "truck",
    "Pedestrian": "pedestrian",
    "Person_sitting": "pedestrian",
    "Cyclist": "bicycle",
}
_KITTI_OTHERS = {"Misc", "Tram", "DontCare"}
# A scene has as many numbers in the names of KITTI's frames.
_SCENE = 1000
_ROWS = pa.schema(
    [
        ("scene", pa.uint32()),
        ("frame", pa.uint32()),
        ("agent", pa.string()),
        ("mode", pa.string()),
        ("class", pa.string()),
        ("score", pa.float64()),
        ("center_m", pa.list_(pa.float64(), 3)),
        ("size_m", pa.list_(pa.float64(), 3)),
        ("quaternion", pa.list_(pa.float64(), 4)),
        ("velocity_mps", pa.list_(pa.float64(), 3)),
    ]
)


class Predictions:
    """Boxes that a model found, frame by frame, put into the world; mode says with whom it worked together (`MODES`)."""

    def __init__(self, store: Dataset | str | os.PathLike[str], *, mode: str = "none") -> None:
        self.dataset = Dataset(store) if isinstance(store, str | os.PathLike) else store
        if mode not in MODES:
            raise ValueError(f"there is no mode {mode}: there are {', '.join(MODES)}")
        self.mode = mode
        self.rows: list[dict[str, Any]] = []
        self._samples: set[tuple[int, int, str]] = set()

    def __repr__(self) -> str:
        boxes = sum(row["score"] is not None for row in self.rows)
        return f"Predictions({boxes} boxes in {len(self._samples)} samples, mode {self.mode})"

    def add(
        self,
        scene: int,
        frame: int,
        agent: str,
        classes: Sequence[str],
        scores: npt.ArrayLike,
        boxes: npt.ArrayLike,
        *,
        sensor: str | None = None,
        velocities: npt.ArrayLike | None = None,
    ) -> None:
        """A sample of an ego: boxes (n, 7) of x, y, z of the middle, length, width, height, yaw, and velocities (n, 2 or 3) along
        the axes of the ego's frame, or of that of one of its sensors (`LIDAR`). No box is a sample in which nothing was found."""
        ego = self._agent(scene, frame, agent)
        frame_from_box = np.asarray(boxes, dtype=np.float64).reshape(-1, 7)
        turns = rotation_from_rpy(frame_from_box[:, 6:] * [0, 0, 1])
        world_from_frame = ego.pose if sensor is None else ego.pose @ ego.sensor(sensor).agent_from_sensor
        moving = None
        if velocities is not None:
            along = np.asarray(velocities, dtype=np.float64)
            along = np.pad(along.reshape(len(frame_from_box), -1), ((0, 0), (0, 3 - along.shape[-1])))
            moving = along @ world_from_frame[:3, :3].T
        places = (frame_from_box[:, :3], turns, frame_from_box[:, 3:6])
        self._put(ego, world_from_frame, classes, np.asarray(scores, dtype=np.float64), places, moving)

    def add_opv2v(
        self,
        scene: int,
        frame: int,
        agent: str,
        scores: npt.ArrayLike,
        corners: npt.ArrayLike,
        *,
        classes: Sequence[str] | None = None,
        lidar: str = "LIDAR",
    ) -> None:
        """A sample in the frame of OPV2V's loaders: corners (n, 8, 3) in the ego's lidar frame with y to the right, of upright boxes,
        in any order. Corners do not say which end is the front: headings may be the opposite of what was meant, which AP by overlap
        does not see. All are cars where no classes are given."""
        ego = self._agent(scene, frame, agent)
        ours = np.asarray(corners, dtype=np.float64).reshape(-1, 8, 3) * [1, -1, 1]
        boxes = np.array([_upright(box) for box in ours]).reshape(-1, 7)
        self.add(scene, frame, ego.name, classes or ["car"] * len(boxes), scores, boxes, sensor=lidar)

    def add_kitti(
        self,
        folder: str | os.PathLike[str],
        agent: str,
        *,
        camera: str = "CAM_FRONT",
        lidar: str = "LIDAR",
        every: int = 1,
    ) -> Counter[str]:
        """A folder of results in KITTI's form, NNNNNN.txt of lines with a score at the end, of an agent of an export; camera, lidar
        and every are those that the export was made with. Returns how many boxes of classes were left out that a store has not."""
        skipped: Counter[str] = Counter()
        paths = sorted(pathlib.Path(folder).glob("[0-9]*.txt"))
        if not paths:
            raise ValueError(f"{folder}: there is no NNNNNN.txt in it")
        for path in paths:
            scene, position = divmod(int(path.stem), _SCENE)
            first = self._agent(scene, 0, agent)
            rates = [first.sensor(f"RGB-{camera}").every_n_frames, first.sensor(lidar).every_n_frames]
            step = math.lcm(every, *rates, self.dataset.scene(scene).label_every_n_frames)
            ego = self._agent(scene, position * step, agent)
            found = [
                _kitti_line(path, number, line)
                for number, line in enumerate(path.read_text().splitlines(), 1)
                if line.strip()
            ]
            skipped.update(name for name, _ in found if name in _KITTI_OTHERS)
            found = [(name, numbers) for name, numbers in found if name not in _KITTI_OTHERS]
            numbers = np.array([numbers for _, numbers in found], dtype=np.float64).reshape(-1, 15)
            height, width, length, x, y, z, turn, scores = numbers[:, 7:].T
            # The place of a label is the middle of its bottom; the camera's y axis looks down.
            middles = np.stack([x, y - height / 2, z], axis=1)
            ahead = np.stack([np.cos(turn), 0 * turn, -np.sin(turn)], axis=1)
            up = np.broadcast_to([0.0, -1.0, 0.0], ahead.shape)
            turns = np.stack([ahead, np.cross(up, ahead), up], axis=2)
            places = (middles, turns, np.stack([length, width, height], axis=1))
            world_from_camera = ego.pose @ ego.sensor(f"RGB-{camera}").agent_from_sensor
            self._put(ego, world_from_camera, [_KITTI[name] for name, _ in found], scores, places, None)
        return skipped

    def write(self, path: str | os.PathLike[str]) -> None:
        """As Parquet (docs/schema.md, Predictions)."""
        pq.write_table(pa.Table.from_pylist(self.rows, schema=_ROWS), path)

    def _agent(self, scene: int, frame: int, agent: str) -> Agent:
        return self.dataset.scene(scene).frame(frame).agent(agent)

    def _put(
        self,
        ego: Agent,
        world_from_frame: Array,
        classes: Sequence[str],
        scores: Array,
        places: tuple[Array, Array, Array],
        velocities: Array | None,
    ) -> None:
        middles, turns, sizes = places
        sample: dict[str, Any] = {
            "scene": ego.frame.scene.number,
            "frame": ego.frame.number,
            "agent": ego.name,
            "mode": self.mode,
        }
        if not len(classes) == len(scores) == len(middles):
            raise ValueError(f"{len(classes)} classes, {len(scores)} scores and {len(middles)} boxes of {sample}")
        if unknown := set(classes) - {*CLASSES, "trailer", "construction_vehicle"}:
            raise ValueError(f"there are no classes {sorted(unknown)}: there are {', '.join(CLASSES)}")
        key = (ego.frame.scene.number, ego.frame.number, ego.name)
        if key in self._samples:
            raise ValueError(f"{sample} was added before")
        self._samples.add(key)
        centers = transform(world_from_frame, middles)
        for i, name in enumerate(classes):
            self.rows.append(
                sample
                | {
                    "class": name,
                    "score": float(scores[i]),
                    "center_m": centers[i].tolist(),
                    "size_m": sizes[i].tolist(),
                    "quaternion": quaternion(world_from_frame[:3, :3] @ turns[i]).tolist(),
                    "velocity_mps": None if velocities is None else velocities[i].tolist(),
                }
            )
        if not len(classes):
            self.rows.append(sample)


def _upright(corners: Array) -> list[float]:
    """x, y, z of the middle, length, width, height, yaw of the eight corners of an upright box."""
    middle = corners.mean(axis=0)
    order = np.argsort(corners[:, 2])
    height = corners[order[4:], 2].mean() - corners[order[:4], 2].mean()
    below = corners[order[:4], :2]
    # From a corner the other three are at the end of the short side, of the long side and of the diagonal.
    sides = below[1:] - below[0]
    short, long = sides[np.argsort(np.linalg.norm(sides, axis=1))[:2]]
    length, width = np.linalg.norm(long), np.linalg.norm(short)
    return [*middle, float(length), float(width), float(height), math.atan2(long[1], long[0])]


def _kitti_line(path: pathlib.Path, number: int, line: str) -> tuple[str, list[float]]:
    """The name, and 15 numbers: truncated, occluded, alpha, 4 of the rectangle, height, width, length, x, y, z, rotation_y, score."""
    name, *words = line.split()
    if name not in _KITTI and name not in _KITTI_OTHERS:
        raise ValueError(f"{path}, line {number}: there is no class {name} in KITTI's labels")
    try:
        numbers = [float(word) for word in words]
    except ValueError as fault:
        raise ValueError(f"{path}, line {number}: {fault}") from fault
    if len(numbers) != 15:
        raise ValueError(
            f"{path}, line {number}: {len(numbers)} numbers after the name, results have 15 (the last is the score)"
        )
    return name, numbers


def _agents(pairs: Sequence[str]) -> Mapping[str, str]:
    found: dict[str, str] = {}
    for pair in pairs:
        agent, equals, folder = pair.partition("=")
        if not equals or agent in found:
            raise ValueError(f"{pair}: say AGENT=FOLDER, each agent once")
        found[agent] = folder
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """`python -m convoy.results`."""
    parser = argparse.ArgumentParser(
        prog="python -m convoy.results",
        description="Makes predictions for `convoy evaluate` of results of trainers. Those of mmdet3d on nuScenes (JSON) it reads by itself.",
    )
    kinds = parser.add_subparsers(dest="kind", required=True)
    kitti = kinds.add_parser("kitti", help="folders of NNNNNN.txt, as OpenPCDet and mmdet3d write them")
    kitti.add_argument("agents", nargs="+", metavar="AGENT=FOLDER", help="whose results, and where they are")
    kitti.add_argument("--store", required=True, help="folder or URL of the data set")
    kitti.add_argument("--out", required=True, metavar="FILE", help="the predictions, .parquet")
    kitti.add_argument("--mode", default="none", choices=MODES, help="with whom the model worked together (none)")
    kitti.add_argument("--camera", default="CAM_FRONT", help="the export's --camera")
    kitti.add_argument("--lidar", default="LIDAR", help="the export's --lidar")
    kitti.add_argument("--every", type=int, default=1, help="the export's --every")
    asked = parser.parse_args(arguments)
    try:
        found, skipped = Predictions(asked.store, mode=asked.mode), Counter[str]()
        for agent, folder in _agents(asked.agents).items():
            skipped += found.add_kitti(folder, agent, camera=asked.camera, lidar=asked.lidar, every=asked.every)
        found.write(asked.out)
    except (StoreError, ValueError, OSError) as fault:
        print(f"convoy.results: {fault}", file=sys.stderr)
        return 1
    left_out = "".join(f"; left out: {count} {name}" for name, count in sorted(skipped.items()))
    print(f"{asked.out}: {found}{left_out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
