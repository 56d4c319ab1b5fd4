"""3-D boxes as arrays."""

from __future__ import annotations

import dataclasses
from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa

from convoy.poses import Array, transform

CLASSES = (
    "traffic_light",
    "traffic_sign",
    "pedestrian",
    "car",
    "truck",
    "bus",
    "motorcycle",
    "bicycle",
    "traffic_cone",
    "barrier",
)
"""The detection classes, in their canonical order."""
DIFFICULTIES = ("easy", "medium", "hard")


@dataclass(frozen=True)
class Boxes:
    """N boxes in one frame of reference: the world's unless `transformed`."""

    id: Array
    """(N,) u16: object ids, the same in images, points and tracks."""
    label: Array
    """(N,) i64: index into `CLASSES`, or -1."""
    center: Array
    """(N, 3) m."""
    size: Array
    """(N, 3): length, width, height, m."""
    rotation: Array
    """(N, 3, 3): reference from box."""
    corners: Array
    """(N, 8, 3) m: 0 to 4 is the length, 0 to 2 the width (0 is left), 0 to 1 the height."""
    velocity: Array
    """(N, 3) over the ground along the axes of the reference, m/s."""
    num_lidar_pts: Array
    """(N,) i64."""
    num_radar_pts: Array
    """(N,) i64."""
    valid: Array
    """(N,) bool: whether it was seen."""
    difficulty: Array
    """(N,) i64: index into `DIFFICULTIES`."""

    def __repr__(self) -> str:
        counts = ", ".join(f"{count} {name or 'other'}" for name, count in Counter(self.class_name).most_common())
        return f"Boxes({len(self)}: {counts})" if len(self) else "Boxes(0)"

    def __len__(self) -> int:
        return len(self.id)

    def __getitem__(self, which: Array | slice) -> Boxes:
        """Some of them: a mask, indices or a slice."""
        return Boxes(*(getattr(self, field.name)[which] for field in dataclasses.fields(self)))

    @property
    def yaw(self) -> Array:
        """(N,) heading in the reference, rad."""
        angle: Array = np.arctan2(self.rotation[:, 1, 0], self.rotation[:, 0, 0])
        return angle

    @property
    def class_name(self) -> list[str]:
        """Their classes' names."""
        return [CLASSES[label] if label >= 0 else "" for label in self.label]

    def to_arrow(self) -> pa.Table:
        """A row per box: id, class, centre, size, yaw, velocity, counts of points, valid, difficulty."""
        difficulty = [DIFFICULTIES[level] if level >= 0 else None for level in self.difficulty]
        columns = {"id": self.id, "class": self.class_name}
        columns |= {f"{axis}_m": self.center[:, n] for n, axis in enumerate("xyz")}
        columns |= {f"{side}_m": self.size[:, n] for n, side in enumerate(("length", "width", "height"))}
        columns["yaw_rad"] = self.yaw
        columns |= {f"v{axis}_mps": self.velocity[:, n] for n, axis in enumerate("xyz")}
        columns |= {"num_lidar_pts": self.num_lidar_pts, "num_radar_pts": self.num_radar_pts, "valid": self.valid}
        return pa.table(columns | {"difficulty": pa.array(difficulty, pa.string())})

    def to_pandas(self) -> Any:
        """`to_arrow` as a data frame of pandas."""
        return self.to_arrow().to_pandas()

    def to_polars(self) -> Any:
        """`to_arrow` as a data frame of Polars."""
        return polars().from_arrow(self.to_arrow())

    def transformed(self, a_from_b: Array) -> Boxes:
        """The same boxes (in b) as they are in a."""
        turn = a_from_b[:3, :3]
        return dataclasses.replace(
            self,
            center=transform(a_from_b, self.center),
            corners=transform(a_from_b, self.corners),
            rotation=turn @ self.rotation,
            velocity=self.velocity @ turn.T,
        )

    def contains(self, points: Array, margin_m: float = 0.0) -> Array:
        """(N, P) bool: which of the points (P, 3), in the same reference, are in which box."""
        own = np.einsum("npk,nkj->npj", points[None] - self.center[:, None], self.rotation)
        inside: Array = (np.abs(own) <= self.size[:, None] / 2 + margin_m).all(axis=2)
        return inside


def polars() -> Any:
    """The package Polars, which not everybody has."""
    try:
        import polars as package
    except ImportError as fault:
        raise ImportError("this needs Polars: pip install polars") from fault
    return package
