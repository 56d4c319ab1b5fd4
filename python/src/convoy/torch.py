"""PyTorch datasets: the samples of `convoy.samples` with tensors in their batches.

loader = DataLoader(Detection("dataset", split="train", mode="x2x"), batch_size=4, shuffle=True, num_workers=2,
                    collate_fn=collate)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from convoy import multitask, samples

try:
    import torch
    from torch.utils.data import Dataset
except ImportError as fault:
    raise ImportError("convoy.torch needs PyTorch: pip install torch, or as pytorch.org says") from fault


class Detection(samples.DetectionSamples, Dataset):  # type: ignore[misc]
    """`convoy.DetectionSamples` for a DataLoader."""


class Segmentation(samples.SegmentationSamples, Dataset):  # type: ignore[misc]
    """`convoy.SegmentationSamples` for a DataLoader."""


class Multitask(multitask.MultitaskSamples, Dataset):  # type: ignore[misc]
    """`convoy.MultitaskSamples` for a DataLoader."""


def collate(batch: Sequence[samples.Sample]) -> dict[str, Any]:
    """`convoy.collate`, its arrays as tensors."""
    merged = samples.collate(batch)
    return {name: torch.from_numpy(value) if isinstance(value, np.ndarray) else value for name, value in merged.items()}
