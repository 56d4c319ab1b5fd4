"""Rigid transforms as 4 x 4 matrices, and where sensors sit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]


def rotation(quaternion: npt.ArrayLike) -> Array:
    """3 x 3 matrix of a unit quaternion w, x, y, z."""
    w, x, y, z = np.asarray(quaternion, dtype=np.float64)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion(turn: Array) -> Array:
    """Unit quaternion w, x, y, z of a 3 x 3 matrix: the eigenvector of the largest eigenvalue of Bar-Itzhack's matrix."""
    (a, b, c), (d, e, f), (g, h, i) = turn
    symmetric = np.array(
        [
            [a - e - i, d + b, g + c, h - f],
            [d + b, e - a - i, h + f, c - g],
            [g + c, h + f, i - a - e, d - b],
            [h - f, c - g, d - b, a + e + i],
        ]
    )
    vectors: Array = np.linalg.eigh(symmetric)[1]
    return np.roll(vectors[:, -1], 1)


def rotation_from_rpy(rpy_rad: npt.ArrayLike) -> Array:
    """Rz(yaw) Ry(pitch) Rx(roll) of angles (..., 3) in rad: matrices (..., 3, 3)."""
    angles = np.asarray(rpy_rad, dtype=np.float64)
    (cr, cp, cy), (sr, sp, sy) = (np.moveaxis(f(angles), -1, 0) for f in (np.cos, np.sin))
    rows = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def pose(translation: npt.ArrayLike, quaternion: npt.ArrayLike) -> Array:
    """4 x 4 matrix of a translation and a unit quaternion w, x, y, z."""
    matrix = np.eye(4)
    matrix[:3, :3] = rotation(quaternion)
    matrix[:3, 3] = translation
    return matrix


def invert(a_from_b: Array) -> Array:
    """b_from_a of a rigid a_from_b."""
    matrix = np.eye(4)
    matrix[:3, :3] = a_from_b[:3, :3].T
    matrix[:3, 3] = -a_from_b[:3, :3].T @ a_from_b[:3, 3]
    return matrix


def transform(a_from_b: Array, points_b: Array) -> Array:
    """Points (..., 3) in b, in a. Their type stays: give f64 for places in the world."""
    turned = points_b @ a_from_b[:3, :3].T.astype(points_b.dtype)
    moved: Array = turned + a_from_b[:3, 3].astype(points_b.dtype)
    return moved


@dataclass(frozen=True)
class Sensor:
    """What a sensor's file says about it."""

    name: str
    """Its name; of cameras without the kind of image."""
    frame: str
    """`flu` (x forward, y left, z up), or `optical` (x right, y down, z forward) of cameras."""
    agent_from_sensor: Array
    """Where it sits: 4 x 4."""
    every_n_frames: int
    """It has readings at frames 0, n, 2 n, ..."""
    width: int | None
    """Of cameras, pixels."""
    height: int | None
    intrinsics: Array | None
    """Of cameras: 3 x 3. Pixel (0, 0) covers [0, 1) x [0, 1)."""
    lens: Mapping[str, Any] | None
    """Of cameras: its model and coefficients."""

    def __repr__(self) -> str:
        x, y, z = self.agent_from_sensor[:3, 3]
        pixels = f", {self.width} x {self.height} pixels" if self.width else ""
        return f"Sensor({self.name} at ({x:.2f}, {y:.2f}, {z:.2f}) m{pixels}, every {self.every_n_frames} frames)"

    @classmethod
    def parse(cls, about: Mapping[str, Any]) -> Sensor:
        """Of the JSON object under the key `sensor` in a table's metadata."""
        place, intrinsics = about["agent_from_sensor"], about.get("intrinsics")
        return cls(
            name=about["name"],
            frame=about["frame"],
            agent_from_sensor=pose(place["translation"], place["quaternion"]),
            every_n_frames=int(about.get("every_n_frames", 1)),
            width=about.get("width"),
            height=about.get("height"),
            intrinsics=None if intrinsics is None else np.array(intrinsics, dtype=np.float64).reshape(3, 3),
            lens=about.get("lens"),
        )
