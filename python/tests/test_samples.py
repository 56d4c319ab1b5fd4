"""Samples and their batches, beside the tables; with PyTorch where it is installed."""

import importlib
import pickle
import tempfile
import unittest
from pathlib import Path

import numpy as np
from plain import SCENE, STORE, agent_pose, rows, sweep

import convoy

EGO, FRAME = "vehicle_0", 10
FAR = {"comm_range_m": 1000.0, "elevation_m": 100.0}


def sample_at(samples, frame=FRAME, ego=EGO):
    return samples[samples.index.index((0, frame, ego))]


class Samples(unittest.TestCase):
    def test_the_index_has_every_keyframe_of_finished_scenes(self):
        wanted = [(0, frame, ego) for ego in ("vehicle_0", "vehicle_1") for frame in (0, 10)]
        self.assertEqual(convoy.DetectionSamples(STORE).index, wanted)
        self.assertEqual(convoy.DetectionSamples(STORE, "train", every=20, egos="first").index, wanted[:1])
        self.assertEqual(len(convoy.DetectionSamples(STORE, every=1, egos="all")), 60)
        # Masks are at every second frame.
        self.assertEqual({frame % 6 for _, frame, _ in convoy.SegmentationSamples(STORE, every=3).index}, {0})
        samples = convoy.SegmentationSamples(STORE)
        with tempfile.TemporaryDirectory() as folder:
            samples.save_index(Path(folder) / "index.parquet")
            again = samples.load_index(Path(folder) / "index.parquet")
        self.assertEqual(again, wanted)
        self.assertEqual(convoy.SegmentationSamples(STORE, index=again[1:2])[0]["frame"], 10)
        with self.assertRaisesRegex(convoy.StoreError, "no sample"):
            convoy.DetectionSamples(STORE, "val")
        with self.assertRaises(ValueError):
            convoy.DetectionSamples(STORE, mode="v2x")
        with self.assertRaises(ValueError):
            convoy.DetectionSamples(STORE, classes=["tram"])

    def test_targets_are_the_same_in_every_mode_and_those_that_somebody_saw(self):
        for reach in (FAR, {"comm_range_m": 0.0, "elevation_m": 0.0}):
            found = [sample_at(convoy.DetectionSamples(STORE, mode=mode, **reach)) for mode in convoy.MODES]
            for other in found[1:]:
                self.assertTrue(np.array_equal(found[0]["boxes"], other["boxes"]))
            heard = ("vehicle_0", "vehicle_1", "rsu_0") if reach is FAR else ("vehicle_0",)
            seen = {
                row["id"]
                for agent in heard
                for row in rows(SCENE / "boxes_valid.parquet", frame=FRAME, agent=agent, valid_flag=True)
            }
            own = rows(SCENE / "agents.parquet", agent=EGO, frame=FRAME)[0]["id"]
            listed = rows(SCENE / "boxes_valid.parquet", frame=FRAME, agent=EGO)
            wanted = [row["id"] for row in listed if row["id"] in seen - {own}]
            self.assertEqual(found[0]["ids"].tolist(), wanted)
            by_ego = {row["id"] for row in listed if row["valid_flag"]}
            self.assertEqual(found[0]["seen_by_ego"].tolist(), [number in by_ego for number in wanted])
        self.assertTrue(all(found[0]["seen_by_ego"]), "nobody else is in range")

    def test_boxes_lead_back_to_the_world(self):
        sample = sample_at(convoy.DetectionSamples(STORE, mode="x2x", classes=["pedestrian", "car"], **FAR))
        self.assertEqual(set(sample["labels"].tolist()), {0, 1})
        raw = {row["id"]: row for row in rows(SCENE / "boxes.parquet", frame=FRAME, agent=EGO)}
        world = agent_pose(EGO, FRAME)
        for number, label, box in zip(sample["ids"], sample["labels"], sample["boxes"], strict=True):
            row = raw[int(number)]
            self.assertEqual(row["class"], ("pedestrian", "car")[label])
            self.assertLess(abs((world @ [*box[:3], 1])[:3] - row["center_m"]).max(), 1e-3)
            self.assertLess(abs(box[3:6] - row["size_m"]).max(), 1e-4)
            turned = world[:3, :3] @ [np.cos(box[6]), np.sin(box[6]), 0]
            corners = np.reshape(row["corners_m"], (8, 3))
            forward = (corners[4] - corners[0]) / np.linalg.norm(corners[4] - corners[0])
            self.assertGreater(turned @ forward, 0.98)  # Pitch is left out.
            speed = np.linalg.inv(world[:3, :3]) @ row["velocity_mps"]
            self.assertLess(abs(box[7:] - speed[:2]).max(), 1e-4)

    def test_points_of_all_are_in_the_egos_frame_or_in_each_ones_own(self):
        moved = sample_at(convoy.DetectionSamples(STORE, mode="x2x", **FAR))
        own = sample_at(convoy.DetectionSamples(STORE, mode="x2x", points="agent", **FAR))
        self.assertEqual(moved["agents"], ["vehicle_0", "vehicle_1", "rsu_0"])
        back = np.linalg.inv(agent_pose(EGO, FRAME))
        for i, name in enumerate(moved["agents"]):
            world = np.column_stack([sweep(name, FRAME), np.ones(len(moved["points"][i]))])
            self.assertLess(abs(moved["points"][i][:, :3] - (back @ world.T).T[:, :3]).max(), 1e-3)
            homogeneous = np.column_stack([own["points"][i][:, :3], np.ones(len(world))])
            self.assertLess(abs(own["ego_from_agent"][i] @ homogeneous.T - (back @ world.T)).max(), 1e-3)
            self.assertTrue(np.array_equal(own["points"][i][:, 3], moved["points"][i][:, 3]))

    def test_a_batch_has_what_its_samples_have(self):
        samples = convoy.DetectionSamples(STORE, mode="x2x", transform=lambda sample: sample | {"noted": 1}, **FAR)
        alone = convoy.DetectionSamples(STORE, mode="none", **FAR)
        members = [samples[0], alone[1] | {"noted": 2}, samples[2]]
        batch = convoy.collate(members)
        self.assertEqual(batch["ego_from_agent"].shape, (3, 3, 4, 4))
        self.assertEqual(batch["agent_mask"].tolist(), [[True] * 3, [True, False, False], [True] * 3])
        self.assertTrue((batch["ego_from_agent"][1, 1:] == np.eye(4)).all())
        self.assertEqual(batch["noted"], [1, 2, 1])
        for b, sample in enumerate(members):
            for a, cloud in enumerate(sample["points"]):
                mine = (batch["point_sample"] == b) & (batch["point_agent"] == a)
                self.assertTrue(np.array_equal(batch["points"][mine], cloud))
            for name in ("boxes", "labels", "ids", "difficulty", "num_lidar_pts", "seen_by_ego"):
                self.assertTrue(np.array_equal(batch[name][b][batch["box_mask"][b]], sample[name]), name)
            self.assertTrue((batch["labels"][b][~batch["box_mask"][b]] == -1).all())
        masks = convoy.SegmentationSamples(STORE, classes=["car", "road"])
        batch = convoy.collate([masks[0], masks[3]])
        self.assertEqual(batch["masks"].shape, (2, 2, 400, 400))
        self.assertTrue(np.array_equal(batch["masks"][1, 0], np.load(SCENE / "bev/vehicle_1.npz")["0010"][7]))
        empty = {name: value[:0] for name, value in members[0].items() if name in ("boxes", "labels", "ids")}
        rest = {name: members[0][name][:0] for name in ("difficulty", "num_lidar_pts", "seen_by_ego")}
        batch = convoy.collate([members[0] | empty | rest])
        self.assertEqual((batch["boxes"].shape, batch["box_mask"].shape), ((1, 0, 9), (1, 0)))

    def test_samples_travel_to_workers(self):
        samples = convoy.DetectionSamples(STORE, mode="x2v", **FAR)
        again = pickle.loads(pickle.dumps(samples))
        self.assertTrue(np.array_equal(samples[1]["points"][1], again[1]["points"][1]))


class Torch(unittest.TestCase):
    def test_workers_of_a_loader_give_what_the_samples_give(self):
        try:
            import torch
        except ImportError:
            with self.assertRaisesRegex(ImportError, "pip install"):
                importlib.import_module("convoy.torch")
            self.skipTest("PyTorch, for convoy.torch")
        from torch.utils.data import DataLoader

        samples = convoy.torch.Detection(STORE, mode="x2x", every=5, **FAR)
        masks = convoy.torch.Segmentation(STORE, mode="x2i", every=2, classes=["car"], **FAR)
        samples[0], masks[0]  # Files are open before the fork.
        for dataset, name in ((samples, "boxes"), (masks, "masks")):
            loader = DataLoader(dataset, batch_size=3, num_workers=2, collate_fn=convoy.torch.collate)
            batches = list(loader)
            self.assertEqual(sum(len(batch["scene"]) for batch in batches), len(dataset))
            for first, batch in enumerate(batches):
                wanted = convoy.collate([dataset[i] for i in range(3 * first, min(3 * first + 3, len(dataset)))])
                self.assertIsInstance(batch["points"], torch.Tensor)
                self.assertTrue(np.array_equal(batch["points"].numpy(), wanted["points"]))
                self.assertTrue(np.array_equal(batch[name].numpy(), wanted[name]))


class Rerun(unittest.TestCase):
    def test_a_scene_becomes_a_recording(self):
        import convoy.rerun

        scene = convoy.Dataset(STORE).scene(0)
        try:
            import rerun  # noqa: F401
        except ImportError:
            with self.assertRaisesRegex(ImportError, "pip install"):
                convoy.rerun.show(scene)
            self.skipTest("Rerun, for convoy.rerun")
        with tempfile.TemporaryDirectory() as folder:
            convoy.rerun.show(scene, every=10, save=f"{folder}/scene.rrd")
            self.assertGreater(Path(folder, "scene.rrd").stat().st_size, 100_000)


if __name__ == "__main__":
    unittest.main()
