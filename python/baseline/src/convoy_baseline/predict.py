"""Predicts with a trained model: python -m convoy_baseline.predict --store dataset --model model.pt --out predictions.parquet

The file is one that `evaluate` reads, with a row for every box, ego and mode; `--masks` names a folder for masks, likewise.
"""

from __future__ import annotations

import argparse
import pathlib
import sys
from collections.abc import Callable, Sequence

import convoy
import numpy as np
import torch

from convoy_baseline.batch import Link, wired
from convoy_baseline.checkpoint import Run, model_of
from convoy_baseline.conditions import Condition, links_under
from convoy_baseline.examples import raster_grid, wired_views
from convoy_baseline.found import Found, MaskWriter, Writer
from convoy_baseline.frames import Keyframe, Keyframes, View
from convoy_baseline.grid import Array
from convoy_baseline.inputs import gathered
from convoy_baseline.model import Model, Said
from convoy_baseline.settings import Settings
from convoy_baseline.traffic import Boxes, bytes_of, together

MOST = 200
LEAST_SCORE = 0.03
"""How many boxes of an ego are kept, and how sure they must be."""


def predict(
    model: Model,
    settings: Settings,
    keyframes: Keyframes,
    conditions: Sequence[Condition],
    take: Callable[[Found], None],
    device: torch.device,
    seed: int = 0,
) -> None:
    """Hands over what every ego finds under each condition. Views are encoded once for all conditions, except with early cooperation,
    where each ego has points of its own."""
    delays = sorted({condition.delay_frames for condition in conditions} - {0})
    with torch.no_grad():
        for i in range(len(keyframes)):
            keyframe = keyframes[i]
            views, heard = list(keyframe.views), {0: (0, keyframe.views)}
            for delay in delays:
                if keyframe.number >= delay:  # The scene had begun.
                    earlier = keyframes.views(keyframe.scene, keyframe.number - delay)
                    heard[delay] = len(views), earlier
                    views += earlier
            looked = Looked(model, settings, keyframe, views, device)
            for condition in conditions:
                if condition.delay_frames in heard:
                    first, earlier = heard[condition.delay_frames]
                    links = links_under(condition, keyframe, earlier, first, settings, seed)
                    for found in looked.found(condition, links):
                        take(found)


class Looked:
    """Views of a keyframe and of moments before, as far as a model has looked at them."""

    def __init__(
        self, model: Model, settings: Settings, keyframe: Keyframe, views: Sequence[View], device: torch.device
    ) -> None:
        self.model, self.settings, self.keyframe, self.views = model, settings, keyframe, views
        self.device = device
        self.features: torch.Tensor | None = None
        self.own: tuple[Said, list[Boxes]] | None = None
        if settings.cooperation != "early":
            self.features = model.features(gathered(views, raster_grid(settings)).to(device))
        if settings.cooperation == "late":
            assert self.features is not None
            said = model.heads(model.fused(self.features, wired(range(len(views)), []).to(device)))
            self.own = said, [self._boxes(said, v) for v in range(len(views))]

    def found(self, condition: Condition, links: Sequence[Link]) -> list[Found]:
        """What all egos find who hear others by links."""
        egos = self.keyframe.egos
        if self.own is not None:
            said, boxes = self.own
            masks = [self._masks(said, ego) for ego in egos]
            heard = [[(link, boxes[link.view]) for link in links if link.ego == e] for e in range(len(egos))]
            grid = self.settings.grid
            found = [together(boxes[ego], others, grid, MOST) for ego, others in zip(egos, heard, strict=True)]
        else:
            if self.features is None:
                inputs, wiring = wired_views(self.views, egos, links, self.settings)
                said = self.model(inputs.to(self.device), wiring.to(self.device))
            else:
                said = self.model.heads(self.model.fused(self.features, wired(egos, links).to(self.device)))
            masks = [self._masks(said, e) for e in range(len(egos))]
            found = [self._boxes(said, e) for e in range(len(egos))]
        sent = self._sent(links)
        counts = np.bincount([link.ego for link in links], minlength=len(egos))
        return [
            Found(condition, self.keyframe, e, int(counts[e]), *found[e], masks[e], sent[e]) for e in range(len(egos))
        ]

    def _boxes(self, said: Said, which: int) -> Boxes:
        if self.model.boxes is None:
            return np.zeros((0, 9)), np.zeros(0, np.int64), np.zeros(0)
        return self.model.boxes.found(said.boxes, which, MOST, LEAST_SCORE)

    def _masks(self, said: Said, which: int) -> Array:
        if said.masks is None:
            side = self.settings.mask_grid.cells
            return np.zeros((0, side, side), np.float32)
        masks: Array = said.masks[which].sigmoid().cpu().numpy()
        return masks

    def _sent(self, links: Sequence[Link]) -> list[int]:
        sent = [0] * len(self.keyframe.egos)
        for link in links:
            boxes = None if self.own is None else self.own[1][link.view]
            sent[link.ego] += bytes_of(self.settings, self.views[link.view], boxes)
        return sent


def opened(store: str, model: pathlib.Path, split: str, device: torch.device) -> tuple[Run, Model, Keyframes]:
    """A model and the keyframes that it is to look at."""
    run, network = model_of(model, device)
    return run, network, Keyframes(convoy.Dataset(store), split, run.settings, keep=False)


def main(arguments: list[str] | None = None) -> int:
    """The program."""
    parser = argparse.ArgumentParser(prog="python -m convoy_baseline.predict", description="Boxes for `evaluate`.")
    parser.add_argument("--store", required=True)
    parser.add_argument("--model", required=True, type=pathlib.Path, help="a checkpoint of convoy_baseline.train")
    parser.add_argument("--out", required=True, type=pathlib.Path, help="Parquet file")
    parser.add_argument("--masks", type=pathlib.Path, help="a folder for masks (default: they are not written)")
    parser.add_argument("--modes", default="none,x2v,x2i,x2x")
    parser.add_argument("--split", default="test")
    parser.add_argument("--device", default="cpu", choices=("cpu", "cuda"))
    parser.add_argument("--threads", type=int, help="of PyTorch, on a CPU")
    options = parser.parse_args(arguments)
    if options.threads:
        torch.set_num_threads(options.threads)
    modes = options.modes.split(",")
    if unknown := set(modes) - set(convoy.MODES):
        parser.error(f"no modes: {', '.join(sorted(unknown))}; expected some of {', '.join(convoy.MODES)}")
    try:
        device = torch.device(options.device)
        run, model, keyframes = opened(options.store, options.model, options.split, device)
        writer = Writer(run.settings.classes)
        conditions = [Condition(mode, mode) for mode in modes]
        masks = (
            None
            if options.masks is None
            else MaskWriter(options.masks, run.settings.mask_grid, keyframes.mask_cell_m())
        )

        def take(found: Found) -> None:
            writer.take(found)
            if masks is not None:
                masks.take(found)

        predict(model, run.settings, keyframes, conditions, take, device)
        writer.write(options.out)
        if masks is not None:
            masks.close()
        for name, (samples, partners, sent) in writer.heard.items():
            mean = sent / max(partners, 1)
            print(
                f"{name}: {samples} samples, {partners / samples:.2f} partners each, {mean:.0f} bytes of a partner and frame"
            )
    except (convoy.StoreError, ValueError, OSError) as fault:
        print(f"error: {fault}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
