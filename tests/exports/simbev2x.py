"""Reads exports in SimBEV2X's layout, raw and processed, as its tools do, and holds them against the store.

Usage: python3 simbev2x.py STORE PROCESSED RAW
"""

import functools
import json
import math
import pathlib
import pickletools
import re
import sys
import zipfile

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from facts import texts
from PIL import Image

CAMERAS = ["CAM_FRONT_LEFT", "CAM_FRONT", "CAM_FRONT_RIGHT", "CAM_BACK_LEFT", "CAM_BACK", "CAM_BACK_RIGHT"]
RADARS = ["RAD_LEFT", "RAD_FRONT", "RAD_RIGHT", "RAD_BACK"]
METADATA = (
    ["camera_intrinsics", "rsu_camera_intrinsics", "voxel_detector_properties", "rsu_voxel_detector_properties"]
    + ["LIDAR", "RSU-LIDAR"] + CAMERAS + ["RSU-" + camera for camera in CAMERAS[:3]]
    + RADARS + ["RSU-RAD_FRONT", "VOXEL-GRID", "RSU-VOXEL-GRID"]
)
ORDER = (
    [f"{kind}-{camera}" for camera in CAMERAS for kind in ["RGB", "SEG", "IST", "DPT", "FLW"]]
    + RADARS + ["LIDAR", "SEG-LIDAR", "GNSS", "IMU", "VOXEL-GRID"]
)
COMMON = ["id", "type", "is_alive", "is_active", "is_dormant", "parent", "attributes", "location", "rotation",
          "linear_velocity", "angular_velocity", "semantic_tags", "bounding_box"]
LIGHT = ["green_time", "yellow_time", "red_time", "state", "opendrive_id", "pole_index"]
SEEN = ["num_lidar_pts", "num_radar_pts", "valid_flag", "class", "difficulty"]
CLASSES = {7: "traffic_light", 8: "traffic_sign", 12: "pedestrian", 14: "car", 15: "truck", 16: "bus",
           18: "motorcycle", 19: "bicycle", 30: "traffic_cone", 31: "barrier"}
# Points below which an object is hard, and below which it is medium.
FEW = {"car": (30, 80), "truck": (40, 100), "bus": (40, 100), "pedestrian": (20, 40), "motorcycle": (20, 40),
       "bicycle": (20, 40), "traffic_light": (10, 20), "traffic_sign": (10, 20), "traffic_cone": (10, 20),
       "barrier": (10, 20)}
OPCODES = set("""PROTO FRAME MEMOIZE BINPUT LONG_BINPUT BINGET LONG_BINGET GLOBAL STACK_GLOBAL SHORT_BINUNICODE
BINUNICODE SHORT_BINBYTES BINBYTES BININT BININT1 BININT2 LONG1 BINFLOAT NONE NEWTRUE NEWFALSE MARK EMPTY_TUPLE TUPLE
TUPLE1 TUPLE2 TUPLE3 EMPTY_LIST APPEND APPENDS EMPTY_DICT SETITEM SETITEMS REDUCE BUILD STOP""".split())
GLOBALS = {"numpy.core.multiarray _reconstruct", "numpy ndarray", "numpy dtype"}
BEV = [(196, 80, 196), (240, 80, 80), (160, 240, 40), (240, 196, 240), (240, 196, 196), (255, 165, 0), (200, 128, 128),
       (0, 128, 240), (80, 240, 80), (0, 144, 0), (240, 240, 0), (0, 240, 240), (240, 144, 0), (240, 0, 0)]
seen_kinds = set()


def turn(q):
    """The matrix of a quaternion w, x, y, z."""
    w, x, y, z = np.array(q) / np.linalg.norm(q)
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def rigid(t, q):
    out = np.eye(4)
    out[:3, :3], out[:3, 3] = turn(q), t
    return out


def moved(m, points):
    return points @ m[:3, :3].T + m[:3, 3]


def python_json(path):
    """JSON that is as Python itself would have written it."""
    text = path.read_text(encoding="ascii")
    value = json.loads(text)
    assert json.dumps(value, indent=4) == text, f"{path}: not as Python writes it"
    return value


def archive(path):
    with zipfile.ZipFile(path) as z:
        assert z.namelist() == ["data.npy"] and z.testzip() is None, path
        raw = z.read("data.npy")
    assert raw[:8] == b"\x93NUMPY\x01\x00" and (10 + int.from_bytes(raw[8:10], "little")) % 64 == 0
    with np.load(path) as found:
        return found["data"]


def objects(path):
    """The records of a file of boxes, as readers load them; its pickle says nothing but what it must."""
    with open(path, "rb") as file:
        version = np.lib.format.read_magic(file)
        assert version == (1, 0), path
        shape, fortran, dtype = np.lib.format.read_array_header_1_0(file)
        assert dtype == np.dtype("O") and not fortran and len(shape) == 1
        for op, arg, _ in pickletools.genops(file):
            assert op.name in OPCODES, op.name
            assert op.name != "GLOBAL" or arg in GLOBALS, arg
            assert op.name != "PROTO" or arg == 3
    found = np.load(path, allow_pickle=True)
    assert found.shape == shape
    return list(found)


def check_types(box):
    kinds = {"id": int, "type": str, "is_alive": bool, "is_active": bool, "is_dormant": bool, "attributes": dict,
             "semantic_tags": list, "distance_to_ego": float, "angle_to_ego": float, "sign_type": str, "green_time": float,
             "yellow_time": float, "red_time": float, "state": str, "opendrive_id": str, "pole_index": int,
             "num_lidar_pts": int, "num_radar_pts": int, "valid_flag": bool, "class": str, "difficulty": str}
    for key, value in box.items():
        if key in kinds:
            assert type(value) is kinds[key], (key, type(value))
    assert box["parent"] is None or type(box["parent"]) is int
    for key, shape in [("bounding_box", (8, 3)), ("location", (3,)), ("rotation", (3,)), ("linear_velocity", (3,)),
                       ("angular_velocity", (3,))]:
        assert box[key].dtype == np.float64 and box[key].shape == shape, key
    assert all(type(k) is str and type(v) is str for k, v in box["attributes"].items())
    tags = box["semantic_tags"]
    assert all(type(tag) is int for tag in tags) and len(set(tags)) == len(tags)
    assert 12 not in tags or box["attributes"]["use_wheelchair"] in ("true", "false")


def check_box(box, row):
    """A record against the row of the store that it comes from."""
    check_types(box)
    corners = np.array(row["corners_m"]).reshape(8, 3)
    assert np.array_equal(box["bounding_box"], corners) and box["id"] == row["id"]
    length, width, height = row["size_m"]
    c = box["bounding_box"]
    for (i, j), size in zip([(0, 4), (0, 2), (0, 1)], (length, width, height)):
        assert abs(np.linalg.norm(c[j] - c[i]) - size) < 1e-6
    # In its own frame (x forward, y left, z up) by the exported angles: corner 0 is rear, left, bottom.
    roll, pitch, yaw = np.radians(box["rotation"])
    rx = np.array([[1, 0, 0], [0, math.cos(roll), -math.sin(roll)], [0, math.sin(roll), math.cos(roll)]])
    ry = np.array([[math.cos(pitch), 0, math.sin(pitch)], [0, 1, 0], [-math.sin(pitch), 0, math.cos(pitch)]])
    rz = np.array([[math.cos(yaw), -math.sin(yaw), 0], [math.sin(yaw), math.cos(yaw), 0], [0, 0, 1]])
    own = (c - (c[0] + c[7]) / 2) @ (rz @ ry @ rx)
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (1, -1) for z in (-1, 1)])
    assert np.allclose(own, signs * np.array(row["size_m"]) / 2, atol=1e-6), "corners are in another order"
    middle = (c[0] + c[6]) / 2 if row["class"] != "pedestrian" else (c[0] + c[7]) / 2
    assert np.allclose(box["location"], middle, atol=1e-12)
    assert np.allclose(box["linear_velocity"], row["velocity_mps"])
    wx, wy, wz = np.degrees(np.array(row["angular_velocity_radps"], float))
    assert np.allclose(box["angular_velocity"], [-wx, -wy, wz]), "turning rates have other signs"
    assert box["semantic_tags"] == row["semantic_tags"]
    assert CLASSES[[tag for tag in box["semantic_tags"] if tag in CLASSES][-1]] == row["class"]
    if "distance_to_ego" in box:
        angle = row["angle_rad"]
        assert box["distance_to_ego"] == row["distance_m"]
        assert math.isnan(box["angle_to_ego"]) if angle is None else abs(box["angle_to_ego"] - math.degrees(angle)) < 1e-9
    light = row["class"] == "traffic_light"
    assert ("state" in box) == light and (not light or box["state"] == row["signal_state"])
    assert box["is_alive"] == (row["is_alive"] or light)
    facts = texts(row["attributes"])
    assert facts.items() <= box["attributes"].items()
    if row["class"] == "traffic_sign" and not row["is_alive"]:
        assert box["sign_type"] == facts.get("sign_type", "") and box["type"] == "TrafficSigns"


def keys_of(box, *, own, seen):
    keys = list(COMMON)
    if own:
        keys += ["distance_to_ego", "angle_to_ego"]
    if 7 in box["semantic_tags"]:
        keys += LIGHT
    elif "sign_type" in box:
        keys += ["sign_type"]
    return keys + (SEEN if seen else [])


def counted(box, points, slack):
    """Points in a box that is larger by so much on every side: three independent projections."""
    c = box["bounding_box"]
    reach = np.linalg.norm(c[7] - c[0]) / 2 + slack
    points = points[((points - (c[0] + c[7]) / 2) ** 2).sum(1) <= reach ** 2 + 1e-6]
    inside = np.ones(len(points), bool)
    for edge in (c[2] - c[0], c[4] - c[0], c[1] - c[0]):
        along = (points - c[0]) @ (edge / np.linalg.norm(edge))
        inside &= (along >= -slack) & (along <= np.linalg.norm(edge) + slack)
    return int(inside.sum())


def check_combined(lists, combined):
    """All agents' lists in their order into one."""
    expected = {}
    for boxes in lists:
        for box in boxes:
            first = expected.setdefault(box["id"], {**box, "num_lidar_pts": 0, "num_radar_pts": 0, "valid_flag": False})
            first["num_lidar_pts"] += box["num_lidar_pts"]
            first["num_radar_pts"] += box["num_radar_pts"]
            first["valid_flag"] |= box["valid_flag"]
    assert [box["id"] for box in combined] == list(expected)
    for box in combined:
        check_types(box)
        assert list(box) == keys_of(box, own=False, seen=True), list(box)
        want = expected[box["id"]]
        hard, medium = FEW[box["class"]]
        n = box["num_lidar_pts"] + box["num_radar_pts"]
        assert box["difficulty"] == ("hard" if n < hard else "medium" if n < medium else "easy")
        for key, value in box.items():
            if key != "difficulty":
                assert np.array_equal(value, want[key]), key


@functools.lru_cache(maxsize=4)
def rows_of(path):
    return pq.read_table(path).to_pylist()


class Agent:
    """What the store has of an agent."""

    def __init__(self, store, scene, name):
        folder = store / f"scenes/{scene:04d}"
        self.name, self.kind = name, name.split("_")[0]
        self.tables, self.about = {}, {}
        for path in sorted((folder / "sensors" / name).glob("*.parquet")):
            about = pq.read_metadata(path).metadata.get(b"sensor")
            if about:
                self.tables[path.stem] = pq.ParquetFile(path)
                self.about[path.stem] = json.loads(about)
        self.rows = [row for row in rows_of(folder / "agents.parquet") if row["agent"] == name]
        boxes = zip(rows_of(folder / "boxes.parquet"), rows_of(folder / "boxes_valid.parquet"), strict=True)
        self.boxes = {}
        for row, seen in boxes:
            if row["agent"] == name:
                self.boxes.setdefault(row["frame"], []).append((row, seen))
        self.lanes = {row["frame"]: row for row in rows_of(folder / "hd_map.parquet") if row["agent"] == name}
        self.grids = {key: np.load(folder / f"{place}/{name}.npz") for key, place in
                      [("VOXEL-GRID", "occupancy"), ("VOXEL-GRID-FILLED", "occupancy_filled"), ("GT_SEG", "bev")]}

    def column(self, sensor, name, frame):
        """A value of a frame; of a sensor's table, which has a group for each, nothing else is read."""
        table = self.tables[sensor]
        is_by_frame = table.num_row_groups == table.metadata.num_rows
        group = table.read_row_group(frame if is_by_frame else 0, columns=[name])
        value = group[name][0 if is_by_frame else frame]
        return value.values.to_numpy() if isinstance(value, pa.ListScalar) else value.as_py()


def check_reading(agent, sensor, frame, path):
    seen_kinds.add(sensor.split("-")[0] if "CAM" in sensor else sensor)
    get = lambda name: np.array(agent.column(sensor, name, frame))
    if "CAM" in sensor and not sensor.startswith("FLW"):
        assert path.read_bytes() == agent.column(sensor, "image", frame)
    elif sensor.startswith("FLW"):
        found, size = archive(path), (int(get("height")), int(get("width")))
        assert found.dtype == np.float32 and found.shape == (*size, 2)
        assert np.array_equal(found[..., 0].ravel(), get("dx")) and np.array_equal(found[..., 1].ravel(), get("dy"))
    elif sensor == "SEG-LIDAR":
        found = archive(path)
        assert found.ndim == 1 and found.dtype == np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("CosAngle", "<f4"),
                                                           ("ObjIdx", "<u4"), ("ObjTag", "<u4")])
        for field, name in [("x", "x"), ("y", "y"), ("z", "z"), ("CosAngle", "cos_angle"), ("ObjIdx", "id"), ("ObjTag", "tag")]:
            assert np.array_equal(found[field], get(name).astype(found[field].dtype)), field
    elif sensor == "LIDAR" or sensor.startswith("RAD"):
        names = ["x", "y", "z"] if sensor == "LIDAR" else ["depth", "altitude", "azimuth", "velocity"]
        found = archive(path)
        assert found.dtype == np.float32 and found.shape == (len(get(names[0])), len(names)), found.shape
        for column, name in enumerate(names):
            assert np.array_equal(found[:, column], get(name).astype(np.float32)), name
    elif sensor == "GNSS":
        assert np.array_equal(np.load(path), [get("latitude_deg"), get("longitude_deg"), get("altitude_m")])
    elif sensor == "IMU":
        a, g = get("acceleration_mps2"), get("gyroscope_radps")
        assert np.array_equal(np.load(path), [*a, -g[0], -g[1], g[2], get("compass_rad")])
    else:
        found = archive(path)
        assert found.dtype == np.uint8 and np.array_equal(found, agent.grids[sensor][f"{frame:04d}.npy"])


def check_metadata(metadata, agents):
    assert list(metadata) == METADATA, list(metadata)
    for agent in agents:
        prefix = "" if agent.kind == "vehicle" else "RSU-"
        lidar = np.array(metadata[prefix + "LIDAR"]["sensor2ego_translation"])
        for sensor, about in agent.about.items():
            place = sensor.split("-", 1)[1] if "CAM" in sensor else sensor
            if sensor in ("GNSS", "IMU", "SEG-LIDAR"):
                continue
            record, pose = metadata[prefix + place], about["agent_from_sensor"]
            assert list(record) == ["sensor2lidar_translation", "sensor2lidar_rotation", "sensor2ego_translation", "sensor2ego_rotation"]
            assert np.allclose(record["sensor2ego_translation"], pose["translation"], atol=1e-15)
            assert np.allclose(record["sensor2ego_rotation"], pose["quaternion"], atol=1e-15)
            assert np.allclose(record["sensor2lidar_translation"], np.array(pose["translation"]) - lidar)
            assert record["sensor2lidar_rotation"] == record["sensor2ego_rotation"]
            if "CAM" in sensor:
                key = "camera_intrinsics" if prefix == "" else "rsu_camera_intrinsics"
                assert np.allclose(metadata[key], about["intrinsics"])
    # The front camera looks ahead: its axis z is the vehicle's x, x its -y, y its -z.
    front = turn(metadata["CAM_FRONT"]["sensor2ego_rotation"])
    assert np.allclose(front, [[0, 0, 1], [-1, 0, 0], [0, -1, 0]], atol=1e-7)
    left = turn(metadata["CAM_FRONT_LEFT"]["sensor2ego_rotation"])[:, 2]
    assert left[0] > 0 and left[1] > 0, "the left camera looks to the right"


def check_scene_info(info, scene, agents):
    entities = [key for key in info if key.startswith(("vehicle_", "rsu_"))]
    assert entities == [agent.name for agent in agents]
    for key in ["map", "n_vehicles", "n_walkers", "n_accident_hazards", "n_road_work_hazards", "n_reckless_vehicles",
                "n_distracted_vehicles", "seed"]:
        assert info[key] == scene[key], key
    assert type(info["scene_duration"]) is int
    weather = ["cloudiness", "precipitation", "precipitation_deposits", "wind_intensity", "sun_azimuth_angle",
               "sun_altitude_angle", "wetness", "fog_density", "fog_distance", "fog_falloff"]
    for which in ["initial", "final"]:
        found = info[f"{which}_weather_parameters"]
        assert list(found) == weather and found["sun_altitude_angle"] == scene[f"{which}_weather"]["sun_altitude_deg"]
    for agent in agents:
        if agent.kind == "vehicle":
            assert sorted(info[agent.name]) == ["distracted_ego", "reckless_ego", "vehicle"]
    assert zipfile.ZipFile(info["log"]).testzip() is None
    log = json.loads(zipfile.ZipFile(info["log"]).read("scene.json"))
    assert log == scene
    keys = [line.split(":")[0] for line in pathlib.Path(info["config"]).read_text().splitlines() if not line.startswith(" ")]
    assert keys == sorted(keys) and "seed" in keys


def check_masks(record, agent, frame):
    masks = archive(record["GT_SEG"])
    assert masks.dtype == np.bool_ and np.array_equal(masks, agent.grids["GT_SEG"][f"{frame:04d}.npy"])
    picture = np.asarray(Image.open(record["GT_SEG_VIZ"])).astype(int)
    painted = np.full((*masks.shape[1:], 3), 255)
    for mask, color in zip(masks, BEV):
        painted[mask] = color
    assert picture.shape == painted.shape and abs(picture - painted).mean() < 6, "another picture of the masks"


def check_lane(path, row):
    lane = python_json(pathlib.Path(path))
    assert list(lane) == ["id", "s", "road_id", "section_id", "lane_id", "lane_type", "lane_width", "lane_change", "is_junction",
                          "junction_id", "is_intersection", "transform", "left_lane_marking", "left_lane",
                          "right_lane_marking", "right_lane"]
    assert lane["s"] == row["s_m"] and lane["lane_id"] == row["lane_id"] and str(lane["road_id"]) == row["road_id"]
    place = lane["transform"]
    assert [place[k] for k in "xyz"] == row["xyz_m"] and abs(math.radians(place["yaw"]) - row["rpy_rad"][2]) < 1e-12
    assert (lane["left_lane"] == {}) == (row["left_lane_id"] is None)


def check_projection(metadata, prefix, record, boxes):
    """Pixels of objects lie where their boxes are projected to; how many were looked at."""
    looked = 0
    k = np.array(metadata["camera_intrinsics" if prefix == "" else "rsu_camera_intrinsics"])
    world_from_ego = rigid(record["ego2global_translation"], record["ego2global_rotation"])
    for camera in CAMERAS:
        if f"IST-{camera}" not in record:
            continue
        pose = metadata[prefix + camera]
        camera_from_world = np.linalg.inv(world_from_ego @ rigid(pose["sensor2ego_translation"], pose["sensor2ego_rotation"]))
        image = np.asarray(Image.open(record[f"IST-{camera}"])).astype(int)
        ids = image[..., 1] + 256 * image[..., 2]
        for box in boxes:
            c = moved(camera_from_world, box["bounding_box"])
            if (c[:, 2] < 0.5).any():
                continue
            rows, columns = np.nonzero((ids == box["id"]) & np.isin(image[..., 0], box["semantic_tags"]))
            if len(rows) < 30:
                continue
            uv = (c @ k.T)[:, :2] / c[:, 2:]
            low, high = uv.min(0) - 2, uv.max(0) + 2
            inside = (columns > low[0] - 1) & (columns < high[0]) & (rows > low[1] - 1) & (rows < high[1])
            assert inside.mean() > 0.95, (camera, box["id"], inside.mean())
            looked += len(rows)
    return looked


def points_of(metadata, prefix, record):
    """Lidar and radar points in the world."""
    world_from_ego = rigid(record["ego2global_translation"], record["ego2global_rotation"])
    lift = lambda pose: world_from_ego @ rigid(pose["sensor2ego_translation"], pose["sensor2ego_rotation"])
    lidar = moved(lift(metadata[prefix + "LIDAR"]), archive(record["LIDAR"]).astype(float))
    radar = [np.zeros((0, 3))]
    for name in RADARS:
        if name in record:
            d, alt, az, _ = archive(record[name]).astype(float).T
            own = np.stack([d * np.cos(alt) * np.cos(az), d * np.cos(alt) * np.sin(az), d * np.sin(alt)], 1)
            radar.append(moved(lift(metadata[prefix + name]), own))
    return lidar, np.concatenate(radar)


def looked_at(frames):
    """Every fourth frame and the last: one of four agents takes two seconds."""
    return sorted({*range(0, frames, 4), frames - 1})


def check_scene(store, raw, metadata, number, data):
    scene = json.loads((store / f"scenes/{number:04d}/log/scene.json").read_text())
    agents = [Agent(store, number, agent["agent"]) for agent in scene["agents"]]
    check_metadata(metadata, agents)
    check_scene_info(data["scene_info"], scene, agents)
    picture = Image.open(raw.parent / f"scenario_images/Scene_{number:04d}.jpg")
    assert picture.size == (2000, 2000) and np.asarray(picture).std() > 5, "an empty picture from above"
    records = data["scene_data"]
    assert list(records) == [agent.name for agent in agents]
    totals = np.zeros(2)
    pixels = partners = 0
    assert all(len(records[agent.name]) == scene["frames"] for agent in agents)
    for frame in looked_at(scene["frames"]):
        lists, clouds = [], []
        for agent in agents:
            record, row = records[agent.name][frame], agent.rows[frame]
            prefix = "" if agent.kind == "vehicle" else "RSU-"
            sensors = [key for key in ORDER if key in agent.about or key == "VOXEL-GRID"]
            if agent.kind == "rsu":
                sensors = [key for key in sensors if key not in ("GNSS", "IMU")]
            expected = ["ego2global_translation", "ego2global_rotation", "timestamp", *sensors, "VOXEL-GRID-FILLED", "GT_SEG",
                        "GT_SEG_VIZ", "GT_DET", "HD_MAP", "scene", "frame", "GT_DET_COMBINED"]
            assert list(record) == expected, (list(record), expected)
            assert record["ego2global_translation"] == row["xyz_m"] and record["ego2global_rotation"] == row["quaternion"]
            assert (record["scene"], record["frame"], record["timestamp"]) == (number, frame, 500_000 * frame)
            i = int(agent.name.split("_")[1])
            for sensor in sensors + ["VOXEL-GRID-FILLED"]:
                path = pathlib.Path(record[sensor])
                stem = f"SimBEV2X-scene-{number:04d}-frame-{frame:04d}-{agent.kind}-{i:04d}-{sensor}"
                assert path.parts[-4:-1] == ("sweeps", f"{agent.kind}-{i}", sensor) and path.stem == stem, path
                check_reading(agent, sensor, frame, path)
            check_masks(record, agent, frame)
            check_lane(record["HD_MAP"], agent.lanes[frame])
            boxes = objects(record["GT_DET"])
            assert len(boxes) == len(agent.boxes[frame])
            for box, (source, seen) in zip(boxes, agent.boxes[frame]):
                check_box(box, source)
                assert list(box) == keys_of(box, own=True, seen=True), list(box)
                assert [box[key] for key in SEEN] == [seen[key] for key in SEEN]
            old = record["GT_DET"].replace("/det/", "/old_det/")
            before = objects(old)
            for box, after in zip(before, boxes, strict=True):
                assert list(box) == keys_of(box, own=True, seen=False)
                assert all(np.array_equal(value, after[key], equal_nan=key == "angle_to_ego") for key, value in box.items())
            name = pathlib.Path(old).name
            assert pathlib.Path(old).read_bytes() == (raw / f"{agent.kind}-{i}/det/{name}").read_bytes()
            pixels += check_projection(metadata, prefix, record, boxes)
            lidar, radar = points_of(metadata, prefix, record)
            clouds.append((lidar, boxes))
            for box in boxes:
                said = np.array([box["num_lidar_pts"], box["num_radar_pts"]])
                # Surfaces lie in the faces of boxes: points fall to either side as numbers are rounded.
                least, most = (np.array([counted(box, lidar, s), counted(box, radar, s)]) for s in (-1e-3, 1e-3))
                assert (least <= said).all() and (said <= most).all(), (agent.name, frame, box["id"], least, said, most)
                totals += said
            lists.append(boxes)
        check_combined(lists, objects(record["GT_DET_COMBINED"]))
        for lidar, boxes in clouds:
            for _, others in clouds:
                if others is not boxes and not partners:
                    partners += sum(counted(box, lidar, 0) > 0 for box in others if box["is_alive"])
    assert (totals > 0).all() and pixels > 1000, (totals, pixels)
    assert len(agents) < 2 or partners > 0, "no point of a partner falls into a box"


def check_folders(root, *, processed):
    truth = root / "ground-truth"
    for kind in ["vehicle", "rsu"]:
        found = sorted(int(path.name.split("-")[1]) for path in truth.glob(f"{kind}-*"))
        assert found == list(range(len(found))) and found, f"{kind}: {found}"
        for i in found:
            names = {path.name for path in (truth / f"{kind}-{i}").iterdir()}
            assert names == {"det", "seg", "seg_viz", "hd_map"} | ({"old_det"} if processed else set()), names
    assert (truth / "combined_det").exists() == processed
    filled = list((root / "sweeps").glob("*/VOXEL-GRID-FILLED"))
    assert bool(filled) == processed, "filled grids are made by post-processing"
    for log in (root / "console_logs").glob("*.log"):
        assert all(re.fullmatch(r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d\.\d{3} \| [A-Z ]{8} \| .*", line) for line in log.read_text().splitlines())


def main():
    store, processed, raw = (pathlib.Path(arg) for arg in sys.argv[1:4])
    scenes = 0
    for path in sorted((processed / "simbev2x/infos").glob("simbev2x_infos_*.json")):
        infos = python_json(path)
        assert list(infos) == ["metadata", "data"]
        if path.stem.endswith("_unprocessed"):
            continue
        split = path.stem.removeprefix("simbev2x_infos_")
        before = python_json(path.with_name(f"{path.stem}_unprocessed.json"))
        generated = python_json(raw / f"simbev2x/infos/simbev2x_infos_{split}.json")
        as_raw = json.dumps(before).replace(f"{processed}/", f"{raw}/")
        assert json.loads(as_raw) == generated, "the state before post-processing is another one"
        for key, data in infos["data"].items():
            number = int(key.removeprefix("scene_"))
            for frames, old in zip(data["scene_data"].values(), before["data"][key]["scene_data"].values(), strict=True):
                assert [{k: v for k, v in f.items() if k != "GT_DET_COMBINED"} for f in frames] == old
            check_scene(store, raw / "simbev2x/ground-truth", infos["metadata"], number, data)
            scenes += 1
    assert scenes, "no scene"
    check_folders(processed / "simbev2x", processed=True)
    check_folders(raw / "simbev2x", processed=False)
    assert seen_kinds >= {"RGB", "SEG", "IST", "DPT", "LIDAR", "SEG-LIDAR", "RAD_FRONT", "GNSS", "IMU", "VOXEL-GRID",
                          "VOXEL-GRID-FILLED"}, seen_kinds


main()
