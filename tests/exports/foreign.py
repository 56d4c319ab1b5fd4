"""Makes a small dataset as SimBEV2X's own generator writes it, with numpy and Python, imports it and holds the store against it;
then breaks it in many ways, each of which must end in a clear error.

Usage: python3 foreign.py PROGRAM FOLDER      (PROGRAM: `import`; FOLDER: an empty one)
"""

import io
import json
import math
import os
import pathlib
import pickle
import shutil
import struct
import subprocess
import sys
import zipfile

import numpy as np
import pyarrow.parquet as pq
from facts import texts
from PIL import Image

PROGRAM, FOLDER = sys.argv[1], pathlib.Path(sys.argv[2])
FRAMES = 3
HASH = 2 ** 63 + 12345  # of scenery: a hash of 64 bits
CAMERAS = ["CAM_FRONT_LEFT", "CAM_FRONT", "CAM_FRONT_RIGHT", "CAM_BACK_LEFT", "CAM_BACK", "CAM_BACK_RIGHT"]
RADARS = ["RAD_LEFT", "RAD_FRONT", "RAD_RIGHT", "RAD_BACK"]
GRID = {"range": 4.0, "voxel_size": 0.5, "upper_limit": 3.0, "lower_limit": -1.0}
random = np.random.default_rng(5)


def pose(x, y, z, q=(1, 0, 0, 0)):
    return {"sensor2lidar_translation": [x, y, z - 1.8], "sensor2lidar_rotation": list(q),
            "sensor2ego_translation": [x, y, z], "sensor2ego_rotation": list(q)}


def metadata():
    k = [[100.0, 0.0, 8.0], [0.0, 100.0, 4.0], [0.0, 0.0, 1.0]]
    said = {"camera_intrinsics": k, "rsu_camera_intrinsics": k, "voxel_detector_properties": GRID,
            "rsu_voxel_detector_properties": GRID, "LIDAR": pose(0, 0, 1.8), "RSU-LIDAR": pose(0, 0, 3.2)}
    for camera in CAMERAS:
        said[camera] = pose(0.4, 0.4, 1.6, (0.6743797, -0.6743797, 0.2126311, -0.2126311))
    for camera in CAMERAS[:3]:
        said["RSU-" + camera] = pose(0, 0, 1.6, (0.5, -0.5, 0.5, -0.5))
    for radar in RADARS:
        said[radar] = pose(0, 1, 0.6, (0.7071067, 0, 0, 0.7071067))
    said["RSU-RAD_FRONT"] = pose(0, 0, 1.2)
    said["VOXEL-GRID"], said["RSU-VOXEL-GRID"] = pose(0, 0, 0.02), pose(0, 0, 0.02)
    return said


def corners(middle, size, yaw):
    l, w, h = np.array(size) / 2
    own = np.array([[x * l, -y * w, z * h] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    c, s = math.cos(yaw), math.sin(yaw)
    return own @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T + middle


def box(number, kind, tags, middle, size, yaw_deg, *, alive=True, angle=30.0, **more):
    bounding_box = corners(np.array(middle), size, math.radians(yaw_deg))
    foot = np.array(middle) - [0, 0, size[2] / 2]
    said = {"id": number, "type": kind, "is_alive": alive, "is_active": alive, "is_dormant": False, "parent": None,
            "attributes": {}, "location": foot, "rotation": np.array([0.0, 0.0, yaw_deg]),
            "linear_velocity": np.array([1.5, -2.5, 0.0]), "angular_velocity": np.array([3.0, -6.0, 9.0]), "semantic_tags": tags,
            "bounding_box": bounding_box, "distance_to_ego": float(np.linalg.norm(foot)), "angle_to_ego": angle}
    return {**said, **more}


def boxes(frame, agent):
    own = math.nan if agent == "vehicle_0" else 12.5
    x = 10 + 0.5 * frame
    return [
        box(24, "vehicle.ford.mustang_2016", [14], [x, 5, 0.7], [4.7, 1.9, 1.4], 30.0, angle=own,
            attributes={"role_name": "hero", "color": "1,2,3", "base_type": "car"}),
        box(70_000, "walker.pedestrian.0051", [12], [x + 3, 9, 0.9], [0.4, 0.5, 1.8], -170.0, parent=24,
            attributes={"use_wheelchair": "false", "role_name": "npc_walker"}),
        box(31, "traffic.traffic_light", [7], [20, 20, 5], [0.5, 0.6, 1.0], 90.0, state="Yellow", green_time=10.5, yellow_time=3.0,
            red_time=2.0, opendrive_id="954", pole_index=1, attributes={}),
        box(HASH, "TrafficSigns", [8], [30, 1, 2], [0.1, 0.7, 0.7], 0.0, alive=False, sign_type="stop"),
        # Numbers as numpy has them, and an array in the order of columns, as a transposed one is pickled.
        box(25, "vehicle.bh.crossbike", [13, 19], [40, 2, 1], [1.5, 0.6, 1.6], 45.0, distance_to_ego=np.float64(40.25),
            bounding_box=np.asfortranarray(corners(np.array([40.0, 2, 1]), [1.5, 0.6, 1.6], math.radians(45.0)))),
    ]


def put(path, data):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)
    return path


def npz(array):
    out = io.BytesIO()
    np.savez_compressed(out, data=array)
    return out.getvalue()


def npy(array, protocol=None):
    out = io.BytesIO()
    if protocol is None:
        np.save(out, array, allow_pickle=True)
    else:
        np.lib.format.write_array_header_1_0(out, np.lib.format.header_data_from_array_1_0(array))
        pickle.dump(array, out, protocol=protocol)
    return out.getvalue()


def picture(array, kind):
    out = io.BytesIO()
    Image.fromarray(array).save(out, kind)
    return out.getvalue()


def readings(agent, frame):
    """Every file of an agent at a frame: name, ending, bytes, and what the store must have."""
    masks = random.random((14, 20, 20)) < 0.2
    grid = random.integers(0, 32, (16, 16, 8), dtype=np.uint8)
    instances = np.zeros((8, 16, 3), np.uint8)
    instances[2:4, 5:9] = [14, 24, 0]
    instances[6, 3] = [19, 25, 0]
    lidar = random.normal(size=(50, 3)).astype("<f4")
    tagged = np.zeros(20, [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("CosAngle", "<f4"), ("ObjIdx", "<u4"), ("ObjTag", "<u4")])
    tagged["x"], tagged["ObjIdx"], tagged["ObjTag"] = np.arange(20), 24, 14
    tagged["ObjIdx"][3] = 70_000
    rgb = random.integers(0, 255, (8, 16, 3), dtype=np.uint8)
    found = {
        "RGB-CAM_FRONT": ("jpg", picture(rgb, "JPEG"), None), "IST-CAM_FRONT": ("png", picture(instances, "PNG"), None),
        "DPT-CAM_FRONT": ("png", picture(rgb, "PNG"), None), "FLW-CAM_FRONT": ("npz", None, random.normal(size=(8, 16, 2)).astype("<f4")),
        "LIDAR": ("npz", None, lidar), "SEG-LIDAR": ("npz", None, tagged),
        "RAD_FRONT": ("npz", None, random.normal(size=(7, 4)).astype("<f4")), "VOXEL-GRID": ("npz", None, grid),
        "GT_SEG": ("npz", None, masks),
    }
    if agent == "vehicle_0":
        found["GNSS"] = ("bin", npy(np.array([49.0, 8.5, 110.25])), None)
        found["IMU"] = ("bin", npy(np.array([0.1, 0.2, 9.81, 0.3, -0.4, 0.5, 1.0])), None)
    return {name: (ext, data if data is not None else npz(array), array) for name, (ext, data, array) in found.items()}


def lane(frame):
    mark = {"type": "Solid", "width": 0.12, "color": "White", "lane_change": "NONE"}
    side = {"id": 5, "s": 1.0, "road_id": 7, "section_id": 0, "lane_id": 2, "lane_type": "Shoulder", "lane_width": 0.5,
            "lane_change": "NONE"}
    return {"id": 2 ** 40, "s": 1.25 + frame, "road_id": 7, "section_id": 0, "lane_id": -1, "lane_type": "Driving", "lane_width": 3.5,
            "lane_change": "Both", "is_junction": True, "junction_id": 12, "is_intersection": True,
            "transform": {"x": 1.0, "y": 2.0, "z": 0.0, "roll": 0.0, "pitch": 0.0, "yaw": 90.0}, "left_lane_marking": mark,
            "left_lane": {}, "right_lane_marking": mark, "right_lane": side}


def dataset(root, protocol=None):
    """Scene 3 of two agents; what the store must have of each file."""
    top = root / "simbev2x"
    wanted, data = {}, {}
    for agent in ["vehicle_0", "rsu_0"]:
        folder, number = agent.replace("_", "-"), f"{agent.split('_')[0]}-0000"
        records = []
        for frame in range(FRAMES):
            stem = f"SimBEV2X-scene-0003-frame-{frame:04d}-{number}"
            record = {"ego2global_translation": [10 + 0.5 * frame, 5.0, 0.0], "ego2global_rotation": [math.cos(0.2), 0, 0, math.sin(0.2)],
                      "timestamp": 123_456_789 + 499_000 * frame}
            for name, (ext, bytes_, array) in readings(agent, frame).items():
                place = f"ground-truth/{folder}/seg" if name == "GT_SEG" else f"sweeps/{folder}/{name}"
                put(top / place / f"{stem}-{name}.{ext}", bytes_)
                record[name] = f"/dataset/simbev2x/{place}/{stem}-{name}.{ext}"
                wanted[agent, name, frame] = bytes_ if array is None else array
            record["VOXEL-GRID-FILLED"] = f"/dataset/simbev2x/sweeps/{folder}/VOXEL-GRID-FILLED/{stem}-VOXEL-GRID-FILLED.npz"
            listed = np.empty(5, object)
            listed[:] = boxes(frame, agent)
            put(top / f"ground-truth/{folder}/det/{stem}-GT_DET.bin", npy(listed, protocol))
            put(top / f"ground-truth/{folder}/hd_map/{stem}-HD_MAP.json", json.dumps(lane(frame), indent=4).encode())
            record["GT_DET"] = f"/dataset/simbev2x/ground-truth/{folder}/det/{stem}-GT_DET.bin"
            record["HD_MAP"] = f"/dataset/simbev2x/ground-truth/{folder}/hd_map/{stem}-HD_MAP.json"
            record.update(scene=3, frame=frame)
            records.append(record)
        data[agent] = records
    weather = {key: 10.0 + k for k, key in enumerate(["cloudiness", "precipitation", "precipitation_deposits", "wind_intensity",
               "sun_azimuth_angle", "sun_altitude_angle", "wetness", "fog_density", "fog_distance", "fog_falloff"])}
    info = {"map": "Town10HD", "vehicle_0": {"vehicle": "vehicle.ford.mustang_2016", "reckless_ego": True, "distracted_ego": False},
            "rsu_0": {}, "scene_duration": 1, "seed": None, "dynamic_weather": True, "initial_weather_parameters": weather,
            "final_weather_parameters": {key: value + 3.0 for key, value in weather.items()}, "street_light_intensity_change": 0.0,
            "n_accident_hazards": 1, "n_road_work_hazards": 0, "n_reckless_vehicles": 2, "n_distracted_vehicles": 3,
            "traffic_parameters": {"speed_difference": -20.0, "distance_to_leading": None, "green_time": 12.5, "walker_cross_factor": 0.25},
            "n_vehicles": 40, "n_walkers": 50, "log": "/dataset/simbev2x/logs/SimBEV2X-scene-0003.log",
            "config": "/dataset/simbev2x/configs/SimBEV2X-scene-0003.yaml"}
    put(top / "configs/SimBEV2X-scene-0003.yaml", b"bev_dim: 20\nbev_res: 0.8\n")
    infos = {"metadata": metadata(), "data": {"scene_0003": {"scene_info": info, "scene_data": data}}}
    put(top / "infos/simbev2x_infos_val.json", json.dumps(infos, indent=4).encode())
    return wanted


def run(root, store, *more):
    command = [PROGRAM, "simbev2x", "--source", root, "--store", store, "--progress", "none", *more]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    return done.returncode, done.stdout + done.stderr


def close(one, two, tolerance=1e-12):
    assert np.allclose(one, two, rtol=0, atol=tolerance), (one, two)


def check_store(store, wanted):
    scene = store / "scenes/0003"
    rows = pq.read_table(scene / "boxes.parquet").to_pylist()
    assert len(rows) == 2 * FRAMES * 5
    first = rows[:5]
    assert [row["class"] for row in first] == ["car", "pedestrian", "traffic_light", "traffic_sign", "bicycle"]
    assert [row["model"] for row in first] == ["ford.mustang_2016", "walker.0051", "traffic_light", "TrafficSigns", "bh.crossbike"]
    # Ids that fit stay; the others come from the top, the smallest first; then the RSU.
    assert [row["id"] for row in first] == [24, 65535, 31, 65534, 25]
    for row, source in zip(first, boxes(0, "vehicle_0")):
        close(np.array(row["corners_m"]).reshape(8, 3), source["bounding_box"], 0)
        close(row["rpy_rad"], np.radians(source["rotation"]))
        close(row["velocity_mps"], source["linear_velocity"], 0)
        close(row["angular_velocity_radps"], np.radians([-3.0, 6.0, 9.0]), 1e-6)
        assert row["distance_m"] == source["distance_to_ego"] and row["semantic_tags"] == source["semantic_tags"]
    close(first[0]["center_m"], [10, 5, 0.7], 1e-9)
    close(first[0]["size_m"], [4.7, 1.9, 1.4], 1e-9)
    assert first[0]["angle_rad"] is None and abs(first[1]["angle_rad"] - math.radians(30)) < 1e-12
    light = first[2]
    assert (light["signal_state"], light["opendrive_id"], light["is_alive"]) == ("Yellow", "954", False)
    assert light["attributes"]["green_time"] == 10.5 and texts(first[3]["attributes"]) == {"sign_type": "stop"}
    agents = pq.read_table(scene / "agents.parquet").to_pylist()
    assert [(row["frame"], row["agent"], row["id"]) for row in agents[2:4]] == [(1, "vehicle_0", 24), (1, "rsu_0", 65533)]
    close(agents[2]["xyz_m"], [10.5, 5, 0], 0)
    close(agents[2]["time_s"], 0.05)
    lanes = pq.read_table(scene / "hd_map.parquet").to_pylist()
    assert (lanes[0]["road_id"], lanes[0]["junction_id"], lanes[0]["right_lane_type"], lanes[0]["left_lane_id"], lanes[0]["lane"]) \
        == ("7", "12", "Shoulder", None, 0)
    # The lane leads north through (1, 2); the agent is at (10, 5): 9 m to its right.
    close(lanes[0]["lane_offset_m"], -9.0, 1e-9)
    check_readings(scene, wanted)
    facts = json.loads((scene / "log/scene.json").read_text())
    assert (facts["speed_difference"], facts["green_time_s"], facts["walker_cross_factor"], facts["imported"]) == (-0.2, 12.5, 0.25, True)
    assert facts["agents"][0]["reckless"] and facts["agents"][0]["color"] == [1, 2, 3] and facts["map"] == "Town10HD"
    weather = pq.read_table(scene / "log/frames.parquet").to_pylist()
    close([row["fog_density"] for row in weather], [18.0, 19.0, 20.0])
    actors = {row["id"]: row for row in pq.read_table(scene / "log/actors.parquet").to_pylist()}
    assert actors[65535]["parent"] == 24 and actors[24]["role"] == "vehicle_0" and actors[65533]["kind"] == "rsu"
    config = json.loads((store / "dataset.json").read_text())["config"]
    assert config["bev"]["cells"] == 20 and config["bev"]["cell_m"] == 0.8 and not config["vehicle_rig"]["camera"]["semantic"]
    assert [lidar["name"] for lidar in config["rsu_rig"]["lidars"]] == ["LIDAR", "SEG-LIDAR"]


def check_readings(scene, wanted):
    for agent in ["vehicle_0", "rsu_0"]:
        table = lambda name: pq.read_table(scene / f"sensors/{agent}/{name}.parquet").to_pylist()
        visible = table("visible")
        assert [(row["frame"], row["id"], row["tag"], row["pixels"]) for row in visible[:2]] == [(0, 24, 14, 8), (0, 25, 19, 1)]
        for frame in range(FRAMES):
            get = lambda name: wanted[agent, name, frame]
            for name in ["RGB-CAM_FRONT", "IST-CAM_FRONT", "DPT-CAM_FRONT"]:
                assert table(name)[frame]["image"] == get(name)
            for name, columns in [("LIDAR", ["x", "y", "z"]), ("RAD_FRONT", ["depth", "altitude", "azimuth", "velocity"])]:
                row = table(name)[frame]
                close(np.array([row[column] for column in columns], "f4").T, get(name), 0)
            row, source = table("SEG-LIDAR")[frame], get("SEG-LIDAR")
            close(row["x"], source["x"], 0)
            assert row["tag"] == source["ObjTag"].tolist() and row["id"] == [65535 if k == 3 else 24 for k in range(20)]
            flow = table("FLW-CAM_FRONT")[frame]
            close(np.array(flow["dx"]).reshape(8, 16), get("FLW-CAM_FRONT")[..., 0], 0)
            for folder, name in [("bev", "GT_SEG"), ("occupancy", "VOXEL-GRID")]:
                assert np.array_equal(np.load(scene / f"{folder}/{agent}.npz")[f"{frame:04d}.npy"], get(name))
    close(pq.read_table(scene / "sensors/vehicle_0/IMU.parquet").to_pylist()[0]["gyroscope_radps"], [-0.3, 0.4, 0.5], 0)
    about = json.loads(pq.read_metadata(scene / "sensors/vehicle_0/RGB-CAM_FRONT.parquet").metadata[b"sensor"])
    assert (about["width"], about["height"]) == (16, 8)
    close(np.linalg.norm(about["agent_from_sensor"]["quaternion"]), 1.0)


class Evil:
    def __reduce__(self):
        return os.system, ("touch " + str(FOLDER / "owned"),)


def listed(protocol=3, **more):
    """A file of one box with something changed."""
    array = np.empty(1, object)
    array[0] = {**boxes(0, "vehicle_0")[0], **more}
    return npy(array, protocol)


def header():
    array = np.empty(1, object)
    return npy(array, 3)[:128]


def bomb():
    """Lists that hold one another, ten times each."""
    value = ["x" * 100]
    for _ in range(12):
        value = [value] * 10
    return listed(attributes={}, sign_type=value)


def faults(top):
    """What is broken, and what the error must say. Each gets the folder `simbev2x` of its own copy."""
    stem = "SimBEV2X-scene-0003-frame-0001-vehicle-0000"
    det = f"ground-truth/vehicle-0/det/{stem}-GT_DET.bin"
    lidar, grid = f"sweeps/vehicle-0/LIDAR/{stem}-LIDAR.npz", f"sweeps/vehicle-0/VOXEL-GRID/{stem}-VOXEL-GRID.npz"
    masks = f"ground-truth/vehicle-0/seg/{stem}-GT_SEG.npz"
    good = (top / det).read_bytes()
    nan = np.array([0.0, math.nan, 0.0])
    deep = {}
    for _ in range(200):
        deep = {"a": deep}
    broken = np.array([[1, 2, math.inf]], "f4")
    zeros = np.zeros((4096, 4096, 4), np.uint8)
    lying = bytearray(npz(np.zeros((50, 3), "<f4")))
    lying[-22 - 60:-22] = bytes(60)
    cases = [
        (det, listed(evil=Evil()), "posix.system"), (det, npy(np.array([Evil()], object), 4), "posix.system"),
        (det, listed(evil=io.BytesIO()), "_io"), (det, listed(evil=np.datetime64("2020")), "elements of type `M8`"),
        (det, good[:-1], "ends early"), (det, good[:200], "ends early"), (det, b"", "no NPY file"), (det, good + b"x", "behind the end"),
        (det, header() + b"\x80\x03" + b"(" * 1000 + b".", "marks"), (det, bomb(), "far more comes out of it"),
        (det, header() + b"\x80\x03]q\x00h\x00a.", "hold themselves"), (det, listed(deep=deep), "nested too deep"),
        (det, header() + b"\x80\x03B\xff\xff\xff\xff.", "ends early"), (det, listed(rotation=nan), "`rotation`"),
        (det, listed(bounding_box=np.zeros((8, 2))), "`bounding_box`"), (det, listed(semantic_tags=[99]), "`semantic_tags`"),
        (det, listed(semantic_tags=[1]), "`semantic_tags`"), (det, listed(id="7"), "`id`"), (det, npy(np.zeros(3), None), "no list"),
        (lidar, npz(broken), "row 0 holds inf"), (lidar, npz(np.zeros((5, 4), "f4")), "expected n x 3"),
        (lidar, (top / lidar).read_bytes()[:-30], lidar), (lidar, bytes(lying), lidar), (lidar, b"PK", lidar),
        (grid, npz(zeros), "has 67108992 bytes, the limit is"), (grid, npz(np.full((16, 16, 8), 40, np.uint8)), "tag 40"),
        (grid, npz(np.zeros((16, 16, 8), "<u2")), grid), (masks, npz(np.zeros((14, 10, 10), bool)), "expected [14, 20, 20]"),
        (f"sweeps/vehicle-0/IST-CAM_FRONT/{stem}-IST-CAM_FRONT.png", b"\x89PNG\r\n", "no PNG"),
        (f"sweeps/vehicle-0/RGB-CAM_FRONT/{stem}-RGB-CAM_FRONT.jpg", b"GIF89a", "no JPEG"),
        (f"sweeps/vehicle-0/GNSS/{stem}-GNSS.bin", npy(nan), "no number"),
        (f"ground-truth/vehicle-0/hd_map/{stem}-HD_MAP.json", b"[" * 100_000, "nested too deep"),
        (f"ground-truth/vehicle-0/hd_map/{stem}-HD_MAP.json", b"{}", "`transform`"), (lidar, None, lidar),
    ]
    for path, data, want in cases:
        def break_it(root, path=path, data=data):
            (root / path).unlink()
            if data is not None:
                (root / path).write_bytes(data)
        yield f"{path.split('-')[-1]} {want}", break_it, want
    infos = "infos/simbev2x_infos_val.json"
    text = (top / infos).read_text()
    for old, new, want in [
        ("/dataset/simbev2x/" + lidar, "/dataset/simbev2x/../../secret", "leads out"), ("/dataset/simbev2x/" + lidar, "/etc/passwd", "no file below"),
        ('"scene": 3', '"scene": 4', "another scene"), ('"map": "Town10HD",', "", "`map`"), ('"fog_density": 17.0', '"fog_density": NaN', "`fog_density`"),
        ('"rsu_0": [', '"rsu_1": [', "rsu_1"), ('"rsu_0": [', '"tram_0": [', "tram_0"), (text[-40:], "", "ends early"),
        ('"voxel_size": 0.5', '"voxel_size": 1e-9', "voxel"), ('"scene_0003"', '"scene_99999999999"', "no name of a scene"),
    ]:
        assert old in text, old
        yield f"infos {want}", lambda root, old=old, new=new: (root / infos).write_text(text.replace(old, new, 1)), want

    def link(root):
        (root / lidar).unlink()
        (root / lidar).symlink_to("/etc/passwd")
    yield "a link", link, "link that leads out"


def main():
    good = FOLDER / "good"
    wanted = dataset(good)
    code, said = run(good, FOLDER / "store")
    assert code == 0 and "1 scenes imported" in said, said
    check_store(FOLDER / "store", wanted)
    code, said = run(good / "simbev2x", FOLDER / "store", "--threads", "1")
    assert code == 0 and "0 scenes imported, 1 kept" in said, said
    for protocol in (2, 3, 4, 5):
        # Lists of any protocol say the same.
        shutil.rmtree(FOLDER / "other", ignore_errors=True)
        for frame in range(FRAMES):
            for agent in ["vehicle-0", "rsu-0"]:
                array = np.empty(5, object)
                array[:] = boxes(frame, agent.replace("-", "_"))
                name = f"SimBEV2X-scene-0003-frame-{frame:04d}-{agent.split('-')[0]}-0000-GT_DET.bin"
                (good / f"simbev2x/ground-truth/{agent}/det/{name}").write_bytes(npy(array, protocol))
        code, said = run(good, FOLDER / "other")
        if protocol == 2:
            # Bytes are texts there, made bytes by a call: told, not guessed.
            assert code == 1 and "_codecs.encode" in said, said
        elif protocol == 5 and code == 1:
            assert "not known here" in said, said
        else:
            assert code == 0, said
            one, two = (pq.read_table(FOLDER / f"{name}/scenes/0003/boxes.parquet") for name in ("store", "other"))
            assert one.equals(two), protocol
    array = None
    dataset_again = dataset(good, 3)
    assert dataset_again.keys() == wanted.keys()
    count = 0
    for name, break_it, want in list(faults(good / "simbev2x")):
        root, store = FOLDER / "bad", FOLDER / "bad-store"
        for path in (root, store):
            shutil.rmtree(path, ignore_errors=True)
        shutil.copytree(good, root)
        break_it(root / "simbev2x")
        code, said = run(root, store)
        assert code in (1, 2) and want in said and "panicked" not in said, (name, code, said)
        assert not (store / "scenes/0003/_manifests/simulate-and-log.json").exists() or not any(
            (store / f"scenes/0003/_manifests/{stage}.json").exists() for stage in ["occupancy-gt"]), name
        count += 1
    assert not (FOLDER / "owned").exists(), "a pickle was run"
    print(f"imported, {count} broken datasets refused")


main()
