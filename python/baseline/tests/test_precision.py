"""What must not depend on the precision that features are computed in, and sums that are the same each time."""

import unittest
from dataclasses import replace
from unittest import mock

import numpy as np
import torch
from test_lift import view as camera_view

from convoy_baseline import sums
from convoy_baseline.batch import Link, wired
from convoy_baseline.encoders.camera import Lift, splatted
from convoy_baseline.encoders.pictures import Plain
from convoy_baseline.examples import targets_of
from convoy_baseline.frames import Truth
from convoy_baseline.grid import Grid
from convoy_baseline.inputs import gathered
from convoy_baseline.loss import loss
from convoy_baseline.model import Model
from convoy_baseline.settings import Settings
from convoy_baseline.warp import places, warp

GRID = Grid(128, 0.8)


def turned_pose(yaw, x, y):
    found = np.eye(4)
    found[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
    found[:2, 3] = x, y
    return found


class Places(unittest.TestCase):
    def test_places_of_partners_are_the_same_under_autocast(self):
        poses = torch.from_numpy(np.stack([turned_pose(0.7, 31.7, -12.3), turned_pose(-2.1, 5.1, 44.4)]))
        spots = torch.rand(2, 3, 64, 64, generator=torch.Generator().manual_seed(0))
        exact, moved = places(poses, GRID.half_m, 64, 64), warp(spots, poses, GRID.half_m)
        with torch.autocast("cpu", torch.bfloat16):
            again, by_half = places(poses, GRID.half_m, 64, 64), warp(spots.bfloat16(), poses, GRID.half_m)
        self.assertLess(((exact - again) * GRID.half_m).abs().max().item(), 0.01)
        self.assertLess((moved - by_half.float()).abs().max().item(), 0.01, "as far as bf16 knows the features")

    def test_pictures_are_lifted_to_the_same_places_under_autocast(self):
        torch.manual_seed(0)
        lift = Lift(GRID, (2.0, 58.0), 28, Plain(4), 6).eval()
        lift.ground = torch.nn.Identity()
        inputs = gathered([camera_view(10, 100, 250)])
        with torch.no_grad():
            exact = lift(inputs)
            with torch.autocast("cpu", torch.bfloat16):
                half = lift(inputs)
        self.assertEqual(half.dtype, torch.float32)
        self.assertTrue(torch.equal((exact != 0).any(1), (half != 0).any(1)), "the same cells")
        self.assertLess((exact - half).abs().max(), 0.02 * exact.abs().max())


class Sums(unittest.TestCase):
    def test_gradients_of_a_splat_are_those_of_a_plain_sum_in_parts_or_at_once(self):
        draw = torch.Generator().manual_seed(1)
        cell = torch.randint(-1, 16, (3, 5, 2, 4), generator=draw)
        owner = torch.tensor([0, 1, 1])
        wanted = None
        for at_once in (None, 7, 1 << 19):
            depth = torch.rand(3, 5, 2, 4, generator=torch.Generator().manual_seed(2)).requires_grad_()
            features = torch.rand(3, 6, 2, 4, generator=torch.Generator().manual_seed(3)).requires_grad_()
            if at_once is None:
                spread = (depth[:, :, None] * features[:, None]).permute(0, 1, 3, 4, 2)
                of_view = cell + 16 * owner.view(-1, 1, 1, 1)
                ground = torch.zeros(32, 6).index_add(0, of_view[cell >= 0], spread[cell >= 0])
                ground = ground.view(2, 4, 4, 6).permute(0, 3, 1, 2)
            else:
                with mock.patch.object(sums, "ROWS_AT_ONCE", at_once):
                    ground = splatted(depth, features, cell, owner, 2, Grid(4, 1.0))
            (ground**2).sum().backward()
            found = ground.detach(), depth.grad, features.grad
            wanted = wanted or found
            for one, other in zip(wanted, found, strict=True):
                self.assertLess((one - other).abs().max(), 1e-5, at_once)


class Steps(unittest.TestCase):
    def test_a_step_in_bf16_is_that_in_f32_within_two_per_cent(self):
        settings = Settings(
            sensors=("lidar", "camera"), fusion="axial", width=8, picture_height=24, picture_width=40, drop_out=0.0
        )
        draw = np.random.default_rng(4)
        views = []
        for i in range(3):
            raster = (draw.random((3, 128, 128)) ** 8 * 255).astype(np.uint8)
            views.append(replace(camera_view(0, 120, 240, seed=i), agent=f"vehicle_{i}", raster=raster))
        links = [
            Link(0, 1, turned_pose(0.7, 20, -9)),
            Link(0, 2, turned_pose(-2, 8, 30)),
            Link(1, 0, turned_pose(1, 4, 40)),
        ]
        boxes = np.array([[10, 5, 1, 4, 2, 1.5, 0.3, 5, 1], [-20, 15, 1, 4, 2, 1.5, 2, 0, 0]], np.float32)
        truth = Truth(boxes, np.array([0, 1]), np.zeros(2), np.ones(2, bool), draw.random((2, 128, 128)) > 0.7)
        inputs, wiring, targets = gathered(views), wired([0, 1], links), targets_of([truth, truth], settings)
        found = {}
        for half in (False, True):
            torch.manual_seed(5)
            model = Model(settings, 2).train()
            optimiser = torch.optim.AdamW(model.parameters(), lr=1e-3)
            for _ in range(2):  # The loss before a step, and that after it.
                with torch.autocast("cpu", torch.bfloat16, enabled=half):
                    said = model(inputs, wiring)
                wrong = loss(model, said, targets, settings)["all"]
                optimiser.zero_grad()
                wrong.backward()
                optimiser.step()
            found[half] = wrong.item()
        self.assertLess(abs(found[True] - found[False]), 0.02 * found[False], found)


if __name__ == "__main__":
    unittest.main()
