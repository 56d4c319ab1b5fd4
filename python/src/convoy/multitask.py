"""Samples with everything that a model of several sensors and tasks learns from."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypedDict

import numpy as np

from convoy.boxes import CLASSES
from convoy.cooperation import Cooperative
from convoy.frame import Agent
from convoy.poses import Array
from convoy.samples import Sample, Samples, check_classes, detection_targets, segmentation_targets
from convoy.sweeps import history


class Pictures(TypedDict):
    """N pictures of a sample's agents, one after another."""

    pictures: Array
    """(N, 3, h, w) u8."""
    picture_agent: Array
    """(N,) i64: which of the sample's agents took it."""
    cameras: list[str]
    """Their names, without `RGB-`."""
    intrinsics: Array
    """(N, 3, 3) f32, of the pictures as they are here; pixel (0, 0) covers [0, 1) x [0, 1)."""
    agent_from_camera: Array
    """(N, 4, 4) f32: from x right, y down, z forward."""


class MultitaskSample(TypedDict, total=False):
    """What a sample has; parts that were not asked for are missing."""

    scene: int
    frame: int
    ego: str
    agents: list[str]
    """The ego, then its partners."""
    ego_from_agent: Array
    """(A, 4, 4) f32."""
    points: list[Array]
    """(P, 3 + columns) f32 of each agent; with `sweeps`, one more column: age in s."""
    boxes: Array
    """(N, 9) f32: `convoy.samples.flat`."""
    labels: Array
    ids: Array
    difficulty: Array
    num_lidar_pts: Array
    seen_by_ego: Array
    masks: Array
    """(C, H, W) bool."""
    classes: tuple[str, ...]
    cell_m: float
    occupancy: Array
    """(X, Y, Z) u8: tags around the ego, 0 is free."""
    occupancy_origin_m: Array
    occupancy_voxel_m: float
    pictures: Array
    picture_agent: Array
    cameras: list[str]
    intrinsics: Array
    agent_from_camera: Array
    """See `Pictures`."""


class MultitaskSamples(Samples):
    """Boxes, masks and occupancy of the same moments, by lidar, its history, and cameras.

    `boxes` says of which classes, `bev` which masks (True: all), `occupancy` whether voxels of the ego are there; `cameras` is the height and
    width that pictures are made small to, `sweeps` how many earlier sweeps of each agent are added.
    """

    def __init__(
        self,
        *args: Any,
        boxes: Sequence[str] | bool = True,
        bev: Sequence[str] | bool = True,
        occupancy: bool = False,
        cameras: tuple[int, int] | None = None,
        sweeps: int = 0,
        **options: Any,
    ) -> None:
        self.boxes = CLASSES if boxes is True else tuple(boxes or ())
        check_classes(self.boxes)
        self.bev = None if bev is True else tuple(bev or ())
        self.occupancy, self.cameras, self.sweeps = occupancy, cameras, sweeps
        if sweeps < 0 or (cameras is not None and min(cameras) < 1):
            raise ValueError(
                f"sweeps {sweeps}, cameras {cameras}: expected sweeps from 0, and a height and width from 1"
            )
        stages, arrays = list(Samples.STAGES), []
        if self.boxes:
            stages.append("postprocess-valid")
        if self.bev is None or self.bev:
            stages.append("bev-gt")
            arrays.append("bev")
        if occupancy:
            stages.append("occupancy-gt")
        self.STAGES, self.ARRAYS = tuple(stages), tuple(arrays)
        super().__init__(*args, **options)

    def _points(self, heard: Cooperative) -> list[Array]:
        if not self.sweeps:
            return super()._points(heard)
        frames = heard.ego_from_agent if self.points == "ego" else [None] * len(heard.agents)
        return [
            history(agent, self.lidar, self.columns, self.sweeps, frame)
            for agent, frame in zip(heard.agents, frames, strict=True)
        ]

    def _targets(self, heard: Cooperative) -> Sample:
        sample: Sample = {}
        if self.boxes:
            sample |= detection_targets(heard, self.boxes, self.comm_range_m, self.elevation_m)
        if self.bev is None or self.bev:
            sample |= segmentation_targets(heard, self.bev)
        if self.occupancy:
            grid = heard.ego.occupancy()
            sample |= {
                "occupancy": grid.tags,
                "occupancy_origin_m": grid.origin_m.astype(np.float32),
                "occupancy_voxel_m": grid.voxel_m,
            }
        if self.cameras is not None:
            sample |= pictures_of(heard.agents, *self.cameras)
        return sample


def pictures_of(agents: Sequence[Agent], height: int, width: int) -> Pictures:
    """Pictures of all RGB cameras of some agents, made small."""
    try:
        from PIL import Image
    except ImportError as fault:
        raise ImportError("pictures are made small by Pillow: pip install pillow") from fault
    pictures, owners, names, intrinsics, poses = [], [], [], [], []
    for number, agent in enumerate(agents):
        for name in (name.removeprefix("RGB-") for name in agent.sensors if name.startswith("RGB-")):
            camera = agent.camera(name)
            lens = camera.sensor.lens
            if lens is not None and lens.get("model", "pinhole") != "pinhole":
                raise agent.fault(
                    f"has a lens of model {lens['model']}",
                    "leave `cameras` out: samples have pinholes alone",
                    f"RGB-{name}",
                )
            whole = camera.image()
            small = Image.fromarray(whole).resize((width, height), Image.Resampling.BOX)
            pictures.append(np.asarray(small).transpose(2, 0, 1))
            owners.append(number)
            names.append(name)
            intrinsics.append(np.diag([width / whole.shape[1], height / whole.shape[0], 1.0]) @ camera.intrinsics)
            poses.append(camera.agent_from_camera)
    return {
        "pictures": np.array(pictures, np.uint8).reshape(-1, 3, height, width),
        "picture_agent": np.array(owners, np.int64),
        "cameras": names,
        "intrinsics": np.array(intrinsics, np.float32).reshape(-1, 3, 3),
        "agent_from_camera": np.array(poses, np.float32).reshape(-1, 4, 4),
    }
