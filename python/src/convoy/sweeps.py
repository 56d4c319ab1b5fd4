"""Sweeps of an agent's lidar: of a moment, and of moments before."""

from __future__ import annotations

import numpy as np

from convoy.frame import Agent
from convoy.poses import Array, invert

FRAME_S = 0.05


def history(
    agent: Agent,
    name: str = "LIDAR",
    columns: tuple[str, ...] = ("intensity",),
    sweeps: int = 0,
    frame_from_agent: Array | None = None,
) -> Array:
    """(P, 3 + columns + 1) f32: a sweep and `sweeps` earlier ones, as far as the scene goes back, with each point's age in s as the last
    column; the newest come first. All are in the agent's frame of now, moved by the poses of then, or in another frame."""
    step = agent.sensor(name).every_n_frames
    place = np.eye(4) if frame_from_agent is None else frame_from_agent
    found = []
    for back in range(0, (sweeps + 1) * step, step):
        number = agent.frame.number - back
        if number < 0:
            break
        then = agent if back == 0 else agent.frame.scene.frame(number).agent(agent.name)
        moved = place if back == 0 else place @ invert(agent.pose) @ then.pose
        cloud = then._points(name, columns, moved)
        found.append(np.column_stack([cloud, np.full(len(cloud), back * FRAME_S, np.float32)]))
    return np.concatenate(found)
