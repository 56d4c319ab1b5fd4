"""What the benchmark hands to `convoy evaluate`: the truth as predictions must be found without an error, in every mode."""

import os
import pathlib
import tempfile
import unittest
from dataclasses import replace

import convoy
import numpy as np

from convoy_baseline.benchmark.scores import BOXES, MASKS, Judge, gained, scored
from convoy_baseline.conditions import Condition
from convoy_baseline.found import Found, MaskWriter, Writer
from convoy_baseline.frames import Keyframes
from convoy_baseline.settings import Settings

STORE, PROGRAM = os.environ.get("CONVOY_STORE"), os.environ.get("CONVOY_PROGRAM")


@unittest.skipUnless(STORE and PROGRAM, "a store and the program convoy, for evaluate")
class Truth(unittest.TestCase):
    def test_truth_scores_one_and_boxes_left_out_are_missed(self):
        dataset = convoy.Dataset(STORE)
        settings = Settings(
            cells=64, cell_m=1.6, comm_range_m=1000, elevation_m=100, classes=convoy.CLASSES, itself=True
        )
        cell_m = Keyframes(dataset, "train", settings).mask_cell_m()
        settings = replace(settings, mask_cells=2 * int(12 / cell_m), mask_cell_m=cell_m)
        keyframes = Keyframes(dataset, "train", settings)
        judge, draw = Judge(PROGRAM, STORE, "train", 0), np.random.default_rng(0)
        with tempfile.TemporaryDirectory() as name:
            folders = [pathlib.Path(name, model) for model in ("alone", "together")]
            for folder, modes in zip(folders, (("none",), ("none", "x2x")), strict=True):
                boxes, masks = Writer(settings.classes), MaskWriter(folder / MASKS, settings.mask_grid, cell_m)
                for i in range(len(keyframes)):
                    keyframe = keyframes[i]
                    for ego, truth in enumerate(keyframe.truths):
                        for mode in modes:
                            kept = (
                                np.ones(len(truth.boxes), bool)
                                if mode == "x2x"
                                else draw.random(len(truth.boxes)) < 0.5
                            )
                            found = Found(
                                Condition(mode, mode), keyframe, ego, 0, truth.boxes[kept], truth.labels[kept],
                                np.ones(kept.sum()), truth.masks.astype(np.float32) * (mode == "x2x"),
                            )  # fmt: skip
                            boxes.take(found)
                            masks.take(found)
                masks.close()
                boxes.write(folder / BOXES)
            rows = scored(judge, folders[1], settings, ())
            gain = gained(judge, folders[1], folders[0], "x2x", settings)

            def value(rows, mode, measure, **of):
                wanted = {"mode": mode, "measure": measure, "class": "all", "level": "all", "threshold": None, **of}
                (row,) = (row for row in rows if all(row[key] == it for key, it in wanted.items()))
                return row["value"]

            for found in (rows, gain):
                self.assertEqual(value(found["boxes"], "x2x", "mAP"), 1.0)
                for error in ("mATE", "mAOE", "mASE", "mAVE"):
                    self.assertLess(value(found["boxes"], "x2x", error), 1e-3, error)
                self.assertLess(value(found["boxes"], "none", "mAP"), 0.8)
                road = {"class": "road", "threshold": 0.5}
                self.assertAlmostEqual(value(found["masks"], "x2x", "IoU", **road), 1.0, places=6)
                self.assertEqual(value(found["masks"], "none", "IoU", **road), 0.0)
            self.assertNotEqual(
                value(rows["boxes"], "none", "mAP"),
                value(gain["boxes"], "none", "mAP"),
                "gains are over the other model",
            )
            self.assertEqual(sorted(path.name for path in folders[1].iterdir()), [MASKS, BOXES])


if __name__ == "__main__":
    unittest.main()
