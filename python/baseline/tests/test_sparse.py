"""Sparse convolutions held against dense ones, and what becomes of points."""

import unittest

import numpy as np
import torch
from torch.nn import functional

from convoy_baseline.encoders.pillar import PillarEncoder
from convoy_baseline.encoders.points import in_cells
from convoy_baseline.encoders.voxel import DOWN, LAST_DOWN, OUT, VoxelEncoder
from convoy_baseline.frames import View
from convoy_baseline.grid import Grid
from convoy_baseline.inputs import gathered
from convoy_baseline.sparse import Kernel, Residual, Sites, SparseConv, rules, sites_after


def some_sites(shape, grids=2, share=0.1, seed=1):
    draw = torch.Generator().manual_seed(seed)
    keys = (torch.rand(grids * int(np.prod(shape)), generator=draw) < share).nonzero()[:, 0]
    return Sites(keys, grids, shape)


def dense_weight(weight, size):
    """(out, in, levels, rows, columns) of (places, in, out)."""
    return weight.permute(2, 1, 0).unflatten(2, size)


class Convolutions(unittest.TestCase):
    def same_as_dense(self, kernel, submanifold):
        torch.manual_seed(3)
        sites = some_sites((9, 14, 11))
        after = sites if submanifold else sites_after(sites, kernel)
        layer = SparseConv(4, 6, kernel).double()
        features = torch.randn(len(sites.keys), 4, dtype=torch.double, requires_grad=True)
        upstream = torch.randn(len(after.keys), 6)
        found = layer(features, rules(sites, after, kernel), len(after.keys))
        (found * upstream).sum().backward()
        grads = features.grad.clone(), layer.weight.grad.clone()
        features.grad = layer.weight.grad = None

        weight = dense_weight(layer.weight, kernel.size)
        whole = functional.conv3d(sites.dense(features), weight, stride=kernel.stride, padding=kernel.padding)
        self.assertEqual(tuple(whole.shape[2:]), after.shape)
        grid, level, row, column = after.places()
        wanted = whole[grid, :, level, row, column]
        (wanted * upstream).sum().backward()
        self.assertLess((found - wanted).abs().max(), 1e-5)
        for one, other in zip(grads, (features.grad, layer.weight.grad), strict=True):
            self.assertLess((one - other).abs().max(), 1e-5 * other.abs().max())
        if not submanifold:
            # Nothing comes out elsewhere.
            self.assertLess((whole - after.dense(wanted)).abs().max(), 1e-9)

    def test_submanifold_convolution_is_the_dense_one_at_its_sites_with_gradients(self):
        self.same_as_dense(Kernel(), True)

    def test_strided_convolutions_are_the_dense_ones_with_gradients(self):
        for kernel in (DOWN, LAST_DOWN, OUT):
            self.same_as_dense(kernel, False)

    def test_sites_are_sorted_and_places_are_theirs(self):
        sites = some_sites((5, 6, 7))
        keys, inside = sites.key_of(*sites.places())
        self.assertTrue(torch.equal(keys, sites.keys) and inside.all())
        after = sites_after(sites, DOWN)
        self.assertTrue((after.keys.diff() > 0).all())

    def test_a_residual_block_has_no_other_sites_and_learns_from_one(self):
        sites = Sites(torch.tensor([40]), 1, (5, 6, 7))
        block = Residual(4).train()
        found = block(torch.randn(1, 4), rules(sites, sites, Kernel()))
        self.assertEqual(found.shape, (1, 4))


class Points(unittest.TestCase):
    GRID = Grid(32, 1.0)

    def cloud(self, count=300, seed=5):
        draw = np.random.default_rng(seed)
        return np.column_stack(
            [draw.uniform(-15, 15, (count, 2)), draw.uniform(-2, 4, count), draw.random(count), np.zeros(count)]
        ).astype(np.float32)

    def test_points_are_sorted_into_their_cells_and_the_first_ones_count(self):
        cloud = np.concatenate([self.cloud(), [[99, 0, 0, 1, 0], [0, 0, 99, 1, 0]]]).astype(np.float32)
        view = torch.arange(302) % 2
        found = in_cells(torch.from_numpy(cloud), view, self.GRID, (-3.0, 5.0), 4, 2)
        wanted = {}
        for i in range(300):
            row, column = (int(v) for v in self.GRID.cell_of(cloud[i]))
            key = ((i % 2) * 4 + int((cloud[i, 2] + 3) // 2)) * 1024 + row * 32 + column
            wanted.setdefault(key, []).append(cloud[i])
        self.assertEqual(found.keys.tolist(), sorted(wanted))
        points = np.concatenate([wanted[key][:2] for key in sorted(wanted)])
        self.assertTrue(np.array_equal(found.points.numpy(), points))

    def test_moved_points_are_seen_at_moved_places(self):
        # By a whole feature's side ahead: what the encoders say moves one row up.
        grid = Grid(96, 0.25)
        encoders = (
            (VoxelEncoder(grid, (-3.0, 5.0), 0.2, 5, (4, 4, 8, 8)), 2.0),
            (PillarEncoder(grid, (-3.0, 5.0), 20, 8, 4), 1.0),
        )
        cloud = self.cloud(60)
        cloud[:, :2] *= 0.1
        for encoder, far in encoders:
            torch.manual_seed(1)
            encoder.eval()
            if isinstance(encoder, VoxelEncoder):
                self.assertEqual(encoder.shape_after, (2, 12, 12))
                encoder.first.convolution.weight.data[:, :2] = 0  # x and y themselves say where a voxel is.
            else:
                encoder.look.weight.data[:, :2] = 0
            ahead = cloud + np.array([far, 0, 0, 0, 0], np.float32)
            with torch.no_grad():
                here, there = (encoder(gathered([View("vehicle_0", None, np.eye(4), (), c)])) for c in (cloud, ahead))
            rows = round(far / (grid.cell_m * grid.cells / here.shape[2]))
            self.assertGreater(here.abs().max(), 0)
            # Without the edge, where convolutions see less.
            self.assertLess((here[:, :, rows + 3 : -3] - there[:, :, 3 : -3 - rows])[..., 3:-3].abs().max(), 1e-3)

    def test_nothing_seen_is_nothing_said(self):
        empty = View("vehicle_0", None, np.eye(4), (), np.zeros((0, 5), np.float32))
        encoder = VoxelEncoder(Grid(64, 0.25), (-3.0, 5.0), 0.2, 5, (4, 4, 8, 8))
        self.assertEqual(encoder(gathered([empty])).abs().max(), 0)
        self.assertEqual(PillarEncoder(Grid(64, 0.25), (-3.0, 5.0), 20, 8, 4)(gathered([empty])).shape, (1, 8, 32, 32))


if __name__ == "__main__":
    unittest.main()
