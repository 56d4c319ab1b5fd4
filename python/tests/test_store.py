"""What the package reads, beside the tables themselves."""

import json
import multiprocessing
import pickle
import shutil
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
import pyarrow.parquet as pq
from plain import SCENE, STORE, agent_pose, inside, matrix, rows, sweep

import convoy

FRAME = 12


def digest(frame):
    """Something of every kind of file."""
    agent = convoy.Dataset(STORE).scene(0).frame(frame).agent("vehicle_1") if isinstance(frame, int) else frame
    return [
        float(agent.points().sum(dtype=np.float64)),
        int(agent.bev().masks.sum()),
        len(agent.camera("CAM_BACK").encoded),
        float(agent.boxes().center.sum()),
    ]


def in_a_worker(agents, queue):
    try:
        queue.put([digest(agent) for agent in agents])
    except (convoy.StoreError, OSError, ValueError) as fault:
        queue.put(repr(fault))


class Reading(unittest.TestCase):
    def setUp(self):
        self.dataset = convoy.Dataset(STORE)
        self.scene = self.dataset.scene(0)
        self.frame = self.scene.frame(FRAME)

    def test_a_store_knows_its_scenes(self):
        self.assertEqual(self.dataset.splits, {"train": [0], "val": [1]})
        self.assertEqual([scene.number for scene in self.dataset.scenes()], [0])
        self.assertEqual(self.dataset.scenes("val"), [])
        self.assertEqual(self.scene.agents, ("vehicle_0", "vehicle_1", "rsu_0"))
        self.assertEqual(self.scene.info["split"], self.scene.split)
        self.assertEqual(self.dataset.config["seed"], 11)
        agents = self.dataset.plan("agents").to_pylist()
        self.assertEqual([row["agent"] for row in agents if row["scene"] == self.scene.number], list(self.scene.agents))
        with self.assertRaisesRegex(convoy.StoreError, "spawn-planner wrote no such file"):
            self.dataset.plan("weather")
        self.assertEqual(self.scene.tracks().num_rows, len(rows(SCENE / "tracks.parquet")))
        kinds = set(self.scene.vector_map()["kind"].to_pylist())
        self.assertTrue({"lane_centreline", "divider", "signal"} <= kinds, kinds)

    def test_poses_and_readings_are_those_of_the_tables(self):
        for name in self.scene.agents:
            agent = self.frame.agent(name)
            self.assertTrue(np.allclose(agent.pose, agent_pose(name, FRAME), atol=1e-9))
            self.assertTrue(np.allclose(convoy.invert(agent.pose) @ agent.pose, np.eye(4), atol=1e-9))
            table = SCENE / f"sensors/{name}/LIDAR.parquet"
            row, points = rows(table, frame=FRAME)[0], agent.lidar()
            for column in points.dtype.names:
                self.assertTrue((points[column] == np.array(row[column], points[column].dtype)).all(), column)
            world = convoy.transform(agent.pose, agent.points()[:, :3].astype(float))
            self.assertLess(abs(world - sweep(name, FRAME)).max(), 1e-4)
            radar = rows(SCENE / f"sensors/{name}/RAD_FRONT.parquet", frame=FRAME)[0]
            self.assertTrue(np.array_equal(agent.radar()["depth"], np.array(radar["depth"], np.float32)))
            self.assertEqual(agent.hd_map(), rows(SCENE / "hd_map.parquet", frame=FRAME, agent=name)[0])
        own = self.frame.agent("vehicle_0")
        self.assertEqual(own.imu(), rows(SCENE / "sensors/vehicle_0/IMU.parquet", frame=FRAME)[0])
        self.assertEqual(own.gnss(), rows(SCENE / "sensors/vehicle_0/GNSS.parquet", frame=FRAME)[0])
        self.assertEqual(own.boxes_2d(), rows(SCENE / "sensors/vehicle_0/boxes_2d.parquet", frame=FRAME))
        self.assertEqual(len(own.semantic_lidar()), len(sweep("vehicle_0", FRAME, "SEG-LIDAR")))

    def test_boxes_in_the_agents_frame_are_those_of_the_world(self):
        for name in self.scene.agents:
            raw = rows(SCENE / "boxes.parquet", frame=FRAME, agent=name)
            seen = rows(SCENE / "boxes_valid.parquet", frame=FRAME, agent=name)
            agent = self.frame.agent(name)
            boxes = agent.boxes()
            local = boxes.transformed(convoy.invert(agent.pose))
            self.assertEqual(boxes.id.tolist(), [row["id"] for row in raw])
            self.assertEqual(boxes.class_name, [row["class"] for row in raw])
            self.assertEqual(len(agent.boxes(valid=True)), sum(row["valid_flag"] for row in seen))
            back = np.linalg.inv(agent_pose(name, FRAME))
            for i, row in enumerate(raw):
                corners = np.column_stack([np.reshape(row["corners_m"], (8, 3)), np.ones(8)])
                corners = (back @ corners.T).T[:, :3]
                self.assertLess(abs(local.corners[i] - corners).max(), 1e-6)
                self.assertLess(abs(local.center[i] - corners.mean(axis=0)).max(), 1e-3)
                forward = corners[4] - corners[0]
                apart = local.yaw[i] - np.arctan2(forward[1], forward[0])
                self.assertLess(abs((apart + np.pi) % (2 * np.pi) - np.pi), 1e-5)
                self.assertAlmostEqual(np.linalg.norm(forward), local.size[i, 0], 4)
                speed = back[:3, :3] @ row["velocity_mps"]
                self.assertLess(abs(local.velocity[i] - speed).max(), 1e-6)
        merged = self.frame.boxes()
        self.assertEqual(len(merged), len(rows(SCENE / "tracks_frames.parquet", frame=FRAME)))

    def test_partners_without_a_lidar_have_no_points_of_it(self):
        heard = self.frame.cooperative("vehicle_0", "x2x", comm_range_m=1000, elevation_m=100)
        sensors = dict(self.frame.scene._sensors)
        sensors["rsu_0"] = tuple(name for name in sensors["rsu_0"] if name != "LIDAR")
        with mock.patch.object(self.frame.scene, "_sensors", sensors):
            ego, other, rsu = heard.points()
        self.assertTrue(len(ego) and len(other))
        self.assertEqual((rsu.shape, rsu.dtype), ((0, 4), np.float32))
        with self.assertRaises(convoy.StoreError):
            heard.points("LIDAR_9")

    def test_partners_points_fall_into_the_boxes_in_which_they_were_counted(self):
        heard = self.frame.cooperative("vehicle_0", "x2x", comm_range_m=1000, elevation_m=100)
        self.assertEqual([agent.name for agent in heard.agents], ["vehicle_0", "vehicle_1", "rsu_0"])
        self.assertTrue((heard.ego_from_agent[0] == np.eye(4)).all())
        ego, counted = convoy.invert(heard.ego.pose), 0
        for agent, points in zip(heard.agents, heard.points(), strict=True):
            boxes = agent.boxes().transformed(ego)
            number = {
                row["id"]: row["num_lidar_pts"]
                for row in rows(SCENE / "boxes_valid.parquet", frame=FRAME, agent=agent.name)
            }
            found = boxes.contains(points[:, :3].astype(float)).sum(axis=1)
            for i, (identity, corners) in enumerate(zip(boxes.id, boxes.corners, strict=True)):
                least, most = (inside(points[:, :3].astype(float), corners, margin).sum() for margin in (-0.002, 0.002))
                self.assertTrue(least <= number[int(identity)] <= most, (agent.name, identity))
                self.assertTrue(least <= found[i] <= most, (agent.name, identity))
            counted += sum(number.values()) if agent.name != "vehicle_0" else 0
        self.assertGreater(counted, 100, "partners saw hardly anything: this test says nothing")

    def test_who_is_heard(self):
        place = {name: agent_pose(name, FRAME)[:3, 3] for name in self.scene.agents}
        apart = {name: np.linalg.norm(place[name] - place["vehicle_0"]) for name in place}
        for mode, kinds in {"none": (), "x2v": ("vehicle",), "x2i": ("rsu",), "x2x": ("vehicle", "rsu")}.items():
            for reach in (0.0, *(metres + step for metres in apart.values() for step in (-0.01, 0.01))):
                heard = self.frame.cooperative("vehicle_0", mode, reach, 1000)
                wanted = [n for n in place if n != "vehicle_0" and n.startswith(kinds or "-") and apart[n] <= reach]
                self.assertEqual([agent.name for agent in heard.partners], wanted)
        height = abs(place["rsu_0"][2] - place["vehicle_0"][2])
        for limit in (height + 1e-6, height - 1e-6):
            heard = self.frame.cooperative("vehicle_0", "x2i", 1000, limit)
            self.assertEqual(len(heard.partners), int(limit > height))
        with self.assertRaises(ValueError):
            self.frame.cooperative("vehicle_0", "v2v")

    def test_masks_lie_where_boxes_are(self):
        hits = other = 0
        for name in ("vehicle_0", "vehicle_1"):
            agent = self.frame.agent(name)
            bev = agent.bev(("car", "truck", "bus"))
            mask = bev.masks.any(axis=0)
            world = agent_pose(name, FRAME)
            yaw = np.arctan2(world[1, 0], world[0, 0])
            for row in rows(SCENE / "boxes_valid.parquet", frame=FRAME, agent=name):
                if row["class"] not in bev.classes:
                    continue
                centre = np.reshape(row["corners_m"], (8, 3)).mean(axis=0) - world[:3, 3]
                ahead = np.cos(yaw) * centre[0] + np.sin(yaw) * centre[1]
                left = -np.sin(yaw) * centre[0] + np.cos(yaw) * centre[1]
                # Far from the middle, so that a picture that is turned or mirrored has nothing there.
                if max(abs(ahead), abs(left)) > 75 or min(abs(ahead), abs(left)) < 3 or abs(centre[2]) > 3:
                    continue
                at = (int((80 - ahead) // 0.4), int((80 - left) // 0.4))
                self.assertEqual(tuple(map(int, bev.cell(np.array([ahead, left])))), at)
                self.assertTrue(mask[at], f"{name}: no {row['class']} at {ahead:.1f}, {left:.1f}")
                hits += 1
                other += sum(bool(turned[at]) for turned in (mask[::-1], mask[:, ::-1], mask.T))
        self.assertGreater(hits, 5)
        self.assertLess(other, hits)

    def test_voxels_lie_where_points_are(self):
        agent = self.frame.agent("vehicle_1")
        grid = agent.occupancy(filled=False)
        points = agent.semantic_lidar()
        local = np.column_stack([points["x"], points["y"], points["z"], np.ones(len(points))]).astype(float)
        about = json.loads(pq.read_metadata(SCENE / "sensors/vehicle_1/SEG-LIDAR.parquet").metadata[b"sensor"])
        mount = matrix(about["agent_from_sensor"]["translation"], about["agent_from_sensor"]["quaternion"])
        cell = ((mount @ local.T).T[:, :3] - grid.origin_m) / grid.voxel_m
        near = (abs(cell - np.round(cell)) > 0.02).all(axis=1) & ((cell >= 0) & (cell < grid.tags.shape)).all(axis=1)
        index = tuple(np.floor(cell[near]).astype(int).T)
        self.assertGreater(near.sum(), 500)
        self.assertGreater((grid.tags[index] != 0).mean(), 0.999)
        self.assertGreater((grid.tags[index] == points["tag"][near]).mean(), 0.8)
        self.assertGreaterEqual((agent.occupancy().tags != 0).sum(), (grid.tags != 0).sum())

    def test_cameras(self):
        try:
            import PIL  # noqa: F401
        except ImportError:
            self.skipTest("Pillow, to decode pictures")
        agent = self.frame.agent("vehicle_0")
        camera = agent.camera("CAM_FRONT")
        self.assertEqual(camera.image().shape, (90, 160, 3))
        self.assertEqual(camera.encoded[:2], b"\xff\xd8")
        raw = pq.read_metadata(SCENE / "sensors/vehicle_0/RGB-CAM_FRONT.parquet").metadata[b"sensor"]
        self.assertEqual(camera.intrinsics.ravel().tolist(), np.ravel(json.loads(raw)["intrinsics"]).tolist())
        # A lidar point of an object, in the picture: the depth there is its z, the object its id.
        points, mount = agent.semantic_lidar(), agent.sensor("SEG-LIDAR").agent_from_sensor
        depth, (tags, ids) = agent.camera("CAM_FRONT", "DPT").depth(), agent.camera("CAM_FRONT", "IST").instances()
        local = np.stack([points["x"], points["y"], points["z"]], axis=1).astype(float)
        optical = convoy.transform(convoy.invert(camera.agent_from_camera) @ mount, local)
        ahead = optical[:, 2] > 1
        pixels = optical[ahead] @ camera.intrinsics.T
        columns, lines = (np.floor(pixels[:, i] / pixels[:, 2]).astype(int) for i in (0, 1))
        shown = (columns >= 0) & (columns < 160) & (lines >= 0) & (lines < 90)
        at = (lines[shown], columns[shown])
        self.assertGreater(shown.sum(), 100)
        same = abs(depth[at] - optical[ahead][shown, 2]) < 0.3 + 0.03 * optical[ahead][shown, 2]
        self.assertGreater(same.mean(), 0.7)
        self.assertGreater((ids[at] == points["id"][ahead][shown]).mean(), 0.7)
        self.assertGreater((tags[at] == points["tag"][ahead][shown]).mean(), 0.7)
        self.assertEqual(agent.flow("CAM_FRONT").shape, (90, 160, 2))
        with self.assertRaises(ValueError):
            camera.depth()

    def test_what_a_store_has_not_is_said_with_its_place(self):
        agent = self.frame.agent("vehicle_0")
        cases = {
            "no such scene": lambda: self.dataset.scene(7),
            "simulate-and-log is not finished": lambda: self.dataset.scene(1).frame(0).agents,
            "frames 0 to 19": lambda: self.scene.frame(20),
            "vehicle_0, vehicle_1, rsu_0": lambda: self.frame.agent("vehicle_7"),
            "agent vehicle_0, sensor SONAR: render-sensors wrote no such file": lambda: agent.lidar("SONAR"),
            "frames 0, 2, 4, ...": lambda: self.scene.frame(13).agent("rsu_0").bev(),
            "has no dragon": lambda: agent.bev(("dragon",)),
            "no column doppler": lambda: agent.points(columns=("doppler",)),
            "no split": lambda: self.dataset.scenes("night"),
        }
        for words, read in cases.items():
            with self.subTest(words), self.assertRaises(convoy.StoreError) as caught:
                read()
            self.assertIn(words, str(caught.exception))
            self.assertEqual(str(pickle.loads(pickle.dumps(caught.exception))), str(caught.exception))
        # Rows that are not there are the store's fault, and told with a remedy.
        agent = self.scene.frame(FRAME).agent("vehicle_0")
        empty = agent.frame._labels("hd_map", ["frame", "agent"], "nobody")
        no_labels = mock.patch.object(type(agent.frame), "_labels", return_value=empty)
        with no_labels, self.assertRaisesRegex(convoy.StoreError, "no map record.*verify"):
            agent.hd_map()
        no_rows = mock.patch.object(type(agent), "_rows", return_value=empty)
        with no_rows, self.assertRaisesRegex(convoy.StoreError, "no row of this frame.*verify"):
            agent._record("sensors/vehicle_0/GNSS", "GNSS")
        with self.assertRaisesRegex(convoy.StoreError, "no finished plan"):
            convoy.Dataset(STORE / "maps")

    def test_damage_is_said_and_unfinished_stages_are_not_believed(self):
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder) / "store"
            shutil.copytree(STORE, copy, ignore=shutil.ignore_patterns("tiles", "stats"))
            agent = convoy.Dataset(copy).scene(0).frame(FRAME).agent("rsu_0")
            table, masks = copy / "scenes/0000/sensors/rsu_0/LIDAR.parquet", copy / "scenes/0000/bev/rsu_0.npz"
            whole = table.read_bytes()
            for name, damage in {"short": whole[:-7], "garbled": b"?" * len(whole), "gone": None}.items():
                table.unlink() if damage is None else table.write_bytes(damage)
                with self.subTest(name), self.assertRaises(convoy.StoreError) as caught:
                    agent.lidar()
                place = (
                    caught.exception.scene,
                    caught.exception.frame,
                    caught.exception.agent,
                    caught.exception.sensor,
                )
                self.assertEqual(place, (0, FRAME, "rsu_0", "LIDAR"))
                self.assertIn(f"`render-sensors --store {copy} --scenes 0 --force`", str(caught.exception))
                self.assertNotIn("make ", str(caught.exception).replace("makes ", ""))
            table.write_bytes(whole)
            self.assertGreater(len(agent.lidar()), 0)
            archive = bytearray(masks.read_bytes())
            archive[200:-4000] = b"\x55" * len(archive[200:-4000])
            masks.write_bytes(archive)
            with self.assertRaisesRegex(convoy.StoreError, "scene 0, frame 12, agent rsu_0, sensor bev: .*verify"):
                agent.bev()
            manifest = copy / "scenes/0000/_manifests/postprocess-valid.json"
            text = manifest.read_text()
            manifest.unlink()
            unfinished = convoy.Dataset(copy).scene(0)
            with self.assertRaisesRegex(convoy.StoreError, "postprocess-valid is not finished.*`convoy run --store "):
                unfinished.frame(FRAME).agent("rsu_0").boxes()
            with self.assertRaisesRegex(convoy.StoreError, "no sample"):
                convoy.DetectionSamples(copy)
            manifest.write_text(text.replace('"format_version": 2', '"format_version": 3'))
            with self.assertRaisesRegex(convoy.StoreError, "format version is 3"):
                convoy.Dataset(copy).scene(0)
            dataset = copy / "dataset.json"
            size = dataset.stat().st_size
            dataset.write_text(dataset.read_text().replace('"format_version": 2', '"format_version": 3'))
            self.assertEqual(dataset.stat().st_size, size)
            with self.assertRaisesRegex(convoy.StoreError, "format version is 3, this package reads 1 to 2"):
                convoy.Dataset(copy)

    def test_workers_read_what_their_parent_reads(self):
        for method in ("fork", "spawn"):
            agents = [self.scene.frame(k).agent("vehicle_1") for k in range(0, 20, 2)]
            wanted = [digest(agent) for agent in agents]  # The parent has everything open now.
            context = multiprocessing.get_context(method)
            queue = context.Queue()
            count = 4 if method == "fork" else 1
            workers = [context.Process(target=in_a_worker, args=(agents, queue)) for _ in range(count)]
            for worker in workers:
                worker.start()
            again = [digest(agent) for agent in agents]
            found = [queue.get(timeout=120) for _ in workers]
            for worker in workers:
                worker.join()
            self.assertEqual(found, [wanted] * count, method)
            self.assertEqual(again, wanted)


if __name__ == "__main__":
    unittest.main()
