"""Training and predicting on a small store: resumed runs, what predictions are, and the files that `evaluate` reads."""

import os
import pathlib
import tempfile
import unittest
from dataclasses import replace

import convoy
import numpy as np
import pyarrow.parquet as pq
import torch

from convoy_baseline.batch import ego_from, heard, wired
from convoy_baseline.benchmark.plan import read as plan_of
from convoy_baseline.checkpoint import load, model_of
from convoy_baseline.conditions import Condition, links_under
from convoy_baseline.examples import example
from convoy_baseline.found import Found, MaskWriter, Writer
from convoy_baseline.frames import Keyframes
from convoy_baseline.grid import Grid
from convoy_baseline.inputs import gathered
from convoy_baseline.loss import loss
from convoy_baseline.model import Model
from convoy_baseline.predict import predict
from convoy_baseline.settings import Settings, parse, read
from convoy_baseline.train import order, rate_at, train

STORE = os.environ.get("CONVOY_STORE")
SMALL = Settings(cells=64, cell_m=1.6, width=4, steps=6, comm_range_m=1000, elevation_m=100, classes=("car", "truck"))
CPU = torch.device("cpu")


class Runs(unittest.TestCase):
    def test_settings_are_read_and_their_faults_named(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.toml")
            path.write_text('[model]\ncells = 64\nclasses = ["bus"]\n')
            self.assertEqual(read(path), Settings(cells=64, classes=("bus",)))
        for wrong in (
            {"cell": 3},
            {"classes": ["tram"]},
            {"fusion": "mean"},
            {"cells": 65},
            {"drop_out": 1.0},
            {"sensors": ["radar"]},
            {"sensors": []},
            {"picture_width": 100},
            {"depth_m": [5.0, 2.0]},
        ):
            with self.assertRaisesRegex(ValueError, "a.toml: .*expected"):
                parse(wrong, "a.toml")

    def test_plans_hold_each_model_against_one_of_its_own_sensors(self):
        folder = pathlib.Path(__file__).resolve().parents[1]
        for name, models in (("benchmark.toml", 3), ("benchmark-gpu.toml", 9), ("benchmark-full.toml", 18)):
            plan = plan_of(folder / name)
            self.assertTrue(plan.config.is_file(), plan.config)
            self.assertEqual(len([entry for entry in plan.entries if not entry.is_extra]), models)
            for entry in plan.entries:
                if entry.mode == "none" or entry.spoil:
                    continue
                rival = plan.entry(entry.rival)
                self.assertEqual((entry.mode, rival.mode), ("x2x", "none"))
                self.assertEqual(entry.settings.sensors, rival.settings.sensors)
                self.assertEqual(entry.settings.steps, rival.settings.steps)
                self.assertEqual(entry.settings.tasks, rival.settings.tasks)

    def test_a_part_of_a_plan_is_chosen_and_what_is_not_there_named(self):
        with tempfile.TemporaryDirectory() as folder:
            small = pathlib.Path(__file__).resolve().parents[1] / "configs" / "models" / "small"
            path = pathlib.Path(folder, "some.toml")
            models = f"""
[[models]]
settings = "{small}/bevfusion-l.toml"
curve = true
[[models]]
settings = "{small}/coopdet3d-l.toml"
curve = true
spoilt = true
start = "bevfusion-l"
"""
            beginning = (
                'config = "x.toml"\nseeds = [4, 5]\nshares = [0.5, 1.0]\nspoilt_steps = 9\nspoilt = ["mirrored"]\n'
            )
            path.write_text(beginning + models)
            plan = plan_of(path)
            few = [f"{entry.name} {seed}" for entry, seed in plan.runs([5], ["coopdet3d-l"], extras=True)]
            self.assertEqual(few, ["coopdet3d-l 5"])
            self.assertEqual(len(plan.runs()), 4)
            names = [f"{entry.name} {seed}" for entry, seed in plan.runs(None, ["coopdet3d-l"], extras=True)]
            self.assertEqual(
                names,
                [
                    "coopdet3d-l 4", "coopdet3d-l 5", "coopdet3d-l-1of2 4", "coopdet3d-l-labels-right 4",
                    "coopdet3d-l-labels-mirrored 4",
                ],
            )  # fmt: skip
            self.assertEqual(plan.entry("coopdet3d-l-1of2").rival, "bevfusion-l-1of2")
            self.assertEqual(plan.entry("coopdet3d-l-labels-mirrored").settings.steps, 9)
            with self.assertRaisesRegex(ValueError, "no models: coop; expected some of bevfusion-l, coopdet3d-l"):
                plan.runs(None, ["coop"])
            for wrong, fault in (
                ("shares = [0.4]", "expected 1 / n"),
                ("share = [0.5]", "no such keys: share"),
                ('spoilt_steps = 9\nspoilt = ["sour"]', "sour"),
            ):
                path.write_text(f'config = "x.toml"\nseeds = [4]\n{wrong}\n{models}')
                with self.assertRaisesRegex(ValueError, fault):
                    plan_of(path)

    def test_every_epoch_has_every_keyframe_once_and_begins_anywhere(self):
        whole = list(order(7, 2, 5, 0, 12))
        for epoch in (whole[:4], whole[4:8], whole[8:]):
            self.assertEqual(sorted(k for step in epoch for k in step), list(range(7)))
        self.assertNotEqual(whole[:4], whole[4:8])
        self.assertEqual(list(order(7, 2, 5, 3, 12)), whole[3:])
        rates = [rate_at(step, Settings(steps=100, rate=1.0)) for step in range(100)]
        self.assertEqual((rates[0], max(rates), rates.index(max(rates))), (0.0, 1.0, 5))


@unittest.skipUnless(STORE, "a store, for training")
class Store(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.dataset = convoy.Dataset(STORE)
        cls.keyframes = Keyframes(cls.dataset, "train", SMALL)

    def test_a_run_that_was_broken_off_ends_with_the_same_weights(self):
        with tempfile.TemporaryDirectory() as folder:
            paths = [pathlib.Path(folder, name) for name in ("whole", "broken", "other")]
            train(self.dataset, SMALL, paths[0], mode="x2x", seed=3, say=False)
            for stop in (2, 3, None):
                run = train(self.dataset, SMALL, paths[1], mode="x2x", seed=3, stop_after=stop, say=False)
            self.assertTrue(run.done)
            train(self.dataset, SMALL, paths[2], mode="x2x", seed=4, say=False)
            whole, broken, other = (load(path, CPU)[1] for path in paths)
            for name, weights in whole["model"].items():
                self.assertTrue(torch.equal(weights, broken["model"][name]), name)
            self.assertFalse(torch.equal(whole["model"]["boxes.heat.1.weight"], other["model"]["boxes.heat.1.weight"]))
            with self.assertRaisesRegex(ValueError, "another run"):
                train(self.dataset, SMALL, paths[0], mode="none", seed=3, say=False)
            torch.save({name: part for name, part in whole.items() if name != "version"}, paths[2])
            with self.assertRaisesRegex(ValueError, "version 1, this build reads 2: train anew"):
                load(paths[2], CPU)
            paths[1].write_bytes(paths[1].read_bytes()[:1000])
            with self.assertRaisesRegex(ValueError, "no checkpoint"):
                train(self.dataset, SMALL, paths[1], mode="x2x", seed=3, say=False)

    def test_any_fusion_of_any_sensors_learns_a_moment_by_heart(self):
        small = {"picture_height": 64, "picture_width": 112, "depth_bins": 14}
        kinds = [
            replace(SMALL, fusion="max"),
            replace(SMALL, fusion="axial"),
            replace(SMALL, sensors=("camera",), **small),
            replace(SMALL, sensors=("lidar", "camera"), **small),
        ]
        for settings in kinds:
            torch.manual_seed(1)
            settings = replace(settings, drop_out=0.0)
            keyframes = Keyframes(self.dataset, "train", settings)
            model = Model(settings, len(keyframes.classes())).train()
            optimiser = torch.optim.AdamW(model.parameters(), lr=5e-3)
            inputs, wiring, targets = example([keyframes[0]], "x2x", settings, np.random.default_rng(0))
            losses = []
            for _ in range(40):
                wrong = loss(model, model(inputs, wiring), targets, settings)["all"]
                optimiser.zero_grad()
                wrong.backward()
                optimiser.step()
                losses.append(wrong.item())
            self.assertLess(losses[-1], 0.6 * losses[0], f"{settings.fusion} {settings.sensors}")

    def test_who_is_heard_is_who_the_package_says(self):
        keyframe = self.keyframes[1]
        frame = self.dataset.scene(keyframe.scene).frame(keyframe.number)
        for mode in convoy.MODES:
            for ego in keyframe.egos:
                for reach in ((1000, 100), (30, 100), (1000, 0.01)):
                    theirs = frame.cooperative(keyframe.views[ego].agent, mode, *reach)
                    ours = heard(keyframe.views[ego], keyframe.views, mode, *reach)
                    names = [keyframe.views[i].agent for i in ours]
                    self.assertEqual(sorted(names), sorted(partner.name for partner in theirs.partners))
                    for partner in theirs.partners:
                        view = keyframe.views[[v.agent for v in keyframe.views].index(partner.name)]
                        exact = theirs.ego_from(partner)
                        self.assertLess(abs(ego_from(keyframe.views[ego], view) - exact).max(), 1e-9)

    def test_conditions_leave_out_misplace_and_delay(self):
        keyframe = self.keyframes[1]
        views = keyframe.views

        def links(**options):
            return links_under(Condition("", "x2x", **options), keyframe, views, 0, SMALL, 7)

        exact = links()
        self.assertEqual(len(exact), 4)
        shares = [{(link.ego, link.view) for link in links(penetration=p)} for p in (0.0, 0.4, 0.7, 1.0)]
        self.assertEqual((len(shares[0]), len(shares[3])), (0, 4))
        self.assertTrue(shares[0] <= shares[1] <= shares[2] <= shares[3])
        for plain, noisy, more in zip(exact, links(noise_m=0.1), links(noise_m=0.3), strict=True):
            once, thrice = (link.ego_from_view - plain.ego_from_view for link in (noisy, more))
            self.assertGreater(abs(once[:2, 3]).max(), 0.001)
            self.assertLess(abs(3 * once - thrice).max(), 1e-9)
        for plain, wrong in zip(exact, links(wrong_poses=True), strict=True):
            self.assertLess(abs(plain.ego_from_view @ wrong.ego_from_view - np.eye(4)).max(), 1e-9)

    def test_an_ego_alone_finds_the_same_in_every_mode_and_partners_change_that(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "model.pt")
            train(self.dataset, SMALL, path, mode="x2x", say=False)
            run, model = model_of(path, CPU)
            found = {}
            conditions = [
                Condition("none", "none"),
                Condition("x2x", "x2x"),
                Condition("empty", "x2x", penetration=0.0),
                Condition("late", "x2x", delay_frames=10),
            ]

            def take(one):
                found[one.condition.name, one.keyframe.number, one.ego] = one

            predict(model, run.settings, self.keyframes, conditions, take, CPU)
            self.assertEqual(len(found), 3 * 4 + 2, "nothing is late at frame 0")
            for (name, number, ego), one in found.items():
                alone = found["none", number, ego]
                self.assertEqual(np.array_equal(one.masks, alone.masks), name in ("none", "empty"))
                self.assertEqual(one.partners, 0 if name in ("none", "empty") else 2)
            # The same by hand for one of them.
            keyframe = self.keyframes[1]
            links = links_under(conditions[1], keyframe, keyframe.views, 0, run.settings, 0)
            with torch.no_grad():
                masks = model(gathered(keyframe.views), wired(keyframe.egos, links)).masks.sigmoid()
            self.assertLess(abs(masks[1].numpy() - found["x2x", keyframe.number, 1].masks).max(), 1e-5)


@unittest.skipUnless(STORE, "a store, for files of predictions")
class Files(unittest.TestCase):
    """Made-up finds, near the truth and not, on a store's targets."""

    @classmethod
    def setUpClass(cls):
        cls.keyframes = Keyframes(convoy.Dataset(STORE), "train", SMALL)
        draw = np.random.default_rng(9)
        cls.finds = []
        for i in range(len(cls.keyframes)):
            keyframe = cls.keyframes[i]
            for ego, truth in enumerate(keyframe.truths):
                again = draw.integers(0, len(truth.boxes), 60)
                boxes = truth.boxes[again].astype(np.float64)
                boxes[:, :3] += draw.normal(size=(60, 3)) * draw.choice([0.1, 0.6, 3], (60, 1))
                scores = np.round(draw.random(60), 2)  # Some are equal.
                by_score = np.argsort(-scores, kind="stable")
                cls.finds.append(
                    Found(Condition("x2x", "x2x"), keyframe, ego, 2, boxes[by_score], truth.labels[again][by_score],
                          scores[by_score].astype(np.float32), np.random.default_rng(i).random(truth.masks.shape, np.float32))
                )  # fmt: skip

    def test_an_ego_that_found_nothing_is_named(self):
        writer, nothing = Writer(SMALL.classes), np.zeros(0)
        first = self.finds[0]
        writer.take(first)
        writer.take(replace(first, boxes=np.zeros((0, 9)), labels=nothing.astype(int), scores=nothing))
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "predictions.parquet")
            writer.write(path)
            rows = pq.read_table(path).to_pylist()
        self.assertEqual(len(rows), 61)
        self.assertEqual({rows[60][name] for name in ("class", "score", "size_m")}, {None})
        self.assertEqual((rows[60]["frame"], rows[60]["agent"]), (first.keyframe.number, first.agent))

    def test_masks_reach_the_thresholds_that_they_reached(self):
        grids = (SMALL.mask_grid, replace(SMALL, mask_cells=50, mask_cell_m=1.5).mask_grid)
        for grid in grids:
            draw, finds = np.random.default_rng(1), []
            with tempfile.TemporaryDirectory() as folder:
                writer = MaskWriter(pathlib.Path(folder), grid, 0.4)
                for found in self.finds:
                    masks = draw.random((3, grid.cells, grid.cells), np.float32)
                    masks[:, :2, :5] = np.float32([0.1, 0.3, 0.7, 0.9, 1.0])
                    finds.append(replace(found, masks=masks))
                    writer.take(finds[-1])
                writer.close()
                for found in finds:
                    path = pathlib.Path(folder, "x2x", f"{found.keyframe.scene:04d}", f"{found.agent}.npz")
                    with np.load(path) as archive:
                        cell_m, written = float(archive["cell_m"]), archive[f"{found.keyframe.number:04d}"]
                    self.assertEqual((written.dtype, cell_m), (np.uint8, 1.6 if grid is grids[0] else 0.4))
                    told = written.astype(np.float32) / np.float32(255)
                    # What is at the middle of each cell that was written.
                    fine = Grid(written.shape[1], cell_m)
                    row, column = grid.cell_of(
                        np.stack(fine.center_of(*np.mgrid[0 : fine.cells, 0 : fine.cells]), axis=-1)
                    )
                    for k in range(1, 10):
                        at = np.float32(k) / np.float32(10)
                        self.assertTrue(np.array_equal(told >= at, found.masks[:, row, column] >= at), (cell_m, k))

    def test_rows_stand_in_the_world(self):
        writer = Writer(SMALL.classes)
        for found in self.finds:
            writer.take(found)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "predictions.parquet")
            writer.write(path)
            rows = pq.read_table(path).to_pylist()
        self.assertEqual(len(rows), 60 * len(self.finds))
        for place in (0, 61, 130):
            found, row = self.finds[place // 60], rows[place]
            box, view = found.boxes[place % 60], found.keyframe.views[found.keyframe.egos[found.ego]]
            self.assertEqual((row["frame"], row["agent"], row["mode"]), (found.keyframe.number, view.agent, "x2x"))
            self.assertEqual(row["class"], SMALL.classes[found.labels[place % 60]])
            back = np.linalg.inv(view.world_from_agent) @ [*row["center_m"], 1]
            self.assertLess(abs(back[:3] - box[:3]).max(), 1e-6)
            heading = np.linalg.inv(view.world_from_agent)[:3, :3] @ convoy.rotation(row["quaternion"])[:, 0]
            self.assertGreater(heading @ [np.cos(box[6]), np.sin(box[6]), 0], 0.99)
            self.assertLess(abs(np.subtract(row["size_m"], box[3:6])).max(), 1e-6)


if __name__ == "__main__":
    unittest.main()
