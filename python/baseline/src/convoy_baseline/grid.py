"""The square of ground that a model looks at, in the frame of whoever looks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]


@dataclass(frozen=True)
class Grid:
    """Square cells around an agent: row 0 is ahead (x), column 0 left (y), as in the masks of `convoy.Bev`."""

    cells: int
    """Rows, and columns."""
    cell_m: float

    @property
    def half_m(self) -> float:
        """How far it reaches ahead, behind, left and right."""
        return self.cells * self.cell_m / 2

    def coarser(self, stride: int) -> Grid:
        """The same square in cells that are `stride` times as wide."""
        if self.cells % stride:
            raise ValueError(f"{self.cells} cells do not divide by {stride}")
        return Grid(self.cells // stride, self.cell_m * stride)

    def cell_of(self, places: Array) -> tuple[Array, Array]:
        """Row and column of places (..., 2 or more); they may lie outside."""
        middle = self.cells / 2
        rows = np.floor(middle - places[..., 0] / self.cell_m).astype(np.int64)
        return rows, np.floor(middle - places[..., 1] / self.cell_m).astype(np.int64)

    def center_of(self, rows: Array, columns: Array) -> tuple[Array, Array]:
        """x and y of the middle of cells, m."""
        return (self.cells / 2 - 0.5 - rows) * self.cell_m, (self.cells / 2 - 0.5 - columns) * self.cell_m

    def has(self, places: Array) -> Array:
        """Which of the places (N, 2 or more) lie within."""
        rows, columns = self.cell_of(places)
        inside: Array = (rows >= 0) & (rows < self.cells) & (columns >= 0) & (columns < self.cells)
        return inside
