"""How views and what is to be found in them are moved, so that a model does not learn directions by heart."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import torch
from torch.nn import functional

from convoy_baseline.frames import Truth, View, sampled
from convoy_baseline.grid import Array, Grid
from convoy_baseline.inputs import Inputs
from convoy_baseline.settings import Settings
from convoy_baseline.sweeps import drawn


@dataclass(frozen=True)
class Move:
    """Mirrors y, then scales, turns to the left and shifts."""

    matrix: Array
    """4 x 4."""
    scale: float = 1.0
    quarters: int | None = None
    """Whether it is a turn by quarters alone, and by how many, so that pictures of the ground stay exact."""
    mirrored: bool = False


def moves(count: int, settings: Settings, draw: np.random.Generator) -> list[Move]:
    """One for each view of a keyframe: mirrored and scaled alike, turned and shifted each for itself."""
    mirrored = bool(draw.integers(2))
    if settings.augment == "quarters":
        return [quarter(int(turn), mirrored) for turn in draw.integers(4, size=count)]
    scale = float(draw.uniform(*settings.scale))
    found = []
    for _ in range(count):
        turn = np.radians(draw.uniform(-settings.turn_deg, settings.turn_deg))
        matrix = np.eye(4)
        matrix[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
        matrix[:3, :3] = scale * matrix[:3, :3] @ np.diag([1, -1 if mirrored else 1, 1])
        matrix[:2, 3] = draw.normal(0, settings.shift_m, 2)
        found.append(Move(matrix, scale))
    return found


def quarter(turn: int, mirrored: bool) -> Move:
    """A turn by quarters."""
    return Move(motion(turn, mirrored), 1.0, turn, mirrored)


def motion(turn: int, mirrored: bool) -> Array:
    """4 x 4: mirrors y, then turns to the left by quarters. Its inverse is its transpose."""
    cosine, sine = ((1, 0), (0, 1), (-1, 0), (0, -1))[turn]
    found = np.eye(4)
    found[:2, :2] = np.array([[cosine, -sine], [sine, cosine]]) @ np.diag([1, -1 if mirrored else 1])
    return found


def turned(picture: Array, turn: int, mirrored: bool) -> Array:
    """A picture (..., H, W) of ground that is moved by `motion`."""
    return np.ascontiguousarray(np.rot90(picture[..., ::-1] if mirrored else picture, turn, axes=(-2, -1)))


def moved_view(view: View, move: Move) -> View:
    """What an agent saw, moved: pictures stay as they are, but their cameras are moved."""
    pictures = tuple(replace(one, agent_from_optical=move.matrix @ one.agent_from_optical) for one in view.pictures)
    raster, points = view.raster, view.points
    if raster is not None:
        if move.quarters is None:
            raise ValueError("a raster turns by quarters alone: expected points")
        raster = turned(raster, move.quarters, move.mirrored)
    return replace(
        view, raster=raster, pictures=pictures, points=None if points is None else moved_points(points, move.matrix)
    )


def moved_points(points: Array, matrix: Array) -> Array:
    """Points (N, 3 or more), by a 4 x 4."""
    found = points.copy()
    found[:, :3] = points[:, :3] @ matrix[:3, :3].T.astype(np.float32) + matrix[:3, 3].astype(np.float32)
    return found


def moved(truth: Truth, move: Move, mask_grid: Grid) -> Truth:
    """What is to be found, moved. By other turns than quarters, masks are taken from those that reach farther."""
    if move.quarters is not None:
        masks = turned(truth.masks, move.quarters, move.mirrored)
    elif truth.wide is not None:
        masks = sampled(truth.wide, mask_grid, move.matrix)
    else:
        raise ValueError("masks turn by quarters alone where there are none that reach farther")
    return replace(truth, boxes=moved_boxes(truth.boxes, move.matrix, move.scale), masks=masks, wide=None)


def moved_boxes(boxes: Array, matrix: Array, scale: float = 1.0) -> Array:
    """Boxes (N, 9) as `convoy.DetectionSamples` has them, by a 4 x 4 that turns about z, mirrors and scales."""
    found = boxes.copy()
    found[:, :3] = boxes[:, :3] @ matrix[:3, :3].T + matrix[:3, 3]
    found[:, 3:6] = boxes[:, 3:6] * scale
    heading = np.column_stack([np.cos(boxes[:, 6]), np.sin(boxes[:, 6])]) @ matrix[:2, :2].T
    found[:, 6] = np.arctan2(heading[:, 1], heading[:, 0])
    found[:, 7:9] = boxes[:, 7:9] @ matrix[:2, :2].T
    return found


def thinner(view: View, settings: Settings, draw: np.random.Generator) -> View:
    """With some of its earlier sweeps, if so many are not wanted in training."""
    if view.points is None or not settings.sweeps_drawn:
        return view
    return replace(view, points=drawn(view.points, settings.sweeps_drawn, draw))


def zoomed(inputs: Inputs, settings: Settings, draw: np.random.Generator) -> Inputs:
    """Pictures zoomed and turned about their middles, each by itself, and their intrinsics with them."""
    (low, high), most = settings.picture_scale, settings.picture_turn_deg
    if not len(inputs.pictures) or (low == high == 1.0 and not most):
        return inputs
    count, _, height, width = inputs.pictures.shape
    zoom = draw.uniform(low, high, count)
    turn = np.radians(draw.uniform(-most, most, count))
    new_from_old = np.tile(np.eye(3), (count, 1, 1))
    linear = zoom[:, None, None] * np.stack([np.cos(turn), -np.sin(turn), np.sin(turn), np.cos(turn)], 1).reshape(
        -1, 2, 2
    )
    middle = np.array([width / 2, height / 2])
    new_from_old[:, :2, :2] = linear
    new_from_old[:, :2, 2] = middle - linear @ middle
    # In units of half a picture, from its middle.
    unit = np.array([[width / 2, 0, width / 2], [0, height / 2, height / 2], [0, 0, 1]])
    theta = np.linalg.inv(unit) @ np.linalg.inv(new_from_old) @ unit
    where = functional.affine_grid(
        torch.from_numpy(theta[:, :2]).float(), list(inputs.pictures.shape), align_corners=False
    )
    pictures = functional.grid_sample(inputs.pictures.float(), where, align_corners=False).round().to(torch.uint8)
    intrinsics = torch.from_numpy(new_from_old).float() @ inputs.intrinsics
    return replace(inputs, pictures=pictures, intrinsics=intrinsics)
