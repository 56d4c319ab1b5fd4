"""Keyframes as batches to learn from: targets as tensors, partners dropped, frames turned and mirrored."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
import torch

from convoy_baseline.batch import Link, Wiring, links_of, wired
from convoy_baseline.frames import Keyframe, Truth, View
from convoy_baseline.grid import Array
from convoy_baseline.inputs import Inputs, gathered
from convoy_baseline.settings import Settings
from convoy_baseline.targets import encode

Spoil = Callable[[Truth, np.random.Generator], Truth]
"""What the test of labels does to them."""


@dataclass(frozen=True)
class Targets:
    """What E egos have to find."""

    heat: torch.Tensor
    """(E, K, h, w)."""
    box_ego: torch.Tensor
    """(N,): whose ..."""
    box_cell: torch.Tensor
    """(N,): ... cell ..."""
    box_numbers: torch.Tensor
    """(N, NUMBERS): ... has which box."""
    masks: torch.Tensor
    """(E, C, H, W) f32."""

    def to(self, device: torch.device) -> Targets:
        """The same on a device."""
        return Targets(*(getattr(self, field.name).to(device) for field in fields(self)))


def example(
    keyframes: Sequence[Keyframe], mode: str, settings: Settings, draw: np.random.Generator, spoil: Spoil | None = None
) -> tuple[Inputs, Wiring, Targets]:
    """A batch: what is seen, and all egos of some keyframes; everything random about it is of `draw`.

    Each view is turned by a number of quarter turns of its own (poses with it, so that warps stay right) and each keyframe mirrored
    or not; each link is there with the chance that `drop_out` leaves.
    """
    views: list[View] = []
    egos: list[int] = []
    links: list[Link] = []
    truths: list[Truth] = []
    for keyframe in keyframes:
        mirrored = bool(draw.integers(2))
        turns = draw.integers(4, size=len(keyframe.views))
        moves = [motion(int(turn), mirrored) for turn in turns]
        for link in links_of(keyframe, mode, settings.comm_range_m, settings.elevation_m):
            if draw.random() >= settings.drop_out:
                pose = moves[keyframe.egos[link.ego]] @ link.ego_from_view @ moves[link.view].T
                links.append(Link(len(egos) + link.ego, len(views) + link.view, pose))
        for ego, truth in zip(keyframe.egos, keyframe.truths, strict=True):
            truth = truth if spoil is None else spoil(truth, draw)
            truths.append(moved(truth, int(turns[ego]), mirrored))
        egos += [len(views) + ego for ego in keyframe.egos]
        views += [moved_view(view, int(turn), mirrored) for view, turn in zip(keyframe.views, turns, strict=True)]
    return gathered(views), wired(egos, links), targets_of(truths, settings)


def targets_of(truths: Sequence[Truth], settings: Settings) -> Targets:
    """Tensors of what is to be found."""
    peaks = [encode(truth.boxes, truth.labels, len(settings.classes), settings.feature_grid) for truth in truths]
    owner = np.repeat(np.arange(len(peaks)), [len(peak.cell) for peak in peaks])
    return Targets(
        torch.from_numpy(np.stack([peak.heat for peak in peaks])),
        torch.from_numpy(owner),
        torch.from_numpy(np.concatenate([peak.cell for peak in peaks])),
        torch.from_numpy(np.concatenate([peak.numbers for peak in peaks])),
        torch.from_numpy(np.stack([truth.masks for truth in truths])).float(),
    )


def motion(turn: int, mirrored: bool) -> Array:
    """4 x 4: mirrors y, then turns to the left by quarters. Its inverse is its transpose."""
    cosine, sine = ((1, 0), (0, 1), (-1, 0), (0, -1))[turn]
    found = np.eye(4)
    found[:2, :2] = np.array([[cosine, -sine], [sine, cosine]]) @ np.diag([1, -1 if mirrored else 1])
    return found


def turned(picture: Array, turn: int, mirrored: bool) -> Array:
    """A picture (..., H, W) of ground that is moved by `motion`."""
    return np.ascontiguousarray(np.rot90(picture[..., ::-1] if mirrored else picture, turn, axes=(-2, -1)))


def moved_view(view: View, turn: int, mirrored: bool) -> View:
    """What an agent saw, moved by `motion`: pictures stay as they are, but their cameras are moved."""
    move = motion(turn, mirrored)
    pictures = tuple(replace(one, agent_from_optical=move @ one.agent_from_optical) for one in view.pictures)
    return replace(view, raster=turned(view.raster, turn, mirrored), pictures=pictures)


def moved(truth: Truth, turn: int, mirrored: bool) -> Truth:
    """What is to be found, moved by `motion`."""
    move, boxes = motion(turn, mirrored)[:2, :2], truth.boxes.copy()
    boxes[:, :2] = boxes[:, :2] @ move.T
    heading = np.column_stack([np.cos(truth.boxes[:, 6]), np.sin(truth.boxes[:, 6])]) @ move.T
    boxes[:, 6] = np.arctan2(heading[:, 1], heading[:, 0])
    boxes[:, 7:9] = boxes[:, 7:9] @ move.T
    return replace(truth, boxes=boxes, masks=turned(truth.masks, turn, mirrored))
