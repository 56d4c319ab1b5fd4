"""Features of pictures, eight pixels to one along either side."""

from __future__ import annotations

import itertools
import pathlib

import torch
from torch import nn
from torch.nn import functional

from convoy_baseline.layers import block

STRIDE = 8
MEAN, SPREAD = (0.485, 0.456, 0.406), (0.229, 0.224, 0.225)
"""Of the pictures that published weights of Swin were learnt from."""


class Plain(nn.Module):
    """Five convolutions."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.channels = 4 * width
        self.steps = nn.Sequential(
            block(3, width, stride=2),
            block(width, 2 * width, stride=2),
            block(2 * width, 2 * width),
            block(2 * width, 4 * width, stride=2),
            block(4 * width, 4 * width),
        )

    def forward(self, pictures: torch.Tensor) -> torch.Tensor:
        """(P, C, h / 8, w / 8) of pictures (P, 3, h, w) from 0 to 1."""
        found: torch.Tensor = self.steps(pictures - 0.5)
        return found


class Residual(nn.Module):
    """A small residual network of four scales with a pyramid down to the eighth: looks farther around than `Plain`."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.channels = 4 * width
        widths = (width, 2 * width, 4 * width, 8 * width, 8 * width)
        self.stem = block(3, width, stride=2)
        self.scales = nn.ModuleList(
            nn.Sequential(Twice(before, after, 2), Twice(after, after, 1))
            for before, after in itertools.pairwise(widths)
        )
        self.pyramid = Pyramid(widths[2:], self.channels)

    def forward(self, pictures: torch.Tensor) -> torch.Tensor:
        """As `Plain`."""
        found, scales = self.stem(pictures - 0.5), []
        for scale in self.scales:
            found = scale(found)
            scales.append(found)
        whole: torch.Tensor = self.pyramid(scales[1:])
        return whole


class Twice(nn.Module):
    """Two convolutions, added to what came in."""

    def __init__(self, channels: int, out: int, stride: int) -> None:
        super().__init__()
        self.steps = nn.Sequential(
            block(channels, out, stride), nn.Conv2d(out, out, 3, padding=1, bias=False), nn.BatchNorm2d(out)
        )
        plain = channels == out and stride == 1
        self.past = (
            nn.Identity()
            if plain
            else nn.Sequential(nn.Conv2d(channels, out, 1, stride=stride, bias=False), nn.BatchNorm2d(out))
        )

    def forward(self, pictures: torch.Tensor) -> torch.Tensor:
        """(P, out, h / stride, w / stride)."""
        return functional.relu(self.past(pictures) + self.steps(pictures))


class Pyramid(nn.Module):
    """Coarse scales are brought to the finest one and added."""

    def __init__(self, widths: tuple[int, ...], channels: int) -> None:
        super().__init__()
        self.sides = nn.ModuleList(nn.Conv2d(width, channels, 1) for width in widths)
        self.smooth = nn.ModuleList(block(channels, channels) for _ in widths[1:])

    def forward(self, scales: list[torch.Tensor]) -> torch.Tensor:
        """(P, channels, ...) of the first of some scales, the finest first."""
        found = self.sides[-1](scales[-1])
        for scale, side, smooth in zip(scales[-2::-1], self.sides[-2::-1], self.smooth[::-1], strict=True):
            found = functional.interpolate(found, size=scale.shape[2:], mode="bilinear", align_corners=False)
            found = smooth(side(scale) + found)
        whole: torch.Tensor = found
        return whole


class Swin(nn.Module):
    """Swin-T of torchvision with a pyramid down to the eighth."""

    def __init__(self, channels: int, weights: str) -> None:
        super().__init__()
        try:
            from torchvision.models import swin_t
        except ImportError as fault:
            raise ValueError(
                "picture_encoder swin_t needs torchvision: pip install 'convoy-baseline[swin]', or choose residual"
            ) from fault
        network = swin_t(weights=None)
        if weights:
            network.load_state_dict(torch.load(pathlib.Path(weights), map_location="cpu", weights_only=True))
        self.channels = channels
        self.stages = network.features
        self.norms = nn.ModuleList(nn.LayerNorm(width) for width in (192, 384, 768))
        self.pyramid = Pyramid((192, 384, 768), channels)
        self.register_buffer("mean", torch.tensor(MEAN).view(1, 3, 1, 1), persistent=False)
        self.register_buffer("spread", torch.tensor(SPREAD).view(1, 3, 1, 1), persistent=False)

    mean: torch.Tensor
    spread: torch.Tensor

    def forward(self, pictures: torch.Tensor) -> torch.Tensor:
        """As `Plain`."""
        found = (pictures - self.mean) / self.spread
        scales: list[torch.Tensor] = []
        for i, stage in enumerate(self.stages):
            found = stage(found)
            if i in (3, 5, 7):
                scales.append(self.norms[len(scales)](found).permute(0, 3, 1, 2))
        whole: torch.Tensor = self.pyramid(scales)
        return whole


def picture_encoder(name: str, width: int, channels: int, weights: str) -> Plain | Residual | Swin:
    """By its name in the settings."""
    if name == "swin_t":
        return Swin(channels, weights)
    return Plain(width) if name == "plain" else Residual(width)
