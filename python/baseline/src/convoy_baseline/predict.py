"""Predicts with a trained model: python -m convoy_baseline.predict --store dataset --model model.pt --out predictions.parquet

The file is one that `evaluate` reads, with a row for every box, ego and mode.
"""

from __future__ import annotations

import argparse
import os
import pathlib
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import convoy
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import torch

from convoy_baseline.batch import wired
from convoy_baseline.checkpoint import Run, model_of
from convoy_baseline.conditions import Condition, links_under
from convoy_baseline.frames import Keyframe, Keyframes
from convoy_baseline.grid import Array
from convoy_baseline.inputs import gathered
from convoy_baseline.model import Model
from convoy_baseline.settings import Settings
from convoy_baseline.targets import decode

MOST = 200
LEAST_SCORE = 0.03
"""How many boxes of an ego are kept, and how sure they must be."""


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


def predict(
    model: Model,
    settings: Settings,
    keyframes: Keyframes,
    conditions: Sequence[Condition],
    take: Callable[[Found], None],
    device: torch.device,
    seed: int = 0,
) -> None:
    """Hands over what every ego finds under each condition. Views are encoded once for all conditions."""
    delays = sorted({condition.delay_frames for condition in conditions} - {0})
    with torch.no_grad():
        for i in range(len(keyframes)):
            keyframe = keyframes[i]
            views, heard = list(keyframe.views), {0: (0, keyframe.views)}
            for delay in delays:
                if keyframe.number >= delay:  # The scene had begun.
                    earlier = keyframes.views(keyframe.scene, keyframe.number - delay)
                    heard[delay] = len(views), earlier
                    views += earlier
            features = model.features(gathered(views).to(device))
            for condition in conditions:
                if condition.delay_frames in heard:
                    first, earlier = heard[condition.delay_frames]
                    links = links_under(condition, keyframe, earlier, first, settings, seed)
                    said = model.heads(model.fused(features, wired(keyframe.egos, links).to(device)))
                    counts = np.bincount([link.ego for link in links], minlength=len(keyframe.egos))
                    for found in _found(said, condition, keyframe, counts, settings):
                        take(found)


def _found(
    said: tuple[torch.Tensor, ...], condition: Condition, keyframe: Keyframe, partners: Array, settings: Settings
) -> list[Found]:
    heat, numbers, masks = said[0].sigmoid(), said[1], said[2].sigmoid().cpu().numpy()
    found = []
    for e in range(len(keyframe.egos)):
        boxes, labels, scores = decode(heat[e], numbers[e], settings.feature_grid, MOST, LEAST_SCORE)
        found.append(Found(condition, keyframe, e, int(partners[e]), boxes, labels, scores, masks[e]))
    return found


class Writer:
    """Collects predictions as rows in the world."""

    def __init__(self, classes: Sequence[str]) -> None:
        self.classes = classes
        self.parts: list[pa.Table] = []

    def take(self, found: Found) -> None:
        """Adds them."""
        view = found.keyframe.views[found.keyframe.egos[found.ego]]
        boxes = found.boxes.astype(np.float64)
        count = len(boxes)
        world = view.world_from_agent
        half = (boxes[:, 6] + np.arctan2(world[1, 0], world[0, 0])) / 2
        columns = {
            "scene": pa.array(np.full(count, found.keyframe.scene, np.uint32)),
            "frame": pa.array(np.full(count, found.keyframe.number, np.uint32)),
            "agent": pa.array([view.agent] * count, pa.string()),
            "mode": pa.array([found.condition.mode] * count, pa.string()),
            "class": pa.array([self.classes[label] for label in found.labels], pa.string()),
            "score": pa.array(found.scores.astype(np.float32)),
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
    """A column of rows (N, k)."""
    return pa.FixedSizeListArray.from_arrays(pa.array(np.ascontiguousarray(values).ravel()), values.shape[1])


def opened(store: str, model: pathlib.Path, split: str, device: torch.device) -> tuple[Run, Model, Keyframes]:
    """A model and the keyframes that it is to look at."""
    run, network = model_of(model, device)
    return run, network, Keyframes(convoy.Dataset(store), split, run.settings, keep=False)


def main(arguments: list[str] | None = None) -> int:
    """The program."""
    parser = argparse.ArgumentParser(prog="python -m convoy_baseline.predict", description="Boxes for `evaluate`.")
    parser.add_argument("--store", required=True)
    parser.add_argument("--model", required=True, type=pathlib.Path, help="a checkpoint of convoy_baseline.train")
    parser.add_argument("--out", required=True, type=pathlib.Path, help="Parquet file")
    parser.add_argument("--modes", default="none,x2v,x2i,x2x")
    parser.add_argument("--split", default="test")
    parser.add_argument("--device", default="cpu", choices=("cpu", "cuda"))
    parser.add_argument("--threads", type=int, help="of PyTorch, on a CPU")
    options = parser.parse_args(arguments)
    if options.threads:
        torch.set_num_threads(options.threads)
    modes = options.modes.split(",")
    if unknown := set(modes) - set(convoy.MODES):
        parser.error(f"no modes: {', '.join(sorted(unknown))}; expected some of {', '.join(convoy.MODES)}")
    try:
        device = torch.device(options.device)
        run, model, keyframes = opened(options.store, options.model, options.split, device)
        writer = Writer(run.settings.classes)
        conditions = [Condition(mode, mode) for mode in modes]
        predict(model, run.settings, keyframes, conditions, writer.take, device)
        writer.write(options.out)
    except (convoy.StoreError, ValueError, OSError) as fault:
        print(f"error: {fault}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
