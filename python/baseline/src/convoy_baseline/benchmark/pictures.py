"""Pictures of what cooperation found: of six scenes of the test the keyframe and ego where working together found the most more.

python -m convoy_baseline.benchmark.pictures --store benchmark-store --predictions benchmark/coopdet3d-l-0/modes.parquet

Wants matplotlib (convoy-data[plots]).
"""

from __future__ import annotations

import argparse
import pathlib
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import convoy
import numpy as np
import pyarrow.compute as pc
import pyarrow.parquet as pq
from convoy.plots import bev

from convoy_baseline.frames import Truth, truth
from convoy_baseline.grid import Array
from convoy_baseline.settings import Settings

SURE = 0.3
"""Boxes with a lower score are not drawn, and count as not found."""
NEAR_M = 2.0
COLOURS = {"none": "#cc79a7", "x2x": "#009e73"}
WORDS = {"none": "said alone", "x2x": "said with partners"}


@dataclass(frozen=True)
class Moment:
    """An ego at a keyframe, and which of its targets it finds in each mode."""

    scene: int
    frame: int
    ego: str
    boxes: dict[str, Array]
    """By mode: (N, 7) places, sizes and yaws in the ego's frame."""
    found: dict[str, Array]
    """By mode: which of the targets."""

    @property
    def more(self) -> int:
        """How many more with partners."""
        return int(self.found["x2x"].sum()) - int(self.found["none"].sum())


def local(rows: Sequence[dict[str, Any]], pose: Array) -> tuple[Array, list[str]]:
    """Boxes of predictions in an ego's frame, the surest first, and their classes."""
    rows = sorted(rows, key=lambda row: -row["score"])
    back = convoy.invert(pose)
    found = np.zeros((len(rows), 7))
    for i, row in enumerate(rows):
        ahead = back[:3, :3] @ convoy.rotation(row["quaternion"])[:, 0]
        found[i, :3] = back[:3, :3] @ np.array(row["center_m"]) + back[:3, 3]
        found[i, 3:6], found[i, 6] = row["size_m"], np.arctan2(ahead[1], ahead[0])
    return found, [row["class"] for row in rows]


def hits(wanted: Truth, boxes: Array, classes: Sequence[str]) -> Array:
    """Which targets are found: in the order of scores each box takes the nearest free one of its class."""
    free = np.ones(len(wanted.boxes), bool)
    for box, name in zip(boxes, classes, strict=True):
        apart = np.linalg.norm(wanted.boxes[:, :2] - box[:2], axis=1)
        apart[~free | (wanted.labels != convoy.CLASSES.index(name))] = np.inf
        if len(apart) and apart.min() <= NEAR_M:
            free[apart.argmin()] = False
    return ~free


def moments(dataset: convoy.Dataset, path: pathlib.Path, settings: Settings, radius_m: float) -> list[Moment]:
    """The best of each scene, those with most to show first."""
    table = pq.read_table(path)
    table = table.filter(pc.greater_equal(table["score"], SURE))
    samples: dict[tuple[int, int, str], dict[str, list[dict[str, Any]]]] = {}
    for row in table.to_pylist():
        if row["mode"] not in COLOURS:
            continue
        of = samples.setdefault((row["scene"], row["frame"], row["agent"]), {mode: [] for mode in COLOURS})
        of[row["mode"]].append(row)
    best: dict[int, Moment] = {}
    for (scene, number, ego), rows in sorted(samples.items()):
        frame = dataset.scene(scene).frame(number)
        wanted = truth(frame, ego, settings)
        near = abs(wanted.boxes[:, :2]).max(axis=1) < radius_m
        wanted = replace(wanted, boxes=wanted.boxes[near], labels=wanted.labels[near])
        boxes = {mode: local(of, frame.agent(ego).pose) for mode, of in rows.items()}
        found = {mode: hits(wanted, *of) for mode, of in boxes.items()}
        moment = Moment(scene, number, ego, {mode: of[0] for mode, of in boxes.items()}, found)
        if scene not in best or moment.more > best[scene].more:
            best[scene] = moment
    return sorted(best.values(), key=lambda moment: (-moment.more, moment.scene))


def draw(dataset: convoy.Dataset, moment: Moment, path: pathlib.Path, radius_m: float) -> None:
    """A picture from above: who saw what, by colour, and outlines of what was said alone and with partners."""
    import matplotlib.pyplot as plt

    figure, ax = plt.subplots(figsize=(8, 8.8), layout="constrained")
    frame = dataset.scene(moment.scene).frame(moment.frame)
    bev(frame, moment.ego, radius_m=radius_m, lidar=None, ax=ax)
    for mode, boxes in moment.boxes.items():
        for x, y, _, length, width, _, yaw in boxes:
            along, across = (
                np.array([length, length, -length, -length, length]) / 2,
                np.array([1, -1, -1, 1, 1]) * width / 2,
            )
            ahead, left = x + np.cos(yaw) * along - np.sin(yaw) * across, y + np.sin(yaw) * along + np.cos(yaw) * across
            ax.plot(
                -left,
                ahead,
                color=COLOURS[mode],
                linewidth=1.4,
                linestyle="-" if mode == "x2x" else (0, (2, 2)),
                zorder=7,
            )
        ax.plot(
            [],
            [],
            color=COLOURS[mode],
            linewidth=1.4,
            linestyle="-" if mode == "x2x" else (0, (2, 2)),
            label=WORDS[mode],
        )
    alone, together = (int(moment.found[mode].sum()) for mode in ("none", "x2x"))
    ax.set_title(
        f"scene {moment.scene}, frame {moment.frame}, {moment.ego}: of {len(moment.found['none'])} targets {alone} found alone, "
        f"{together} with partners",
        fontsize="medium",
    )
    ax.get_legend().remove()
    figure.legend(loc="outside lower center", ncols=4, fontsize="small", frameon=False)
    figure.savefig(path, dpi=110, metadata={"Software": None})
    plt.close(figure)


def main(arguments: list[str] | None = None) -> int:
    """The program."""
    parser = argparse.ArgumentParser(
        prog="python -m convoy_baseline.benchmark.pictures", description="What cooperation found."
    )
    parser.add_argument("--store", required=True)
    parser.add_argument(
        "--predictions", required=True, type=pathlib.Path, help="boxes of a model in modes none and x2x"
    )
    parser.add_argument("--out", type=pathlib.Path, default="docs/results", help="a folder for found-0.png, ...")
    parser.add_argument("--count", type=int, default=6)
    parser.add_argument("--radius-m", type=float, default=51.2)
    options = parser.parse_args(arguments)
    try:
        dataset = convoy.Dataset(options.store)
        settings = Settings(classes=tuple(convoy.CLASSES))
        for number, moment in enumerate(
            moments(dataset, options.predictions, settings, options.radius_m)[: options.count]
        ):
            path = options.out / f"found-{number}.png"
            draw(dataset, moment, path, options.radius_m)
            print(f"{path}: scene {moment.scene}, frame {moment.frame}, {moment.ego}: {moment.more} more with partners")
    except (convoy.StoreError, ValueError, OSError) as fault:
        print(f"error: {fault}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
