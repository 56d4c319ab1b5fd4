"""python -m convoy_baseline.benchmark --plan python/baseline/benchmark.toml --store benchmark-store --out benchmark

Makes the data, trains, scores, leaves a file of each run in docs/results, and makes the page docs/results.md of all that are there. What
is done is kept: started again, it goes on. With --seeds and --models a part is run, and others later.
"""

from __future__ import annotations

import argparse
import dataclasses
import hashlib
import json
import pathlib
import subprocess
import sys
import time
from typing import Any

import convoy
import torch
from convoy.evaluation import found as found_program
from convoy.evaluation import run as run_program

from convoy_baseline.benchmark.forecast import forecast, try_out
from convoy_baseline.benchmark.page import page
from convoy_baseline.benchmark.plan import Entry, Plan, read
from convoy_baseline.benchmark.records import Record, box_rows, commit, machine, mask_rows, read_all
from convoy_baseline.benchmark.scores import Judge, gained, predicted, scored
from convoy_baseline.checkpoint import Run, load
from convoy_baseline.frames import Keyframes
from convoy_baseline.pack import KEYS, pack_split
from convoy_baseline.parts import counts, table
from convoy_baseline.settings import Settings
from convoy_baseline.train import train

PLANS = ("benchmark", "benchmark-gpu", "benchmark-full")
"""Whose rows the page names as open where there is no run."""
NOTE = "scored.json"
FULL_SIZE = pathlib.Path("python/baseline/configs/models/full")
"""The models whose sizes the page tells; like the page itself below the folder in which the benchmark is started."""


@dataclasses.dataclass(frozen=True)
class Job:
    """Where a benchmark works, and with what."""

    plan: Plan
    store: str
    out: pathlib.Path
    results: pathlib.Path
    device: str
    workers: int
    program: str
    began: float

    @property
    def judge(self) -> Judge:
        """Who scores."""
        return Judge(self.program, self.store, self.plan.test_split, self.plan.bootstrap)

    def say(self, what: str) -> None:
        """On the screen and in the log of the folder, with the seconds since it was started."""
        line = f"[{time.monotonic() - self.began:6.0f} s] {what}"
        print(line, flush=True)
        with open(self.out / "log.txt", "a") as file:
            print(line, file=file)


def arguments_of(arguments: list[str] | None) -> argparse.Namespace:
    """Those of the command line."""
    parser = argparse.ArgumentParser(
        prog="python -m convoy_baseline.benchmark", description="Data, models, scores, a page."
    )
    parser.add_argument(
        "--plan",
        type=pathlib.Path,
        help="a TOML file: python/baseline/benchmark.toml; without it only the page is made",
    )
    parser.add_argument("--store", help="where the data is, or will be")
    parser.add_argument("--out", type=pathlib.Path, help="a folder for packs, models and predictions")
    parser.add_argument("--results", type=pathlib.Path, default="docs/results", help="a folder for a file of each run")
    parser.add_argument("--page", type=pathlib.Path, default="docs/results.md", help="the page that is written")
    parser.add_argument("--seeds", type=_numbers, help="only these, such as 0,1 (default: the plan's)")
    parser.add_argument(
        "--models", type=lambda text: text.split(","), help="only these, such as bevfusion-l,coopdet3d-l"
    )
    parser.add_argument("--extras", action="store_true", help="learning curves and spoilt labels, too")
    parser.add_argument("--forecast", action="store_true", help="says what the plan comes to, and does nothing")
    parser.add_argument(
        "--steps",
        type=int,
        help="trains only so many steps of each model, to see time, memory and whether the loss falls",
    )
    parser.add_argument(
        "--rate", type=float, help="with --forecast: how many 10^12 operations a second the machine makes, such as 40"
    )
    parser.add_argument("--program", help="Convoy's program (default: as convoy.evaluate finds it)")
    parser.add_argument("--device", default="cpu", choices=("cpu", "cuda"))
    parser.add_argument("--workers", type=int, default=0, help="processes that read data for training")
    parser.add_argument("--threads", type=int, help="of PyTorch, on a CPU")
    options = parser.parse_args(arguments)
    if options.plan and not options.forecast and not (options.store and options.out):
        parser.error("expected --store and --out")
    return options


def _numbers(text: str) -> list[int]:
    return [int(part) for part in text.split(",")]


def main(arguments: list[str] | None = None) -> int:
    """The program."""
    options = arguments_of(arguments)
    if options.threads:
        torch.set_num_threads(options.threads)
    try:
        if options.plan:
            work(options)
        if not options.forecast and options.steps is None:
            pictures = [path.name for path in sorted(options.results.glob("found-*.png"))]
            sizes = table(sorted(FULL_SIZE.glob("*/*.toml")))
            options.page.write_text(page(read_all(options.results), PLANS, pictures, sizes))
            print(f"written: {options.page}")
    except (convoy.StoreError, convoy.ProgramError, ValueError, OSError) as fault:
        print(f"error: {fault}", file=sys.stderr)
        return 1
    return 0


def work(options: argparse.Namespace) -> None:
    """All that is to be done of a plan."""
    plan = read(options.plan)
    runs = plan.runs(options.seeds, options.models, options.extras)
    program = found_program(options.program)
    if options.forecast:
        print(forecast(plan, runs, program, options.out, options.rate))
        return
    options.out.mkdir(parents=True, exist_ok=True)
    job = Job(
        plan, options.store, options.out, options.results, options.device, options.workers, program, time.monotonic()
    )
    make_data(job)
    if options.steps is not None:
        for entry, seed in runs:
            job.say(
                try_out(
                    convoy.Dataset(job.store),
                    entry,
                    seed,
                    packed(job, entry.settings),
                    options.steps,
                    job.device,
                    job.out,
                )
            )
        return
    for number, (entry, seed) in enumerate(runs, 1):
        finish(job, entry, seed, f"run {number} of {len(runs)}, {entry.name} with seed {seed}")


def make_data(job: Job) -> None:
    """Makes what is missing of the store."""
    began = time.monotonic()
    command = [job.program, "run", "--config", str(job.plan.config), "--store", job.store, "--progress", "plain"]
    if subprocess.run(command, check=False).returncode:
        raise ValueError(f"{' '.join(command)} did not end well: see above")
    job.say(f"data: {time.monotonic() - began:.0f} s")


def about_data(job: Job, settings: Settings, share: float) -> tuple[list[str], list[str]]:
    """What is learnt from and tested on, in words; and the maps that are learnt from."""
    dataset, lines, maps = convoy.Dataset(job.store), [], []
    for split, part in (("train", share), (job.plan.test_split, 1.0)):
        keyframes = Keyframes(dataset, split, settings, keep=False, share=part)
        scenes = {scene for scene, _ in keyframes.keys}
        towns = sorted({dataset.scene(scene).map_name for scene in scenes})
        lines.append(f"{split}: {len(keyframes)} keyframes in {len(scenes)} scenes of {', '.join(towns)}")
        maps.append(towns)
    return lines, maps[0]


def packed(job: Job, settings: Settings) -> pathlib.Path:
    """A pack of the scenes to learn from, made where it is missing; models of the same sensors and grids share one."""
    values = {key: getattr(settings, key) for key in KEYS}
    name = hashlib.sha256(json.dumps(values, sort_keys=True).encode()).hexdigest()[:8]
    pack = job.out / f"pack-{name}"
    began = time.monotonic()
    count, size = pack_split(job.store, "train", settings, pack, max(job.workers, torch.get_num_threads()))
    if size:
        job.say(f"{pack}: {count} keyframes, {size / 1e6:.0f} MB in {time.monotonic() - began:.0f} s")
    return pack


def learn(job: Job, entry: Entry, seed: int, words: str) -> tuple[Run, pathlib.Path]:
    """Goes on with training where it was."""
    checkpoint = checkpoint_of(job, entry.name, seed)
    if checkpoint.exists():
        run = load(checkpoint, torch.device("cpu"))[0]
        if run.done and run.settings == entry.settings:
            return run, checkpoint
    start = checkpoint_of(job, entry.start, seed) if entry.start else None
    if start is not None and not start.exists():
        raise ValueError(f"{entry.name} starts with {entry.start}, seed {seed}: train that first ({start} is missing)")
    pack = packed(job, entry.settings)
    job.say(f"{words}: training")
    spoil = "" if entry.spoil == "right" else entry.spoil
    run = train(
        convoy.Dataset(job.store), entry.settings, checkpoint,
        mode=entry.mode, seed=seed, spoil=spoil, device=job.device, workers=job.workers, pack=pack, share=entry.share, start=start,
    )  # fmt: skip
    job.say(f"{words}: {run.step} steps in {run.seconds:.0f} s")
    return run, checkpoint


def checkpoint_of(job: Job, name: str, seed: int) -> pathlib.Path:
    """Where a model is kept."""
    return job.out / f"{name}-{seed}.pt"


def finish(job: Job, entry: Entry, seed: int, words: str) -> None:
    """Trains and scores a model, and leaves a file of it."""
    run, checkpoint = learn(job, entry, seed, words)
    began = time.monotonic()
    conditions = entry.conditions if seed == job.plan.seeds[0] else ()
    folder = job.out / f"{entry.name}-{seed}"
    job.say(f"{words}: predicting")
    note = predicted(job.store, job.plan.test_split, checkpoint, entry, conditions, folder, job.device)
    job.say(f"{words}: predicted in {time.monotonic() - began:.0f} s")
    rival = job.out / f"{entry.rival}-{seed}" if entry.rival else None
    rival_note = (
        json.loads((rival / "about.json").read_text())
        if rival is not None and (rival / "about.json").exists()
        else None
    )
    if rival is not None and rival_note is None:
        job.say(f"{words}: {entry.rival} with this seed has not run: what is gained over it stays open")
    # What scores are of: where nothing of it changed, they stay.
    version = run_program([job.program, "--version"]).strip()
    wanted: dict[str, Any] = {
        "checkpoint": note["checkpoint"], "conditions": note["conditions"], "rounds": job.plan.bootstrap, "program": version,
        "rival": None if rival_note is None else rival_note["checkpoint"],
    }  # fmt: skip
    path = job.results / f"{job.plan.name}-{entry.name}-{seed}.json"
    try:
        if path.exists() and json.loads((folder / NOTE).read_text()) == wanted:
            job.say(f"{words}: {path} is there")
            return
    except (OSError, ValueError):
        pass
    began = time.monotonic()
    speed = measured(job, entry, checkpoint)
    numbers = scored(job.judge, folder, entry.settings, conditions)
    gain = {} if rival_note is None or rival is None else gained(job.judge, folder, rival, entry.mode, entry.settings)
    data, seen_maps = about_data(job, entry.settings, entry.share)
    classes, modes = entry.settings.classes, ("none", entry.mode)
    record = Record(
        job.plan.name, entry.name, entry.model, entry.mode, seed, entry.share, entry.spoil, commit(), machine(job.device), version,
        dataclasses.asdict(entry.settings), run.step, round(run.seconds, 1), sum(counts(entry.settings, len(run.masks)).values()),
        speed, {name: [of[0], of[1] / max(of[0], 1), of[2] / max(of[1], 1)] for name, of in note["heard"].items()},
        data, seen_maps,
        boxes=box_rows(numbers.get("boxes", ()), classes, modes),
        masks=mask_rows(numbers.get("masks", ()), modes),
        gain_boxes=box_rows(_of(gain.get("boxes", ()), entry.mode), (), ()),
        gain_masks=mask_rows(_of(gain.get("masks", ()), entry.mode), ()),
        conditions={name: box_rows(rows, (), ()) for name, rows in numbers["conditions"].items()},
    )  # fmt: skip
    record.write(job.results)
    (folder / NOTE).write_text(json.dumps(wanted))
    job.say(f"{words}: scored in {time.monotonic() - began:.0f} s: {path}")


def _of(rows: list[dict[str, Any]], mode: str) -> list[dict[str, Any]]:
    return [row for row in rows if row["mode"] == mode]


def measured(job: Job, entry: Entry, checkpoint: pathlib.Path) -> dict[str, float]:
    """Speed and memory, by a process of its own."""
    command = [
        sys.executable,
        "-m",
        "convoy_baseline.benchmark.measure",
        "--store",
        job.store,
        "--split",
        job.plan.test_split,
    ]
    command += [
        "--model",
        str(checkpoint),
        "--mode",
        entry.mode,
        "--device",
        job.device,
        "--threads",
        str(torch.get_num_threads()),
    ]
    found: dict[str, float] = json.loads(run_program(command))
    return found


if __name__ == "__main__":
    sys.exit(main())
