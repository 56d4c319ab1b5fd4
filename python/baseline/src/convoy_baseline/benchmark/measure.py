"""How fast a model predicts, and how much memory that takes: a process of its own, as memory at its peak is one's of a process.

python -m convoy_baseline.benchmark.measure --store store --split test --model model.pt --mode x2x
"""

from __future__ import annotations

import argparse
import json
import pathlib
import resource
import sys
import time

import convoy
import torch

from convoy_baseline.batch import Link, ego_from, heard
from convoy_baseline.examples import wired_views
from convoy_baseline.frames import Keyframe
from convoy_baseline.model import Model
from convoy_baseline.predict import LEAST_SCORE, MOST, opened
from convoy_baseline.settings import Settings

WARM = 2
"""Samples before the clock starts."""


def look(model: Model, settings: Settings, keyframe: Keyframe, ego: int, mode: str, device: torch.device) -> None:
    """What has to be done for one ego that hears its partners: from what was seen to boxes and masks."""
    own = keyframe.views[ego]
    partners = heard(own, keyframe.views, mode, settings.comm_range_m, settings.elevation_m)
    views = [own, *(keyframe.views[v] for v in partners)]
    links = [Link(0, i, ego_from(own, view)) for i, view in enumerate(views[1:], 1)]
    inputs, wiring = wired_views(views, [0], links, settings)
    said = model(inputs.to(device), wiring.to(device))
    if model.boxes is not None:
        model.boxes.found(said.boxes, 0, MOST, LEAST_SCORE)
    if said.masks is not None:
        said.masks[0].sigmoid().cpu()


def main(arguments: list[str] | None = None) -> int:
    """The program."""
    parser = argparse.ArgumentParser(
        prog="python -m convoy_baseline.benchmark.measure", description="Speed and memory."
    )
    parser.add_argument("--store", required=True)
    parser.add_argument("--split", required=True)
    parser.add_argument("--model", required=True, type=pathlib.Path)
    parser.add_argument("--mode", required=True, choices=convoy.MODES)
    parser.add_argument("--samples", type=int, default=20, help="how many egos")
    parser.add_argument("--device", default="cpu", choices=("cpu", "cuda"))
    parser.add_argument("--threads", type=int)
    options = parser.parse_args(arguments)
    if options.threads:
        torch.set_num_threads(options.threads)
    device = torch.device(options.device)
    run, model, keyframes = opened(options.store, options.model, options.split, device)
    step = max(len(keyframes) * 3 // options.samples, 1)
    seconds: list[float] = []
    with torch.no_grad():
        for i in range(0, len(keyframes), step):
            keyframe = keyframes[i]
            for ego in keyframe.egos:
                if len(seconds) == options.samples + WARM:
                    break
                began = time.monotonic()
                look(model, run.settings, keyframe, ego, options.mode, device)
                if device.type == "cuda":
                    torch.cuda.synchronize()
                seconds.append(time.monotonic() - began)
    timed = seconds[WARM:] or seconds
    memory = (
        torch.cuda.max_memory_allocated()
        if device.type == "cuda"
        else 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    )
    print(json.dumps({"fps": len(timed) / sum(timed), "memory_bytes": memory, "samples": len(timed)}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
