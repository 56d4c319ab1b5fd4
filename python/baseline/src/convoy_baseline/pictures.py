"""What an agent's cameras saw, made small."""

from __future__ import annotations

from dataclasses import dataclass

import convoy
import numpy as np
from PIL import Image

from convoy_baseline.grid import Array


@dataclass(frozen=True)
class Picture:
    """A picture of a camera."""

    rgb: Array
    """(3, h, w) u8."""
    intrinsics: Array
    """(3, 3) of the small picture; pixel (0, 0) covers [0, 1) x [0, 1)."""
    agent_from_optical: Array
    """(4, 4), from x right, y down, z forward."""


def pictures(agent: convoy.Agent, height: int, width: int) -> tuple[Picture, ...]:
    """Those of all its cameras, by name."""
    names = [name.removeprefix("RGB-") for name in agent.sensors if name.startswith("RGB-")]
    if not names:
        raise agent.fault("has no RGB pictures", 'take "camera" out of the settings\' sensors', "RGB")
    found = []
    for name in names:
        camera = agent.camera(name)
        lens = camera.sensor.lens
        if lens is not None and lens.get("model", "pinhole") != "pinhole":
            raise agent.fault(
                f"has a lens of model {lens['model']}", "the baseline lifts pinholes alone", f"RGB-{name}"
            )
        whole = camera.image()
        small = Image.fromarray(whole).resize((width, height), Image.Resampling.BOX)
        scale = np.diag([width / whole.shape[1], height / whole.shape[0], 1.0])
        rgb = np.ascontiguousarray(np.asarray(small).transpose(2, 0, 1))
        found.append(Picture(rgb, scale @ camera.intrinsics, camera.agent_from_camera))
    return tuple(found)
