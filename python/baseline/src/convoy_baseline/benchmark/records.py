"""What a run leaves: one JSON file with all that the page says of it."""

from __future__ import annotations

import json
import os
import pathlib
import platform
import subprocess
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import torch

VERSION = 1
COLUMNS = (
    "map",
    "mode",
    "class",
    "level",
    "measure",
    "threshold",
    "value",
    "low",
    "high",
    "gain",
    "gain_low",
    "gain_high",
)
"""Of a number, in their order: as `convoy evaluate` writes them. No map: all of them."""
MEANS = {"mAP", "mATE", "mAOE", "mASE", "mAVE", "SDS"}
PARTS = {"AP", "targets"}
RINGS = ("0-20 m", "20-40 m", "over 40 m")
MASK_THRESHOLDS = (0.5, 0.7, 0.9)

Rows = list[list[Any]]


@dataclass(frozen=True)
class Record:
    """A run."""

    plan: str
    entry: str
    model: str
    mode: str
    seed: int
    share: float
    spoil: str
    commit: str
    machine: str
    program: str
    """Convoy's version."""
    settings: dict[str, Any]
    steps: int
    train_s: float
    parameters: int
    speed: dict[str, float]
    """`fps`, `memory_bytes`, `samples`: of predicting."""
    heard: dict[str, list[float]]
    """Of each condition: samples, partners of a sample, bytes of a partner and frame."""
    data: list[str]
    """What it learnt from and was tested on."""
    seen_maps: list[str]
    """Those with scenes to learn from."""
    boxes: Rows = field(default_factory=list)
    masks: Rows = field(default_factory=list)
    gain_boxes: Rows = field(default_factory=list)
    """Numbers beside those of the model that never worked together, whose are those of mode none."""
    gain_masks: Rows = field(default_factory=list)
    conditions: dict[str, Rows] = field(default_factory=dict)

    def write(self, folder: pathlib.Path) -> pathlib.Path:
        """Writes it, replacing what is there as a whole."""
        path = folder / f"{self.plan}-{self.entry}-{self.seed}.json"
        values = {"version": VERSION, **asdict(self)}
        lines = [f'"{name}": {_text(value)}' for name, value in values.items()]
        folder.mkdir(parents=True, exist_ok=True)
        beside = path.with_name(path.name + ".new")
        beside.write_text("{\n" + ",\n".join(lines) + "\n}\n")
        os.replace(beside, path)
        return path


def _text(value: Any) -> str:
    """A number of the scores a line, so that changes can be read."""
    if isinstance(value, list) and value and isinstance(value[0], list):
        return "[\n" + ",\n".join(json.dumps(row, separators=(",", ":")) for row in value) + "\n]"
    if isinstance(value, dict) and value and all(isinstance(part, list) for part in value.values()):
        return "{\n" + ",\n".join(f"{json.dumps(name)}: {_text(part)}" for name, part in value.items()) + "\n}"
    return json.dumps(value)


def read_all(folder: pathlib.Path) -> list[Record]:
    """All runs of a folder, in the order of their files' names."""
    found = []
    for path in sorted(folder.glob("*.json")):
        try:
            values = json.loads(path.read_text())
            version = values.pop("version")
            if version != VERSION:
                raise ValueError(f"it is of version {version}, expected {VERSION}: make it anew")
            found.append(Record(**values))
        except (KeyError, TypeError, AttributeError, ValueError) as fault:
            raise ValueError(f"{path} is no result of a run: {fault}") from fault
    return found


def box_rows(rows: Iterable[dict[str, Any]], classes: Sequence[str], modes: Sequence[str]) -> Rows:
    """Those that the page is made of: means, and in these modes those of the model's classes."""
    return _rows(
        row
        for row in rows
        if row["measure"] in MEANS
        or (row["measure"] in PARTS and row["class"] in classes and row["mode"] in modes and row.get("map") is None)
    )


def mask_rows(rows: Iterable[dict[str, Any]], modes: Sequence[str]) -> Rows:
    """Likewise: means of any class at the thresholds of the paper, and each class at 0.5."""
    return _rows(
        row
        for row in rows
        if row["threshold"] in MASK_THRESHOLDS
        and (
            row["measure"] == "mIoU"
            or (row["measure"] == "IoU" and row["threshold"] == 0.5 and row["level"] == "all"
                and row["mode"] in modes and row.get("map") is None)
        )
    )  # fmt: skip


def _rows(rows: Iterable[dict[str, Any]]) -> Rows:
    found: Rows = []
    for row in rows:
        if row["value"] is None:
            continue
        values = [row.get(name) for name in COLUMNS]
        values = [round(value, 6) if isinstance(value, float) else value for value in values]
        while values[-1] is None:
            values.pop()
        found.append(values)
    return found


def commit() -> str:
    """Of this code, `+` behind it if files were changed since."""

    def git(*words: str) -> str:
        command = ["git", "-C", str(pathlib.Path(__file__).parent), *words]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()

    try:
        changed = git("status", "--porcelain", "--untracked-files=no", "--", ":/", ":!/docs", ":!/CHANGELOG.md")
        return git("rev-parse", "--short=12", "HEAD") + ("+" if changed else "")
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def machine(device: str) -> str:
    """In words: processor, threads of PyTorch, graphics card."""
    name = platform.processor() or platform.machine()
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines()
        name = next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        pass
    card = f"{torch.cuda.get_device_name()}, " if device == "cuda" else ""
    return f"{card}{name}, {os.cpu_count()} cores, {torch.get_num_threads()} threads, PyTorch {torch.__version__}"
