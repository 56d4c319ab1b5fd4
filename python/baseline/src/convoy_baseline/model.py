"""The model: an encoder for each view, fusion in the ego's grid, heads for boxes and masks. Dense operations alone."""

from __future__ import annotations

import torch
from torch import nn
from torch.nn import functional

from convoy_baseline.batch import Wiring
from convoy_baseline.fusion import AxialFusion, MaxFusion
from convoy_baseline.inputs import Inputs
from convoy_baseline.layers import bias_of, block, head
from convoy_baseline.lift import Lift
from convoy_baseline.raster import CHANNELS, unpack
from convoy_baseline.settings import Settings
from convoy_baseline.targets import NUMBERS
from convoy_baseline.warp import reach, warp

RARE = -4.0
"""First guess of heat maps and masks as a logit: nearly nothing is anywhere."""


class Model(nn.Module):
    """Of views, links and poses to heat maps, numbers and masks."""

    def __init__(self, settings: Settings, masks: int) -> None:
        super().__init__()
        self.half_m = settings.grid.half_m
        channels = 2 * settings.width
        self.encoder = Encoder(CHANNELS, settings.width) if "lidar" in settings.sensors else None
        self.lift = (
            Lift(settings.feature_grid, settings.depth_m, settings.depth_bins, settings.width, channels)
            if "camera" in settings.sensors
            else None
        )
        self.join = block(2 * channels, channels) if len(settings.sensors) > 1 else None
        self.fusion = (
            AxialFusion(channels, settings.heads, settings.window) if settings.fusion == "axial" else MaxFusion()
        )
        self.decoder = nn.Sequential(block(channels, channels), block(channels, channels))
        self.heat = head(channels, len(settings.classes), RARE)
        self.numbers = head(channels, NUMBERS, 0.0)
        self.finer = block(channels, settings.width)
        self.masks = nn.Conv2d(settings.width, masks, 1)
        nn.init.constant_(bias_of(self.masks), RARE)

    def features(self, inputs: Inputs) -> torch.Tensor:
        """(V, C, h, w) of what V views saw, each in its own frame; not negative, so that nothing is zero."""
        parts = [] if self.encoder is None else [self.encoder(unpack(inputs.rasters))]
        parts += [] if self.lift is None else [self.lift(inputs)]
        found: torch.Tensor = parts[0] if self.join is None else self.join(torch.cat(parts, dim=1))
        return found

    def fused(self, features: torch.Tensor, wiring: Wiring) -> torch.Tensor:
        """(E, C, h, w): what each ego knows, of its own view and of those that it hears."""
        own = features[wiring.ego_view]
        egos, links = len(own), wiring.link_ego
        # Slots of each ego: its own view first, then those that it hears, in the order of links.
        counts = torch.bincount(links, minlength=egos)
        slots = 1 + (int(counts.max()) if len(links) else 0)
        views = own.new_zeros(egos, slots, *own.shape[1:])
        known = torch.zeros(egos, slots, *own.shape[2:], dtype=torch.bool, device=own.device)
        views[:, 0], known[:, 0] = own, True
        if len(links):
            order = torch.sort(links, stable=True).indices
            of = links[order]
            slot = 1 + torch.arange(len(of), device=of.device) - (counts.cumsum(0) - counts)[of]
            poses = wiring.ego_from_view[order]
            views[of, slot] = warp(features[wiring.link_view[order]], poses, self.half_m)
            known[of, slot] = reach(poses, self.half_m, *own.shape[2:])
        together: torch.Tensor = self.fusion(views, known)
        return together

    def heads(self, fused: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        """Logits of heat maps (E, K, h, w), numbers (E, NUMBERS, h, w), logits of masks (E, C, H, W)."""
        known = self.decoder(fused)
        finer = functional.interpolate(known, scale_factor=2.0, mode="bilinear", align_corners=False)
        return self.heat(known), self.numbers(known), self.masks(self.finer(finer))

    def forward(self, inputs: Inputs, wiring: Wiring) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        """`heads` of all egos."""
        return self.heads(self.fused(self.features(inputs), wiring))


class Encoder(nn.Module):
    """Three scales, joined at half the resolution."""

    def __init__(self, channels: int, width: int) -> None:
        super().__init__()
        self.at_full = nn.Sequential(block(channels, width), block(width, width))
        self.at_half = nn.Sequential(block(width, 2 * width, stride=2), block(2 * width, 2 * width))
        self.at_quarter = nn.Sequential(block(2 * width, 4 * width, stride=2), block(4 * width, 4 * width))
        self.up = nn.Conv2d(4 * width, 2 * width, 1)
        self.join = block(2 * width, 2 * width)

    def forward(self, pictures: torch.Tensor) -> torch.Tensor:
        """(V, 2 width, H / 2, W / 2)."""
        half = self.at_half(self.at_full(pictures))
        coarse = functional.interpolate(self.up(self.at_quarter(half)), scale_factor=2.0, mode="nearest")
        joined: torch.Tensor = self.join(half + coarse)
        return joined
