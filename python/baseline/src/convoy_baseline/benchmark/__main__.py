"""python -m convoy_baseline.benchmark --plan python/baseline/benchmark.toml --store benchmark-store --out benchmark --page docs/benchmark.md

Makes the data, trains, scores, writes the page. What is done is kept: started again, it goes on.
"""

from __future__ import annotations

import argparse
import dataclasses
import pathlib
import subprocess
import sys
import time

import convoy
import torch
from convoy.evaluation import found as found_program

from convoy_baseline.benchmark.page import Trained, page
from convoy_baseline.benchmark.plan import Entry, Plan, read
from convoy_baseline.benchmark.scores import score
from convoy_baseline.checkpoint import load
from convoy_baseline.conditions import Condition
from convoy_baseline.frames import Keyframes
from convoy_baseline.train import train


@dataclasses.dataclass(frozen=True)
class Job:
    """Where a benchmark works, and with what."""

    plan: Plan
    store: str
    out: pathlib.Path
    device: str
    workers: int
    program: str


def main(arguments: list[str] | None = None) -> int:
    """The program."""
    parser = argparse.ArgumentParser(
        prog="python -m convoy_baseline.benchmark", description="Data, models, scores, a page."
    )
    parser.add_argument("--plan", required=True, type=pathlib.Path, help="a TOML file: python/baseline/benchmark.toml")
    parser.add_argument("--store", required=True, help="where the data is, or will be")
    parser.add_argument("--out", required=True, type=pathlib.Path, help="a folder for models and scores")
    parser.add_argument("--page", required=True, type=pathlib.Path, help="the page that is written")
    parser.add_argument("--program", help="Convoy's program (default: as convoy.evaluate finds it)")
    parser.add_argument("--device", default="cpu", choices=("cpu", "cuda"))
    parser.add_argument("--workers", type=int, default=0, help="processes that read data for training")
    parser.add_argument("--threads", type=int, help="of PyTorch, on a CPU")
    options = parser.parse_args(arguments)
    if options.threads:
        torch.set_num_threads(options.threads)
    try:
        plan = read(options.plan)
        program = found_program(options.program)
        options.out.mkdir(parents=True, exist_ok=True)
        job = Job(plan, options.store, options.out, options.device, options.workers, program)
        about = make_data(job)
        trained = [one for entry in plan.entries for seed in plan.seeds for one in [learn(job, entry, seed)]]
        spoilt = [(name or "right", learn_spoilt(job, name)) for name in ("", *plan.spoilt) if plan.spoilt_steps]
        options.page.write_text(page(plan, trained, spoilt, about))
    except (convoy.StoreError, convoy.ProgramError, ValueError, OSError) as fault:
        print(f"error: {fault}", file=sys.stderr)
        return 1
    print(f"written: {options.page}")
    return 0


def make_data(job: Job) -> list[str]:
    """Makes what is missing of the store; says what it has."""
    began = time.monotonic()
    command = [job.program, "run", "--config", str(job.plan.config), "--store", job.store, "--progress", "plain"]
    if subprocess.run(command, check=False).returncode:
        raise ValueError(f"{' '.join(command)} did not end well: see above")
    dataset, settings = convoy.Dataset(job.store), job.plan.entries[0].settings
    say(job, f"data: {time.monotonic() - began:.0f} s")
    lines = []
    for split in ("train", job.plan.test_split):
        keyframes = Keyframes(dataset, split, settings)
        scenes = {scene for scene, _ in keyframes.keys}
        towns = sorted({dataset.scene(scene).map_name for scene in scenes})
        lines.append(f"{split}: {len(keyframes)} keyframes in {len(scenes)} scenes of {', '.join(towns)}")
    return lines


def learn(job: Job, entry: Entry, seed: int) -> Trained:
    """Trains and scores a model."""
    return finish(job, entry, seed, f"{entry.name}-{seed}", "")


def learn_spoilt(job: Job, spoil: str) -> Trained:
    """The last of the models, with few steps and spoilt labels, or with right ones."""
    entry = job.plan.entries[-1]
    short = dataclasses.replace(
        entry,
        settings=dataclasses.replace(entry.settings, steps=job.plan.spoilt_steps),
        conditions=(Condition("x2x", "x2x"),),
    )
    return finish(job, short, job.plan.seeds[0], f"labels-{spoil or 'right'}", spoil)


def finish(job: Job, entry: Entry, seed: int, name: str, spoil: str) -> Trained:
    """Goes on with training where it was, then scores."""
    checkpoint = job.out / f"{name}.pt"
    if not (checkpoint.exists() and load(checkpoint, torch.device("cpu"))[0].done):
        say(job, f"{name}: training")
    run = train(
        convoy.Dataset(job.store), entry.settings, checkpoint,
        mode=entry.mode, seed=seed, spoil=spoil, device=job.device, workers=job.workers,
    )  # fmt: skip
    began = time.monotonic()
    rows = score(
        job.store, job.plan.test_split, checkpoint, entry, job.plan.latest_frames, job.out / f"{name}.parquet",
        job.device, job.program,
    )  # fmt: skip
    say(job, f"{name}: {run.step} steps in {run.seconds:.0f} s, scored in {time.monotonic() - began:.0f} s")
    return Trained.of(entry, run, rows)


def say(job: Job, what: str) -> None:
    """On the screen and in the log of the folder."""
    print(what, flush=True)
    with open(job.out / "log.txt", "a") as file:
        print(what, file=file)


if __name__ == "__main__":
    sys.exit(main())
