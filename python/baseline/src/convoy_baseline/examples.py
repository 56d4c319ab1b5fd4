"""Keyframes as batches to learn from: targets as tensors, partners dropped, views moved."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
import torch

from convoy_baseline.augment import moved, moved_points, moved_view, moves, thinner, zoomed
from convoy_baseline.batch import Link, Wiring, links_of, wired
from convoy_baseline.frames import Keyframe, Truth, View
from convoy_baseline.grid import Array, Grid
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
    box_label: torch.Tensor
    """(N,): ... has a box of which class ..."""
    box_numbers: torch.Tensor
    """(N, NUMBERS): ... and which numbers."""
    masks: torch.Tensor
    """(E, C, H, W) f32."""

    def to(self, device: torch.device) -> Targets:
        """The same on a device."""
        return Targets(*(getattr(self, field.name).to(device) for field in fields(self)))


def example(
    keyframes: Sequence[Keyframe], mode: str, settings: Settings, draw: np.random.Generator, spoil: Spoil | None = None
) -> tuple[Inputs, Wiring, Targets]:
    """A batch: what is seen, and all egos of some keyframes; everything random about it is of `draw`.

    Each view is turned by an angle of its own (poses with it, so that warps stay right) and each keyframe mirrored or not; each link
    is there with the chance that `drop_out` leaves.
    """
    views: list[View] = []
    egos: list[int] = []
    links: list[Link] = []
    truths: list[Truth] = []
    for keyframe in keyframes:
        each = moves(len(keyframe.views), settings, draw)
        for link in links_of(keyframe, mode, settings.comm_range_m, settings.elevation_m):
            if draw.random() >= settings.drop_out:
                back = np.linalg.inv(each[link.view].matrix)
                pose = each[keyframe.egos[link.ego]].matrix @ link.ego_from_view @ back
                links.append(Link(len(egos) + link.ego, len(views) + link.view, pose))
        for ego, truth in zip(keyframe.egos, keyframe.truths, strict=True):
            truth = truth if spoil is None else spoil(truth, draw)
            truths.append(moved(truth, each[ego], settings.mask_grid))
        egos += [len(views) + ego for ego in keyframe.egos]
        views += [
            moved_view(thinner(view, settings, draw), move) for view, move in zip(keyframe.views, each, strict=True)
        ]
    seen, wiring = wired_views(views, egos, links, settings)
    return zoomed(seen, settings, draw), wiring, targets_of(truths, settings)


def wired_views(
    views: Sequence[View], egos: Sequence[int], links: Sequence[Link], settings: Settings
) -> tuple[Inputs, Wiring]:
    """What a model looks at: with early cooperation, egos' views with points of those that they hear; with late, nobody is heard."""
    if settings.cooperation == "early":
        views, egos, links = with_heard(views, egos, links), range(len(egos)), []
    elif settings.cooperation == "late":
        links = []
    return gathered(views, raster_grid(settings)), wired(egos, links)


def raster_grid(settings: Settings) -> Grid | None:
    """On which grid rasters are made of points, if the model looks at any."""
    return settings.grid if "lidar" in settings.sensors and settings.lidar_encoder == "raster" else None


def with_heard(views: Sequence[View], egos: Sequence[int], links: Sequence[Link]) -> list[View]:
    """Views of egos with the points of all that they hear."""
    clouds = [[points_of(views[ego])] for ego in egos]
    for link in links:
        clouds[link.ego].append(moved_points(points_of(views[link.view]), link.ego_from_view))
    return [replace(views[ego], points=np.concatenate(parts)) for ego, parts in zip(egos, clouds, strict=True)]


def points_of(view: View) -> Array:
    """Those that were kept."""
    if view.points is None:
        raise ValueError(f"{view.agent} has a raster alone: expected points")
    return view.points


def targets_of(truths: Sequence[Truth], settings: Settings) -> Targets:
    """Tensors of what is to be found."""
    peaks = [encode(truth.boxes, truth.labels, len(settings.classes), settings.feature_grid) for truth in truths]
    owner = np.repeat(np.arange(len(peaks)), [len(peak.cell) for peak in peaks])
    return Targets(
        torch.from_numpy(np.stack([peak.heat for peak in peaks])),
        torch.from_numpy(owner),
        torch.from_numpy(np.concatenate([peak.cell for peak in peaks])),
        torch.from_numpy(np.concatenate([peak.labels for peak in peaks])),
        torch.from_numpy(np.concatenate([peak.numbers for peak in peaks])),
        torch.from_numpy(np.stack([truth.masks for truth in truths])).float(),
    )
