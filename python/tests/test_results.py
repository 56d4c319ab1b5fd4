"""Results of other people's trainers: boxes by hand, and a store's own boxes there and back."""

import contextlib
import io
import json
import math
import random
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pyarrow.parquet as pq
from plain import SCENE, STORE, agent_pose, matrix, rows

from convoy import results
from convoy.poses import rotation

# Camera from vehicle: right, down, ahead.
AHEAD = np.array([[0, 0, 1], [-1, 0, 0], [0, -1, 0]])


def placed(turn, place):
    return np.vstack([np.column_stack([turn, place]), [0, 0, 0, 1]])


def stub(pose):
    """A dataset in which an agent stands at `pose` in every frame, with a camera 1.5 m and a lidar 1.8 m above it."""
    mounts = {
        "RGB-CAM_FRONT": SimpleNamespace(agent_from_sensor=placed(AHEAD, [0, 0, 1.5]), every_n_frames=2),
        "LIDAR": SimpleNamespace(agent_from_sensor=placed(np.eye(3), [0, 0, 1.8]), every_n_frames=1),
    }

    def scene(number):
        held = SimpleNamespace(number=number, label_every_n_frames=1)

        def frame(at):
            where = SimpleNamespace(number=at, scene=held)
            return SimpleNamespace(
                agent=lambda name: SimpleNamespace(name=name, frame=where, pose=pose, sensor=mounts.__getitem__)
            )

        held.frame = frame
        return held

    return SimpleNamespace(scene=scene)


def yaw_of(row):
    ahead = rotation(row["quaternion"])[:, 0]
    return math.atan2(ahead[1], ahead[0])


# At (100, 50, 2), looking along the world's y axis.
TURNED = placed([[0, -1, 0], [1, 0, 0], [0, 0, 1]], [100, 50, 2])


class ByHand(unittest.TestCase):
    def assertPlace(self, row, center, size, yaw):
        np.testing.assert_allclose(row["center_m"], center, atol=1e-9)
        np.testing.assert_allclose(row["size_m"], size, atol=1e-9)
        self.assertAlmostEqual(math.remainder(yaw_of(row) - yaw, 2 * math.pi), 0, places=9)

    def test_a_box_of_the_lidar_is_put_into_the_world(self):
        found = results.Predictions(stub(TURNED), mode="x2x")
        box = [10, 2, -1, 4, 2, 1.5, 0.3]
        found.add(7, 12, "vehicle_0", ["car"], [0.9], [box], sensor="LIDAR", velocities=[[3, 1]])
        found.add(7, 14, "vehicle_0", ["bus"], [0.8], [box])
        # 10 m ahead is 10 m along y, 2 m to the left is 2 m against x.
        row, without_mount = found.rows
        self.assertPlace(row, [98, 60, 2.8], [4, 2, 1.5], math.pi / 2 + 0.3)
        np.testing.assert_allclose(row["velocity_mps"], [-1, 3, 0], atol=1e-9)
        self.assertEqual([row[key] for key in ("scene", "frame", "agent", "mode", "class", "score")],
                         [7, 12, "vehicle_0", "x2x", "car", 0.9])  # fmt: skip
        self.assertPlace(without_mount, [98, 60, 1], [4, 2, 1.5], math.pi / 2 + 0.3)
        self.assertIsNone(without_mount["velocity_mps"])

    def test_corners_of_opv2v_are_left_handed_and_in_any_order(self):
        # 10 m ahead of the lidar, 3 m to the right, turned by 30 degrees to the right.
        across, up = (np.array([math.cos(a), math.sin(a), 0]) for a in np.radians([30, 120])), [0, 0, 0.8]
        length, width = across
        corners = [
            np.array([10, 3, -1.2]) + i * 2.25 * length + j * 0.9 * width + k * np.array(up)
            for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)
        ]  # fmt: skip
        for order in range(20):
            random.Random(order).shuffle(corners)
            found = results.Predictions(stub(TURNED))
            found.add_opv2v(0, 0, "vehicle_0", [0.5], [corners])
            # 3 m to the right is 3 m along x. Which end is the front, corners do not say.
            row = found.rows[0]
            turned = math.remainder(yaw_of(row) - math.radians(60), math.pi)
            self.assertAlmostEqual(turned, 0, places=9)
            self.assertPlace(row, [103, 60, 2 + 1.8 - 1.2], [4.5, 1.8, 1.6], yaw_of(row))
            self.assertEqual(row["class"], "car")

    def test_labels_of_kitti_stand_at_their_bottom(self):
        text = (
            "Car -1 -1 0.1 10 20 30 40 1.6 1.8 4.2 2.0 1.5 20.0 -1.5707963267948966 0.75\n"
            "Van -1 -1 0.1 10 20 30 40 2.4 2.0 5.5 -4.0 1.0 30.0 0.0 0.5\n"
            "Misc -1 -1 0.1 10 20 30 40 1 1 1 0 0 9 0 0.4\n"
        )
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "007003.txt").write_text(text)
            Path(folder, "007004.txt").write_text("")
            found = results.Predictions(stub(np.eye(4)))
            skipped = found.add_kitti(folder, "vehicle_0", every=3)
            out = Path(folder, "predictions.parquet")
            found.write(out)
            read = pq.read_table(out).to_pylist()
        self.assertEqual(skipped, {"Misc": 1})
        self.assertEqual(read, [{name: row.get(name) for name in read[0]} for row in found.rows])
        car, van, nothing = read
        # Heading along the camera's axis is ahead; along its x axis to the right. The camera is 1.5 m above the ground.
        self.assertPlace(car, [20, -2, 0.8], [4.2, 1.8, 1.6], 0)
        self.assertPlace(van, [30, 4, 0.5 + 1.2], [5.5, 2.0, 2.4], -math.pi / 2)
        # Upright, not on the head.
        np.testing.assert_allclose(rotation(van["quaternion"])[:, 2], [0, 0, 1], atol=1e-9)
        self.assertEqual((car["class"], car["score"], van["class"]), ("car", 0.75, "truck"))
        # The export's fourth frame of every third, of a camera at every second.
        self.assertEqual({(row["scene"], row["frame"]) for row in (car, van)}, {(7, 18)})
        self.assertEqual((nothing["frame"], nothing["class"], nothing["score"]), (24, None, None))

    def test_faults_say_where(self):
        with self.assertRaisesRegex(ValueError, "no mode late: there are none, "):
            results.Predictions(stub(np.eye(4)), mode="late")
        found = results.Predictions(stub(np.eye(4)))
        for classes, scores, told in (
            (["tank"], [1], "no classes"),
            (["car"], [1, 2], "1 classes, 2 scores and 1 boxes"),
        ):
            with self.assertRaisesRegex(ValueError, told):
                found.add(0, 0, "vehicle_0", classes, scores, [[0] * 7])
        found.add(0, 0, "vehicle_0", [], [], [])
        with self.assertRaisesRegex(ValueError, "was added before"):
            found.add(0, 0, "vehicle_0", [], [], [])
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaisesRegex(ValueError, "there is no NNNNNN.txt"):
                found.add_kitti(folder, "vehicle_0")
            for line, told in (("Car 1 2", "2 numbers"), ("Boat 1", "no class Boat"), ("Car a", "could not convert")):
                Path(folder, "000000.txt").write_text(line)
                with self.assertRaisesRegex(ValueError, f"000000.txt, line 1: .*{told}"):
                    found.add_kitti(folder, "vehicle_0")


class ThereAndBack(unittest.TestCase):
    def test_boxes_of_a_store_written_as_kittis_come_back(self):
        agent = "vehicle_0"
        about = [
            json.loads(pq.read_metadata(SCENE / f"sensors/{agent}/{name}.parquet").metadata[b"sensor"])
            for name in ("RGB-CAM_FRONT", "LIDAR")
        ]
        mount = about[0]["agent_from_sensor"]
        every = json.loads((SCENE / "log/scene.json").read_text())["label_every_n_frames"]
        position = 2
        frame = position * math.lcm(every, *(one.get("every_n_frames", 1) for one in about))
        camera_from_world = np.linalg.inv(agent_pose(agent, frame) @ matrix(mount["translation"], mount["quaternion"]))
        boxes = [row for row in rows(SCENE / "boxes.parquet", agent=agent, frame=frame) if row["class"] == "car"]
        self.assertGreater(len(boxes), 2)
        lines = []
        for box in boxes:
            corners = np.array(box["corners_m"]).reshape(8, 3) @ camera_from_world[:3, :3].T + camera_from_world[:3, 3]
            length, width, height = box["size_m"]
            ahead = corners[4] - corners[0]
            turn = math.atan2(-ahead[2], ahead[0])
            # An upright box of the camera has its bottom half a height below its middle.
            x, y, z = corners.mean(axis=0) + [0, height / 2, 0]
            lines.append(f"Car 0 0 0 0 0 0 0 {height!r} {width!r} {length!r} {x} {y} {z} {turn} 0.5")
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, f"{position:06d}.txt").write_text("\n".join(lines))
            out = Path(folder, "predictions.parquet")
            said = io.StringIO()
            with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
                codes = [
                    results.main(["kitti", which, "--store", str(STORE), "--out", str(out)])
                    for which in (f"{agent}={folder}", folder)
                ]
            self.assertEqual(codes, [0, 1])
            self.assertIn(f"{len(boxes)} boxes in 1 samples", said.getvalue())
            self.assertIn("say AGENT=FOLDER", said.getvalue())
            found = pq.read_table(out).to_pylist()
        for box, row in zip(boxes, found, strict=True):
            self.assertEqual((row["frame"], row["agent"], row["mode"]), (frame, agent, "none"))
            np.testing.assert_allclose(row["center_m"], box["center_m"], atol=1e-6)
            np.testing.assert_allclose(row["size_m"], box["size_m"], atol=1e-9)
            # Labels have a heading alone: roll and pitch of the street are lost.
            corners = np.array(box["corners_m"]).reshape(8, 3)
            ahead = corners[4] - corners[0]
            off = math.remainder(yaw_of(row) - math.atan2(ahead[1], ahead[0]), 2 * math.pi)
            self.assertLess(abs(off), math.radians(2))


if __name__ == "__main__":
    unittest.main()
