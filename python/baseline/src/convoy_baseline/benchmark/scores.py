"""Scores of a trained model, under each condition, kept as a table."""

from __future__ import annotations

import functools
import hashlib
import os
import pathlib
from dataclasses import replace
from itertools import chain
from typing import Any

import convoy
import pyarrow as pa
import pyarrow.parquet as pq
import torch

from convoy_baseline.batch import heard
from convoy_baseline.benchmark.plan import Entry
from convoy_baseline.frames import Keyframe, truth
from convoy_baseline.predict import Found, Writer, opened, predict
from convoy_baseline.score import SUBSETS, THRESHOLDS_M, Tally

DIGEST = b"checkpoint"
SCHEMA = pa.schema(
    [
        ("condition", pa.string()),
        ("measure", pa.string()),
        ("class", pa.string()),
        ("subset", pa.string()),
        ("threshold_m", pa.float64()),
        ("value", pa.float64()),
    ]
)
SAME = 1e-6
"""How far our numbers and those of `evaluate` may be apart."""


def score(
    store: str, split: str, model: pathlib.Path, entry: Entry, late: int, out: pathlib.Path, device: str, program: str
) -> list[dict[str, Any]]:
    """Scores of a checkpoint: those that are kept, or new ones. `late` frames are left out at the beginning of scenes where conditions
    have to do with delay, so that all of them are about the same frames."""
    digest = hashlib.sha256(model.read_bytes()).hexdigest().encode()
    if out.exists() and (pq.read_schema(out).metadata or {}).get(DIGEST) == digest:
        kept: list[dict[str, Any]] = pq.read_table(out).to_pylist()
        return kept
    run, network, keyframes = opened(store, model, split, torch.device(device))
    settings = run.settings
    tallies = {
        c.name: Tally(settings.classes, settings.grid, late if c.name.startswith("delay") else 0)
        for c in entry.conditions
    }
    whole = {c.name: Tally(settings.classes, None) for c in entry.conditions if c.name == c.mode}
    writer = Writer(settings.classes)

    @functools.lru_cache(maxsize=1)
    def with_itself(keyframe: Keyframe) -> Keyframe:
        frame = keyframes.dataset.scene(keyframe.scene).frame(keyframe.number)
        names = [keyframe.views[ego].agent for ego in keyframe.egos]
        return replace(keyframe, truths=tuple(truth(frame, name, settings, itself=True) for name in names))

    def take(found: Found) -> None:
        ego = found.keyframe.views[found.keyframe.egos[found.ego]]
        near = heard(ego, found.keyframe.views, "x2x", settings.comm_range_m, settings.elevation_m)
        tallies[found.condition.name].take(found, not near)
        if found.condition.name in whole:
            whole[found.condition.name].take(replace(found, keyframe=with_itself(found.keyframe)), not near)
            writer.take(found)

    predict(network, settings, keyframes, entry.conditions, take, torch.device(device))
    predictions = out.with_suffix(".predictions.parquet")
    writer.write(predictions)
    rows = [row for name, tally in tallies.items() for row in numbers(name, tally, run.masks)]
    agree(store, split, settings.every, predictions, whole, program)
    table = pa.Table.from_pylist(rows, SCHEMA.with_metadata({DIGEST: digest}))
    pq.write_table(table, out.with_name(out.name + ".new"))
    os.replace(out.with_name(out.name + ".new"), out)
    return rows


def numbers(condition: str, tally: Tally, masks: tuple[str, ...]) -> list[dict[str, Any]]:
    """All that is said of a condition."""

    def row(
        measure: str, value: float | None, of: str = "all", subset: str = "all", at: float | None = None
    ) -> dict[str, Any]:
        return {
            "condition": condition, "measure": measure, "class": of, "subset": subset, "threshold_m": at, "value": value,
        }  # fmt: skip

    rows = [
        row("samples", float(len(tally.partners))),
        row("partners", sum(tally.partners) / max(len(tally.partners), 1)),
    ]
    for subset in SUBSETS:
        rows.append(row("targets", float(tally.target_count(subset)), subset=subset))
        rows.append(row("mAP", tally.mean_precision(subset), subset=subset))
        rows += [row("mAP at", tally.mean_precision(subset, at), subset=subset, at=at) for at in THRESHOLDS_M]
    for k, name in enumerate(tally.classes):
        rows += [row("AP", tally.average_precision(k, at), name, at=at) for at in THRESHOLDS_M]
    rows += [row("IoU", tally.overlap(i), name) for i, name in enumerate(masks)]
    return rows


def agree(
    store: str, split: str, every: int, predictions: pathlib.Path, tallies: dict[str, Tally], program: str
) -> None:
    """Fails unless `evaluate` says the same of the same predictions, on all targets. It knows nothing of a mode without any."""
    tallies = {
        mode: tally for mode, tally in tallies.items() if any(len(rows) for rows in chain(*tally.predicted.values()))
    }
    if not tallies:
        return
    theirs = convoy.evaluate(
        predictions, store, split=split, every=every, metrics=["simbev2x"], program=program or None
    )
    for mode, tally in tallies.items():
        for k, name in enumerate(tally.classes):
            for at in THRESHOLDS_M:
                for level in ("all", "easy", "medium", "hard"):
                    ours = tally.average_precision(k, at, level)
                    other = theirs.value("AP", mode=mode, threshold=at, level=level, of_class=name)
                    if (ours is None) != (other is None) or abs((ours or 0.0) - (other or 0.0)) > SAME:
                        raise ValueError(
                            f"{predictions}: AP of {name} at {at} m, {level}, mode {mode}: {ours} here, {other} by {theirs.program}"
                        )
