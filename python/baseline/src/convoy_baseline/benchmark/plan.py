"""What a benchmark is: a TOML file."""

from __future__ import annotations

import dataclasses
import pathlib
import tomllib
from dataclasses import dataclass
from typing import Any

from convoy_baseline.conditions import Condition
from convoy_baseline.frames import every_nth
from convoy_baseline.settings import Settings, parse, read_with_mode
from convoy_baseline.spoil import SPOILS


@dataclass(frozen=True)
class Entry:
    """A model that is trained with a seed."""

    name: str
    """Of its files: unlike all others of the plan."""
    model: str
    """What it is called on the page: the name of its settings' file."""
    mode: str
    """With whom it learns to work together."""
    settings: Settings
    start: str = ""
    """The entry with whose weights it begins; none if empty."""
    rival: str = ""
    """The entry without cooperation that it is held against; none if empty."""
    conditions: tuple[Condition, ...] = ()
    """Under which it is evaluated besides the modes."""
    share: float = 1.0
    """Which part of the scenes it learns from."""
    spoil: str = ""
    """What is done to its labels."""

    @property
    def is_extra(self) -> bool:
        """Whether it is a point of a learning curve, or learns from spoilt labels or few steps of right ones."""
        return self.share < 1 or bool(self.spoil)

    @property
    def modes(self) -> tuple[str, ...]:
        """In which it is evaluated."""
        return ("none",) if self.mode == "none" else ("none", "x2v", "x2i", "x2x")


@dataclass(frozen=True)
class Plan:
    """All of it."""

    name: str
    config: pathlib.Path
    """The dataset's."""
    test_split: str
    seeds: tuple[int, ...]
    entries: tuple[Entry, ...]
    """Models first, in the order in which they are trained; then their learning curves and labels that are spoilt."""
    bootstrap: int
    """How often scenes are drawn to say how sure a number is."""

    def runs(
        self, seeds: list[int] | None = None, models: list[str] | None = None, extras: bool = False
    ) -> list[tuple[Entry, int]]:
        """What is to be trained: all of it, or some seeds of some models. Learning curves and spoilt labels are `extras`, of the first
        seed alone, after all else."""
        known = [entry.model for entry in self.entries]
        if models is not None and (unknown := set(models) - set(known)):
            raise ValueError(
                f"no models: {', '.join(sorted(unknown))}; expected some of {', '.join(dict.fromkeys(known))}"
            )
        wanted = [entry for entry in self.entries if models is None or entry.model in models]
        chosen = self.seeds if seeds is None else seeds
        found = [(entry, seed) for seed in chosen for entry in wanted if not entry.is_extra]
        if extras and self.seeds[0] in chosen:
            found += [(entry, self.seeds[0]) for entry in wanted if entry.is_extra]
        return found

    def entry(self, name: str) -> Entry:
        """The one with a name."""
        return next(entry for entry in self.entries if entry.name == name)


KEYS = {
    "config", "test_split", "seeds", "bootstrap", "model", "models", "penetration", "noise", "delay_frames", "shares",
    "spoilt_steps", "spoilt",
}  # fmt: skip
MODEL_KEYS = {"settings", "start", "curve", "sensitivity", "spoilt"}


def read(path: pathlib.Path) -> Plan:
    """A plan of a file; keys that do not exist are errors."""
    with open(path, "rb") as file:
        table = tomllib.load(file)
    if unknown := set(table) - KEYS:
        raise ValueError(
            f"{path}: no such keys: {', '.join(sorted(unknown))}; expected some of {', '.join(sorted(KEYS))}"
        )
    try:
        entries = [_entry(model, table, path) for model in table["models"]]
        entries = [dataclasses.replace(entry, rival=_rival(entry, entries)) for entry in entries]
        for model, entry in list(zip(table["models"], entries, strict=True)):
            entries += _others(model, entry, table)
        plan = Plan(
            path.stem,
            (path.parent / table["config"]).resolve(),
            str(table.get("test_split", "test")),
            tuple(int(seed) for seed in table["seeds"]),
            tuple(entries),
            int(table.get("bootstrap", 1000)),
        )
    except KeyError as fault:
        raise ValueError(f"{path}: {fault.args[0]} is missing") from fault
    names = [entry.name for entry in entries]
    for i, entry in enumerate(entries):
        if entry.name in names[:i]:
            raise ValueError(f"{path}: expected models of different names, {entry.name} is there twice")
        if entry.start and entry.start not in names[:i]:
            raise ValueError(f"{path}: {entry.name} starts with {entry.start}: expected a model before it")
    return plan


def _entry(model: dict[str, Any], table: dict[str, Any], path: pathlib.Path) -> Entry:
    if "settings" not in model:
        raise KeyError("settings")
    file = path.parent / model["settings"]
    base, mode = read_with_mode(file)
    own = {name: value for name, value in model.items() if name not in MODEL_KEYS}
    values = {**dataclasses.asdict(base), **table.get("model", {}), **own}
    folder = file.parent.name
    task = f"{folder}-" if folder in ("detection", "segmentation") else ""
    conditions = tuple(sensitivities(table)) if model.get("sensitivity", False) else ()
    start = str(model.get("start", ""))
    return Entry(
        task + file.stem, file.stem, mode or "none", parse(values, str(path)), start=start, conditions=conditions
    )


def _rival(entry: Entry, entries: list[Entry]) -> str:
    """The one without cooperation that looks through the same sensors and learns the same tasks."""
    if entry.mode == "none":
        return ""
    same = [
        other.name
        for other in entries
        if other.mode == "none"
        and (other.settings.sensors, other.settings.tasks) == (entry.settings.sensors, entry.settings.tasks)
    ]
    return same[0] if same else ""


def _others(model: dict[str, Any], entry: Entry, table: dict[str, Any]) -> list[Entry]:
    """A model again with fewer scenes, and with few steps on labels that are spoilt or right."""
    plain = dataclasses.replace(entry, conditions=())
    found = []
    if model.get("curve", False):
        for share in table.get("shares", ()):
            nth = every_nth(float(share))
            if nth > 1:
                rival = f"{entry.rival}-1of{nth}" if entry.rival else ""
                found.append(dataclasses.replace(plain, name=f"{entry.name}-1of{nth}", share=float(share), rival=rival))
    if model.get("spoilt", False) and table.get("spoilt_steps", 0):
        short = dataclasses.replace(entry.settings, steps=int(table["spoilt_steps"]))
        for spoil in ("", *table.get("spoilt", ())):
            if spoil and spoil not in SPOILS:
                raise ValueError(f"spoilt {spoil!r}: expected some of {', '.join(SPOILS)}")
            found.append(
                dataclasses.replace(
                    plain,
                    name=f"{entry.name}-labels-{spoil or 'right'}",
                    settings=short,
                    spoil=spoil or "right",
                    rival="",
                )
            )
    return found


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
