"""The model: encoders of what each view saw, fusion in an agent and between agents in the ego's grid, heads for boxes and masks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import torch
from torch import nn

from convoy_baseline.batch import Wiring
from convoy_baseline.encoders.camera import Lift
from convoy_baseline.encoders.pictures import picture_encoder
from convoy_baseline.encoders.pillar import PillarEncoder
from convoy_baseline.encoders.raster import RasterEncoder
from convoy_baseline.encoders.voxel import VoxelEncoder
from convoy_baseline.fusion import AxialFusion, MaxFusion
from convoy_baseline.heads.decoder import PlainDecoder, PyramidDecoder
from convoy_baseline.heads.masks import MaskHead
from convoy_baseline.heads.peaks import PeakHead
from convoy_baseline.heads.queries import QueryHead
from convoy_baseline.inputs import Inputs
from convoy_baseline.layers import block
from convoy_baseline.settings import Settings
from convoy_baseline.warp import reach, warp

POINTS_OF_PILLAR = 8
"""Times those of a voxel."""


@dataclass(frozen=True)
class Said:
    """Of E egos; None of what is no task of the model."""

    boxes: Any
    """`Peaks` or `Queries`, as the model's head is."""
    masks: torch.Tensor | None
    """(E, C, H, W): logits."""


class Model(nn.Module):
    """Of views, links and poses to boxes and masks."""

    def __init__(self, settings: Settings, masks: int) -> None:
        super().__init__()
        self.half_m = settings.grid.half_m
        channels, features = settings.fused_channels, settings.feature_grid
        self.lidar = lidar_encoder(settings) if "lidar" in settings.sensors else None
        self.camera = camera_encoder(settings) if "camera" in settings.sensors else None
        both = len(settings.sensors) > 1
        self.join = block(settings.lidar_channels + settings.lifted_channels, channels) if both else None
        self.fusion = (
            AxialFusion(channels, settings.heads, settings.window) if settings.fusion == "axial" else MaxFusion()
        )
        self.decoder = (
            PyramidDecoder(channels, settings.decoder_channels, settings.pyramid_channels)
            if settings.decoder == "pyramid"
            else PlainDecoder(channels)
        )
        known, classes = self.decoder.channels, len(settings.classes)
        self.boxes: PeakHead | QueryHead | None = None
        if "boxes" in settings.tasks:
            self.boxes = (
                QueryHead(known, classes, features, settings.query_count, settings.query_channels)
                if settings.box_head == "queries"
                else PeakHead(known, classes, features)
            )
        self.masks = (
            MaskHead(known, settings.mask_channels or settings.width, masks, features, settings.mask_grid)
            if "masks" in settings.tasks
            else None
        )

    def features(self, inputs: Inputs) -> torch.Tensor:
        """(V, C, h, w) of what V views saw, each in its own frame; not negative, so that nothing is zero."""
        parts = [encoder(inputs) for encoder in (self.lidar, self.camera) if encoder is not None]
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

    def heads(self, fused: torch.Tensor) -> Said:
        """What is found in it."""
        known = self.decoder(fused)
        return Said(
            None if self.boxes is None else self.boxes(known), None if self.masks is None else self.masks(known)
        )

    def forward(self, inputs: Inputs, wiring: Wiring) -> Said:
        """`heads` of all egos."""
        return self.heads(self.fused(self.features(inputs), wiring))


def lidar_encoder(settings: Settings) -> nn.Module:
    """By its name in the settings."""
    grid, height_m, most = settings.grid, settings.height_m, settings.cell_points
    if settings.lidar_encoder == "voxel":
        return VoxelEncoder(grid, height_m, settings.voxel_height_m, most, settings.voxel_channels)
    if settings.lidar_encoder == "pillar":
        return PillarEncoder(grid, height_m, POINTS_OF_PILLAR * most, settings.pillar_channels, settings.width)
    return RasterEncoder(settings.width)


def camera_encoder(settings: Settings) -> Lift:
    """Likewise."""
    encoder = picture_encoder(
        settings.picture_encoder, settings.width, settings.picture_channels, settings.picture_weights
    )
    return Lift(settings.feature_grid, settings.depth_m, settings.depth_bins, encoder, settings.lifted_channels)
