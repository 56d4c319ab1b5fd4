"""Under which conditions a model works together: whom it hears, how well poses are known, how old what it hears is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from convoy_baseline.batch import Link, ego_from, heard
from convoy_baseline.frames import Keyframe, View
from convoy_baseline.grid import Array
from convoy_baseline.settings import Settings


@dataclass(frozen=True)
class Condition:
    """One way of evaluating a model."""

    name: str
    mode: str
    penetration: float = 1.0
    """The chance of each partner that it takes part; with a larger one, those of a smaller one take part, too."""
    noise_m: float = 0.0
    """Standard deviation of x and y of what is believed of a partner's relative pose."""
    noise_deg: float = 0.0
    """The same of its yaw."""
    delay_frames: int = 0
    """How old partners' views and poses are, in frames of 0.05 s. The ego's own are new."""
    wrong_poses: bool = False
    """Poses the wrong way round: partner_from_ego where ego_from_partner belongs, to see that scores collapse."""


def links_under(
    condition: Condition, keyframe: Keyframe, earlier: Sequence[View], first: int, settings: Settings, seed: int
) -> list[Link]:
    """Who hears which of the earlier views, whose first has the number `first`. Who is in range is decided by poses at the keyframe.
    What is random follows from seed, scene, frame and names alone, and does not depend on other conditions."""
    links = []
    for e, own in enumerate(keyframe.egos):
        ego = keyframe.views[own]
        for v in heard(ego, keyframe.views, condition.mode, settings.comm_range_m, settings.elevation_m):
            draw = np.random.default_rng([seed, 3, keyframe.scene, keyframe.number, own, v])
            takes_part, *off = draw.random(), *draw.normal(size=3)
            if takes_part >= condition.penetration:
                continue
            exact = ego_from(ego, earlier[v])
            believed = error(condition, np.array(off)) @ exact
            links.append(Link(e, first + v, np.linalg.inv(exact) if condition.wrong_poses else believed))
    return links


def error(condition: Condition, normal: Array) -> Array:
    """4 x 4 that is applied to a pose in the ego's frame: the partner turned about itself would be moved by the same amount
    everywhere, here turning moves what is far from the ego more."""
    yaw = np.radians(condition.noise_deg) * normal[2]
    found = np.eye(4)
    found[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
    found[:2, 3] = condition.noise_m * normal[:2]
    return found
