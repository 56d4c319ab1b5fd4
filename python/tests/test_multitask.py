"""Samples of several sensors and tasks: they are those of the parts, joined."""

import importlib
import unittest

import numpy as np
from plain import STORE

import convoy

FAR = {"comm_range_m": 1000.0, "elevation_m": 100.0, "mode": "x2x"}


class Multitask(unittest.TestCase):
    def test_targets_are_those_of_each_task(self):
        both = convoy.MultitaskSamples(STORE, boxes=["car", "truck"], occupancy=True, **FAR)
        boxes = convoy.DetectionSamples(STORE, classes=["car", "truck"], **FAR)
        masks = convoy.SegmentationSamples(STORE, **FAR)
        self.assertEqual(both.index, boxes.index)
        sample, one, other = both[1], boxes[1], masks[1]
        for name in ("boxes", "labels", "ids", "seen_by_ego"):
            self.assertTrue(np.array_equal(sample[name], one[name]), name)
        self.assertTrue(np.array_equal(sample["masks"], other["masks"]))
        agent = both.dataset.scene(sample["scene"]).frame(sample["frame"]).agent(sample["ego"])
        self.assertTrue(np.array_equal(sample["occupancy"], agent.occupancy().tags))
        self.assertEqual(sample["occupancy_voxel_m"], agent.occupancy().voxel_m)
        self.assertTrue(set(sample) <= set(convoy.MultitaskSample.__annotations__))
        plain = convoy.MultitaskSamples(STORE, boxes=False, bev=["road"], **FAR)
        self.assertEqual(plain.STAGES, ("simulate-and-log", "render-sensors", "bev-gt"))
        self.assertEqual(plain[0]["masks"].shape[0], 1)
        self.assertNotIn("boxes", plain[0])
        for wrong in ({"boxes": ["tram"]}, {"sweeps": -1}, {"cameras": (0, 3)}):
            with self.assertRaises(ValueError):
                convoy.MultitaskSamples(STORE, **wrong)

    def test_sweeps_of_before_lie_where_what_stands_still_is_now(self):
        samples = convoy.MultitaskSamples(STORE, sweeps=3, columns=("intensity", "tag"), **FAR)
        number = samples.index.index((0, 10, "vehicle_0"))
        sample = samples[number]
        plain = convoy.MultitaskSamples(STORE, columns=("intensity", "tag"), **FAR)[number]
        for cloud, newest in zip(sample["points"], plain["points"], strict=True):
            ages = np.unique(cloud[:, -1])
            self.assertEqual(len(ages), 4)
            self.assertTrue(np.array_equal(cloud[cloud[:, -1] == 0][:, :-1], newest))
            self.assertTrue((np.diff(cloud[:, -1]) >= 0).all(), "the newest come first")
        # In the world every sweep lies where it was measured.
        frame = samples.dataset.scene(0).frame(10)
        ego, own = frame.agent("vehicle_0"), sample["points"][0]
        then = samples.dataset.scene(0).frame(8).agent("vehicle_0")
        step = ego.sensor("LIDAR").every_n_frames
        self.assertEqual(step, 1)
        here = convoy.transform(ego.pose, own[own[:, -1] == np.float32(0.1)][:, :3].astype(float))
        there = convoy.transform(then.pose, then.points()[:, :3].astype(float))
        self.assertLess(abs(here - there).max(), 1e-3)
        first = convoy.history(samples.dataset.scene(0).frame(0).agent("vehicle_0"), sweeps=5)
        self.assertEqual(np.unique(first[:, -1]).tolist(), [0], "the scene had not begun")

    def test_pictures_are_small_and_their_rays_stay(self):
        samples = convoy.MultitaskSamples(STORE, cameras=(45, 80), bev=False, **FAR)
        sample = samples[0]
        agents = [samples.dataset.scene(0).frame(0).agent(name) for name in sample["agents"]]
        wanted = [(a, name[4:]) for a, agent in enumerate(agents) for name in agent.sensors if name.startswith("RGB-")]
        self.assertEqual(list(zip(sample["picture_agent"].tolist(), sample["cameras"], strict=True)), wanted)
        self.assertEqual(sample["pictures"].shape, (len(wanted), 3, 45, 80))
        for n, (a, name) in enumerate(wanted):
            camera = agents[a].camera(name)
            whole = camera.image()
            scale = [80 / whole.shape[1], 45 / whole.shape[0], 1]
            self.assertLess(abs(sample["intrinsics"][n] - np.diag(scale) @ camera.intrinsics).max(), 1e-4)
            # Of 160 x 90 each pixel is the mean of four.
            mean = whole.reshape(45, 2, 80, 2, 3).mean(axis=(1, 3)).transpose(2, 0, 1)
            self.assertLess(abs(mean - sample["pictures"][n]).max(), 1.01)

    def test_batches_say_whose_pictures_and_voxels_are(self):
        samples = convoy.MultitaskSamples(STORE, cameras=(45, 80), occupancy=True, **FAR)
        two = [samples[0], samples[1]]
        batch = convoy.collate(two)
        self.assertEqual(batch["picture_sample"].tolist(), [b for b in range(2) for _ in two[b]["cameras"]])
        self.assertEqual(len(batch["pictures"]), sum(len(sample["pictures"]) for sample in two))
        self.assertEqual(batch["occupancy"].shape, (2, *two[0]["occupancy"].shape))
        try:
            torch = importlib.import_module("torch")
        except ImportError:
            self.skipTest("PyTorch, for convoy.torch")
        ours = importlib.import_module("convoy.torch")
        loader = torch.utils.data.DataLoader(
            ours.Multitask(STORE, cameras=(45, 80), **FAR), batch_size=2, collate_fn=ours.collate
        )
        self.assertEqual(next(iter(loader))["pictures"].dtype, torch.uint8)


if __name__ == "__main__":
    unittest.main()
