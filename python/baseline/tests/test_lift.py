"""Where pixels are lifted to, and what becomes of them there."""

import unittest

import numpy as np
import torch

from convoy_baseline.augment import motion, moved_view, quarter, turned
from convoy_baseline.encoders.camera import Lift, cells, frustum, splatted
from convoy_baseline.encoders.pictures import STRIDE, Plain
from convoy_baseline.frames import View
from convoy_baseline.grid import Grid
from convoy_baseline.inputs import gathered
from convoy_baseline.pictures import Picture

GRID = Grid(40, 1.0)
FLU_FROM_OPTICAL = np.array([[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1]], float)
WIDTH, HEIGHT = 5 * STRIDE, 3 * STRIDE
INTRINSICS = np.array([[WIDTH / 2, 0, WIDTH / 2], [0, WIDTH / 2, HEIGHT / 2], [0, 0, 1]], float)


def facing(yaw_deg, place=(1.5, 0.5, 1.6)):
    """agent_from_optical of a camera that looks level at an angle to the left."""
    found = np.eye(4)
    yaw = np.radians(yaw_deg)
    found[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
    found[:3, 3] = place
    return found @ FLU_FROM_OPTICAL


def view(*yaws_deg, seed=3):
    draw = np.random.default_rng(seed)
    pictures = tuple(
        Picture(draw.integers(0, 256, (3, HEIGHT, WIDTH)).astype(np.uint8), INTRINSICS, facing(yaw)) for yaw in yaws_deg
    )
    return View("vehicle_0", np.zeros((3, 80, 80), np.uint8), np.eye(4), pictures)


class Places(unittest.TestCase):
    def test_the_middle_of_a_picture_lies_ahead_of_its_camera_and_the_edge_at_45_degrees(self):
        inputs = gathered([view(0, 90)])
        depths = torch.tensor([4.0, 10.0])
        places = frustum(inputs.intrinsics, inputs.view_from_optical, depths, 3, 5).double().numpy()
        for d, depth in enumerate((4.0, 10.0)):
            self.assertLess(abs(places[0, d, 1, 2] - [1.5 + depth, 0.5, 1.6]).max(), 1e-5)
            self.assertLess(abs(places[1, d, 1, 2] - [1.5, 0.5 + depth, 1.6]).max(), 1e-5)
            # The first column's middle is 4/5 of the way to the edge, which lies at 45 degrees; left is +y, up +z.
            self.assertLess(abs(places[0, d, 1, 0] - [1.5 + depth, 0.5 + 0.8 * depth, 1.6]).max(), 1e-5)
            self.assertLess(abs(places[0, d, 0, 2] - [1.5 + depth, 0.5, 1.6 + 0.4 * depth]).max(), 1e-5)

    def test_cells_are_those_of_the_grid(self):
        places = torch.tensor([[19.9, 19.9, 0], [-19.9, -19.9, 3], [0.5, -0.5, 0], [20.1, 0, 0], [0, -20.1, 0]])
        rows, columns = GRID.cell_of(places.numpy())
        want = [r * 40 + c if 0 <= r < 40 and 0 <= c < 40 else -1 for r, c in zip(rows, columns, strict=True)]
        self.assertEqual(cells(places, GRID).tolist(), want)
        self.assertEqual(want[:2] + want[3:], [0, 1599, -1, -1])

    def test_sums_are_those_of_a_loop(self):
        draw = torch.Generator().manual_seed(1)
        depth = torch.rand(3, 4, 2, 5, generator=draw)
        features = torch.rand(3, 6, 2, 5, generator=draw)
        cell = torch.randint(-1, 1600, (3, 4, 2, 5), generator=draw)
        owner = torch.tensor([0, 1, 1])
        want = torch.zeros(2, 6, 40, 40)
        for p, d, r, c in np.ndindex(3, 4, 2, 5):
            at = int(cell[p, d, r, c])
            if at >= 0:
                want[owner[p], :, at // 40, at % 40] += depth[p, d, r, c] * features[p, :, r, c]
        found = splatted(depth, features, cell, owner, 2, GRID)
        self.assertLess((found - want).abs().max().item(), 1e-6)

    def test_a_moved_view_lifts_to_moved_ground(self):
        torch.manual_seed(0)
        lift = Lift(GRID, (2.0, 18.0), 16, Plain(4), 6).eval()
        lift.ground = torch.nn.Identity()  # Which is no symmetric one.
        # Off the edges of cells, where rounding would decide.
        plain = view(10, 100, 250)
        with torch.no_grad():
            before = lift(gathered([plain])).numpy()
            self.assertGreater((abs(before).sum(axis=1) > 0).sum(), 50)
            for turn in range(4):
                for mirrored in (False, True):
                    after = lift(gathered([moved_view(plain, quarter(turn, mirrored))])).numpy()
                    self.assertLess(abs(after - turned(before, turn, mirrored)).max(), 1e-5, (turn, mirrored))
        self.assertEqual(motion(0, True)[1, 1], -1)


if __name__ == "__main__":
    unittest.main()
