"""Boxes to heat maps and back, and what spoils them."""

import unittest

import numpy as np
import torch

from convoy_baseline.augment import motion, moved, quarter
from convoy_baseline.frames import Truth, coarsened
from convoy_baseline.grid import Grid
from convoy_baseline.spoil import SPOILS
from convoy_baseline.targets import NUMBERS, decode, encode

GRID = Grid(64, 1.6)


def boxes(count, seed=2):
    draw = np.random.default_rng(seed)
    # One in each of some squares of 9 m, so that no two are neighbours.
    squares = draw.permutation(100)[:count]
    center = np.column_stack(np.divmod(squares, 10)) * 10.0 - 45 + draw.uniform(-3, 3, (count, 2))
    size = draw.uniform([3, 1.5, 1.2], [9, 2.6, 3.5], (count, 3))
    rest = [draw.uniform(0, 2, count), draw.uniform(-np.pi, np.pi, count), draw.normal(size=(count, 2))]
    found = np.column_stack([center, rest[0], size, rest[1], rest[2]])
    return found.astype(np.float32), draw.integers(0, 3, count)


def painted(peaks):
    numbers = torch.zeros(NUMBERS, 64 * 64)
    numbers[:, torch.from_numpy(peaks.cell)] = torch.from_numpy(peaks.numbers).T
    return torch.from_numpy(peaks.heat), numbers.view(NUMBERS, 64, 64)


class RoundTrip(unittest.TestCase):
    def test_what_was_encoded_is_found_again(self):
        wanted, labels = boxes(40)
        found, classes, scores = decode(*painted(encode(wanted, labels, 3, GRID)), GRID, 100, 0.999)
        self.assertEqual(len(found), 40)
        self.assertTrue((scores == 1).all())
        nearest = np.linalg.norm(found[:, None, :2] - wanted[None, :, :2], axis=2).argmin(axis=1)
        self.assertEqual(sorted(nearest), list(range(40)))
        self.assertTrue(np.array_equal(classes, labels[nearest]))
        self.assertLess(abs(found - wanted[nearest]).max(), 1e-4)

    def test_what_is_outside_is_left_out(self):
        wanted, labels = boxes(5)
        wanted[0, 0], wanted[1, 1] = 51.3, -51.3
        peaks = encode(wanted, labels, 3, GRID)
        self.assertEqual(len(peaks.cell), 3)
        self.assertEqual((peaks.heat == 1).sum(), 3)
        self.assertEqual(len(encode(wanted[:0], labels[:0], 3, GRID).cell), 0)

    def test_heat_falls_by_the_law_around_a_peak(self):
        box = np.array([[0.8, 0.8, 1, 16, 4, 3, 0, 0, 0]], np.float32)
        heat = encode(box, np.array([1]), 3, GRID).heat
        sigma = np.sqrt(64) / 1.6 / 4
        self.assertEqual(heat[1, 31, 31], 1)
        self.assertAlmostEqual(heat[1, 33, 30], np.exp(-5 / (2 * sigma**2)), places=5)
        self.assertFalse(heat[[0, 2]].any())

    def test_of_two_that_stand_in_one_another_the_surer_stays(self):
        wanted = np.array([[0, 0, 1, 5, 2.4, 2, 0, 0, 0], [3, 0, 1, 5, 2.4, 2, 0, 0, 0]], np.float32)
        for gap, left in ((1.1, 1), (1.3, 2)):
            # Cells that are not neighbours, offsets that bring the boxes together.
            peaks = encode(wanted, np.zeros(2, int), 3, Grid(128, 0.8))
            heat, numbers = torch.zeros(3, 128, 128), torch.zeros(NUMBERS, 128, 128)
            for i, cell in enumerate(peaks.cell):
                heat[0].view(-1)[cell] = 0.9 - 0.1 * i
                numbers.view(NUMBERS, -1)[:, cell] = torch.from_numpy(peaks.numbers[i])
            numbers.view(NUMBERS, -1)[0, peaks.cell[1]] -= (3 - gap) / 0.8
            found, _, scores = decode(heat, numbers, Grid(128, 0.8), 10, 0.1)
            self.assertEqual(len(found), left)
            self.assertAlmostEqual(scores[0], 0.9, places=5)


class Truths(unittest.TestCase):
    def truth(self):
        wanted, labels = boxes(20)
        masks = np.random.default_rng(4).random((2, 64, 64)) > 0.7
        return Truth(wanted, labels, np.zeros(20, int), np.ones(20, bool), masks)

    def test_masks_are_true_where_more_than_half_is(self):
        fine = np.zeros((1, 8, 8), bool)
        fine[0, 2:4, 2:4] = [[True, True], [True, False]]
        fine[0, 4:6, 2:4] = [[True, True], [False, False]]
        fine[0, 0:2] = True  # In the margin.
        self.assertEqual(np.argwhere(coarsened(fine, 0.4, Grid(2, 0.8))[0]).tolist(), [[0, 0]])
        with self.assertRaisesRegex(ValueError, "choose other"):
            coarsened(fine, 0.4, Grid(8, 0.8))
        self.assertEqual(np.argwhere(coarsened(fine, 0.4, Grid(2, 0.9))[0]).tolist(), [[0, 0]], "at the middles")

    def test_truth_moves_with_the_ground(self):
        truth = self.truth()
        for mirrored in (False, True):
            for turn in range(4):
                move, after = motion(turn, mirrored), moved(truth, quarter(turn, mirrored), GRID)
                nose = truth.boxes[:, :2] + 3 * np.column_stack([np.cos(truth.boxes[:, 6]), np.sin(truth.boxes[:, 6])])
                there = after.boxes[:, :2] + 3 * np.column_stack([np.cos(after.boxes[:, 6]), np.sin(after.boxes[:, 6])])
                self.assertLess(abs(there - nose @ move[:2, :2].T).max(), 1e-4)
                rows, columns = np.nonzero(truth.masks[0])
                places = np.column_stack(GRID.center_of(rows, columns)) @ move[:2, :2].T
                self.assertTrue(after.masks[0][GRID.cell_of(places)].all())

    def test_spoilt_labels_are_elsewhere(self):
        truth = self.truth()
        for name, spoil in SPOILS.items():
            after = spoil(truth, np.random.default_rng(1))
            self.assertFalse(np.array_equal(after.masks, truth.masks), name)
            self.assertGreater(np.median(np.linalg.norm(after.boxes[:, :2] - truth.boxes[:, :2], axis=1)), 8, name)
            self.assertTrue(np.array_equal(after.boxes[:, 3:6], truth.boxes[:, 3:6]))


if __name__ == "__main__":
    unittest.main()
