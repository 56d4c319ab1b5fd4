"""A store as memory-mapped arrays for one set of grids: python -m convoy_baseline.pack --store dataset --settings file.toml --out pack

Reading a keyframe of a store means decoding tables and pictures; of a pack it means touching pages. A scene that is packed is kept, and
packed anew if its files in the store or the settings that matter are others.
"""

from __future__ import annotations

import argparse
import functools
import json
import multiprocessing
import os
import pathlib
import shutil
import sys
import time
from typing import Any

import convoy
import numpy as np
from torch.utils.data import Dataset

from convoy_baseline.frames import STAGES, Keyframe, Keyframes, Truth, View, Wide
from convoy_baseline.grid import Array
from convoy_baseline.pictures import Picture
from convoy_baseline.settings import Settings, read

VERSION = 1
STEP_M, LIGHT_STEP, AGE_STEP_S = 1 / 256, 1 / 16384, 0.001
"""Points are i16: x, y and z within 128 m, intensity, and age in these steps."""
KEYS = (
    "cells", "cell_m", "mask_cells", "mask_cell_m", "sensors", "beams", "sweeps", "picture_height", "picture_width", "keeps_points",
    "augment", "classes", "every", "itself", "comm_range_m", "elevation_m",
)  # fmt: skip
"""Settings that a pack depends on."""


def about(dataset: convoy.Dataset, scene: int, settings: Settings) -> dict[str, Any]:
    """What a scene's pack must be of, as it stands in its `about.json`."""
    values = {key: getattr(settings, key) for key in KEYS}
    stages = dataset.scene(scene).digests
    note = {"version": VERSION, "settings": values, "stages": {stage: stages[stage] for stage in STAGES}}
    as_read: dict[str, Any] = json.loads(json.dumps(note))
    return as_read


def folder_of(pack: pathlib.Path, scene: int) -> pathlib.Path:
    """Where a scene is."""
    return pack / f"scene-{scene:04d}"


def is_fresh(dataset: convoy.Dataset, scene: int, settings: Settings, pack: pathlib.Path) -> bool:
    """Whether a scene is packed as it is in the store."""
    try:
        known = json.loads((folder_of(pack, scene) / "about.json").read_text())
    except (OSError, ValueError):
        return False
    wanted = about(dataset, scene, settings)
    return {name: known.get(name) for name in wanted} == wanted


def pack_scene(store: str, split: str, settings: Settings, pack: pathlib.Path, scene: int) -> tuple[int, int]:
    """Packs a scene, unless it is: how many keyframes, and how many bytes were written."""
    keyframes = Keyframes(convoy.Dataset(store), split, settings, keep=False)
    numbers = [i for i, (of, _) in enumerate(keyframes.keys) if of == scene]
    if is_fresh(keyframes.dataset, scene, settings, pack):
        return len(numbers), 0
    found = [keyframes[number] for number in numbers]
    arrays, names = packed(found)
    folder = folder_of(pack, scene)
    beside = folder.with_name(folder.name + ".new")
    shutil.rmtree(beside, ignore_errors=True)
    beside.mkdir(parents=True)
    for name, array in arrays.items():
        np.save(beside / f"{name}.npy", array)
    note = {
        **about(keyframes.dataset, scene, settings),
        "agents": names,
        "frames": [keyframe.number for keyframe in found],
        "masks": list(keyframes.classes()),
        "mask_shape": list(found[0].truths[0].masks.shape) if found[0].truths else [],
        "wide": wide_of(found),
    }
    (beside / "about.json").write_text(json.dumps(note))
    shutil.rmtree(folder, ignore_errors=True)
    os.replace(beside, folder)
    return len(numbers), sum(array.nbytes for array in arrays.values())


def wide_of(keyframes: list[Keyframe]) -> dict[str, Any] | None:
    """Shape and cells of masks that reach farther, if there are any."""
    for keyframe in keyframes:
        for truth in keyframe.truths:
            if truth.wide is not None:
                return {"shape": list(truth.wide.masks.shape), "cell_m": truth.wide.cell_m}
    return None


def packed(keyframes: list[Keyframe]) -> tuple[dict[str, Array], list[str]]:
    """Arrays of a scene's keyframes; `..._end` say where the parts of each view, ego or keyframe end. And names of agents."""
    views = [view for keyframe in keyframes for view in keyframe.views]
    truths = [truth for keyframe in keyframes for truth in keyframe.truths]
    pictures = [picture for view in views for picture in view.pictures]
    names = sorted({view.agent for view in views})
    arrays = {
        "view_end": ends(len(keyframe.views) for keyframe in keyframes),
        "view_agent": np.array([names.index(view.agent) for view in views], np.int32),
        "view_pose": np.array([view.world_from_agent for view in views], np.float64).reshape(-1, 4, 4),
        "ego_end": ends(len(keyframe.egos) for keyframe in keyframes),
        "ego_view": np.array([ego for keyframe in keyframes for ego in keyframe.egos], np.int32),
        "box_end": ends(len(truth.boxes) for truth in truths),
        "boxes": np.concatenate([np.zeros((0, 9), np.float32), *(truth.boxes for truth in truths)]),
        "labels": np.concatenate([np.zeros(0, np.int64), *(truth.labels for truth in truths)]),
        "difficulty": np.concatenate([np.zeros(0, np.int64), *(truth.difficulty for truth in truths)]),
        "seen_by_ego": np.concatenate([np.zeros(0, bool), *(truth.seen_by_ego for truth in truths)]),
        "masks": bits([truth.masks for truth in truths]),
        "picture_end": ends(len(view.pictures) for view in views),
    }
    if any(view.raster is not None for view in views):
        arrays["rasters"] = np.stack([view.raster for view in views if view.raster is not None])
    if any(view.points is not None for view in views):
        clouds = [quantised(view.points) for view in views if view.points is not None]
        arrays |= {"points": np.concatenate(clouds), "point_end": ends(len(cloud) for cloud in clouds)}
    if pictures:
        arrays |= {
            "pictures": np.stack([picture.rgb for picture in pictures]),
            "intrinsics": np.stack([picture.intrinsics for picture in pictures]),
            "agent_from_optical": np.stack([picture.agent_from_optical for picture in pictures]),
        }
    if all(truth.wide is not None for truth in truths) and truths:
        arrays["wide"] = bits([truth.wide.masks for truth in truths if truth.wide is not None])
    return arrays, names


def ends(counts: Any) -> Array:
    """Where parts end that lie one after another."""
    return np.cumsum(np.fromiter(counts, np.int64), dtype=np.int64)


def bits(masks: list[Array]) -> Array:
    """(E, bytes) u8 of masks (C, H, W) each."""
    return np.packbits(np.array(masks, bool).reshape(len(masks), -1) if masks else np.zeros((0, 8), bool), axis=1)


def quantised(points: Array) -> Array:
    """(N, 5) i16 of points within 128 m."""
    steps = np.array([STEP_M] * 3 + [LIGHT_STEP, AGE_STEP_S])
    whole = np.rint(points / steps)
    kept = (abs(whole[:, :3]) < 32767).all(axis=1)
    steps_of: Array = whole[kept].clip(-32767, 32767).astype(np.int16)
    return steps_of


def restored(points: Array) -> Array:
    """The other way round."""
    return points.astype(np.float32) * np.array([STEP_M] * 3 + [LIGHT_STEP, AGE_STEP_S], np.float32)


class Packed(Dataset[Keyframe]):
    """Keyframes of a pack, as `Keyframes` has them of a store; points to a 512th of a metre."""

    def __init__(
        self, dataset: convoy.Dataset, split: str, settings: Settings, pack: pathlib.Path, share: float = 1.0
    ) -> None:
        self.settings, self.pack = settings, pack
        of_store = Keyframes(dataset, split, settings, keep=False, share=share)
        self.keys = of_store.keys
        self._of_store = of_store
        for scene in sorted({scene for scene, _ in self.keys}):
            if not is_fresh(dataset, scene, settings, pack):
                raise convoy.StoreError(
                    f"scene {scene} is not packed as it is in the store, or for other settings",
                    do="`python -m convoy_baseline.pack` with this store, split and settings",
                    file=str(pack),
                )
        self._row: dict[tuple[int, int], int] = {}
        for scene in {scene for scene, _ in self.keys}:
            frames = json.loads((folder_of(pack, scene) / "about.json").read_text())["frames"]
            self._row |= {(scene, frame): row for row, frame in enumerate(frames)}

    def __len__(self) -> int:
        return len(self.keys)

    def classes(self) -> tuple[str, ...]:
        """Names of the masks."""
        return self._of_store.classes()

    def present(self) -> Array:
        """As `Keyframes`."""
        return self._of_store.present()

    def __getitem__(self, number: int) -> Keyframe:
        scene, frame = self.keys[number]
        note, arrays = opened(folder_of(self.pack, scene))
        row = self._row[scene, frame]
        views = tuple(_view(note, arrays, v) for v in part(arrays["view_end"], row))
        truths = tuple(_truth(note, arrays, e) for e in part(arrays["ego_end"], row))
        egos = tuple(int(arrays["ego_view"][e]) for e in part(arrays["ego_end"], row))
        return Keyframe(scene, frame, views, egos, truths)


@functools.lru_cache(maxsize=1024)
def opened(folder: pathlib.Path) -> tuple[dict[str, Any], dict[str, Array]]:
    """A scene's note and arrays, mapped into memory: in each process once."""
    note = json.loads((folder / "about.json").read_text())
    return note, {path.stem: np.load(path, mmap_mode="r") for path in sorted(folder.glob("*.npy"))}


def part(end: Array, row: int) -> range:
    """Which ones belong to a row."""
    return range(int(end[row - 1]) if row else 0, int(end[row]))


def _some(array: Array, rows: range) -> Array:
    return np.array(array[rows.start : rows.stop])


def _view(note: dict[str, Any], arrays: dict[str, Array], v: int) -> View:
    pictures = tuple(
        Picture(
            np.array(arrays["pictures"][p]),
            np.array(arrays["intrinsics"][p]),
            np.array(arrays["agent_from_optical"][p]),
        )
        for p in part(arrays["picture_end"], v)
    )
    raster = np.array(arrays["rasters"][v]) if "rasters" in arrays else None
    points = restored(_some(arrays["points"], part(arrays["point_end"], v))) if "points" in arrays else None
    return View(note["agents"][arrays["view_agent"][v]], raster, np.array(arrays["view_pose"][v]), pictures, points)


def _truth(note: dict[str, Any], arrays: dict[str, Array], e: int) -> Truth:
    rows = part(arrays["box_end"], e)
    wide = None
    if note["wide"] is not None:
        wide = Wide(_masks(arrays["wide"][e], note["wide"]["shape"]), float(note["wide"]["cell_m"]))
    boxes, labels, difficulty, seen = (
        _some(arrays[name], rows) for name in ("boxes", "labels", "difficulty", "seen_by_ego")
    )
    return Truth(boxes, labels, difficulty, seen, _masks(arrays["masks"][e], note["mask_shape"]), wide)


def _masks(packed_bits: Array, shape: list[int]) -> Array:
    flat = np.unpackbits(packed_bits, count=int(np.prod(shape)))
    return flat.view(bool).reshape(shape)


def pack_split(store: str, split: str, settings: Settings, pack: pathlib.Path, workers: int) -> tuple[int, int]:
    """Packs all scenes of a split that are not packed yet: how many keyframes it has, and how many bytes were written."""
    keyframes = Keyframes(convoy.Dataset(store), split, settings, keep=False)
    scenes = sorted({scene for scene, _ in keyframes.keys})
    stale = [scene for scene in scenes if not is_fresh(keyframes.dataset, scene, settings, pack)]
    if len(stale) < len(scenes):
        print(f"{pack}: {len(scenes) - len(stale)} of {len(scenes)} scenes are kept", flush=True)
    if not stale:
        return len(keyframes), 0
    pack.mkdir(parents=True, exist_ok=True)
    work = functools.partial(pack_scene, store, split, settings, pack)
    size = 0
    with multiprocessing.get_context("spawn").Pool(min(workers, len(stale))) as pool:
        for scene, (frames, written) in zip(stale, pool.imap(work, stale), strict=True):
            print(f"scene {scene}: {frames} keyframes, {written / 1e6:.1f} MB", flush=True)
            size += written
    return len(keyframes), size


def main(arguments: list[str] | None = None) -> int:
    """The program."""
    parser = argparse.ArgumentParser(
        prog="python -m convoy_baseline.pack", description="A store as arrays for training."
    )
    parser.add_argument("--store", required=True)
    parser.add_argument("--out", required=True, type=pathlib.Path, help="the pack's folder; what is packed is kept")
    parser.add_argument("--settings", type=pathlib.Path, help="a TOML file with a table [model]")
    parser.add_argument("--split", default="train")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="processes")
    options = parser.parse_args(arguments)
    try:
        settings = read(options.settings) if options.settings else Settings()
        began = time.monotonic()
        count, size = pack_split(options.store, options.split, settings, options.out, options.workers)
    except (convoy.StoreError, ValueError, OSError) as fault:
        print(f"error: {fault}", file=sys.stderr)
        return 1
    print(f"{options.out}: {count} keyframes, {size / 1e6:.1f} MB written in {time.monotonic() - began:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
