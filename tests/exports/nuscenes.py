"""Reads an export in nuScenes' layout from its JSON and binary files alone, and holds it against the store.

Usage: python3 nuscenes.py STORE EXPORT [RADIUS_M]
RADIUS_M: how far annotations reach; a minus before it says that boxes without a point are annotated, too.
Exit code 77: something could not be looked at.
"""

import collections
import io
import json
import pathlib
import sys

import numpy as np
import pyarrow.parquet as pq
from facts import texts
from PIL import Image

FIELDS = {
    "category": "token name description index",
    "attribute": "token name description",
    "visibility": "token level description",
    "sensor": "token channel modality",
    "calibrated_sensor": "token sensor_token translation rotation camera_intrinsic",
    "ego_pose": "token timestamp rotation translation",
    "log": "token logfile vehicle date_captured location",
    "map": "token category filename log_tokens location global_from_world_m",
    "scene": "token log_token nbr_samples first_sample_token last_sample_token name description",
    "sample": "token timestamp prev next scene_token",
    "sample_data": "token sample_token ego_pose_token calibrated_sensor_token timestamp fileformat is_key_frame height width"
    " filename prev next",
    "instance": "token category_token nbr_annotations first_annotation_token last_annotation_token",
    "sample_annotation": "token sample_token instance_token visibility_token attribute_tokens translation size rotation prev"
    " next num_lidar_pts num_radar_pts",
}
REFERENCES = [
    ("calibrated_sensor", "sensor_token", "sensor"),
    ("scene", "log_token", "log"),
    ("scene", "first_sample_token", "sample"),
    ("scene", "last_sample_token", "sample"),
    ("sample", "scene_token", "scene"),
    ("sample_data", "sample_token", "sample"),
    ("sample_data", "ego_pose_token", "ego_pose"),
    ("sample_data", "calibrated_sensor_token", "calibrated_sensor"),
    ("instance", "category_token", "category"),
    ("instance", "first_annotation_token", "sample_annotation"),
    ("instance", "last_annotation_token", "sample_annotation"),
    ("sample_annotation", "sample_token", "sample"),
    ("sample_annotation", "instance_token", "instance"),
    ("sample_annotation", "visibility_token", "visibility"),
]
CLASSES = {
    "car": "vehicle.car",
    "truck": "vehicle.truck",
    "bus": "vehicle.bus.rigid",
    "motorcycle": "vehicle.motorcycle",
    "bicycle": "vehicle.bicycle",
    "traffic_cone": "movable_object.trafficcone",
    "barrier": "movable_object.barrier",
    "traffic_light": "static.other",
    "traffic_sign": "static.other",
}
# What a class is by its kind.
OF_KIND = {
    ("truck", "trailer"): "vehicle.trailer",
    ("bus", "articulated"): "vehicle.bus.bendy",
    ("pedestrian", "pram"): "human.pedestrian.stroller",
}
# Categories of points by tag, for those that an object does not tell better.
POINTS = {
    0: "noise", 1: "flat.driveable_surface", 2: "flat.sidewalk", 3: "static.manmade", 4: "static.manmade", 5: "static.manmade",
    6: "static.manmade", 7: "static.manmade", 8: "static.manmade", 9: "static.vegetation", 10: "flat.terrain",
    14: "vehicle.car", 15: "vehicle.truck", 16: "vehicle.bus.rigid", 18: "vehicle.motorcycle", 19: "vehicle.bicycle",
    24: "flat.driveable_surface", 30: "movable_object.trafficcone", 31: "movable_object.barrier",
}  # fmt: skip
DRIVABLE = {"Driving", "Entry", "Exit", "OffRamp", "OnRamp", "Shared", "Bidirectional", "Parking"}
BOX_COLUMNS = "frame id class semantic_tags corners_m center_m size_m velocity_mps".split()
SEEN_COLUMNS = "frame id num_lidar_pts num_radar_pts num_pixels".split()
looked = collections.Counter()


def rotation(q):
    """Matrix of a quaternion w, x, y, z."""
    w, x, y, z = q
    assert abs(w * w + x * x + y * y + z * z - 1) < 1e-6, f"{q} has not length 1"
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def moved(points, row):
    """Points of a sensor or agent in what its row says it stands in."""
    return points @ rotation(row["rotation"]).T + row["translation"]


def chain(rows, first):
    """Rows by token, followed from the first; each names the one before it."""
    found, before, token = [], "", first
    while token:
        row = rows[token]
        assert row["prev"] == before, f"{token} does not follow {before!r}"
        found.append(row)
        before, token = token, row["next"]
        assert len(found) <= len(rows), "the chain does not end"
    return found


def inside(points, box, slack=0.0):
    """Which points are in a box."""
    reach = np.linalg.norm(box["size"]) / 2 + slack
    near = np.flatnonzero((abs(points[:, :2] - box["translation"][:2]) <= reach).all(1))
    found = np.zeros(len(points), bool)
    found[near] = inside_near(points[near], box, slack)
    return found


def inside_near(points, box, slack):
    own = (points - box["translation"]) @ rotation(box["rotation"])
    width, length, height = box["size"]
    return (abs(own) <= np.array([length, width, height]) / 2 + slack).all(1)


class Store:
    """What a scene of the store holds of an agent."""

    def __init__(self, root, scene, agent):
        self.root, self.agent = root / f"scenes/{scene:04d}", agent
        self.sensors = self.root / f"sensors/{agent}"
        self.info = json.loads((self.root / "log/scene.json").read_text())
        self.poses = [r for r in pq.read_table(self.root / "agents.parquet").to_pylist() if r["agent"] == agent]
        own = [("agent", "=", agent)]
        raw = pq.read_table(self.root / "boxes.parquet", columns=BOX_COLUMNS, filters=own).to_pylist()
        seen = pq.read_table(self.root / "boxes_valid.parquet", columns=SEEN_COLUMNS, filters=own).to_pylist()
        self.boxes = collections.defaultdict(dict)
        for a, b in zip(raw, seen, strict=True):
            assert (a["frame"], a["id"]) == (b["frame"], b["id"])
            self.boxes[a["frame"]][a["id"]] = {**b, **a}
        actors = pq.read_table(self.root / "log/actors.parquet", columns=["id", "kind", "attributes"]).to_pylist()
        self.kinds = {row["id"]: row["kind"] for row in actors}
        self.facts = {row["id"]: texts(row["attributes"]) for row in actors}
        self.tables = {}

    def reading(self, name, frame):
        """A row of a sensor's table, lists as arrays, and what the table says of the sensor."""
        if name not in self.tables:
            file = pq.ParquetFile(self.sensors / f"{name}.parquet")
            self.tables[name] = file, json.loads(file.metadata.metadata[b"sensor"])
        file, about = self.tables[name]
        table = file.read_row_group(frame // about["every_n_frames"])
        assert table["frame"].to_pylist() == [frame]
        row = {}
        for column in table.column_names:
            cell = table[column][0]
            row[column] = cell.values.to_numpy() if hasattr(cell, "values") else cell.as_py()
        return row, about

    def shares(self):
        """Pixels that show an object and those that would, by frame and id, where the store knows."""
        path = self.sensors / "boxes_2d.parquet"
        if not path.exists():
            return None
        shares = collections.defaultdict(lambda: [0.0, 0.0])
        for row in pq.read_table(path).to_pylist():
            entry = shares[row["frame"], row["id"]]
            entry[0] += row["pixels"]
            entry[1] += row["pixels"] / (1 - min(row["occlusion"], 0.999))
        return shares

    def category(self, box):
        facts = self.facts[box["id"]]
        special = facts.get("special_type")
        if (box["class"], special) in OF_KIND:
            return OF_KIND[box["class"], special]
        if box["class"] != "pedestrian":
            return CLASSES[box["class"]]
        if facts.get("use_wheelchair") == "true" or special == "wheelchair":
            return "human.pedestrian.wheelchair"
        if special in ("worker", "police"):
            return "human.pedestrian." + {"worker": "construction_worker", "police": "police_officer"}[special]
        return "human.pedestrian." + ("child" if facts.get("age") == "child" else "adult")

    def attribute(self, box):
        moves = np.linalg.norm(box["velocity_mps"]) > 0.2
        if box["class"] in ("car", "truck", "bus"):
            parked = self.kinds[box["id"]] == "parked" or "hazard" in self.facts[box["id"]]
            return "vehicle.moving" if moves else "vehicle.parked" if parked else "vehicle.stopped"
        if box["class"] in ("motorcycle", "bicycle"):
            return "cycle.with_rider" if 13 in box["semantic_tags"] else "cycle.without_rider"
        if box["class"] == "pedestrian":
            return "pedestrian.moving" if moves else "pedestrian.standing"
        return None


class Version:
    """The tables of a version."""

    def __init__(self, export, folder):
        self.export, self.folder = export, folder
        self.rows = {}
        for name, fields in FIELDS.items():
            rows = json.loads((folder / f"{name}.json").read_text())
            for row in rows:
                assert list(row) == fields.split(), f"{name} has {list(row)}"
            self.rows[name] = {row["token"]: row for row in rows}
            assert len(self.rows[name]) == len(rows), f"{name}: tokens are not unique"
        for table, field, other in REFERENCES:
            for row in self.rows[table].values():
                assert row[field] in self.rows[other], f"{table}.{field} names no {other}"
        for row in self.rows["sample_annotation"].values():
            assert len(row["attribute_tokens"]) <= 1 and all(t in self.rows["attribute"] for t in row["attribute_tokens"])
        mapped = [token for row in self.rows["map"].values() for token in row["log_tokens"]]
        assert sorted(mapped) == sorted(self.rows["log"]), "each log belongs to one map"
        self.by_sample = collections.defaultdict(list)
        for row in self.rows["sample_annotation"].values():
            self.by_sample[row["sample_token"]].append(row)
        self.data = collections.defaultdict(dict)
        for row in self.rows["sample_data"].values():
            if row["is_key_frame"]:
                self.data[row["sample_token"]][self.channel(row)] = row
        self.cooperation = json.loads((folder / "cooperation.json").read_text())
        lidarseg = folder / "lidarseg.json"
        self.labels = {r["sample_data_token"]: r for r in json.loads(lidarseg.read_text())} if lidarseg.exists() else {}
        if self.labels:
            files = list((export / "lidarseg" / folder.name).glob("*.bin"))
            assert len(files) == len(self.labels), "devkits count label files"

    def channel(self, data):
        calibration = self.rows["calibrated_sensor"][data["calibrated_sensor_token"]]
        return self.rows["sensor"][calibration["sensor_token"]]["channel"]

    def calibration(self, data):
        return self.rows["calibrated_sensor"][data["calibrated_sensor_token"]]

    def pose(self, data):
        return self.rows["ego_pose"][data["ego_pose_token"]]

    def check_chains(self):
        samples = [r for s in self.rows["scene"].values() for r in self.check_scene(s)]
        assert len(samples) == len(self.rows["sample"])
        lengths = collections.Counter(row["instance_token"] for row in self.rows["sample_annotation"].values())
        for row in self.rows["instance"].values():
            found = chain(self.rows["sample_annotation"], row["first_annotation_token"])
            assert len(found) == row["nbr_annotations"] == lengths[row["token"]]
            assert found[-1]["token"] == row["last_annotation_token"]
            assert {r["instance_token"] for r in found} == {row["token"]}
            times = [self.rows["sample"][r["sample_token"]]["timestamp"] for r in found]
            assert times == sorted(set(times)), "an instance is twice in a sample or runs backwards"
        firsts = [row for row in self.rows["sample_data"].values() if not row["prev"]]
        chained = 0
        for first in firsts:
            found = chain(self.rows["sample_data"], first["token"])
            assert len({row["calibrated_sensor_token"] for row in found}) == 1
            times = [row["timestamp"] for row in found]
            assert times == sorted(set(times))
            chained += len(found)
        assert chained == len(self.rows["sample_data"]) and len(firsts) == len(self.rows["calibrated_sensor"])
        for row in self.rows["sample_data"].values():
            time, sample = row["timestamp"], self.rows["sample"][row["sample_token"]]
            assert self.pose(row)["timestamp"] == time and isinstance(time, int)
            if row["is_key_frame"]:
                assert sample["timestamp"] == time and row["filename"].startswith("samples/")
            else:
                last = not sample["next"] and sample["timestamp"] < time
                before = self.rows["sample"].get(sample["prev"], {"timestamp": 0})["timestamp"]
                assert last or before < time < sample["timestamp"], "a sweep belongs to the sample that follows it"
                assert row["filename"].startswith("sweeps/")

    def check_scene(self, scene):
        samples = chain(self.rows["sample"], scene["first_sample_token"])
        assert len(samples) == scene["nbr_samples"] and samples[-1]["token"] == scene["last_sample_token"]
        assert {s["scene_token"] for s in samples} == {scene["token"]}
        gaps = set(np.diff([s["timestamp"] for s in samples]))
        assert all(gap >= 500_000 for gap in gaps) and len(gaps) <= 1, f"samples {gaps} us apart"
        channels = {tuple(sorted(self.data[s["token"]])) for s in samples}
        assert len(channels) == 1 and "LIDAR_TOP" in min(channels), channels
        looked["samples"] += len(samples)
        return samples

    def check_splits(self):
        splits = json.loads((self.folder / "splits.json").read_text())
        names = sorted(name for scenes in splits.values() for name in scenes)
        assert names == sorted(s["name"] for s in self.rows["scene"].values())
        return {name: split for split, scenes in splits.items() for name in scenes}


def check_cloud(version, store, data, frame, channel):
    """A lidar's file against its table; its points in the global frame with their objects."""
    row, about = store.reading("LIDAR" if channel == "LIDAR_TOP" else channel, frame)
    points = np.fromfile(version.export / data["filename"], "<f4").reshape(-1, 5)
    want = np.stack([-row["y"], row["x"], row["z"], 255 * row["intensity"], row["ring"]], 1).astype(np.float32)
    assert points.shape == want.shape and np.allclose(points, want, rtol=1e-6, atol=0), "the cloud is another"
    calibration = version.calibration(data)
    own = np.array(about["agent_from_sensor"]["translation"])
    turn = rotation(about["agent_from_sensor"]["quaternion"])
    in_agent = np.stack([row["x"], row["y"], row["z"]], 1).astype(float) @ turn.T + own
    assert np.allclose(moved(points[:, :3].astype(float), calibration), in_agent, atol=1e-4), "lidar calibration"
    assert np.allclose(rotation(calibration["rotation"])[:, 1], turn[:, 0], atol=1e-8), "y of a lidar is ahead"
    looked["points"] += len(points)
    return moved(in_agent, version.pose(data)), row


def check_labels(version, store, data, row):
    labels = np.fromfile(version.export / version.labels[data["token"]]["filename"], np.uint8)
    assert len(labels) == len(row["tag"]), "a label for each point"
    names = {r["index"]: r["name"] for r in version.rows["category"].values()}
    assert sorted(names) == list(range(32))
    for tag, identity, label in set(zip(row["tag"].tolist(), row["id"].tolist(), labels.tolist())):
        if tag in (12, 13, 15, 16) and identity in store.facts:
            classes = {12: "pedestrian", 15: "truck", 16: "bus"}
            if tag in classes:
                want = store.category({"id": identity, "class": classes[tag]})
                assert names[label] == want, (tag, identity, names[label])
            else:
                assert names[label] in ("vehicle.bicycle", "vehicle.motorcycle"), (tag, identity, names[label])
            looked["labels of objects"] += 1
        elif tag in POINTS:
            assert names[label] == POINTS[tag], (tag, names[label])


def radar_points(path):
    """A radar file: header of eleven lines, then packed points and at least a byte."""
    data = path.read_bytes()
    lines = data.split(b"\n", 11)
    head = {line.split(b" ", 1)[0].decode(): line.decode().split(" ")[1:] for line in lines[:11]}
    assert lines[10] == b"DATA binary" and head["HEIGHT"] == ["1"] and head["WIDTH"] == head["POINTS"]
    kinds = [f"<{ {'F': 'f', 'I': 'i'}[t] }{s}" for t, s in zip(head["TYPE"], head["SIZE"])]
    dtype = np.dtype(list(zip(head["FIELDS"], kinds)))
    assert head["FIELDS"][5] == "rcs" and len(dtype) == 18 and dtype.itemsize == 43
    count = int(head["WIDTH"][0])
    assert len(lines[11]) > count * dtype.itemsize, "devkits want a byte behind the last point"
    return np.frombuffer(lines[11], dtype, count)


def check_radar(version, store, data, frame, channel):
    points = radar_points(version.export / data["filename"])
    row, about = store.reading("RAD_" + channel.removeprefix("RADAR_"), frame)
    if len(row["depth"]) == 0:
        assert len(points) == 1 and np.isnan(points["x"][0])
        return
    assert len(points) == len(row["depth"])
    level = np.cos(row["altitude"])
    ray = np.stack([level * np.cos(row["azimuth"]), level * np.sin(row["azimuth"]), np.sin(row["altitude"])], 1)
    at = np.stack([points["x"], points["y"], points["z"]], 1)
    assert np.allclose(at, ray * row["depth"][:, None], atol=1e-3), "radar places"
    assert np.allclose(points["rcs"], row["rcs_dbsm"])
    measured = np.stack([points["vx"], points["vy"]], 1)
    assert np.allclose(measured, ray[:, :2] * row["velocity"][:, None], atol=1e-3), "radar velocities"
    assert (points["ambig_state"] == 3).all() and (points["invalid_state"] == 0).all()
    assert np.isin(points["dyn_prop"], (0, 1)).all() and (points["id"] >= 0).all()
    # What is built into the ground does not move once the radar's own motion is taken away.
    still = np.isin(row["tag"], (1, 2, 3, 4, 5, 6, 9, 10, 24)) & (np.hypot(ray[:, 0], ray[:, 1]) > 0.5)
    if still.sum() > 10:
        drift = np.hypot(points["vx_comp"], points["vy_comp"])[still]
        assert np.median(drift) < 0.25, f"{np.median(drift)} m/s"
        looked["still returns"] += int(still.sum())
    assert np.allclose(moved(np.zeros((1, 3)), version.calibration(data))[0], about["agent_from_sensor"]["translation"])


def check_image(version, store, data, frame, channel):
    row, about = store.reading(f"RGB-{channel}", frame)
    raw = (version.export / data["filename"]).read_bytes()
    assert raw == row["image"] and Image.open(io.BytesIO(raw)).size == (data["width"], data["height"])
    calibration = version.calibration(data)
    assert np.allclose(calibration["camera_intrinsic"], about["intrinsics"])
    assert np.allclose(rotation(calibration["rotation"]), rotation(about["agent_from_sensor"]["quaternion"]), atol=1e-8)
    assert np.allclose(calibration["translation"], about["agent_from_sensor"]["translation"])


def check_mask(version, store, data, frame, channel, boxes):
    """Pixels of objects lie within their boxes as the export's poses and intrinsics project them."""
    if not (store.sensors / f"IST-{channel}.parquet").exists():
        return
    row, _ = store.reading(f"IST-{channel}", frame)
    mask = np.asarray(Image.open(io.BytesIO(row["image"]))).astype(int)
    ids = mask[..., 1] + 256 * mask[..., 2]
    calibration, pose = version.calibration(data), version.pose(data)
    k = np.array(calibration["camera_intrinsic"])
    for identity, box in boxes.items():
        # Poles of lights and signs share their id and reach out of the box.
        if store.boxes[frame][identity]["class"] in ("traffic_light", "traffic_sign"):
            continue
        width, length, height = box["size"]
        signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2
        corners = signs * [length, width, height] @ rotation(box["rotation"]).T + box["translation"]
        in_agent = (corners - pose["translation"]) @ rotation(pose["rotation"])
        optical = (in_agent - calibration["translation"]) @ rotation(calibration["rotation"])
        seen = np.argwhere(ids == identity)[:, ::-1] + 0.5
        if len(seen) == 0 or (optical[:, 2] < 0.2).any():
            continue
        screen = optical @ k.T
        screen = screen[:, :2] / screen[:, 2:]
        within = ((seen >= screen.min(0) - 1.5) & (seen <= screen.max(0) + 1.5)).all(1)
        looked["pixels in boxes"] += int(within.sum())
        looked["pixels beside boxes"] += int((~within).sum())


def check_boxes(version, store, sample, frame, shift, limits):
    """The annotations of a sample; by id."""
    radius, empty = limits
    pose = store.poses[frame]
    wanted = {}
    for identity, box in store.boxes[frame].items():
        near = np.hypot(*(np.array(box["center_m"]) - pose["xyz_m"])[:2]) <= radius
        if near and identity != pose["id"] and (empty or box["num_lidar_pts"] + box["num_radar_pts"] > 0):
            wanted[identity] = box
    rows = version.by_sample[sample["token"]]
    assert len(rows) == len(wanted), f"{len(rows)} annotations, {len(wanted)} boxes"
    centres = np.array([box["center_m"] for box in wanted.values()]).reshape(-1, 3) + shift
    found = {}
    for row in rows:
        # By category too: boxes of one place may be two.
        away = np.linalg.norm(centres - row["translation"], axis=1)
        category = version.rows["category"][version.rows["instance"][row["instance_token"]]["category_token"]]["name"]
        near = [i for i in np.argsort(away)[:4] if away[i] < 1e-3]
        ids = [list(wanted)[i] for i in near]
        ids = [i for i in ids if store.category(wanted[i]) == category and i not in found]
        assert ids, f"no box at {row['translation']}"
        identity = ids[0]
        box = found[identity] = row
        truth = wanted[identity]
        length, width, height = truth["size_m"]
        assert np.allclose(box["size"], [width, length, height], atol=1e-3), "size is width, length, height"
        corners = np.array(truth["corners_m"]).reshape(8, 3)
        axes = np.stack([corners[4] - corners[0], corners[0] - corners[2], corners[1] - corners[0]], 1)
        assert np.allclose(rotation(box["rotation"]) * [length, width, height], axes, atol=1e-3), "rotation"
        assert (box["num_lidar_pts"], box["num_radar_pts"]) == (truth["num_lidar_pts"], truth["num_radar_pts"])
        names = [version.rows["attribute"][t]["name"] for t in box["attribute_tokens"]]
        speed = np.linalg.norm(truth["velocity_mps"])
        want = store.attribute(truth)
        assert names == ([want] if want else []) or abs(speed - 0.2) < 1e-4, (names, want)
        assert min(box["translation"][:2]) > 0, "global coordinates are positive"
    looked["boxes"] += len(found)
    return found


def check_visibility(store, frame, boxes, shares):
    for identity, box in boxes.items():
        level = int(box["visibility_token"])
        if shares is None:
            shown = store.boxes[frame][identity]["num_pixels"] > 0
            images = any(store.sensors.glob("IST-*.parquet"))
            assert level == (4 if shown or not images else 1)
        else:
            part, whole = shares.get((frame, identity), (0.0, 1.0))
            share = part / whole
            assert level in {1 + sum(share + e >= limit for limit in (0.4, 0.6, 0.8)) for e in (-1e-6, 1e-6)}, (share, level)


def check_moment(version, stores, moment, shift, limits, shares):
    """A moment of a scene: the samples of all its agents."""
    frame, clouds, all_boxes = moment["frame"], {}, {}
    for agent, token in moment["samples"].items():
        store, sample = stores[agent], version.rows["sample"][token]
        scene = version.rows["scene"][sample["scene_token"]]
        assert scene["name"] == f"{moment['scene']}-{agent}"
        # Devkits cannot sort scenes that begin at the same time.
        place = [a["agent"] for a in store.info["agents"]].index(agent)
        assert sample["timestamp"] == moment["timestamp"] + place
        boxes = check_boxes(version, store, sample, frame, shift, limits)
        check_visibility(store, frame, boxes, shares[agent])
        for channel, data in version.data[token].items():
            pose = version.pose(data)
            assert np.allclose(pose["translation"], np.array(store.poses[frame]["xyz_m"]) + shift, atol=1e-6)
            assert np.allclose(rotation(pose["rotation"]), rotation(store.poses[frame]["quaternion"]), atol=1e-7)
            if channel.startswith("RADAR_"):
                check_radar(version, store, data, frame, channel)
            elif data["fileformat"] == "pcd":
                points, row = check_cloud(version, store, data, frame, channel)
                if channel == "LIDAR_TOP":
                    clouds[agent] = points, row
                    if version.labels:
                        check_labels(version, store, data, row)
            else:
                check_image(version, store, data, frame, channel)
                check_mask(version, store, data, frame, channel, boxes)
        all_boxes[agent] = boxes
    check_points(stores, clouds, all_boxes)


def check_points(stores, clouds, all_boxes):
    for agent, boxes in all_boxes.items():
        lidars = len(list(stores[agent].sensors.glob("LIDAR*.parquet")))
        points, _ = clouds[agent]
        for identity, box in boxes.items():
            # Counts are of all lidars of an agent.
            if lidars == 1 and box["num_lidar_pts"] > 0:
                count = inside(points, box).sum()
                slack = inside(points, box, 0.01).sum() - inside(points, box, -0.01).sum()
                assert abs(count - box["num_lidar_pts"]) <= slack, (agent, identity, count, box["num_lidar_pts"])
                looked["boxes with points"] += 1
            for partner, (theirs, row) in clouds.items():
                if stores[agent].boxes and stores[agent].kinds[identity] not in ("traffic_light", "sign"):
                    hits = theirs[row["id"] == identity]
                    if len(hits):
                        whose = "own" if partner == agent else "partners'"
                        looked[f"{whose} points in boxes"] += int(inside(hits, box, 0.1).sum())
                        looked[f"{whose} points"] += len(hits)


def winding(points, ring):
    """How often a ring goes round each point, and how near its edges come."""
    a, b = ring[None], np.roll(ring, -1, 0)[None]
    p = points[:, None]
    cross = (b - a)[..., 0] * (p - a)[..., 1] - (b - a)[..., 1] * (p - a)[..., 0]
    up = (a[..., 1] <= p[..., 1]) & (b[..., 1] > p[..., 1]) & (cross > 0)
    down = (a[..., 1] > p[..., 1]) & (b[..., 1] <= p[..., 1]) & (cross < 0)
    share = ((p - a) * (b - a)).sum(-1) / np.maximum(((b - a) ** 2).sum(-1), 1e-12)
    away = np.linalg.norm(p - (a + np.clip(share, 0, 1)[..., None] * (b - a)), axis=-1).min(1)
    return up.sum(1) - down.sum(1), away


def check_map(version, root, row, ways):
    """A map's mask against lanes and junctions, point by point, by another rule than theirs."""
    mask = np.asarray(Image.open(version.export / row["filename"]))
    assert mask.dtype == np.uint8 and mask.ndim == 2
    if mask.size == 1:
        looked["blank masks"] += 1
        return
    assert set(np.unique(mask)) == {0, 255}
    shift = np.array(row["global_from_world_m"])
    assert (shift == np.round(shift)).all() and shift[2] == 0
    table = pq.read_table(root / f"maps/{row['location']}.vector.parquet").to_pydict()
    random = np.random.default_rng(7)
    points = random.uniform([0.5, 0.5], [mask.shape[1] / 10 - 0.5, mask.shape[0] / 10 - 0.5], (4000, 2))
    near_way = random.choice(ways, 2000)[:, :2] + random.uniform(-30, 30, (2000, 2))
    points = np.concatenate([points, np.clip(near_way, 0.5, np.array(mask.shape[::-1]) / 10 - 0.5)])
    # Where devkits look: the middle of the pixel.
    pixel = np.round(np.stack([10 * points[:, 0], mask.shape[0] - 10 * points[:, 1]], 1)).astype(int)
    points = np.stack([pixel[:, 0] / 10, (mask.shape[0] - pixel[:, 1]) / 10], 1) - shift[:2]
    drivable, near_edge = np.zeros(len(points), bool), np.zeros(len(points), bool)
    line = lambda i: np.stack([table["x_m"][i], table["y_m"][i]], 1)  # noqa: E731
    for i, kind in enumerate(table["kind"]):
        if kind == "junction":
            rings = np.split(line(i), table["rings"][i][1:])
        elif kind == "lane_centreline" and table["lane_type"][i] in DRIVABLE and len(table["boundaries"][i]) == 2:
            left, right = (line(j) for j in table["boundaries"][i])
            rings = [np.concatenate([left, right[::-1]])]
        else:
            continue
        close = ((points > rings[0].min(0) - 1) & (points < rings[0].max(0) + 1)).all(1)
        turns = np.zeros(close.sum(), int)
        for ring in rings:
            found, away = winding(points[close], ring)
            turns += found
            near_edge[close] |= away < 0.02
        drivable[close] |= turns != 0
    got = mask[pixel[:, 1], pixel[:, 0]] == 255
    wrong = (got != drivable) & ~near_edge
    assert wrong.sum() == 0, f"{wrong.sum()} of {len(points)} pixels, first {points[wrong][:3]}"
    assert drivable.sum() > 100, "nothing drivable near the agents"
    looked["pixels of maps"] += int((~near_edge).sum())
    way = np.round(np.stack([10 * ways[:, 0], mask.shape[0] - 10 * ways[:, 1]], 1)).astype(int)
    assert (way >= 1000).all() and (way < np.array(mask.shape[::-1]) - 990).all(), "100 m around ways are on the map"
    on_road = mask[way[:, 1], way[:, 0]] == 255
    assert on_road.mean() > 0.95, f"{on_road.mean()} of the ways of vehicles are on roads"


def check_version(root, export, folder, limits):
    version = Version(export, folder)
    version.check_chains()
    splits = version.check_splits()
    shifts = {token: row["global_from_world_m"] for row in version.rows["map"].values() for token in row["log_tokens"]}
    scenes = {}
    for scene in version.rows["scene"].values():
        number, agent = scene["name"].split("-", 1)
        scenes.setdefault(number, {})[agent] = Store(root, int(number), agent)
        info = scenes[number][agent].info
        log = version.rows["log"][scene["log_token"]]
        assert splits[scene["name"]] == f"convoy_{info['split']}" and log["location"] == info["map"]
        if folder.name.startswith(f"v1.0-{info['split']}-"):
            assert folder.name == f"v1.0-{info['split']}-{info['map'].replace('/', '_')}"
        scenes[number].setdefault("shift", np.array(shifts[scene["log_token"]]))
    moments = collections.Counter(len(moment["samples"]) for moment in version.cooperation)
    assert sum(n * k for n, k in moments.items()) == len(version.rows["sample"]), "each sample belongs to one moment"
    bases = {}
    for moment in version.cooperation:
        stores = {a: s for a, s in scenes[moment["scene"]].items() if a != "shift"}
        assert set(stores) >= set(moment["samples"])
        base = bases.setdefault(moment["scene"], moment["timestamp"] - 50_000 * moment["frame"])
        assert moment["timestamp"] == base + 50_000 * moment["frame"]
    shares = {(n, a): s.shares() for n, agents in scenes.items() for a, s in agents.items() if a != "shift"}
    for moment in version.cooperation:
        agents = {a: s for a, s in scenes[moment["scene"]].items() if a != "shift"}
        own = {a: shares[moment["scene"], a] for a in agents}
        check_moment(version, agents, moment, scenes[moment["scene"]]["shift"], limits, own)
    check_sweeps(version, scenes, bases)
    for row in version.rows["map"].values():
        of_map = {s["token"] for s in version.rows["scene"].values() if s["log_token"] in row["log_tokens"]}
        vehicles = {s for s in of_map if "-vehicle_" in version.rows["scene"][s]["name"]}
        ways = [
            version.pose(data["LIDAR_TOP"])["translation"]
            for token, data in version.data.items()
            if version.rows["sample"][token]["scene_token"] in vehicles
        ]
        if ways:
            check_map(version, root, row, np.array(ways))
    return {row["filename"] for row in version.rows["sample_data"].values()}


def check_sweeps(version, scenes, bases):
    """Files between samples."""
    for row in version.rows["sample_data"].values():
        if row["is_key_frame"]:
            continue
        sample = version.rows["sample"][row["sample_token"]]
        number, agent = version.rows["scene"][sample["scene_token"]]["name"].split("-", 1)
        frame, rest = divmod(row["timestamp"] - bases[number], 50_000)
        store, channel = scenes[number][agent], version.channel(row)
        assert rest == [a["agent"] for a in store.info["agents"]].index(agent)
        pose = version.pose(row)
        assert np.allclose(pose["translation"], np.array(store.poses[frame]["xyz_m"]) + scenes[number]["shift"], atol=1e-6)
        if channel.startswith("RADAR_"):
            check_radar(version, store, row, frame, channel)
        elif row["fileformat"] == "pcd":
            check_cloud(version, store, row, frame, channel)
        else:
            check_image(version, store, row, frame, channel)
        looked["sweeps"] += 1


def main(root, export, radius=60.0):
    files, versions = set(), [p.parent for p in sorted(export.glob("*/category.json"))]
    for folder in versions:
        named = check_version(root, export, folder, (abs(radius), radius < 0))
        assert not files & named, "two versions share a file"
        files |= named
    there = {p.relative_to(export).as_posix() for top in ("samples", "sweeps") for p in (export / top).rglob("*") if p.is_file()}
    assert there == files, f"files that no table names, or the other way: {sorted(there ^ files)[:3]}"
    for whose in ("own", "partners'"):
        found, all_points = looked[f"{whose} points in boxes"], looked[f"{whose} points"]
        assert found >= 0.97 * all_points, f"{found} of {all_points} {whose} points are in their boxes"
    assert looked["pixels in boxes"] >= 99 * looked["pixels beside boxes"], dict(looked)
    print(f"nuscenes: {len(versions)} versions, {dict(looked)}")
    wanted = ["samples", "boxes", "boxes with points", "points", "own points", "partners' points", "pixels in boxes", "still returns"]
    missing = [what for what in wanted if looked[what] == 0]
    if missing:
        print(f"note: nuscenes: there were no {', '.join(missing)} to look at")
        return 77
    return 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), *(float(a) for a in sys.argv[3:4])))
