"""Says what a model is made of: python -m convoy_baseline.parts python/baseline/configs/models/full/*/*.toml"""

from __future__ import annotations

import argparse
import pathlib
import sys
from collections.abc import Sequence

import torch

from convoy_baseline.model import Model
from convoy_baseline.settings import Settings, read_with_mode
from convoy_baseline.traffic import FEATURE_BYTES

MASKS = 14
"""How many masks a store has, if nothing else is asked for."""
PARTS = ("lidar", "camera", "join", "fusion", "decoder", "boxes", "masks")


def counts(settings: Settings, masks: int = MASKS) -> dict[str, int]:
    """Parameters of each part, on a device that holds no numbers."""
    with torch.device("meta"):
        model = Model(settings, masks)
    found = {}
    for name in PARTS:
        part = getattr(model, name)
        found[name] = 0 if part is None else sum(each.numel() for each in part.parameters())
    return found


def table(files: Sequence[pathlib.Path], masks: int = MASKS) -> str:
    """A Markdown table with a row for each file of settings."""
    lines = [f"| model | features | a partner sends | {' | '.join(PARTS)} | all |", "| --- " * (len(PARTS) + 4) + "|"]
    for path in files:
        settings, mode = read_with_mode(path)
        found = counts(settings, masks)
        grid = settings.feature_grid
        sent = f"{FEATURE_BYTES * settings.fused_channels * grid.cells**2 / 1e6:.1f} MB" if mode != "none" else "-"
        numbers = " | ".join(f"{number:,}" if number else "-" for number in (*found.values(), sum(found.values())))
        size = f"{settings.fused_channels} x {grid.cells} x {grid.cells} of {grid.cell_m:g} m"
        lines.append(f"| {path.parent.name}/{path.stem} | {size} | {sent} | {numbers} |")
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    """The program."""
    parser = argparse.ArgumentParser(prog="python -m convoy_baseline.parts", description="Parameters part by part.")
    parser.add_argument("settings", nargs="+", type=pathlib.Path, help="TOML files with a table [model]")
    parser.add_argument("--masks", type=int, default=MASKS, help="how many masks the store has")
    options = parser.parse_args(arguments)
    try:
        print(table(options.settings, options.masks))
    except (ValueError, OSError) as fault:
        print(f"error: {fault}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
