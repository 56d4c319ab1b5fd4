"""What networks are put together from."""

from __future__ import annotations

import torch
from torch import nn

RARE = -4.0
"""First guess of heat maps and masks as a logit: nearly nothing is anywhere."""


def block(channels: int, out: int, stride: int = 1) -> nn.Sequential:
    """A 3 x 3 convolution, normalised, without what is negative."""
    return nn.Sequential(
        nn.Conv2d(channels, out, 3, stride=stride, padding=1, bias=False), nn.BatchNorm2d(out), nn.ReLU()
    )


def head(channels: int, out: int, guess: float) -> nn.Sequential:
    """Numbers of each cell."""
    last = nn.Conv2d(channels, out, 1)
    nn.init.constant_(bias_of(last), guess)
    return nn.Sequential(block(channels, channels), last)


def bias_of(layer: nn.Conv2d) -> torch.Tensor:
    """The bias of a layer that has one."""
    assert layer.bias is not None
    return layer.bias
