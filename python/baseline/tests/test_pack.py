"""A pack has what the store has, goes on where it was, and is made anew where something changed."""

import json
import os
import pathlib
import tempfile
import unittest
from dataclasses import replace

import convoy
import numpy as np
import torch

from convoy_baseline.checkpoint import load
from convoy_baseline.frames import Keyframes
from convoy_baseline.pack import STEP_M, Packed, folder_of, is_fresh, pack_scene, quantised, restored
from convoy_baseline.settings import Settings
from convoy_baseline.train import train

STORE = os.environ.get("CONVOY_STORE")
SMALL = Settings(cells=64, cell_m=1.6, width=4, steps=2, comm_range_m=1000, elevation_m=100, classes=("car", "truck"))
EVERYTHING = replace(
    SMALL,
    sensors=("lidar", "camera"),
    lidar_encoder="pillar",
    sweeps=2,
    beams=16,
    augment="any",
    picture_height=32,
    picture_width=64,
)


class Points(unittest.TestCase):
    def test_points_are_kept_to_half_a_step(self):
        draw = np.random.default_rng(1)
        cloud = np.column_stack([draw.uniform(-127, 127, (99, 3)), draw.random(99), np.full(99, 0.45)]).astype(
            np.float32
        )
        again = restored(quantised(cloud))
        self.assertLess(abs(again[:, :3] - cloud[:, :3]).max(), 0.51 * STEP_M)
        self.assertLess(abs(again[:, 3:] - cloud[:, 3:]).max(), 6e-5)
        cloud[3, 0] = 500
        self.assertEqual(len(quantised(cloud)), 98)


@unittest.skipUnless(STORE, "a store, for packs")
class Packs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.pack = pathlib.Path(folder.name)
        self.dataset = convoy.Dataset(STORE)

    def test_keyframes_are_those_of_the_store(self):
        for settings in (SMALL, EVERYTHING):
            pack = self.pack / settings.lidar_encoder
            plain = Keyframes(self.dataset, "train", settings)
            frames, written = pack_scene(STORE, "train", settings, pack, 0)
            self.assertEqual(frames, len(plain))
            self.assertGreater(written, 1000)
            packed = Packed(self.dataset, "train", settings, pack)
            self.assertEqual(packed.classes(), plain.classes())
            for number in range(len(plain)):
                one, other = plain[number], packed[number]
                self.assertEqual((one.scene, one.number, one.egos), (other.scene, other.number, other.egos))
                for a, b in zip(one.views, other.views, strict=True):
                    self.assertEqual(a.agent, b.agent)
                    self.assertTrue(np.array_equal(a.world_from_agent, b.world_from_agent))
                    if settings.keeps_points:
                        within = a.points[(abs(a.points[:, :3]) < 127.9).all(axis=1)]
                        self.assertLess(abs(within - b.points).max(), STEP_M)
                        self.assertIsNone(b.raster)
                    else:
                        self.assertTrue(np.array_equal(a.raster, b.raster))
                    for p, q in zip(a.pictures, b.pictures, strict=True):
                        self.assertTrue(np.array_equal(p.rgb, q.rgb))
                        self.assertTrue(np.array_equal(p.intrinsics, q.intrinsics))
                        self.assertTrue(np.array_equal(p.agent_from_optical, q.agent_from_optical))
                for a, b in zip(one.truths, other.truths, strict=True):
                    for name in ("boxes", "labels", "difficulty", "seen_by_ego", "masks"):
                        self.assertTrue(np.array_equal(getattr(a, name), getattr(b, name)), name)
                    self.assertEqual(a.wide is None, b.wide is None)
                    if a.wide is not None:
                        self.assertTrue(np.array_equal(a.wide.masks, b.wide.masks))

    def test_what_is_packed_is_kept_until_settings_or_the_store_are_others(self):
        pack_scene(STORE, "train", SMALL, self.pack, 0)
        self.assertEqual(pack_scene(STORE, "train", SMALL, self.pack, 0)[1], 0)
        self.assertTrue(is_fresh(self.dataset, 0, replace(SMALL, rate=1.0, steps=9), self.pack), "what does not matter")
        self.assertFalse(is_fresh(self.dataset, 0, replace(SMALL, classes=("car",)), self.pack))
        note = folder_of(self.pack, 0) / "about.json"
        known = json.loads(note.read_text())
        known["stages"]["bev-gt"] = "0" * 64
        note.write_text(json.dumps(known))
        with self.assertRaisesRegex(convoy.StoreError, "scene 0 is not packed as it is in the store"):
            Packed(self.dataset, "train", SMALL, self.pack)
        self.assertGreater(pack_scene(STORE, "train", SMALL, self.pack, 0)[1], 0)
        (folder_of(self.pack, 0) / "about.json").unlink()  # As a run that was killed leaves it.
        self.assertGreater(pack_scene(STORE, "train", SMALL, self.pack, 0)[1], 0)

    def test_a_model_learns_the_same_of_it(self):
        pack_scene(STORE, "train", SMALL, self.pack, 0)
        weights = []
        for pack in (None, self.pack):
            out = self.pack / f"{pack is None}.pt"
            train(self.dataset, SMALL, out, mode="x2x", pack=pack, say=False)
            weights.append(load(out, torch.device("cpu"))[1]["model"])
        for name, value in weights[0].items():
            self.assertTrue(torch.equal(value, weights[1][name]), name)


if __name__ == "__main__":
    unittest.main()
