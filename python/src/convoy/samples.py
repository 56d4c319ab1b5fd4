"""Samples to learn from, as numpy arrays: `convoy.torch` makes tensors of them."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Literal

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from convoy.boxes import CLASSES, Boxes
from convoy.cooperation import MODES, Cooperative
from convoy.dataset import Dataset, Scene
from convoy.errors import StoreError
from convoy.poses import Array, invert

Sample = dict[str, Any]
Key = tuple[int, int, str]
"""Scene, frame, ego."""


class Samples:
    """What detection and segmentation have in common: which moments, and the points of whoever is heard.

    A moment is a scene, a frame and an ego; of each scene for which all stages are finished that are needed, frames 0, n,
    2 n, ..., with n = `every` (10 is 2 Hz), or a multiple where a sensor or label is rarer. `index` is kept and given again to
    skip looking through the scenes. Workers may be forked or spawned.
    """

    STAGES: tuple[str, ...] = ("simulate-and-log", "render-sensors")
    ARRAYS: tuple[str, ...] = ()

    def __init__(
        self,
        dataset: Dataset | str | os.PathLike[str],
        split: str | None = None,
        mode: str = "none",
        *,
        comm_range_m: float = 80.0,
        elevation_m: float = 4.8,
        every: int = 10,
        egos: Literal["vehicles", "first", "all"] = "vehicles",
        lidar: str = "LIDAR",
        columns: tuple[str, ...] = ("intensity",),
        points: Literal["ego", "agent"] = "ego",
        transform: Callable[[Sample], Sample] | None = None,
        index: Sequence[Key] | None = None,
    ) -> None:
        if mode not in MODES:
            raise ValueError(f"mode {mode!r}: expected one of {', '.join(MODES)}")
        if every < 1 or egos not in ("vehicles", "first", "all") or points not in ("ego", "agent"):
            raise ValueError(f"every {every}, egos {egos!r}, points {points!r}: see convoy.Samples")
        self.dataset = dataset if isinstance(dataset, Dataset) else Dataset(dataset)
        self.mode, self.comm_range_m, self.elevation_m = mode, comm_range_m, elevation_m
        self.lidar, self.columns, self.points, self.transform = lidar, columns, points, transform
        self.index: list[Key] = list(index) if index is not None else list(self._look(split, every, egos))
        if not self.index:
            raise StoreError(
                f"there is no sample: split {split}, stages {', '.join(self.STAGES)}",
                do="`make status` says which scenes are finished",
                file=self.dataset.location,
            )

    def __len__(self) -> int:
        return len(self.index)

    def __getitem__(self, number: int) -> Sample:
        if not -len(self) <= number < len(self):
            raise IndexError(number)  # Ends loops over samples.
        scene, frame, ego = self.index[number]
        moment = self.dataset.scene(scene).frame(frame)
        heard = moment.cooperative(ego, self.mode, self.comm_range_m, self.elevation_m)
        sample: Sample = {
            "scene": scene,
            "frame": frame,
            "ego": ego,
            "agents": [agent.name for agent in heard.agents],
            "ego_from_agent": heard.ego_from_agent.astype(np.float32),
            "points": self._points(heard),
        }
        sample |= self._targets(heard)
        return sample if self.transform is None else self.transform(sample)

    def save_index(self, path: str | os.PathLike[str]) -> None:
        """Keeps the index as Parquet: scene, frame, ego."""
        scenes, frames, egos = zip(*self.index, strict=True)
        table = pa.table({"scene": pa.array(scenes, pa.uint32()), "frame": pa.array(frames, pa.uint32()), "ego": egos})
        pq.write_table(table, path)

    @staticmethod
    def load_index(path: str | os.PathLike[str]) -> list[Key]:
        """The index that was kept."""
        columns = pq.read_table(path).to_pydict()
        return list(zip(columns["scene"], columns["frame"], columns["ego"], strict=True))

    def _points(self, heard: Cooperative) -> list[Array]:
        if self.points == "ego":
            return heard.points(self.lidar, self.columns)
        return [agent.points(self.lidar, self.columns) for agent in heard.agents]

    def _targets(self, heard: Cooperative) -> Sample:
        raise NotImplementedError

    def _look(self, split: str | None, every: int, egos: str) -> Iterator[Key]:
        def of_scene(scene: Scene) -> list[Key]:
            vehicles = [name for name in scene.agents if egos == "all" or not name.startswith("rsu")]
            if not vehicles:
                return []
            step, chosen = math.lcm(every, *self._rates(scene)), vehicles[:1] if egos == "first" else vehicles
            return [(scene.number, frame, ego) for ego in chosen for frame in range(0, scene.frames, step)]

        for keys in self.dataset._place.each(of_scene, self.dataset.scenes(split, self.STAGES)):
            yield from keys

    def _rates(self, scene: Scene) -> Iterator[int]:
        yield scene.label_every_n_frames
        for name in scene.agents:
            agent = scene.frame(0).agent(name)
            yield agent.sensor(self.lidar).every_n_frames
            for kind in self.ARRAYS:
                yield int(agent._archive(kind).get("every_n_frames", 1))


class DetectionSamples(Samples):
    """Boxes to find.

    Targets are the objects of the ego's own list, without the ego, that it or anybody within its communication range has seen,
    whatever the mode: modes are compared on the same targets.
    """

    STAGES = (*Samples.STAGES, "postprocess-valid")

    def __init__(self, *args: Any, classes: Sequence[str] = CLASSES, **options: Any) -> None:
        self.classes = check_classes(classes)
        super().__init__(*args, **options)

    def _targets(self, heard: Cooperative) -> Sample:
        return detection_targets(heard, self.classes, self.comm_range_m, self.elevation_m)


class SegmentationSamples(Samples):
    """The ego's BEV masks to find: `masks` (C, H, W) bool, row 0 ahead, column 0 left."""

    STAGES = (*Samples.STAGES, "bev-gt")
    ARRAYS = ("bev",)

    def __init__(self, *args: Any, classes: Sequence[str] | None = None, **options: Any) -> None:
        self.classes = None if classes is None else tuple(classes)
        super().__init__(*args, **options)

    def _targets(self, heard: Cooperative) -> Sample:
        return segmentation_targets(heard, self.classes)


def check_classes(classes: Sequence[str]) -> tuple[str, ...]:
    """Classes of boxes, if there are such ones."""
    if unknown := set(classes) - set(CLASSES):
        raise ValueError(f"no classes: {', '.join(sorted(unknown))}; expected some of {', '.join(CLASSES)}")
    return tuple(classes)


def detection_targets(heard: Cooperative, classes: tuple[str, ...], comm_range_m: float, elevation_m: float) -> Sample:
    """What `DetectionSamples` has to find."""
    ego = heard.ego
    boxes = ego.boxes()
    boxes = boxes[boxes.id != ego.id]
    everybody = ego.frame.cooperative(ego.name, "x2x", comm_range_m, elevation_m)
    seen = everybody.seen_by(boxes.id)
    number = np.array([classes.index(name) if name in classes else -1 for name in (*CLASSES, "")])
    label = number[boxes.label]
    kept = seen.any(axis=0) & (label >= 0)
    local = boxes[kept].transformed(invert(ego.pose))
    return {
        "boxes": flat(local),
        "labels": label[kept],
        "ids": local.id.astype(np.int64),
        "difficulty": local.difficulty,
        "num_lidar_pts": local.num_lidar_pts,
        "seen_by_ego": seen[0, kept],
    }


def segmentation_targets(heard: Cooperative, classes: tuple[str, ...] | None) -> Sample:
    """What `SegmentationSamples` has to find."""
    bev = heard.ego.bev(classes)
    return {"masks": bev.masks, "classes": bev.classes, "cell_m": bev.cell_m}


def flat(boxes: Boxes) -> Array:
    """(N, 9) f32: centre x, y, z, length, width, height, yaw, velocity x, y."""
    parts = [boxes.center, boxes.size, boxes.yaw[:, None], boxes.velocity[:, :2]]
    return np.concatenate(parts, axis=1).astype(np.float32)


_PADDED = {"boxes": 0.0, "labels": -1, "ids": 0, "difficulty": -1, "num_lidar_pts": 0, "seen_by_ego": False}


def collate(samples: Sequence[Sample]) -> Sample:
    """A batch of B samples with at most A agents and N boxes.

    `points` are all points one after another, `point_sample` and `point_agent` say whose they are. `ego_from_agent` (B, A, 4, 4)
    is filled up with identities, `agent_mask` (B, A) says which are real; likewise `boxes` (B, N, 9), `labels` (B, N; -1 where
    there is none) and so on with `box_mask`. `masks` are (B, C, H, W), `occupancy` is (B, X, Y, Z). Pictures with what belongs to them
    are one after another, too, with `picture_sample` beside `picture_agent`. The rest are lists.
    """
    agents = max(len(sample["points"]) for sample in samples)
    clouds = [(b, a, cloud) for b, sample in enumerate(samples) for a, cloud in enumerate(sample["points"])]
    counts = [len(cloud) for _, _, cloud in clouds]
    poses = np.tile(np.eye(4, dtype=np.float32), (len(samples), agents, 1, 1))
    mask = np.zeros((len(samples), agents), bool)
    for b, sample in enumerate(samples):
        own = sample["ego_from_agent"]
        poses[b, : len(own)], mask[b, : len(own)] = own, True
    batch: Sample = {
        "points": np.concatenate([cloud for _, _, cloud in clouds]),
        "point_sample": np.repeat(np.array([b for b, _, _ in clouds], np.int64), counts),
        "point_agent": np.repeat(np.array([a for _, a, _ in clouds], np.int64), counts),
        "ego_from_agent": poses,
        "agent_mask": mask,
    }
    if "boxes" in samples[0]:
        most = max(len(sample["boxes"]) for sample in samples)
        for name, blank in _PADDED.items():
            first = samples[0][name]
            padded = np.full((len(samples), most, *first.shape[1:]), blank, first.dtype)
            for b, sample in enumerate(samples):
                padded[b, : len(sample[name])] = sample[name]
            batch[name] = padded
        batch["box_mask"] = np.arange(most) < np.array([[len(sample["boxes"])] for sample in samples])
    for name in ("masks", "occupancy"):
        if name in samples[0]:
            batch[name] = np.stack([sample[name] for sample in samples])
    if "pictures" in samples[0]:
        for name in ("pictures", "picture_agent", "intrinsics", "agent_from_camera"):
            batch[name] = np.concatenate([sample[name] for sample in samples])
        batch["picture_sample"] = np.repeat(
            np.arange(len(samples), dtype=np.int64), [len(sample["pictures"]) for sample in samples]
        )
    for name in samples[0]:
        if name not in batch:
            batch[name] = [sample[name] for sample in samples]
    return batch
