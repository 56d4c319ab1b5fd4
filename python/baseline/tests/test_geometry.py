"""Cells, pictures, warps and moves, by numbers worked out by hand."""

import unittest

import numpy as np
import torch

from convoy_baseline.augment import motion, turned
from convoy_baseline.grid import Grid
from convoy_baseline.raster import CHANNELS, SLICES, rasterise, unpack
from convoy_baseline.warp import reach, warp

GRID = Grid(32, 2.0)


def pose(x, y, yaw, z=0.0):
    found = np.eye(4)
    found[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
    found[:3, 3] = x, y, z
    return found


class Cells(unittest.TestCase):
    def test_ahead_is_up_and_left_is_left(self):
        row, column = GRID.cell_of(np.array([[31.9, 31.9], [-31.9, -31.9], [0.1, -0.1], [5.0, 9.0]]))
        self.assertEqual(row.tolist(), [0, 31, 15, 13])
        self.assertEqual(column.tolist(), [0, 31, 16, 11])
        x, y = GRID.center_of(row, column)
        self.assertEqual((x[3], y[3]), (5.0, 9.0))
        self.assertEqual(GRID.has(np.array([[32.1, 0], [-31.9, 31.9], [0, -32.1]])).tolist(), [False, True, False])


class Pictures(unittest.TestCase):
    def test_a_picture_has_every_point_at_its_place_and_height(self):
        points = np.array([[5, 9, 0.1, 0.5], [5.2, 9.2, 0.2, 0.25], [5, 9, 99, 0.75], [-40, 0, 0, 1]], np.float32)
        picture = unpack(torch.from_numpy(rasterise(points, GRID))[None])[0].numpy()
        self.assertEqual(picture.shape, (CHANNELS, 32, 32))
        self.assertEqual(picture[:SLICES, 13, 11].tolist(), [0, 1, 0, 0, 0, 0, 0, 1])
        self.assertAlmostEqual(picture[SLICES, 13, 11], 32 * np.log2(4) / 255, places=2)
        self.assertAlmostEqual(picture[SLICES + 1, 13, 11], 0.5, places=2)
        picture[:, 13, 11] = 0
        self.assertFalse(picture.any(), "the point that is outside is nowhere")


class Warps(unittest.TestCase):
    def test_what_is_painted_in_a_partners_frame_lands_where_it_is_for_the_ego(self):
        # Distances of whole cells and quarter turns: exact.
        for yaw, there, here in (
            (0.0, (5.0, 9.0), (9.0, 3.0)),
            (np.pi / 2, (5.0, 9.0), (4.0 - 9.0, -6.0 + 5.0)),
            (np.pi, (5.0, 9.0), (4.0 - 5.0, -6.0 - 9.0)),
            (-np.pi / 2, (5.0, 9.0), (4.0 + 9.0, -6.0 - 5.0)),
        ):
            painted = torch.zeros(1, 1, 32, 32)
            painted[0, 0][GRID.cell_of(np.array(there))] = 1.0
            found = warp(painted, torch.from_numpy(pose(4.0, -6.0, yaw)[None]), GRID.half_m)[0, 0]
            self.assertAlmostEqual(found[GRID.cell_of(np.array(here))].item(), 1.0, places=4)
            self.assertAlmostEqual(found.sum().item(), 1.0, places=3)

    def test_any_pose_moves_the_middle_of_a_spot_as_the_matrix_does(self):
        rows, columns = np.mgrid[0:32, 0:32]
        x, y = GRID.center_of(rows, columns)
        draw = np.random.default_rng(5)
        for _ in range(20):
            there, ego_from_view = draw.uniform(-8, 8, 2), pose(*draw.uniform(-12, 12, 2), draw.uniform(-3, 3), 1.5)
            spot = torch.from_numpy(np.exp(-((x - there[0]) ** 2 + (y - there[1]) ** 2) / 18)).float()
            found = warp(spot[None, None], torch.from_numpy(ego_from_view[None]), GRID.half_m)[0, 0].double().numpy()
            middle = np.array([(found * x).sum(), (found * y).sum()]) / found.sum()
            wanted = (ego_from_view @ [*there, 0, 1])[:2]
            self.assertLess(abs(middle - wanted).max(), 0.05)

    def test_where_a_partner_does_not_look_there_is_nothing(self):
        found = warp(torch.ones(1, 1, 32, 32), torch.from_numpy(pose(40.0, 0.0, 0.0)[None]), GRID.half_m)[0, 0]
        self.assertTrue((found[:12] == 1).all())
        self.assertTrue((found[12:] == 0).all())
        there = reach(torch.from_numpy(pose(40.0, 0.0, 0.0)[None]), GRID.half_m, 32, 32)[0]
        self.assertTrue(there[:12].all() and not there[12:].any())


class Moves(unittest.TestCase):
    def test_turned_pictures_are_pictures_of_turned_points(self):
        points = np.random.default_rng(3).uniform(-31, 31, (200, 4)).astype(np.float32)
        points[:, 3] = 0.5
        for mirrored in (False, True):
            for turn in range(4):
                move = motion(turn, mirrored)
                there = points.copy()
                there[:, :2] = points[:, :2] @ move[:2, :2].T
                same = np.array_equal(turned(rasterise(points, GRID), turn, mirrored), rasterise(there, GRID))
                self.assertTrue(same, (turn, mirrored))
                self.assertTrue(np.allclose(move @ move.T, np.eye(4)))


if __name__ == "__main__":
    unittest.main()
