"""What a benchmark is: a TOML file."""

from __future__ import annotations

import dataclasses
import pathlib
import tomllib
from dataclasses import dataclass
from typing import Any

from convoy_baseline.conditions import Condition
from convoy_baseline.settings import Settings, check_mode, parse


@dataclass(frozen=True)
class Entry:
    """A model that is trained with every seed."""

    name: str
    mode: str
    """With whom it learns to work together."""
    settings: Settings
    conditions: tuple[Condition, ...]
    """Under which it is evaluated."""


@dataclass(frozen=True)
class Plan:
    """All of it."""

    config: pathlib.Path
    """The dataset's."""
    test_split: str
    seeds: tuple[int, ...]
    entries: tuple[Entry, ...]
    """Those that work together stand behind the one without cooperation that they are held against."""
    spoilt_steps: int
    """Steps of each model of the test of labels; none with 0."""
    spoilt: tuple[str, ...]

    @property
    def latest_frames(self) -> int:
        """The longest delay."""
        return max(condition.delay_frames for entry in self.entries for condition in entry.conditions)

    @property
    def pairs(self) -> list[tuple[Entry, Entry]]:
        """Each model that learnt to work together, and the last one before it that did not."""
        return [
            (entry, next(alone for alone in reversed(self.entries[:i]) if alone.mode == "none"))
            for i, entry in enumerate(self.entries)
            if entry.mode != "none"
        ]


KEYS = {
    "config", "test_split", "seeds", "model", "models", "penetration", "noise", "delay_frames", "spoilt_steps", "spoilt",
}  # fmt: skip


def read(path: pathlib.Path) -> Plan:
    """A plan of a file; keys that do not exist are errors."""
    with open(path, "rb") as file:
        table = tomllib.load(file)
    if unknown := set(table) - KEYS:
        raise ValueError(
            f"{path}: no such keys: {', '.join(sorted(unknown))}; expected some of {', '.join(sorted(KEYS))}"
        )
    try:
        entries = tuple(_entry(model, table, str(path)) for model in table["models"])
        plan = Plan(
            (path.parent / table["config"]).resolve(),
            str(table.get("test_split", "test")),
            tuple(int(seed) for seed in table["seeds"]),
            entries,
            int(table.get("spoilt_steps", 0)),
            tuple(table.get("spoilt", ())),
        )
    except KeyError as fault:
        raise ValueError(f"{path}: {fault.args[0]} is missing") from fault
    if len(entries) < 2 or entries[0].mode != "none" or len({entry.name for entry in entries}) < len(entries):
        raise ValueError(f"{path}: expected two models or more of different names, the first of mode none")
    return plan


def _entry(model: dict[str, Any], table: dict[str, Any], source: str) -> Entry:
    own = {name: value for name, value in model.items() if name not in ("name", "mode", "sensitivity")}
    mode = check_mode(model["mode"])
    conditions = [Condition("none", "none")]
    if mode != "none":
        conditions += [Condition(name, name) for name in ("x2v", "x2i", "x2x")]
    if model.get("sensitivity", False):
        conditions += sensitivities(table)
    return Entry(str(model["name"]), mode, parse({**table.get("model", {}), **own}, source), tuple(conditions))


def sensitivities(table: dict[str, Any]) -> list[Condition]:
    """What is asked of one model that works together, all in mode x2x."""
    base = Condition("", "x2x")
    found = [
        dataclasses.replace(base, name=f"penetration {share}", penetration=share)
        for share in table.get("penetration", ())
    ]
    found += [
        dataclasses.replace(base, name=f"noise {metres} m, {degrees} deg", noise_m=metres, noise_deg=degrees)
        for metres, degrees in table.get("noise", ())
    ]
    if table.get("delay_frames"):
        found.append(dataclasses.replace(base, name="delay 0"))
        found += [dataclasses.replace(base, name=f"delay {d}", delay_frames=d) for d in table["delay_frames"]]
    return [*found, dataclasses.replace(base, name="wrong poses", wrong_poses=True)]
