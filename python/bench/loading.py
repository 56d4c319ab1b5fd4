"""How fast samples are read, beside the same from an export to OPV2V: python3 python/bench/loading.py STORE OPV2V/SPLIT

A sample is an ego with the sweeps of several agents in its frame, the boxes that these list, and from the store its BEV masks, too, which
OPV2V has not. Of the export a YAML file and a PCD file of each agent are read, as its loaders do. Files are in memory after the first
round; numbers mean something on an idle machine only. Needs PyTorch and PyYAML.
"""

from __future__ import annotations

import argparse
import pathlib
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import torch
import yaml
from torch.utils.data import DataLoader, Dataset

import convoy

Sample = dict[str, Any]


class OfStore(Dataset[Sample]):
    """Samples of a store."""

    def __init__(self, store: str, keys: Sequence[tuple[int, int, str]], masks: bool) -> None:
        options: dict[str, Any] = {"mode": "x2x", "comm_range_m": 1e4, "elevation_m": 1e3, "index": keys}
        self.parts: list[Any] = [convoy.DetectionSamples(store, **options)]
        self.masks = masks

    def __len__(self) -> int:
        return len(self.parts[0])

    def __getitem__(self, number: int) -> Sample:
        sample = self.parts[0][number]
        if self.masks:
            scene, frame, ego = self.parts[0].index[number]
            sample["masks"] = self.parts[0].dataset.scene(scene).frame(frame).agent(ego).bev().masks
        return sample


class OfOpv2v(Dataset[Sample]):
    """The same of a folder of OPV2V's layout, by a YAML loader of PyYAML's."""

    def __init__(self, moments: Sequence[tuple[pathlib.Path, str, Sequence[str]]], loader: type) -> None:
        self.moments, self.loader = moments, loader

    def __len__(self) -> int:
        return len(self.moments)

    def __getitem__(self, number: int) -> Sample:
        folder, moment, agents = self.moments[number]
        points, boxes, poses = [], {}, []
        for agent in agents:
            with open(folder / agent / f"{moment}.yaml") as file:
                about = yaml.load(file, self.loader)
            poses.append(pose(about["lidar_pose"]))
            cloud = points_of(folder / agent / f"{moment}.pcd")
            ego_from_agent = np.linalg.inv(poses[0]) @ poses[-1]
            cloud[:, :3] = cloud[:, :3] @ ego_from_agent[:3, :3].T + ego_from_agent[:3, 3]
            points.append(cloud)
            boxes |= about["vehicles"]
        return {"points": points, "boxes": boxes}


def pose(of: Sequence[float]) -> np.ndarray:
    """World from sensor, of x, y, z, roll, yaw, pitch in degrees, as OPV2V has them."""
    x, y, z, *angles = of
    (sr, cr), (sy, cy), (sp, cp) = ((np.sin(a), np.cos(a)) for a in np.radians(angles))
    turn = [
        [cp * cy, cy * sp * sr - sy * cr, -cy * sp * cr - sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, -sy * sp * cr + cy * sr],
        [sp, -cp * sr, cp * cr],
    ]
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = turn, (x, y, z)
    return found


def points_of(path: pathlib.Path) -> np.ndarray:
    """(P, 4) of a PCD file of four f32."""
    whole = path.read_bytes()
    head, _, rest = whole.partition(b"DATA binary\n")
    fields = head.partition(b"\nFIELDS ")[2].split(b"\n", 1)[0].split()
    if not rest and b"DATA" not in head[-20:]:
        raise ValueError(f"{path} is no binary PCD file")
    return np.frombuffer(rest, np.float32).reshape(-1, len(fields))[:, :4].copy()


def first(samples: list[Sample]) -> Sample:
    """A batch of one, as it is."""
    return samples[0]


def rate(dataset: Dataset[Sample], workers: int) -> float:
    """Samples a second, of the second round: files are in memory then."""
    loader = DataLoader(dataset, 1, num_workers=workers, collate_fn=first, persistent_workers=workers > 0)
    for _ in range(2):
        began, count = time.monotonic(), 0
        for _ in loader:
            count += 1
        seconds = time.monotonic() - began
    return count / seconds


def main() -> None:
    """Measures and prints a table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("store")
    parser.add_argument("opv2v", type=pathlib.Path)
    parser.add_argument("--agents", type=int, default=4)
    parser.add_argument("--samples", type=int, default=150)
    options = parser.parse_args()
    torch.set_num_threads(1)
    moments, keys = [], []
    for folder in sorted(path for path in options.opv2v.iterdir() if path.is_dir()):
        agents = sorted((path for path in folder.iterdir() if path.is_dir()), key=lambda path: -int(path.name))
        agents = [path.name for path in agents]
        if len(agents) == options.agents:
            for file in sorted((folder / agents[0]).glob("[0-9]*.yaml")):
                moments.append((folder, file.stem, agents))
    dataset = convoy.Dataset(options.store)
    for scene in dataset.scenes(None, ("simulate-and-log", "render-sensors", "bev-gt", "postprocess-valid")):
        if len(scene.agents) == options.agents:
            keys += [(scene.number, frame, scene.agents[0]) for frame in range(0, scene.frames, 10)]
    moments, keys = moments[: options.samples], keys[: options.samples]
    if not moments or not keys:
        raise SystemExit(f"there are no moments of {options.agents} agents in both")
    kinds: list[tuple[str, Callable[[], Dataset[Sample]]]] = [
        ("store, points and boxes", lambda: OfStore(options.store, keys, False)),
        ("store, points, boxes and masks", lambda: OfStore(options.store, keys, True)),
        ("OPV2V, PyYAML's C loader", lambda: OfOpv2v(moments, yaml.CSafeLoader)),
        ("OPV2V, PyYAML's own loader", lambda: OfOpv2v(moments, yaml.Loader)),
    ]
    for name, made in kinds:
        points = np.mean([sum(len(cloud) for cloud in made()[i]["points"]) for i in range(0, len(made()), 10)])
        rates = [rate(made(), workers) for workers in (0, 1, 2)]
        print(
            f"{name}: {points:.0f} points a sample;",
            ", ".join(f"{r:.1f}" for r in rates),
            "a second with 0, 1, 2 workers",
        )


if __name__ == "__main__":
    main()
