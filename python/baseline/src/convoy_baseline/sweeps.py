"""Points of an agent's lidar: of a moment, and of moments before."""

from __future__ import annotations

import convoy
import numpy as np

from convoy_baseline.grid import Array


def points(agent: convoy.Agent, sweeps: int, beams: int) -> Array:
    """(N, 5) f32: x, y, z in the agent's frame, intensity, and age in s: of its sweep and of `sweeps` earlier ones."""
    if not beams:
        return convoy.history(agent, sweeps=sweeps)
    cloud = convoy.history(agent, columns=("intensity", "ring"), sweeps=sweeps)
    stay: Array = cloud[thinned(cloud[:, 4], beams)][:, [0, 1, 2, 3, 5]]
    return stay


def thinned(rings: Array, beams: int) -> Array:
    """Which points stay, of rings (N,): every n-th one, so that about `beams` are left."""
    step = max(1, -(-int(rings.max(initial=0) + 1) // beams))
    stay: Array = rings % step == 0
    return stay


def drawn(cloud: Array, sweeps: int, draw: np.random.Generator) -> Array:
    """The newest sweep and so many of the earlier ones, at random."""
    ages = np.unique(cloud[:, 4])
    if len(ages) <= sweeps + 1:
        return cloud
    chosen = draw.choice(ages[1:], sweeps, replace=False)
    stay: Array = cloud[(cloud[:, 4] == ages[0]) | np.isin(cloud[:, 4], chosen)]
    return stay
