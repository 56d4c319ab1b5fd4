"""The nine models of the paper, small and full, and what their partners send."""

import os
import pathlib
import tempfile
import unittest
from dataclasses import replace

import convoy
import numpy as np
import torch
from test_lift import view as camera_view

from convoy_baseline.augment import moved, moved_points, moves, zoomed
from convoy_baseline.batch import Link
from convoy_baseline.checkpoint import load, model_of
from convoy_baseline.conditions import Condition
from convoy_baseline.examples import example, with_heard
from convoy_baseline.frames import Keyframes, Truth, View, Wide
from convoy_baseline.grid import Grid
from convoy_baseline.heads.decoder import PyramidDecoder
from convoy_baseline.heads.queries import QueryHead
from convoy_baseline.inputs import gathered
from convoy_baseline.loss import loss
from convoy_baseline.model import Model, lidar_encoder
from convoy_baseline.parts import counts, table
from convoy_baseline.predict import predict
from convoy_baseline.settings import Settings, read_with_mode
from convoy_baseline.sweeps import drawn, thinned
from convoy_baseline.traffic import BOX_BYTES, together
from convoy_baseline.train import balanced, train

STORE = os.environ.get("CONVOY_STORE")
THOROUGH = os.environ.get("CONVOY_THOROUGH")
FILES = pathlib.Path(__file__).resolve().parents[1] / "configs" / "models"
NAMES = [f"{kind}{by}" for kind in ("bevfusion", "coopdet3d", "cobevfusion") for by in ("-c", "-l", "")]
SMALLER = {
    "width": 4, "voxel_channels": (4, 8, 8, 16), "pyramid_channels": 32, "decoder_channels": (24, 32), "mask_channels": 16,
    "query_count": 40, "query_channels": 32, "camera_channels": 16, "channels": 32, "depth_bins": 14, "picture_height": 64,
    "picture_width": 96, "comm_range_m": 1000.0, "elevation_m": 100.0, "drop_out": 0.0, "classes": ("car", "truck"), "sweeps": 0,
    "mask_cells": 64, "mask_cell_m": 0.8,
}  # fmt: skip
CPU = torch.device("cpu")


def smaller(name):
    """A small model on 51 m, which the store's masks cover."""
    settings, mode = read_with_mode(FILES / "small" / f"{name}.toml")
    ground = {"cells": 64, "cell_m": 0.8} if name.endswith("-c") else {"cells": 256, "cell_m": 0.2}
    return replace(settings, **SMALLER, **ground), mode


class Files(unittest.TestCase):
    def test_all_are_read_and_say_with_whom_they_learn(self):
        for folder in ("small", "full/detection", "full/segmentation"):
            found = sorted(path.stem for path in (FILES / folder).glob("b*n*.toml") if path.stem != "base")
            self.assertEqual(len(found) + len(list((FILES / folder).glob("co*.toml"))), 9)
            for name in NAMES:
                settings, mode = read_with_mode(FILES / folder / f"{name}.toml")
                self.assertEqual(mode, "none" if name.startswith("bev") else "x2x")
                self.assertEqual(settings.fusion, "axial" if name.startswith("cobev") else "max")
                self.assertEqual(("lidar" in settings.sensors, "camera" in settings.sensors),
                                 (not name.endswith("-c"), not name.endswith("-l")))  # fmt: skip

    def test_those_for_two_cores_differ_in_their_fusion_alone(self):
        found = {name: read_with_mode(FILES / "two-cores" / f"{name}.toml") for name in NAMES if name.endswith("-l")}
        alone = found["bevfusion-l"][0]
        self.assertEqual((alone.lidar_encoder, alone.feature_grid, len(alone.classes)), ("pillar", Grid(64, 1.6), 10))
        for name, (settings, mode) in found.items():
            self.assertEqual(mode, "none" if name.startswith("bev") else "x2x")
            self.assertEqual(settings.fusion, "axial" if name.startswith("cobev") else "max")
            self.assertEqual(replace(settings, fusion="max"), alone)

    def test_circles_and_strange_keys_are_named(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.toml")
            for text, fault in (
                ('base = "a.toml"', "circle"),
                ("[models]\nwidth = 3", "models"),
                ('mode = "x3x"', "x3x"),
                ('[model]\ncooperation = "early"\nsensors = ["camera"]', "early.*expected"),
                ("[model]\nmask_cells = 3", "mask_cell_m"),
            ):
                path.write_text(text)
                with self.assertRaisesRegex(ValueError, fault):
                    read_with_mode(path)

    def test_full_ones_have_the_channels_and_grids_of_the_paper(self):
        try:
            import torchvision  # noqa: F401
        except ImportError:
            self.skipTest("torchvision, for Swin-T")
        for task, voxels, cells in (("detection", 1440, 180), ("segmentation", 1024, 128)):
            for name in NAMES:
                settings, _ = read_with_mode(FILES / "full" / task / f"{name}.toml")
                alone = name.endswith("-c")
                self.assertEqual(settings.fused_channels, 80 if alone else 256)
                self.assertEqual(settings.feature_grid.cells, 128 if alone else cells)
                with torch.device("meta"):
                    model = Model(settings, 14)
                    features = torch.empty(
                        2, settings.fused_channels, settings.feature_grid.cells, settings.feature_grid.cells
                    )
                    known = torch.ones(2, 3, *features.shape[2:], dtype=torch.bool)
                    self.assertEqual(
                        model.fusion(features[:, None].expand(-1, 3, -1, -1, -1), known).shape, features.shape
                    )
                    self.assertEqual(model.decoder(features).shape, (2, 512, *features.shape[2:]))
                if not alone:
                    encoder = lidar_encoder(settings)
                    self.assertEqual(encoder.shape, (41, voxels, voxels))
                    self.assertEqual(encoder.shape_after, (2, cells, cells))
                    self.assertEqual(settings.lidar_channels, 256)
                if model.camera is not None:
                    pictures = torch.empty(6, 3, 256, 704, device="meta")
                    self.assertEqual(model.camera.encoder(pictures).shape, (6, 256, 32, 88))
                    self.assertEqual(model.camera.said.out_channels, 118 + 80)
                    self.assertEqual(model.camera.grid.cells, 2 * settings.feature_grid.cells)
                    self.assertAlmostEqual(model.camera.depths_m.numel(), 118)
                if task == "segmentation":
                    self.assertEqual((settings.mask_grid.cells, settings.mask_grid.cell_m), (200, 0.5))
                    self.assertIsNone(model.boxes)
                else:
                    self.assertEqual((model.boxes.queries, model.boxes.classes), (200, 10))
                self.assertEqual(sum(counts(settings).values()), sum(p.numel() for p in model.parameters()))

    def test_the_page_of_results_tells_their_sizes(self):
        page = FILES.parents[3] / "docs" / "results.md"
        if not page.is_file():
            self.skipTest("the page is not beside the package")
        self.assertIn(table(sorted((FILES / "full").glob("*/*.toml"))), page.read_text())


class Heads(unittest.TestCase):
    def test_a_query_may_say_a_box_in_another_cell(self):
        grid = Grid(16, 1.0)
        head = QueryHead(8, 2, grid, 5, 16)
        numbers = torch.zeros(1, 10)
        numbers[0, :2] = torch.tensor([0.2, -0.3])
        box, query = 5 * 16 + 7, 8 * 16 + 3
        there = head._from_query(torch.tensor([query]), torch.tensor([box]), numbers)[0]
        x, y = grid.center_of(np.array([5, 8]), np.array([7, 3]))
        self.assertAlmostEqual(x[1] + there[0].item(), x[0] + 0.2, places=5)
        self.assertAlmostEqual(y[1] + there[1].item(), y[0] - 0.3, places=5)

    def test_the_pyramid_keeps_the_grid(self):
        self.assertEqual(PyramidDecoder(6, (8, 12), 20)(torch.zeros(2, 6, 10, 10)).shape, (2, 20, 10, 10))


class Moves(unittest.TestCase):
    def test_truth_and_points_move_alike_by_any_angle(self):
        settings = Settings(augment="any", turn_deg=45.0)
        grid, draw = Grid(64, 0.5), np.random.default_rng(2)
        for move in moves(6, settings, draw):
            masks = np.zeros((1, 256, 256), bool)
            places = draw.uniform(-8, 8, (12, 2))
            fine = Grid(256, 0.25)
            for row, column in zip(*fine.cell_of(places), strict=True):
                masks[0, row - 3 : row + 4, column - 3 : column + 4] = True
            boxes = np.column_stack(
                [places, np.ones(12), np.full((12, 3), 2.0), draw.uniform(-3, 3, 12), np.ones((12, 2))]
            )
            truth = Truth(
                boxes,
                np.zeros(12, int),
                np.zeros(12),
                np.ones(12, bool),
                np.zeros((1, 64, 64), bool),
                Wide(masks, 0.25),
            )
            after = moved(truth, move, grid)
            points = moved_points(np.column_stack([places, np.ones((12, 3))]).astype(np.float32), move.matrix)
            self.assertLess(abs(after.boxes[:, :2] - points[:, :2]).max(), 1e-5)
            self.assertTrue(after.masks[0][grid.cell_of(points)].all())
            self.assertLess(abs(after.boxes[:, 3:6] - 2 * move.scale).max(), 1e-9)
            nose = places + np.column_stack([np.cos(boxes[:, 6]), np.sin(boxes[:, 6])])
            there = nose @ move.matrix[:2, :2].T + move.matrix[:2, 3] - after.boxes[:, :2]
            self.assertLess(abs(np.arctan2(there[:, 1], there[:, 0]) - after.boxes[:, 6]).max(), 1e-6)

    def test_zoomed_pictures_show_the_same_at_the_same_rays(self):
        inputs = gathered([camera_view(0)])
        smooth = torch.linspace(0, 255, inputs.pictures.shape[3]).expand(inputs.pictures.shape).to(torch.uint8)
        inputs = replace(inputs, pictures=smooth)
        after = zoomed(inputs, Settings(picture_scale=(1.2, 1.2), picture_turn_deg=5.0), np.random.default_rng(0))
        ray = torch.tensor([0.2, -0.1, 1.0])
        seen = []
        for one in (inputs, after):
            u, v, _ = one.intrinsics[0] @ ray
            seen.append(float(one.pictures[0, 0, int(v), int(u)]))
        self.assertLess(abs(seen[0] - seen[1]), 12)
        self.assertGreater((inputs.intrinsics - after.intrinsics).abs().max(), 1)

    def test_beams_are_thinned_and_sweeps_drawn(self):
        rings = np.repeat(np.arange(128), 3)
        self.assertEqual(len(np.unique(rings[thinned(rings, 32)])), 32)
        self.assertTrue(thinned(rings, 500).all())
        cloud = np.zeros((40, 5), np.float32)
        cloud[:, 4] = np.repeat(np.arange(10), 4) * 0.05
        found = drawn(cloud, 4, np.random.default_rng(1))
        self.assertEqual((len(found), len(np.unique(found[:, 4])), found[0, 4]), (20, 5, 0))

    def test_rare_classes_are_drawn_as_often(self):
        present = np.zeros((100, 3), bool)
        present[:, 0], present[:2, 1] = True, True
        chosen = balanced(present, np.random.default_rng(0))
        self.assertEqual(len(chosen), 100)
        self.assertGreaterEqual((chosen < 2).sum(), 50)


class Partners(unittest.TestCase):
    def test_early_partners_give_points_in_the_egos_frame(self):
        pose = np.eye(4)
        pose[:3, 3] = 10, -4, 0.5
        views = [View(f"vehicle_{i}", None, np.eye(4), (), np.full((2, 5), i + 1, np.float32)) for i in range(2)]
        (merged,) = with_heard(views, [0], [Link(0, 1, pose)])
        self.assertEqual(merged.points[:, :3].tolist(), [[1, 1, 1], [1, 1, 1], [12, -2, 2.5], [12, -2, 2.5]])

    def test_late_partners_give_boxes_and_the_surer_stays(self):
        pose = np.eye(4)
        pose[:2, 3] = 20, 0
        box = np.array([[0.0, 0, 1, 4, 2, 1.5, 0, 0, 0]])
        own = box + [10, 0, 0, 0, 0, 0, 0, 0, 0], np.array([0]), np.array([0.5])
        theirs = (
            np.concatenate([box + [x, 0, 0, 0, 0, 0, 0, 0, 0] for x in (-10.1, -20, 5, 500)]),
            np.zeros(4, int),
            np.array([0.9, 0.8, 0.3, 0.7]),
        )
        boxes, _, scores = together(own, [(Link(0, 0, pose), theirs)], Grid(128, 0.8), 10)
        self.assertEqual(scores.tolist(), [0.9, 0.3], "neither the ego itself, nor what is beyond the grid")
        self.assertAlmostEqual(boxes[0, 0], 9.9)


@unittest.skipUnless(STORE, "a store, for models")
class Learning(unittest.TestCase):
    def learnt(self, settings, mode, steps):
        """Losses of a moment that is learnt by heart, without moves."""
        settings = replace(settings, turn_deg=0.0, scale=(1.0, 1.0), shift_m=0.0)
        keyframes = Keyframes(convoy.Dataset(STORE), "train", settings)
        torch.manual_seed(1)
        model = Model(settings, len(keyframes.classes())).train()
        optimiser = torch.optim.AdamW(model.parameters(), lr=3e-3)
        batch = example([keyframes[0]], mode, settings, np.random.default_rng(0))
        losses = []
        for step in range(steps):
            wrong = loss(model, model(*batch[:2]), batch[2], settings)["all"]
            optimiser.zero_grad()
            wrong.backward()
            torch.nn.utils.clip_grad_norm_(model.parameters(), 10.0)
            optimiser.step()
            losses.append(wrong.item())
            if steps > 100 and step > 100 and step % 25 == 0 and min(self.scores(model, batch, settings)) > 0.95:
                break
        return losses, self.scores(model, batch, settings)

    def scores(self, model, batch, settings):
        """Of boxes at 2 m, recall at full precision; of the first mask, the road, intersection over union."""
        with torch.no_grad():
            said = model(*batch[:2])
        targets, good, all_ = batch[2], 0, 0
        for ego in range(len(said.masks)):
            mine = targets.box_ego == ego
            boxes, labels, _ = model.boxes.found(said.boxes, ego, int(mine.sum()), 0.0)
            from convoy_baseline.targets import boxes_at

            wanted = boxes_at(targets.box_cell[mine].numpy(), targets.box_numbers[mine].numpy(), settings.feature_grid)
            apart = np.linalg.norm(boxes[:, None, :2] - wanted[None, :, :2], axis=2)
            apart[labels[:, None] != targets.box_label[mine].numpy()[None]] = np.inf
            good, all_ = good + int((apart.min(axis=0, initial=np.inf) < 2).sum()), all_ + len(wanted)
        road, true = said.masks[:, 0] > 0, targets.masks[:, 0] > 0.5
        return good / max(all_, 1), (road & true).sum().item() / (road | true).sum().item()

    def test_all_nine_learn_a_moment_by_heart(self):
        """Without CONVOY_THOROUGH three of them take a few steps, which have all encoders, fusions and heads."""
        for name in NAMES if THOROUGH else ("bevfusion-c", "coopdet3d-l", "cobevfusion"):
            with self.subTest(name):
                settings, mode = smaller(name)
                losses, scores = self.learnt(settings, mode, 600 if THOROUGH else 10)
                if THOROUGH:
                    print(
                        f"{name}: {len(losses)} steps, loss {losses[0]:.2f} -> {losses[-1]:.3f}, recall {scores[0]:.2f}, road {scores[1]:.3f}"
                    )
                    self.assertEqual(scores[0], 1.0)
                    self.assertGreater(scores[1], 0.95)
                self.assertLess(losses[-1], 0.8 * losses[0])

    def test_pillars_learn_too(self):
        settings, mode = smaller("coopdet3d-l")
        losses, _ = self.learnt(
            replace(settings, lidar_encoder="pillar", cells=128, cell_m=0.4, box_head="peaks"), mode, 12
        )
        self.assertLess(losses[-1], 0.8 * losses[0])

    def test_a_run_begins_with_other_weights_and_predicts_with_averaged_ones(self):
        settings = Settings(cells=64, cell_m=1.6, width=4, steps=3, classes=("car",))
        dataset = convoy.Dataset(STORE)
        with tempfile.TemporaryDirectory() as folder:
            first, second = pathlib.Path(folder, "a.pt"), pathlib.Path(folder, "b.pt")
            train(dataset, settings, first, mode="none", say=False)
            more = replace(settings, average=0.9, balanced=True, fusion="axial", rate=1e-9)
            run = train(dataset, more, second, mode="x2x", start=first, say=False)
            self.assertEqual(len(run.began_from), 64)
            begun, model = load(first, CPU)[1]["model"], model_of(second, CPU)[1]
            name = "lidar.scales.join.0.weight"
            self.assertLess((model.state_dict()[name] - begun[name]).abs().max(), 1e-6, "hardly any rate")
            train(dataset, replace(more, rate=0.1), pathlib.Path(folder, "c.pt"), mode="x2x", start=first, say=False)
            _, state = load(pathlib.Path(folder, "c.pt"), CPU)
            model = model_of(pathlib.Path(folder, "c.pt"), CPU)[1]
            self.assertGreater(
                (model.state_dict()[name] - state["model"][name]).abs().max(), 1e-3, "the mean is behind"
            )

    def test_early_and_late_partners_are_heard_and_counted(self):
        dataset = convoy.Dataset(STORE)
        for cooperation in ("features", "early", "late"):
            settings = Settings(
                cells=64, cell_m=1.6, width=4, steps=2, comm_range_m=1000, elevation_m=100, cooperation=cooperation
            )
            keyframes = Keyframes(dataset, "train", settings)
            torch.manual_seed(0)
            model = Model(settings, len(keyframes.classes()))
            batch = example([keyframes[0]], "x2x", settings, np.random.default_rng(0))
            loss(model, model(*batch[:2]), batch[2], settings)["all"].backward()
            found = {}
            conditions = [Condition("none", "none"), Condition("x2x", "x2x")]
            predict(
                model.eval(),
                settings,
                keyframes,
                conditions,
                lambda one, found=found: found.setdefault((one.condition.name, one.keyframe.number, one.ego), one),
                CPU,
            )
            alone, heard = found["none", 0, 0], found["x2x", 0, 0]
            self.assertEqual((alone.bytes_heard, heard.partners), (0, 2))
            if cooperation == "features":
                self.assertEqual(heard.bytes_heard, 2 * 2 * 8 * 32 * 32)
            elif cooperation == "early":
                points = [len(view.points) for view in keyframes[0].views]
                self.assertEqual(heard.bytes_heard, 16 * (points[1] + points[2]))
            else:
                self.assertEqual(heard.bytes_heard % BOX_BYTES, 0)
            self.assertEqual(np.array_equal(alone.masks, heard.masks), cooperation == "late")


if __name__ == "__main__":
    unittest.main()
