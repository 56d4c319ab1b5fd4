"""Scores of a trained model: its predictions as files, and what `convoy evaluate` says of them."""

from __future__ import annotations

import hashlib
import json
import os
import pathlib
import shutil
import tempfile
from dataclasses import dataclass
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
import torch
from convoy.evaluation import run as run_program

from convoy_baseline.benchmark.plan import Entry
from convoy_baseline.conditions import Condition
from convoy_baseline.found import Found, MaskWriter, Writer
from convoy_baseline.predict import opened, predict
from convoy_baseline.settings import Settings

BOXES, MASKS, NOTE = "modes.parquet", "masks", "about.json"


@dataclass(frozen=True)
class Judge:
    """What holds predictions against the store."""

    program: str
    store: str
    split: str
    rounds: int
    """How often scenes are drawn; 0: never."""

    def boxes(self, path: pathlib.Path, settings: Settings, rounds: int | None = None) -> list[dict[str, Any]]:
        """Numbers of a file of boxes, within the model's ground."""
        half = settings.grid.half_m
        reach = ["--comm-range-m", str(settings.comm_range_m), "--elevation-m", str(settings.elevation_m)]
        within = [f"--range-m={-half},{-half},{half},{half}"]
        return self._say(["--predictions", str(path), "--metrics", "simbev2x", *reach, *within], rounds)

    def masks(self, folder: pathlib.Path, settings: Settings) -> list[dict[str, Any]]:
        """Numbers of a folder of masks, of their own extent."""
        return self._say(["--bev-masks", str(folder), "--every", str(settings.every)], None)

    def _say(self, what: list[str], rounds: int | None) -> list[dict[str, Any]]:
        rounds = self.rounds if rounds is None else rounds
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder, "scores.json")
            command = [self.program, "evaluate", *what, "--store", self.store, "--split", self.split, "--out", str(out)]
            command += ["--bootstrap", str(rounds), "--by", "map"] if rounds else []
            run_program(command)
            rows: list[dict[str, Any]] = json.loads(out.read_text())
            return rows


def predicted(
    store: str, split: str, checkpoint: pathlib.Path, entry: Entry, conditions: tuple[Condition, ...], folder: pathlib.Path, device: str
) -> dict[str, Any]:  # fmt: skip
    """Writes what a checkpoint predicts into a folder, unless it is there: boxes and masks of all modes, boxes of each other condition.
    Says how many samples, partners and bytes there were under each."""
    digest = hashlib.sha256(checkpoint.read_bytes()).hexdigest()
    wanted = {"checkpoint": digest, "conditions": [condition.name for condition in conditions]}
    note: dict[str, Any]
    try:
        note = json.loads((folder / NOTE).read_text())
        if {name: note.get(name) for name in wanted} == wanted:
            return note
    except (OSError, ValueError):
        pass
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    run, network, keyframes = opened(store, checkpoint, split, torch.device(device))
    modes, masks = (
        Writer(run.settings.classes),
        MaskWriter(folder / MASKS, run.settings.mask_grid, keyframes.mask_cell_m()),
    )
    others = {condition.name: Writer(run.settings.classes) for condition in conditions}
    latest = max((condition.delay_frames for condition in conditions), default=0)

    def take(found: Found) -> None:
        if found.condition.name not in others:
            modes.take(found)
            masks.take(found)
        # Whatever has to do with delay is asked of the same frames.
        elif not found.condition.name.startswith("delay") or found.keyframe.number >= latest:
            others[found.condition.name].take(found)

    asked = [*(Condition(mode, mode) for mode in entry.modes), *conditions]
    predict(network, run.settings, keyframes, asked, take, torch.device(device))
    modes.write(folder / BOXES)
    masks.close()
    for name, writer in others.items():
        writer.write(folder / file_of(name))
    heard = {name: of for writer in (modes, *others.values()) for name, of in writer.heard.items()}
    note = {**wanted, "heard": heard}
    beside = folder / (NOTE + ".new")
    beside.write_text(json.dumps(note))
    os.replace(beside, folder / NOTE)
    return note


def file_of(condition: str) -> str:
    """The name of a condition's file."""
    return condition.replace(",", "").replace(" ", "-") + ".parquet"


def scored(judge: Judge, folder: pathlib.Path, settings: Settings, conditions: tuple[Condition, ...]) -> dict[str, Any]:
    """All numbers of a folder of predictions: of its modes, and of other conditions without intervals."""
    found: dict[str, Any] = {}
    if "boxes" in settings.tasks:
        found["boxes"] = judge.boxes(folder / BOXES, settings)
    if (folder / MASKS).is_dir():
        found["masks"] = judge.masks(folder / MASKS, settings)
    found["conditions"] = {
        condition.name: judge.boxes(folder / file_of(condition.name), settings, rounds=0) for condition in conditions
    }
    return found


def gained(judge: Judge, folder: pathlib.Path, rival: pathlib.Path, mode: str, settings: Settings) -> dict[str, Any]:
    """What a model that works together gains over another one that never did, by the same draws of scenes: numbers of one file in which
    mode `none` is the rival's."""
    found: dict[str, Any] = {}
    with tempfile.TemporaryDirectory(dir=folder) as both:
        if "boxes" in settings.tasks:
            tables = [pq.read_table(of / BOXES) for of in (rival, folder)]
            parts = [
                table.filter(pc.equal(table["mode"], name)) for table, name in zip(tables, ("none", mode), strict=True)
            ]
            path = pathlib.Path(both, BOXES)
            pq.write_table(pa.concat_tables(parts), path, compression="zstd")
            found["boxes"] = judge.boxes(path, settings)
        if (folder / MASKS).is_dir():
            masks = pathlib.Path(both, MASKS)
            masks.mkdir()
            for of, name in ((rival, "none"), (folder, mode)):
                (masks / name).symlink_to((of / MASKS / name).resolve(), target_is_directory=True)
            found["masks"] = judge.masks(masks, settings)
    return found
