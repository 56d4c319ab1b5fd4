"""Fused axial attention, as the papers of CoBEVT and MaxViT describe it: among all views within windows of neighbouring cells, then among
all views on a wide-meshed grid over the whole ground, then the greatest."""

from __future__ import annotations

import torch
from torch import nn
from torch.nn import functional
from torch.utils.checkpoint import checkpoint

from convoy_baseline.fusion.greatest import greatest

AT_ONCE = 1 << 26
"""So many scores of attention are in memory at a time; of what is more, sets go one after another and are worked out again backwards."""


class AxialFusion(nn.Module):
    """One block. A view takes part only where it is known; sides that the window does not divide are filled up with unknown cells."""

    def __init__(self, channels: int, heads: int, window: int) -> None:
        super().__init__()
        self.window = window
        self.near = AttentionBlock(channels, heads, window)
        self.far = AttentionBlock(channels, heads, window)

    def forward(self, views: torch.Tensor, known: torch.Tensor) -> torch.Tensor:
        """(E, C, h, w) of views (E, A, C, h, w) that are known at (E, A, h, w); of each cell one must be."""
        egos, agents, channels, height, width = views.shape
        side = self.window
        down, right = -height % side, -width % side
        padded = functional.pad(views, (0, right, 0, down))
        there = functional.pad(known, (0, right, 0, down))
        rows, columns = (height + down) // side, (width + right) // side
        # A window is `side` neighbours; a mesh is `side` cells that lie a `side`-th of the ground apart.
        tokens = padded.view(egos, agents, channels, rows, side, columns, side).permute(0, 3, 5, 1, 4, 6, 2)
        open_ = there.view(egos, agents, rows, side, columns, side).permute(0, 2, 4, 1, 3, 5)
        tokens = self.near(tokens.flatten(0, 2).flatten(1, 3), open_.flatten(0, 2).flatten(1, 3))
        padded = tokens.view(egos, rows, columns, agents, side, side, channels).permute(0, 3, 6, 1, 4, 2, 5)
        tokens = padded.reshape(egos, agents, channels, side, rows, side, columns).permute(0, 4, 6, 1, 3, 5, 2)
        open_ = there.view(egos, agents, side, rows, side, columns).permute(0, 3, 5, 1, 2, 4)
        tokens = self.far(tokens.flatten(0, 2).flatten(1, 3), open_.flatten(0, 2).flatten(1, 3))
        padded = tokens.view(egos, rows, columns, agents, side, side, channels).permute(0, 3, 6, 4, 1, 5, 2)
        padded = padded.reshape(egos, agents, channels, height + down, width + right)
        return greatest(padded[..., :height, :width], known)


class AttentionBlock(nn.Module):
    """Attention and a small network, each added to what came in. Where two tokens lie from one another on the square of `side` cells, and
    whether they are of one view, is added to their score (`bias`)."""

    offset: torch.Tensor

    def __init__(self, channels: int, heads: int, side: int) -> None:
        super().__init__()
        if channels % heads:
            raise ValueError(f"{channels} channels do not divide by {heads} heads")
        self.heads = heads
        self.before = nn.LayerNorm(channels)
        self.asked = nn.Linear(channels, 3 * channels)
        self.out = nn.Linear(channels, channels)
        self.bias = nn.Parameter(0.02 * torch.randn(2, (2 * side - 1) ** 2, heads))
        self.network = nn.Sequential(
            nn.LayerNorm(channels), nn.Linear(channels, 2 * channels), nn.GELU(), nn.Linear(2 * channels, channels)
        )
        place = torch.stack(torch.meshgrid(torch.arange(side), torch.arange(side), indexing="ij")).flatten(1)
        apart = place[:, :, None] - place[:, None, :] + side - 1
        self.register_buffer("offset", apart[0] * (2 * side - 1) + apart[1], persistent=False)

    def forward(self, tokens: torch.Tensor, known: torch.Tensor) -> torch.Tensor:
        """(sets, A * side * side, C); nobody attends to those that are not known (sets, A * side * side)."""
        bias = self._bias(tokens.shape[1] // len(self.offset))
        some = max(1, AT_ONCE // bias.numel())
        if len(tokens) <= some:
            return self._some(tokens, known, bias)
        parts = zip(torch.split(tokens, some), torch.split(known, some), strict=True)
        again = self.training and torch.is_grad_enabled()
        done = [
            checkpoint(self._some, part, of_part, bias, use_reentrant=False)
            if again
            else self._some(part, of_part, bias)
            for part, of_part in parts
        ]
        return torch.cat(done)

    def _bias(self, agents: int) -> torch.Tensor:
        """(heads, A * side * side, A * side * side)."""
        own, other = self.bias[:, self.offset].permute(0, 3, 1, 2)
        same = torch.eye(agents, dtype=torch.bool, device=own.device)[None, :, None, :, None]
        whole = torch.where(same, own[:, None, :, None, :], other[:, None, :, None, :])
        return whole.flatten(3, 4).flatten(1, 2)

    def _some(self, tokens: torch.Tensor, known: torch.Tensor, bias: torch.Tensor) -> torch.Tensor:
        sets, count, channels = tokens.shape
        asked = self.asked(self.before(tokens)).view(sets, count, 3, self.heads, -1).permute(2, 0, 3, 1, 4)
        hidden = torch.zeros(sets, 1, 1, count, device=tokens.device).masked_fill(~known[:, None, None, :], -1e9)
        score = (bias.float() + hidden).to(asked.dtype)
        said = functional.scaled_dot_product_attention(asked[0], asked[1], asked[2], attn_mask=score)
        tokens = tokens + self.out(said.transpose(1, 2).reshape(sets, count, channels))
        grown: torch.Tensor = tokens + self.network(tokens)
        return grown
