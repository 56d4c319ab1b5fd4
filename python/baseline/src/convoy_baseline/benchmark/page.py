"""The page with the benchmark's numbers."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from convoy_baseline.benchmark.plan import Entry, Plan
from convoy_baseline.checkpoint import Run
from convoy_baseline.score import SUBSETS

Key = tuple[str, str, str, str, float | None]
"""Condition, measure, class, subset, threshold."""


@dataclass(frozen=True)
class Trained:
    """A model of one seed and its scores."""

    entry: Entry
    run: Run
    scores: dict[Key, float | None]

    @classmethod
    def of(cls, entry: Entry, run: Run, rows: Sequence[dict[str, Any]]) -> Trained:
        """Of rows of a table of scores."""
        names = ("condition", "measure", "class", "subset", "threshold_m")
        return cls(entry, run, {tuple(row[name] for name in names): row["value"] for row in rows})

    def get(
        self, condition: str, measure: str = "mAP", of: str = "all", subset: str = "all", at: float | None = None
    ) -> float | None:
        """One of the numbers."""
        return self.scores[condition, measure, of, subset, at]


Ask = Callable[[Trained], float | None]


def page(plan: Plan, trained: Sequence[Trained], spoilt: Sequence[tuple[str, Trained]], data: Sequence[str]) -> str:
    """Everything, as Markdown."""
    of = {entry.name: [one for one in trained if one.entry.name == entry.name] for entry in plan.entries}
    parts = [
        "# Benchmark",
        (
            "Written by `make benchmark` ([how](python.md#the-benchmark)). Precision is SimBEV2X's, in per cent, as a mean over "
            f"{', '.join(plan.entries[0].settings.classes)} and the distances 0.5, 1, 2 and 4 m; targets are what the ego or anybody in its "
            "range has seen, within the model's grid, the same in every mode. Each number is the mean of "
            f"{len(plan.seeds)} seeds, with their standard deviation after ±."
        ),
        "\n".join(f"* {line}" for line in [*data, *(_about(of[entry.name]) for entry in plan.entries)]),
        "## What holds",
        "\n".join(f"* {line}" for line in verdicts(plan, of)),
        "## Modes",
        _modes(plan, of),
        "## Gain of cooperation",
        "Mode x2x less a model that never heard of partners, seed by seed, and less the same model without partners, in points.",
        _gains(plan, of),
        "## Masks",
        (
            "Intersection over union at a chance of 0.5, in per cent; cells of "
            f"{plan.entries[0].settings.mask_grid.cell_m} m, in which what is thinner than half a cell is lost."
        ),
        _masks(plan, of),
    ]
    for title, beginning, words in (
        ("Partners that take part", "penetration", "Each partner takes part with this chance."),
        (
            "Errors of poses",
            "noise",
            "Standard deviation of what is believed of each partner's place (x and y) and yaw.",
        ),
        (
            "Delay",
            "delay",
            "What partners say is so many frames of 0.05 s old, with the pose of then; the ego's own is new.",
        ),
    ):
        parts += _sensitivity(plan, of, title, beginning, words)
    if spoilt:
        parts += ["## Labels and poses that are wrong", *_spoilt(spoilt, plan, of)]
    return "\n\n".join(parts) + "\n"


def verdicts(plan: Plan, of: dict[str, list[Trained]]) -> list[str]:
    """What is expected of cooperation, and whether it is so."""
    found = []
    for entry, rival in plan.pairs:
        together, alone = of[entry.name], of[rival.name]

        def gain(subset: str, together: list[Trained] = together, alone: list[Trained] = alone) -> list[float]:
            values = [difference(t, a, subset) for t, a in zip(together, alone, strict=True)]
            return [value for value in values if value is not None]

        everywhere, spread = gain("all"), _spread(gain("all"))
        holds = bool(everywhere) and statistics.mean(everywhere) > spread and min(everywhere) > 0
        found.append(
            f"{entry.name}: cooperation gains more than the seeds' spread: {_word(holds)} ({_text(everywhere)} points)."
        )
        for more, less in (("hard", "easy"), ("seen by partners only", "seen by the ego")):
            pair = gain(more), gain(less)
            if all(pair):
                holds = statistics.mean(pair[0]) > statistics.mean(pair[1])
                found.append(
                    f"{entry.name}: more for `{more}` than for `{less}`: {_word(holds)} ({_text(pair[0])} and {_text(pair[1])} points)."
                )
        same = [
            abs(
                (one.get("x2x", subset="no partner in range") or 0)
                - (one.get("none", subset="no partner in range") or 0)
            )
            for one in together
            if one.get("none", subset="no partner in range") is not None
        ]
        if same:
            found.append(
                f"{entry.name}: nothing changes between modes where no partner is in range: {_word(max(same) < 1e-6)} "
                f"({100 * max(same):.2g} points at most)."
            )
    return found


def difference(together: Trained, alone: Trained, subset: str) -> float | None:
    """Gain of x2x over another model without partners, in points."""
    here, there = together.get("x2x", subset=subset), alone.get("none", subset=subset)
    return None if here is None or there is None else 100 * (here - there)


def _modes(plan: Plan, of: dict[str, list[Trained]]) -> str:
    rows = []
    for entry in plan.entries:
        for condition in entry.conditions:
            if condition.name == condition.mode:
                name = condition.name
                values = [_cell(of[entry.name], _asks(name, subset)) for subset in SUBSETS]
                partners = statistics.mean(one.get(name, "partners") or 0.0 for one in of[entry.name])
                at_two = _cell(of[entry.name], _asks(name, measure="mAP at", at=2.0))
                rows.append([entry.name, name, f"{partners:.2f}", *values, at_two])
    first = of[plan.entries[0].name][0]
    counts = [f"{first.get('none', 'targets', subset=subset):.0f}" for subset in SUBSETS]
    rows.append(["targets", "", "", *counts, ""])
    return _table(["model", "mode", "partners", *SUBSETS, "all, at 2 m"], rows)


def _gains(plan: Plan, of: dict[str, list[Trained]]) -> str:
    rows = []
    for entry, rival in plan.pairs:
        for words, rivals in (
            (f"over `{rival.name}`", of[rival.name]),
            ("over itself without partners", of[entry.name]),
        ):
            pairs = list(zip(of[entry.name], rivals, strict=True))
            cells = []
            for subset in SUBSETS:
                both = [(t.get("x2x", subset=subset), a.get("none", subset=subset)) for t, a in pairs]
                cells.append(
                    _text([100 * (here - there) for here, there in both if here is not None and there is not None])
                )
            rows.append([entry.name, words, *cells])
    return _table(["model", "gain", *SUBSETS], rows)


def _masks(plan: Plan, of: dict[str, list[Trained]]) -> str:
    names = of[plan.entries[0].name][0].run.masks
    first = of[plan.entries[0].name][0]
    names = tuple(name for name in names if first.get("none", "IoU", of=name) is not None)
    rows = []
    for entry in plan.entries:
        for condition in entry.conditions:
            if condition.name == condition.mode:
                asks = [_asks(condition.name, measure="IoU", of=name) for name in names]
                rows.append([entry.name, condition.name, *(_cell(of[entry.name], ask) for ask in asks)])
    return _table(["model", "mode", *names], rows)


def _sensitivity(plan: Plan, of: dict[str, list[Trained]], title: str, beginning: str, words: str) -> list[str]:
    subsets = ("all", "hard", "seen by partners only")
    rows = []
    for entry in plan.entries:
        names = [condition.name for condition in entry.conditions if condition.name.startswith(beginning)]
        ends = {"penetration": (["none"], ["x2x"]), "noise": (["x2x"], []), "delay": ([], [])}[beginning]
        for name in [*ends[0], *names, *ends[1]] if names else []:
            label = {"none": "nobody", "x2x": "exact" if beginning == "noise" else "everybody"}.get(name, name)
            partners = statistics.mean(one.get(name, "partners") or 0.0 for one in of[entry.name])
            rows.append(
                [entry.name, label, f"{partners:.2f}", *(_cell(of[entry.name], _asks(name, s)) for s in subsets)]
            )
    return [f"## {title}", words, _table(["model", beginning, "partners", *subsets], rows)] if rows else []


def _spoilt(spoilt: Sequence[tuple[str, Trained]], plan: Plan, of: dict[str, list[Trained]]) -> list[str]:
    rows = [
        [
            name,
            str(one.run.step),
            _cell([one], _asks("x2x")),
            _cell([one], _asks("x2x", measure="IoU", of="road")),
        ]
        for name, one in spoilt
    ]
    for entry in plan.entries:
        if any(condition.wrong_poses for condition in entry.conditions):
            for name in ("x2x", "wrong poses"):
                words = f"{entry.name}, {'poses the wrong way round' if name != 'x2x' else 'as above'}"
                steps = str(of[entry.name][0].run.step)
                road = _asks(name, measure="IoU", of="road")
                rows.append([words, steps, _cell(of[entry.name], _asks(name)), _cell(of[entry.name], road)])
    return [
        (
            "The same model on labels that were spoilt in training, scored against the true ones, and a good one that is told poses the "
            "wrong way round: scores that would not fall would say nothing."
        ),
        _table(["labels", "steps", "mAP, x2x", "IoU of the road"], rows),
    ]


def _about(trained: Sequence[Trained]) -> str:
    entry, settings = trained[0].entry, trained[0].run.settings
    seconds = statistics.mean(one.run.seconds for one in trained)
    heard = {"features": f"{settings.fusion} fusion", "early": "partners' points", "late": "partners' boxes"}[
        settings.cooperation
    ]
    return (
        f"`{entry.name}`: {' and '.join(settings.sensors)}, learnt in mode {entry.mode}, {heard}, {settings.cells} x {settings.cells} cells of "
        f"{settings.cell_m} m, width {settings.width}, {settings.steps} steps of {settings.frames_a_step} keyframes with all vehicles as "
        f"egos, partners left out with a chance of {settings.drop_out}: {seconds:.0f} s a seed."
    )


def _asks(
    condition: str, subset: str = "all", *, measure: str = "mAP", of: str = "all", at: float | None = None
) -> Ask:
    return lambda one: one.get(condition, measure, of, subset, at)


def _cell(trained: Sequence[Trained], ask: Ask) -> str:
    return _text([100 * value for one in trained if (value := ask(one)) is not None])


def _text(values: Sequence[float]) -> str:
    if not values:
        return "-"
    return f"{statistics.mean(values):.1f}" + (f" ± {_spread(values):.1f}" if len(values) > 1 else "")


def _spread(values: Sequence[float]) -> float:
    return statistics.stdev(values) if len(values) > 1 else 0.0


def _word(holds: bool) -> str:
    return "yes" if holds else "**no**"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
