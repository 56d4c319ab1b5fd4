"""Numbers of several seeds of one model, and cells of tables."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from convoy_baseline.benchmark.records import COLUMNS, Record, Rows

Key = tuple[Any, ...]
"""Map, mode, class, level, measure, threshold."""
AT = {name: i for i, name in enumerate(COLUMNS)}
KEYS = AT["value"]


@dataclass(frozen=True)
class Number:
    """A score, with its interval over scenes."""

    value: float
    low: float | None = None
    high: float | None = None


def mean(numbers: Iterable[Number | None]) -> Number | None:
    """Of several seeds: of bounds, too, which is wider than what the mean has."""
    known = [number for number in numbers if number is not None]
    if not known:
        return None
    lows = [number.low for number in known if number.low is not None]
    highs = [number.high for number in known if number.high is not None]
    whole = len(lows) == len(highs) == len(known)
    return Number(
        statistics.mean(number.value for number in known),
        statistics.mean(lows) if whole else None,
        statistics.mean(highs) if whole else None,
    )


def table_of(rows: Rows) -> dict[Key, list[Any]]:
    """Rows by what they are of."""
    return {tuple(row[:KEYS]): [*row[KEYS:], *[None] * (len(COLUMNS) - len(row))] for row in rows}


class Seeds:
    """All runs of a model."""

    def __init__(self, records: Sequence[Record]) -> None:
        self.records = list(records)
        self.first = records[0]
        self._tables: dict[str, list[dict[Key, list[Any]]]] = {}

    def tables(self, part: str) -> list[dict[Key, list[Any]]]:
        """Of `boxes`, `masks`, `gain_boxes`, `gain_masks`, or a condition."""
        if part not in self._tables:
            found = [getattr(record, part, None) or record.conditions.get(part, []) for record in self.records]
            self._tables[part] = [table_of(rows) for rows in found]
        return self._tables[part]

    def value(
        self, part: str, measure: str, *, mode: str = "", of: str = "all", level: str = "all", at: float | None = None,
        place: str | None = None,
    ) -> Number | None:  # fmt: skip
        """The mean of a score over seeds; None if none has it."""
        key = (place, mode or self.first.mode, of, level, measure, at)
        found = [table.get(key) for table in self.tables(part)]
        return mean(None if row is None else Number(row[0], row[1], row[2]) for row in found)

    def gain(
        self, part: str, measure: str, *, level: str = "all", at: float | None = None, place: str | None = None, mode: str = ""
    ) -> Number | None:  # fmt: skip
        """Likewise, of how much more it is than without cooperation."""
        key = (place, mode or self.first.mode, "all", level, measure, at)
        found = [table.get(key) for table in self.tables(part)]
        return mean(None if row is None or row[3] is None else Number(row[3], row[4], row[5]) for row in found)

    def precision(self, of: str, thresholds: Sequence[float], mode: str = "") -> Number | None:
        """AP of a class: its mean over distances, as the paper's tables have it. Without an interval."""
        values = [self.value("boxes", "AP", mode=mode, of=of, at=at) for at in thresholds]
        known = [number.value for number in values if number is not None]
        return Number(statistics.mean(known)) if known else None

    def about(self, ask: Callable[[Record], float]) -> float:
        """The mean of something else."""
        return statistics.mean(ask(record) for record in self.records)


def percent(number: Number | None, interval: bool = False) -> str:
    """As a cell, with its interval if that is wanted."""
    if number is None:
        return "-"
    text = f"{100 * number.value:.1f}"
    if interval and number.low is not None and number.high is not None:
        text += f" ({100 * number.low:.1f} to {100 * number.high:.1f})"
    return text


def points(number: Number | None) -> str:
    """A gain in points with its sign and interval; bold where all of the interval is on one side of nought."""
    if number is None:
        return "-"
    text = f"{100 * number.value:+.1f}"
    if number.low is not None and number.high is not None:
        if number.low > 0 or number.high < 0:
            text = f"**{text}**"
        text += f" ({100 * number.low:+.1f} to {100 * number.high:+.1f})"
    return text


def plain(number: Number | None) -> str:
    """An error in its unit."""
    return "-" if number is None else f"{number.value:.3f}"


def markdown(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
