"""Pictures by matplotlib: what `Frame.plot_bev` and `Agent.plot_cameras` draw.

Colours of boxes say who saw an object: the ego, only others, or nobody. They can be told apart by people who see red and
green alike.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from convoy.boxes import Boxes
from convoy.errors import StoreError
from convoy.poses import Array, invert, transform

if TYPE_CHECKING:
    from convoy.frame import Agent, Frame

SEEN_BY = ("seen by the ego", "seen by others only", "seen by nobody")
"""What the colours of boxes mean."""
_BOX_COLOURS = ("#0072b2", "#d55e00", "#b9bec4")
_BOX_WIDTHS = (1.8, 1.8, 1.0)
_AGENT_COLOURS = ("#56b4e9", "#009e73", "#cc79a7", "#b8a100", "#8c6bb1", "#999999")
_EDGES = ((0, 1), (2, 3), (4, 5), (6, 7), (0, 2), (1, 3), (4, 6), (5, 7), (0, 4), (1, 5), (2, 6), (3, 7))
_NEAR_M = 0.3
_WITHOUT_SENSORS = ("traffic_light", "traffic_sign")


def _pyplot() -> Any:
    try:
        import matplotlib.pyplot as plt
    except ImportError as fault:
        raise ImportError("plots need matplotlib: pip install matplotlib pillow") from fault
    return plt


def who_saw(frame: Frame, ego: str) -> tuple[Boxes, Array]:
    """All boxes of a frame but the ego's own, in the world, and for each an index into `SEEN_BY`."""
    boxes = frame.boxes()
    own = frame.agent(ego)
    boxes = boxes[boxes.id != own.id]
    seen = np.where(np.isin(boxes.id, own.boxes(valid=True).id), 0, np.where(boxes.valid, 1, 2))
    return boxes, seen


def bev(
    frame: Frame,
    ego: str | None = None,
    *,
    radius_m: float = 60.0,
    lidar: str | None = "LIDAR",
    ax: Any = None,
) -> Any:
    """`Frame.plot_bev`."""
    plt = _pyplot()
    ego = ego or frame.agents[0]
    if ax is None:
        ax = plt.subplots(figsize=(8, 8), layout="constrained")[1]
    ego_from_world = invert(frame.agent(ego).pose)
    _draw_map(ax, frame, ego_from_world, radius_m)
    for number, name in enumerate(frame.agents):
        agent, colour = frame.agent(name), _AGENT_COLOURS[number % len(_AGENT_COLOURS)]
        if lidar is not None and lidar in agent.sensors:
            points = transform(ego_from_world @ agent.pose, agent.points(lidar)[:, :3].astype(np.float64))
            near = points[np.abs(points[:, :2]).max(axis=1) < radius_m]
            ax.scatter(-near[:, 1], near[:, 0], s=1.2, color=colour, alpha=0.6, linewidths=0, rasterized=True, zorder=2)
        at = transform(ego_from_world, agent.pose[:3, 3])
        ax.plot(-at[1], at[0], "o", color=colour, markersize=9, markeredgecolor="black", zorder=6, label=name)
    boxes, seen = who_saw(frame, ego)
    keep = np.array([name not in _WITHOUT_SENSORS for name in boxes.class_name], bool)
    boxes, seen = boxes[keep].transformed(ego_from_world), seen[keep]
    outline = boxes.corners[:, [0, 2, 6, 4, 0], :2]
    for kind in (2, 1, 0):
        strips = outline[seen == kind]
        for strip in strips[np.abs(strips).max(axis=(1, 2)) < radius_m]:
            ax.fill(-strip[:, 1], strip[:, 0], color=_BOX_COLOURS[kind], alpha=0.15, linewidth=0, zorder=3)
            ax.plot(-strip[:, 1], strip[:, 0], color=_BOX_COLOURS[kind], linewidth=_BOX_WIDTHS[kind], zorder=5 - kind)
    for kind, meaning in enumerate(SEEN_BY):
        ax.plot([], [], color=_BOX_COLOURS[kind], linewidth=2, label=meaning)
    ax.set(xlim=(-radius_m, radius_m), ylim=(-radius_m, radius_m), aspect="equal")
    ax.set(xlabel=f"metres to the right of {ego}", ylabel="metres ahead")
    ax.legend(loc="lower left", fontsize="small", framealpha=0.9)
    return ax


def cameras(agent: Agent, names: list[str] | None = None, *, reach_m: float = 60.0, axes: Any = None) -> Any:
    """`Agent.plot_cameras`."""
    plt = _pyplot()
    names = names or [name.removeprefix("RGB-") for name in agent.sensors if name.startswith("RGB-")]
    if not names:
        raise agent.fault("it has no colour images", "see Agent.sensors")
    if axes is None:
        columns = min(3, len(names))
        rows = -(-len(names) // columns)
        size = (4.2 * columns, 2.6 * rows)
        axes = plt.subplots(rows, columns, figsize=size, squeeze=False, layout="constrained")[1]
    flat = np.atleast_1d(np.asarray(axes, dtype=object)).ravel()
    boxes, seen = who_saw(agent.frame, agent.name)
    boxes = boxes.transformed(invert(agent.pose))
    near = np.linalg.norm(boxes.center, axis=1) < reach_m
    near &= np.array([name not in _WITHOUT_SENSORS for name in boxes.class_name], bool)
    for ax, name in zip(flat, names, strict=False):
        camera = agent.camera(name)
        ax.imshow(camera.image(), interpolation="antialiased")
        width, height = camera.sensor.width, camera.sensor.height
        ax.set(xlim=(0, width), ylim=(height, 0), xticks=[], yticks=[], title=f"{agent.name} {name}")
        if _is_pinhole(camera.sensor.lens):
            corners = transform(invert(camera.agent_from_camera), boxes.corners)
            for kind in (1, 0):
                for eight in corners[near & (seen == kind)]:
                    _draw_edges(ax, eight, camera.intrinsics, _BOX_COLOURS[kind])
    for ax in flat[len(names) :]:
        ax.set_axis_off()
    return axes


def _is_pinhole(lens: Any) -> bool:
    return lens is None or lens.get("model", "pinhole") == "pinhole"


def _draw_edges(ax: Any, corners: Array, intrinsics: Array, colour: str) -> None:
    """The twelve edges of a box in an optical frame, each cut off where it passes behind the camera."""
    for begin, end in _EDGES:
        a, b = corners[begin], corners[end]
        if max(a[2], b[2]) <= _NEAR_M:
            continue
        if a[2] < _NEAR_M:
            a = b + (a - b) * (b[2] - _NEAR_M) / (b[2] - a[2])
        if b[2] < _NEAR_M:
            b = a + (b - a) * (a[2] - _NEAR_M) / (a[2] - b[2])
        pixels = np.stack([a, b]) @ intrinsics.T
        ax.plot(*(pixels[:, :2] / pixels[:, 2:]).T, color=colour, linewidth=1.1)


def _draw_map(ax: Any, frame: Frame, ego_from_world: Array, radius_m: float) -> None:
    try:
        elements = frame.scene.vector_map()
    except StoreError:
        return  # Imported scenes have none.
    kinds = {"divider": ("#c9cdd2", 0.8), "kerb": ("#8a9099", 1.0), "crosswalk": ("#9db8d2", 1.0)}
    for row in elements.select(["kind", "x_m", "y_m", "z_m"]).to_pylist():
        if row["kind"] in kinds:
            colour, width = kinds[row["kind"]]
            line = transform(ego_from_world, np.stack([row["x_m"], row["y_m"], row["z_m"]], axis=1).astype(np.float64))
            if (np.abs(line[:, :2]).max(axis=1) < 1.5 * radius_m).any():
                ax.plot(-line[:, 1], line[:, 0], color=colour, linewidth=width, zorder=1)
