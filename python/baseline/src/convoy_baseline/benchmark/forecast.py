"""What a plan comes to: data, parameters, memory, operations and time; and its first steps, as they are."""

from __future__ import annotations

import json
import pathlib
import resource
import statistics
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import replace

import convoy
import torch
from convoy.evaluation import run as run_program
from torch.utils.flop_counter import FlopCounterMode

from convoy_baseline.benchmark.plan import Entry, Plan
from convoy_baseline.benchmark.table import markdown
from convoy_baseline.checkpoint import load
from convoy_baseline.model import Model
from convoy_baseline.parts import MASKS
from convoy_baseline.settings import Settings
from convoy_baseline.train import train

EGOS, SLOTS, PICTURES = 5, 6, 6
"""A keyframe as SimBEV2X has them in the mean: 4.84 vehicles and 0.93 RSUs."""
PASSES = 3
"""Forward once, backward twice as much."""
STATE_BYTES = 16
"""Of a parameter: itself, its gradient, two means of AdamW."""


def forecast(
    plan: Plan, runs: Sequence[tuple[Entry, int]], program: str, out: pathlib.Path | None, rate: float | None
) -> str:
    """A plan in words and a table. A step takes what steps took that were made in `out`; of others it is told by operations alone, if it
    is known how many a machine makes: a `rate` of so many 10^12 a second."""
    said = run_program([program, "forecast", "--config", str(plan.config)]).strip().splitlines()
    rows, seconds, bounded, unknown = [], 0.0, 0.0, 0
    for entry in dict.fromkeys(entry for entry, _ in runs):
        seeds = sum(other is entry for other, _ in runs)
        steps, a_step = entry.settings.steps, None if out is None else step_seconds(out, entry)
        parameters, operations, kept = dense(entry.settings)
        time_of = "not known"
        if a_step is None and rate is not None:
            least = operations / (rate * 1e12) * steps
            bounded += least * seeds
            time_of = f"at least {least / 3600:.1f} h"
        elif a_step is None:
            unknown += seeds
        else:
            seconds += a_step * steps * seeds
            time_of = f"{a_step:.2f} s x {steps:,} = {a_step * steps / 3600:.1f} h"
        rows.append(
            [
                entry.name, str(seeds), f"{parameters / 1e6:.2f} M", f"{STATE_BYTES * parameters / 1e9:.2f} GB", f"{kept / 1e9:.1f} GB",
                f"{operations / 1e12:.2f}", f"{steps:,} of {entry.settings.frames_a_step}", time_of,
            ]
        )  # fmt: skip
    head = [
        "model",
        "seeds",
        "parameters",
        "with gradients and means",
        "kept in a step",
        "10^12 operations a step",
        "steps of keyframes",
        "learning",
    ]
    total = f"learning: {(seconds + bounded) / 3600:.1f} hours, {(seconds + bounded) / 86400:.2f} days"
    if bounded:
        total += f", at least: {bounded / 3600:.1f} hours are of what is dense alone, at {rate:g} x 10^12 operations a second"
    if unknown:
        total += (
            f", without {unknown} runs of which no step was made: `--steps 20` with --store and --out makes some, and --rate tells a least "
            "time by operations"
        )
    words = (
        f"Kept in a step, and operations: of what is dense (pictures' features, fusion, decoder) in f32, for keyframes of {EGOS} vehicles "
        "that hear each other and an RSU; voxels and lifted pictures come on top, as `--steps` shows."
    )
    return "\n".join([*said, "", markdown(head, rows), "", words, total])


def step_seconds(out: pathlib.Path, entry: Entry) -> float | None:
    """Seconds that a step of an entry took, by its checkpoints or by steps that were tried."""
    found = []
    for path in sorted(out.glob(f"{entry.name}-*.pt")):
        if path.stem.removeprefix(f"{entry.name}-").isdigit():
            run = load(path, torch.device("cpu"))[0]
            if run.step:
                found.append(run.seconds / run.step)
    tried = out / f"{entry.name}.tried.json"
    if not found and tried.exists():
        found.append(float(json.loads(tried.read_text())["seconds_a_step"]))
    return statistics.mean(found) if found else None


def dense(settings: Settings) -> tuple[int, int, int]:
    """Parameters; operations of a step in parts that are dense; bytes that these keep for the way back. On a device without numbers."""
    frames, side = settings.frames_a_step, settings.feature_grid.cells
    with torch.device("meta"):
        model = Model(settings, MASKS)

        def ground() -> list[torch.Tensor]:
            views = torch.empty(frames * EGOS, SLOTS, settings.fused_channels, side, side, requires_grad=True)
            known = torch.ones(frames * EGOS, SLOTS, side, side, dtype=torch.bool)
            found = [model.decoder(model.fusion(views, known))]
            if model.masks is not None:
                cells = settings.mask_grid.cells
                finer = torch.empty(frames * EGOS, found[0].shape[1], cells, cells, requires_grad=True)
                found.append(model.masks.masks(model.masks.steps(finer)))
            return found

        operations, kept = cost(model, ground)
        camera = model.camera
        if camera is not None:
            pictures = torch.empty(PICTURES, 3, settings.picture_height, settings.picture_width)
            of_agent = cost(model, lambda: camera.said(camera.encoder(pictures)))
            operations, kept = operations + frames * SLOTS * of_agent[0], kept + frames * SLOTS * of_agent[1]
    return sum(parameter.numel() for parameter in model.parameters()), PASSES * operations, kept


def cost(model: Model, act: Callable[[], object]) -> tuple[int, int]:
    """Operations of an act of a model, and bytes that it keeps for the way back, without the model's own."""
    kept: dict[int, int] = {}
    own = {parameter.untyped_storage()._cdata for parameter in model.parameters()}
    alive = []

    def keep(tensor: torch.Tensor) -> torch.Tensor:
        alive.append(tensor)  # A place that is free again would be taken for the same.
        storage = tensor.untyped_storage()
        kept[storage._cdata] = storage.nbytes()
        return tensor

    counter = FlopCounterMode(display=False)
    with counter, torch.autograd.graph.saved_tensors_hooks(keep, lambda tensor: tensor):
        act()
    return int(counter.get_total_flops()), sum(size for of, size in kept.items() if of not in own)


def try_out(
    dataset: convoy.Dataset, entry: Entry, seed: int, pack: pathlib.Path, steps: int, device: str, out: pathlib.Path
) -> str:
    """Makes the first steps of a model: how long one takes, how much memory there is at most, and whether the loss falls."""
    losses: list[float] = []
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        train(
            dataset, replace(entry.settings, steps=steps), pathlib.Path(folder, "model.pt"),
            mode=entry.mode, seed=seed, device=device, pack=pack, share=entry.share, losses=losses, say=False,
        )  # fmt: skip
    a_step = (time.monotonic() - began) / len(losses)
    memory = (
        torch.cuda.max_memory_allocated()
        if device == "cuda"
        else 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    )
    part = max(len(losses) // 4, 1)
    first, last = statistics.mean(losses[:part]), statistics.mean(losses[-part:])
    (out / f"{entry.name}.tried.json").write_text(
        json.dumps({"seconds_a_step": a_step, "steps": steps, "memory_bytes": memory})
    )
    falls = "" if last < first else ": it does not fall"
    whole = a_step * entry.settings.steps / 3600
    return (
        f"{entry.name}: {steps} steps of {a_step:.2f} s, {memory / 1e9:.1f} GB at most; loss {first:.3f} in the first quarter, "
        f"{last:.3f} in the last{falls}; all {entry.settings.steps:,} steps: {whole:.1f} h"
    )
