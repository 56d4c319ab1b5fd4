"""Keyframes as tensors: views, egos, and links from partners to egos."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
import torch

from convoy_baseline.frames import Keyframe, View
from convoy_baseline.grid import Array


@dataclass(frozen=True)
class Link:
    """An ego hears a view."""

    ego: int
    view: int
    ego_from_view: Array


@dataclass(frozen=True)
class Wiring:
    """Whose views of V are whose own, and who hears which: of any number of keyframes."""

    ego_view: torch.Tensor
    """(E,): which view is the ego's own."""
    link_ego: torch.Tensor
    """(L,): who hears ..."""
    link_view: torch.Tensor
    """(L,): ... what."""
    ego_from_view: torch.Tensor
    """(L, 4, 4)."""

    def to(self, device: torch.device) -> Wiring:
        """The same on a device."""
        return Wiring(*(getattr(self, field.name).to(device) for field in fields(self)))


def heard(ego: View, others: Sequence[View], mode: str, comm_range_m: float, elevation_m: float) -> list[int]:
    """Indices of those that an ego hears, the nearest first: the rule of `convoy.Frame.cooperative`."""
    found = []
    for i, other in enumerate(others):
        apart = other.world_from_agent[:3, 3] - ego.world_from_agent[:3, 3]
        near = np.linalg.norm(apart) <= comm_range_m and abs(apart[2]) <= elevation_m
        if other.agent != ego.agent and near and (mode == "x2x" or mode == ("x2i" if other.is_rsu else "x2v")):
            found.append((float(np.linalg.norm(apart)), i))
    return [i for _, i in sorted(found)]


def ego_from(ego: View, other: View) -> Array:
    """ego_from_view, by the poses that each had when it saw."""
    relative: Array = np.linalg.inv(ego.world_from_agent) @ other.world_from_agent
    return relative


def wired(egos: Sequence[int], links: Sequence[Link]) -> Wiring:
    """Tensors of egos and links."""
    poses = np.array([link.ego_from_view for link in links]).reshape(-1, 4, 4)
    return Wiring(
        torch.tensor(list(egos), dtype=torch.long),
        torch.tensor([link.ego for link in links], dtype=torch.long),
        torch.tensor([link.view for link in links], dtype=torch.long),
        torch.from_numpy(poses),
    )


def links_of(keyframe: Keyframe, mode: str, comm_range_m: float, elevation_m: float) -> list[Link]:
    """Who hears whom in a keyframe."""
    views = keyframe.views
    return [
        Link(e, v, ego_from(views[ego], views[v]))
        for e, ego in enumerate(keyframe.egos)
        for v in heard(views[ego], views, mode, comm_range_m, elevation_m)
    ]
