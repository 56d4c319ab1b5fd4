"""Reads the datasets that Convoy makes.

>>> import convoy
>>> ds = convoy.Dataset("dataset")                                      # doctest: +SKIP
>>> points = ds.scene(0).frame(12).agent("vehicle_0").lidar()           # doctest: +SKIP

Names of poses say which way they go: `a_from_b` takes coordinates in b to coordinates in a. Metres, seconds, radians;
everything is right-handed.
"""

from __future__ import annotations

import importlib
from types import ModuleType

from convoy.boxes import CLASSES, DIFFICULTIES, Boxes
from convoy.cooperation import MODES, Cooperative
from convoy.dataset import Dataset, Scene
from convoy.errors import StoreError
from convoy.evaluation import Evaluation, ProgramError, evaluate
from convoy.frame import Agent, Bev, Camera, Frame, Occupancy
from convoy.multitask import MultitaskSample, MultitaskSamples
from convoy.poses import Sensor, invert, pose, rotation, transform
from convoy.samples import DetectionSamples, SegmentationSamples, collate
from convoy.sweeps import history

__all__ = [
    "CLASSES",
    "DIFFICULTIES",
    "MODES",
    "Agent",
    "Bev",
    "Boxes",
    "Camera",
    "Cooperative",
    "Dataset",
    "DetectionSamples",
    "Evaluation",
    "Frame",
    "MultitaskSample",
    "MultitaskSamples",
    "Occupancy",
    "ProgramError",
    "Scene",
    "SegmentationSamples",
    "Sensor",
    "StoreError",
    "collate",
    "evaluate",
    "history",
    "invert",
    "pose",
    "rotation",
    "transform",
]
__version__ = "0.1.0"


def __getattr__(name: str) -> ModuleType:
    # These need packages that not everybody has.
    if name in ("torch", "rerun"):
        return importlib.import_module(f"convoy.{name}")
    raise AttributeError(f"module 'convoy' has no attribute {name!r}")


def __dir__() -> list[str]:
    """What is ours and meant to be used: not what this file imports."""
    return sorted([*__all__, "rerun", "torch", "__doc__", "__version__"])
