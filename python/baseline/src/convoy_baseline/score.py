"""Scores by SimBEV2X's rule in numpy, for parts of the targets that a table of `evaluate` has not; where both have a number, it is the
same (tests/test_scores.py).

A tally takes what egos found and keeps who was matched with what; `average_precision` then asks for any part.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from convoy_baseline.grid import Array, Grid
from convoy_baseline.predict import Found

THRESHOLDS_M = (0.5, 1.0, 2.0, 4.0)
RINGS_M = (20.0, 40.0)
MOST = {"car": 100, "pedestrian": 100, "traffic_sign": 60, "traffic_light": 40, "traffic_cone": 40}
"""The surest predictions of a sample that count; 20 of the other classes."""

SUBSETS = (
    "all", "easy", "medium", "hard", "seen by the ego", "seen by partners only", "up to 20 m", "20 to 40 m", "beyond 40 m",
    "partner in range", "no partner in range",
)  # fmt: skip


class Tally:
    """Predictions and targets of one condition."""

    def __init__(self, classes: Sequence[str], grid: Grid | None, first_frame: int = 0) -> None:
        """Targets outside the grid are left out if there is one, keyframes before the first frame, too."""
        self.classes, self.grid, self.first_frame = classes, grid, first_frame
        self.predicted: dict[tuple[int, float], list[Array]] = {}
        self.targets: dict[int, list[Array]] = {k: [] for k in range(len(classes))}
        self.cells: Array | None = None
        self.partners: list[int] = []
        self.samples: list[tuple[int, int, int]] = []

    def take(self, found: Found, alone: bool) -> None:
        """What an ego found; `alone` is it if nobody at all is in its range."""
        if found.keyframe.number < self.first_frame:
            return
        truth = found.keyframe.truths[found.ego]
        self.partners.append(found.partners)
        self.samples.append((found.keyframe.scene, found.ego, found.keyframe.number))
        if len(found.masks):  # Not every model finds masks.
            self._masks(found.masks >= 0.5, truth.masks)
        for k, name in enumerate(self.classes):
            chosen = np.flatnonzero(truth.labels == k)
            if self.grid is not None:
                chosen = chosen[self.grid.has(truth.boxes[chosen])]
            # Kept of each target: difficulty, seen by the ego, distance, alone.
            about = np.column_stack(
                [
                    truth.difficulty[chosen],
                    truth.seen_by_ego[chosen],
                    np.linalg.norm(truth.boxes[chosen, :2].astype(np.float64), axis=1),
                    np.full(len(chosen), alone),
                ]
            )
            self.targets[k].append(about)
            mine = np.flatnonzero(found.labels == k)
            mine = mine[np.argsort(-found.scores[mine], kind="stable")][: MOST.get(name, 20)]
            boxes = found.boxes[mine]
            apart = np.linalg.norm(boxes[:, None, :3] - truth.boxes[None, chosen, :3].astype(np.float64), axis=2)
            for threshold in THRESHOLDS_M:
                partner = matched(apart, threshold)
                hit = partner >= 0
                of_target = np.full((len(mine), 4), np.nan)
                of_target[hit] = about[partner[hit]]
                own = [found.scores[mine], hit, np.linalg.norm(boxes[:, :2], axis=1), np.full(len(mine), alone)]
                self.predicted.setdefault((k, threshold), []).append(np.column_stack([*own, of_target]))

    def average_precision(self, label: int, threshold_m: float, subset: str = "all") -> float | None:
        """Area below precision over recall; a prediction of a target that is not of the subset is neither right nor wrong, one of none
        is wrong where the subset is a place and the prediction there. None without targets."""
        wanted = int(part(np.concatenate(self.targets[label]), subset).sum()) if self.targets[label] else 0
        if not wanted:
            return None
        # Of equal scores the earlier counts as the surer, and `evaluate` goes through a scene ego by ego.
        of_sample = self.predicted[label, threshold_m]
        rows = np.concatenate([of_sample[i] for i in sorted(range(len(of_sample)), key=self.samples.__getitem__)])
        hit = rows[:, 1] > 0
        right = hit & part(rows[:, 4:], subset)
        # A prediction has a place, but neither difficulty nor seers.
        wrong = ~hit & part(np.column_stack([rows[:, [1, 1, 2, 3]]]), subset if subset in PLACES else "all")
        rows, right = rows[right | wrong], right[right | wrong]
        in_order = np.argsort(-rows[:, 0], kind="stable")
        good = np.cumsum(right[in_order])
        precision = np.concatenate([[1.0], good / np.arange(1, len(good) + 1)])
        recall = np.concatenate([[0.0], good / wanted])
        kept = precision >= 0.1
        return float(np.clip(np.trapezoid(precision[kept], recall[kept]), 0, 1))

    def mean_precision(self, subset: str = "all", threshold_m: float | None = None) -> float | None:
        """Mean over classes and thresholds, or at one threshold, of those that have targets."""
        thresholds = THRESHOLDS_M if threshold_m is None else (threshold_m,)
        values = [self.average_precision(k, at, subset) for k in range(len(self.classes)) for at in thresholds]
        known = [value for value in values if value is not None]
        return float(np.mean(known)) if known else None

    def target_count(self, subset: str = "all") -> int:
        """How many targets there are."""
        return sum(int(part(np.concatenate(rows), subset).sum()) for rows in self.targets.values() if rows)

    def overlap(self, mask: int) -> float | None:
        """Intersection over union of a mask at a chance of 0.5, over all samples and cells."""
        if self.cells is None or not self.cells[:, mask].sum():
            return None
        both, extra, missing = self.cells[:, mask]
        return float(both / (both + extra + missing))

    def _masks(self, said: Array, true: Array) -> None:
        counts = [(said & true).sum(axis=(1, 2)), (said & ~true).sum(axis=(1, 2)), (~said & true).sum(axis=(1, 2))]
        self.cells = np.stack(counts) if self.cells is None else self.cells + np.stack(counts)


PLACES = ("up to 20 m", "20 to 40 m", "beyond 40 m", "partner in range", "no partner in range")


def part(about: Array, subset: str) -> Array:
    """Which rows (difficulty, seen by the ego, distance, alone) are of a subset."""
    difficulty, seen, distance, alone = about.T
    near, far = RINGS_M
    found: Array = {
        "all": np.ones(len(about), bool),
        "easy": difficulty == 0,
        "medium": difficulty == 1,
        "hard": difficulty == 2,
        "seen by the ego": seen == 1,
        "seen by partners only": seen == 0,
        "up to 20 m": distance <= near,
        "20 to 40 m": (distance > near) & (distance <= far),
        "beyond 40 m": distance > far,
        "partner in range": alone == 0,
        "no partner in range": alone == 1,
    }[subset]
    return found


def matched(apart: Array, threshold_m: float) -> Array:
    """(P,) which target each prediction finds, -1 for none: in their order each takes the nearest free one, if it is near enough."""
    free = apart.copy()
    found = np.full(len(apart), -1)
    for p in range(len(apart)):
        if not free.shape[1]:
            break
        nearest = int(free[p].argmin())
        if free[p, nearest] <= threshold_m:
            found[p] = nearest
            free[:, nearest] = np.inf
    return found
