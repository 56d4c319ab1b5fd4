"""Fusion of views: masks of what each one knows, and attention held against loops."""

import unittest
from unittest import mock

import numpy as np
import torch

from convoy_baseline.fusion import AxialFusion, MaxFusion, attention


def attended(block, tokens, known, places, side):
    """What `AttentionBlock` does to tokens of one set, token by token. `places` are (view, row, column) on the square of `side`."""
    channels, heads = tokens.shape[1], block.heads
    asked = block.asked(block.before(tokens)).view(len(tokens), 3, heads, channels // heads)
    out = torch.zeros_like(tokens)
    for i, (view, row, column) in enumerate(places):
        said = []
        for h in range(heads):
            scores, values = [], []
            for j, (other, far, along) in enumerate(places):
                if known[j]:
                    offset = (row - far + side - 1) * (2 * side - 1) + column - along + side - 1
                    bias = block.bias[0 if other == view else 1, offset, h]
                    scores.append(asked[i, 0, h] @ asked[j, 1, h] / (channels // heads) ** 0.5 + bias)
                    values.append(asked[j, 2, h])
            said.append(torch.softmax(torch.stack(scores), 0) @ torch.stack(values))
        out[i] = tokens[i] + block.out(torch.cat(said))
    return out + block.network(out)


def written_out(fusion, views, known):
    """What `AxialFusion` does, in loops over windows and meshes."""
    side, (egos, agents, channels, height, width) = fusion.window, views.shape
    rows, columns = -(-height // side), -(-width // side)
    whole = torch.zeros(egos, agents, rows * side, columns * side, channels)
    whole[:, :, :height, :width] = views.permute(0, 1, 3, 4, 2)
    there = torch.zeros(egos, agents, rows * side, columns * side, dtype=torch.bool)
    there[:, :, :height, :width] = known
    for block, near in ((fusion.near, True), (fusion.far, False)):
        after = whole.clone()
        for e, r, c in np.ndindex(egos, rows, columns):
            places = list(np.ndindex(agents, side, side))
            cells = [
                (e, a, r * side + i, c * side + j) if near else (e, a, i * rows + r, j * columns + c)
                for a, i, j in places
            ]
            tokens = torch.stack([whole[cell] for cell in cells])
            for cell, value in zip(
                cells, attended(block, tokens, [there[cell] for cell in cells], places, side), strict=True
            ):
                after[cell] = value
        whole = after
    out = torch.zeros(egos, channels, height, width)
    for e, y, x in np.ndindex(egos, height, width):
        out[e, :, y, x] = torch.stack([whole[e, a, y, x] for a in range(agents) if known[e, a, y, x]]).amax(0)
    return out


def views_of(egos, agents, channels, height, width, seed=1):
    draw = torch.Generator().manual_seed(seed)
    views = torch.randn(egos, agents, channels, height, width, generator=draw)
    known = torch.rand(egos, agents, height, width, generator=draw) > 0.4
    known[:, 0] = True
    return views, known


class Greatest(unittest.TestCase):
    def test_the_greatest_of_what_is_known_wins_whoever_says_it(self):
        views, known = views_of(2, 3, 4, 8, 8)
        found = MaxFusion()(views, known)
        for e, y, x in np.ndindex(2, 8, 8):
            self.assertTrue(torch.equal(found[e, :, y, x], views[e, known[e, :, y, x], :, y, x].amax(0)))
        self.assertTrue(torch.equal(found, MaxFusion()(views.flip(1), known.flip(1))))


class Attention(unittest.TestCase):
    def test_it_is_what_loops_say_with_masks_and_sides_that_do_not_divide(self):
        torch.manual_seed(2)
        for height, width in ((4, 4), (3, 5)):
            fusion = AxialFusion(4, 2, 2).eval()
            views, known = views_of(2, 3, 4, height, width)
            with torch.no_grad():
                self.assertLess((fusion(views, known) - written_out(fusion, views, known)).abs().max(), 1e-5)

    def test_what_is_not_known_changes_nothing(self):
        fusion = AxialFusion(8, 2, 4).eval()
        views, known = views_of(2, 3, 8, 10, 10)
        other = torch.where(known[:, :, None], views, 100.0)
        with torch.no_grad():
            self.assertLess((fusion(views, known) - fusion(other, known)).abs().max(), 1e-5)
            self.assertLess(
                (fusion(views, known) - fusion(views.flip(1), known.flip(1))).abs().max(), 1e-5, "nor does their order"
            )

    def test_a_place_matters_by_where_it_lies(self):
        torch.manual_seed(3)
        fusion = AxialFusion(8, 2, 4).eval()
        views, known = torch.zeros(1, 1, 8, 8, 8), torch.ones(1, 1, 8, 8, dtype=torch.bool)
        views[0, 0, :, 1, 2] = torch.randn(8)
        with torch.no_grad():
            torch.nn.init.normal_(fusion.near.bias)
            found = fusion(views, known)
        self.assertGreater((found[0, :, 0, 0] - found[0, :, 3, 3]).abs().max(), 1e-3)

    def test_in_parts_it_is_the_same_with_the_same_gradients(self):
        torch.manual_seed(4)
        fusion = AxialFusion(8, 2, 4).train()
        views, known = views_of(2, 2, 8, 12, 12)
        found = []
        for limit in (attention.AT_ONCE, 2 * 2 * 32 * 32):
            leaf = views.clone().requires_grad_()
            with mock.patch.object(attention, "AT_ONCE", limit):
                said = fusion(leaf, known)
                (said**2).sum().backward()
            found.append((said.detach(), leaf.grad))
        for whole, parts in zip(*found, strict=True):
            self.assertLess((whole - parts).abs().max(), 1e-5)


if __name__ == "__main__":
    unittest.main()
