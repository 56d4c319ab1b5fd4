"""Who hears whom, and what they say in the ego's frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from convoy.frame import Agent, Frame
from convoy.poses import Array, invert

MODES = ("none", "x2v", "x2i", "x2x")
"""No partners, vehicles, RSUs, both."""


@dataclass(frozen=True)
class Cooperative:
    """An ego and its partners at one moment."""

    ego: Agent
    partners: tuple[Agent, ...]
    """Vehicles, then RSUs; never the ego."""
    mode: str

    def __repr__(self) -> str:
        partners = ", ".join(agent.name for agent in self.partners) or "nobody"
        return f"Cooperative({self.ego.name} hears {partners}, mode={self.mode!r})"

    @property
    def agents(self) -> tuple[Agent, ...]:
        """The ego, then its partners."""
        return (self.ego, *self.partners)

    def ego_from(self, agent: Agent) -> Array:
        """ego_from_agent: 4 x 4, by the exact poses of both."""
        return invert(self.ego.pose) @ agent.pose

    @property
    def ego_from_agent(self) -> Array:
        """(A, 4, 4) of `agents`; the first is the identity."""
        found = np.stack([self.ego_from(agent) for agent in self.agents])
        found[0] = np.eye(4)
        return found

    def points(self, name: str = "LIDAR", columns: tuple[str, ...] = ("intensity",)) -> list[Array]:
        """Sweeps of `agents`, all moved into the ego's frame: (P, 3 + columns) f32 each; none of a partner without this lidar."""
        return [
            agent._points(name, columns, ego_from_agent)
            if agent is self.ego or name in agent.sensors
            else np.empty((0, 3 + len(columns)), np.float32)
            for agent, ego_from_agent in zip(self.agents, self.ego_from_agent, strict=True)
        ]

    def seen_by(self, ids: Array) -> Array:
        """(A, N) bool: which of the objects each of `agents` has seen, by its own list."""
        return np.stack([np.isin(ids, agent.boxes(valid=True).id) for agent in self.agents])


def cooperate(frame: Frame, ego: str, mode: str, comm_range_m: float, elevation_m: float) -> Cooperative:
    """`Frame.cooperative`."""
    if mode not in MODES:
        raise ValueError(f"mode {mode!r}: expected one of {', '.join(MODES)}")
    own = frame.agent(ego)
    partners = []
    for name in frame.agents:
        other = frame.agent(name)
        apart = other.pose[:3, 3] - own.pose[:3, 3]
        heard = mode == "x2x" or mode == ("x2i" if other.is_rsu else "x2v")
        if name != ego and heard and np.linalg.norm(apart) <= comm_range_m and abs(apart[2]) <= elevation_m:
            partners.append(other)
    return Cooperative(own, tuple(partners), mode)
