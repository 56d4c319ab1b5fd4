"""Trains a model: python -m convoy_baseline.train --store dataset --mode x2x --out model.pt

A run that is started again goes on after the last checkpoint. On a CPU the same seed and number of threads give the same weights,
however often it was broken off.
"""

from __future__ import annotations

import argparse
import math
import pathlib
import sys
import time
from collections.abc import Iterator

import convoy
import numpy as np
import torch
from torch.utils.data import DataLoader

from convoy_baseline.checkpoint import Run, averaged, begin, digest, load, save
from convoy_baseline.examples import example
from convoy_baseline.frames import Keyframe, Keyframes
from convoy_baseline.grid import Array
from convoy_baseline.loss import loss
from convoy_baseline.model import Model
from convoy_baseline.pack import Packed
from convoy_baseline.settings import Settings, check_mode, read_with_mode
from convoy_baseline.spoil import SPOILS

KEEP_EVERY_S = 60.0
SAY_EVERY = 50


def order(
    keyframes: int, a_step: int, seed: int, first: int, steps: int, present: Array | None = None
) -> Iterator[list[int]]:
    """Which keyframes make which step: each epoch all of them, shuffled by seed and epoch alone. Where it is known which classes are
    `present` (keyframes, K), an epoch is as long, but draws as many keyframes of each class."""
    of_epoch = math.ceil(keyframes / a_step)
    for step in range(first, steps):
        epoch, place = divmod(step, of_epoch)
        draw = np.random.default_rng([seed, 1, epoch])
        shuffled = draw.permutation(keyframes if present is None else balanced(present, draw))
        yield shuffled[place * a_step : (place + 1) * a_step].tolist()


def balanced(present: Array, draw: np.random.Generator) -> Array:
    """As many keyframes as there are, of each class that is anywhere the same number, again and again if it is rare."""
    classes = np.flatnonzero(present.any(axis=0))
    if not len(classes):
        return np.arange(len(present))
    of_class = np.resize(draw.permutation(classes), len(present))
    return np.array([draw.choice(np.flatnonzero(present[:, k])) for k in of_class])


def rate_at(step: int, settings: Settings) -> float:
    """Learning rate: up over the first twentieth, then down along a cosine."""
    part = step / settings.steps
    return settings.rate * (part / 0.05 if part < 0.05 else 0.5 * (1 + math.cos(math.pi * (part - 0.05) / 0.95)))


def train(
    dataset: convoy.Dataset,
    settings: Settings,
    out: pathlib.Path,
    *,
    mode: str,
    seed: int = 0,
    spoil: str = "",
    split: str = "train",
    device: str = "cpu",
    workers: int = 0,
    start: pathlib.Path | None = None,
    pack: pathlib.Path | None = None,
    share: float = 1.0,
    stop_after: int | None = None,
    losses: list[float] | None = None,
    say: bool = True,
) -> Run:
    """Trains until all steps are done, or `stop_after` of this call, and keeps the model in `out`. It begins with weights of another
    checkpoint, `start`, as far as they fit, and reads keyframes of a `pack` if there is one. Of the scenes a `share` of 1 / n is used.
    The loss of each step is added to `losses`."""
    on = torch.device(device)
    keyframes = (
        Packed(dataset, split, settings, pack, share)
        if pack
        else Keyframes(dataset, split, settings, keep=workers == 0, share=share)
    )
    began_from = "" if start is None else digest(start)
    run = Run(settings, check_mode(mode), seed, spoil, began_from, keyframes.classes(), 0, 0.0, share)
    torch.manual_seed(seed)
    model = Model(settings, len(run.masks)).to(on)
    optimiser = torch.optim.AdamW(model.parameters(), lr=settings.rate, weight_decay=settings.weight_decay)
    average = averaged(model, settings)
    if start is not None and not out.exists():
        taken, left = begin(model, start, on)
        if average is not None:
            average = averaged(model, settings)
        if say:
            print(f"{start}: {taken} tensors of weights to begin with, {left} of the model begin anew", flush=True)
    if out.exists():
        kept, state = load(out, on)
        if kept.identity() != run.identity():
            raise ValueError(f"{out} is of another run ({kept.identity()}): remove it, or choose another file")
        model.load_state_dict(state["model"])
        optimiser.load_state_dict(state["optimiser"])
        if average is not None:
            average.load_state_dict(state["average"])
        run = kept
        if run.done:
            return run
    present = keyframes.present() if settings.balanced else None
    last = settings.steps if stop_after is None else min(run.step + stop_after, settings.steps)
    loader: DataLoader[Keyframe] = DataLoader(
        keyframes,
        batch_sampler=list(order(len(keyframes), settings.frames_a_step, seed, run.step, last, present)),
        num_workers=workers,
        collate_fn=list,
    )
    model.train()
    began = kept_at = time.monotonic()
    before = run.seconds
    for batch in loader:
        draw = np.random.default_rng([seed, 2, run.step])
        inputs, wiring, targets = example(batch, mode, settings, draw, SPOILS.get(spoil))
        for group in optimiser.param_groups:
            group["lr"] = rate_at(run.step, settings)
        with torch.autocast(on.type, torch.bfloat16, enabled=on.type == "cuda"):
            said = model(inputs.to(on), wiring.to(on))
        parts = loss(model, said, targets.to(on), settings)
        optimiser.zero_grad()
        parts["all"].backward()  # type: ignore[no-untyped-call]
        torch.nn.utils.clip_grad_norm_(model.parameters(), 10.0)
        optimiser.step()
        if average is not None:
            average.update_parameters(model)
        if losses is not None:
            losses.append(parts["all"].item())
        now = time.monotonic()
        run.step, run.seconds = run.step + 1, before + now - began
        if say and run.step % SAY_EVERY == 0:
            about = ", ".join(f"{name} {part.item():.3f}" for name, part in parts.items())
            print(f"step {run.step} of {settings.steps}, {run.seconds:.0f} s: {about}", flush=True)
        if now - kept_at > KEEP_EVERY_S:
            save(out, run, model, optimiser, average)
            kept_at = now
    save(out, run, model, optimiser, average)
    return run


def main(arguments: list[str] | None = None) -> int:
    """The program."""
    parser = argparse.ArgumentParser(prog="python -m convoy_baseline.train", description="Trains a model on a store.")
    parser.add_argument("--store", required=True)
    parser.add_argument("--out", required=True, type=pathlib.Path, help="checkpoint; a run goes on where it was")
    parser.add_argument(
        "--mode",
        choices=convoy.MODES,
        help="with whom it learns to work together (default: the settings' mode, or none)",
    )
    parser.add_argument(
        "--settings",
        type=pathlib.Path,
        help="a TOML file with a table [model], such as configs/models/small/coopdet3d-l.toml",
    )
    parser.add_argument("--start", type=pathlib.Path, help="a checkpoint whose weights it begins with, where they fit")
    parser.add_argument("--pack", type=pathlib.Path, help="reads keyframes of what convoy_baseline.pack made")
    parser.add_argument(
        "--share", type=float, default=1.0, help="learns from each n-th scene alone: 1 / n, such as 0.25"
    )
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--split", default="train")
    parser.add_argument("--device", default="cpu", choices=("cpu", "cuda"))
    parser.add_argument(
        "--workers", type=int, default=0, help="processes that read; 0: this one, and it keeps what it read"
    )
    parser.add_argument("--threads", type=int, help="of PyTorch, on a CPU")
    parser.add_argument(
        "--spoil", default="", choices=("", *SPOILS), help="spoils the labels, to see that scores collapse"
    )
    options = parser.parse_args(arguments)
    if options.threads:
        torch.set_num_threads(options.threads)
    try:
        settings, mode = read_with_mode(options.settings) if options.settings else (Settings(), None)
        run = train(
            convoy.Dataset(options.store),
            settings,
            options.out,
            mode=options.mode or mode or "none",
            seed=options.seed,
            spoil=options.spoil,
            split=options.split,
            device=options.device,
            workers=options.workers,
            start=options.start,
            pack=options.pack,
            share=options.share,
        )
    except (convoy.StoreError, ValueError, OSError) as fault:
        print(f"error: {fault}", file=sys.stderr)
        return 1
    print(f"{options.out}: {run.step} steps in {run.seconds:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
