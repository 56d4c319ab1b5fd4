"""Reads an export in the layout of OPV2V or V2X-Real as their loaders are said to, and holds it against the store.

Poses are [x, y, z, roll, yaw, pitch] in a left-handed world (y to the other side), metres and degrees.

Usage: python3 opv2v.py STORE EXPORT
Exit code 77: something could not be looked at.
"""

import io
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import pyarrow.parquet as pq
from PIL import Image

try:
    import yaml
except ImportError:
    yaml = None

MIRROR = np.diag([1.0, -1.0, 1.0, 1.0])
FIRST = 10000
CARS = {"car", "truck", "bus"}
TYPES = {
    "car": {"Car"},
    "truck": {"Truck", "Van"},
    "bus": {"Bus"},
    "pedestrian": {"Pedestrian"},
    "motorcycle": {"Motorcycle", "MotorcyleRider"},
    "bicycle": {"BicycleRider"},
}
SPLITS = {"train": "train", "val": "validate", "test": "test"}
COUNTS = ("frames", "boxes", "points in boxes", "points of partners", "pixels on masks", "lit pixels", "depths",
          "pictures that stand in")
found = dict.fromkeys(COUNTS, 0)


def x_to_world(pose):
    """4 x 4 of a pose: turn by yaw about z, then nose up by pitch, then roll, all as the left-handed world has them."""
    x, y, z, roll, yaw, pitch = pose
    (cr, sr), (cy, sy), (cp, sp) = ((np.cos(a), np.sin(a)) for a in np.radians([roll, yaw, pitch]))
    about_z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    about_y = np.array([[cp, 0, -sp], [0, 1, 0], [sp, 0, cp]])
    about_x = np.array([[1, 0, 0], [0, cr, sr], [0, -sr, cr]])
    matrix = np.eye(4)
    matrix[:3, :3] = about_z @ about_y @ about_x
    matrix[:3, 3] = x, y, z
    return matrix


def rigid(translation, quaternion):
    """4 x 4 of a right-handed pose of the store: quaternion w, x, y, z."""
    w, x, y, z = quaternion
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, 3] = translation
    return matrix


def mounted(table):
    """agent_from_sensor and what a table says of its sensor."""
    about = json.loads(pq.read_metadata(table).metadata[b"sensor"])
    pose = about["agent_from_sensor"]
    return rigid(pose["translation"], pose["quaternion"]), about


def moved(matrix, points):
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def box_matrix(box):
    """World from box: the middle is location and center added, without a turn."""
    roll, yaw, pitch = box["angle"]
    return x_to_world([*np.add(box["location"], box["center"]), roll, yaw, pitch])


def box_corners(box):
    signs = np.array([[a, b, c] for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)], float)
    return moved(box_matrix(box), signs * box["extent"])


def inside(points, box, slack=0.1):
    own = moved(np.linalg.inv(box_matrix(box)), points)
    return (abs(own) <= np.array(box["extent"]) + slack).all(1)


def loaders_yaw(corners):
    """The heading of a box as loaders find it: the mean of four directions of edges, as numbers. Corners run rear to front."""
    ahead = corners[4:] - corners[:4]
    return np.degrees(np.arctan2(ahead[:, 1], ahead[:, 0]).mean())


def read_frame(stem):
    """What a frame says; text and numbers of both forms are the same."""
    twin = json.loads(stem.with_suffix(".json").read_text())
    twin["vehicles"] = {int(key): box for key, box in twin["vehicles"].items()}
    if yaml:
        text = stem.with_suffix(".yaml").read_text()
        assert yaml.safe_load(text) == twin, f"{stem}: yaml and json differ"
    return twin


def read_pcd(path):
    """Points and intensity, as open3d gives them: red over 255."""
    data = path.read_bytes()
    end = data.index(b"DATA binary\n") + len(b"DATA binary\n")
    header = dict(line.split(" ", 1) for line in data[:end].decode().splitlines() if line[0] != "#")
    assert header["FIELDS"] == "x y z rgb" and header["SIZE"] == "4 4 4 4" and header["TYPE"] in ("F F F U", "F F F F")
    assert header["WIDTH"] == header["POINTS"] and header["HEIGHT"] == "1"
    rows = np.frombuffer(data[end:], np.dtype([("xyz", "<f4", 3), ("rgb", "<u4")]))
    assert len(rows) == int(header["POINTS"])
    return rows["xyz"].astype(float), (rows["rgb"] >> 16 & 255) / 255.0, rows["rgb"] & 0xFFFF


def check_clouds(stem, hetero, sweep, variant):
    """A cloud is the store's, mirrored; thinned ones have every so manieth beam. Its points."""
    expected = np.stack([sweep["x"], -np.array(sweep["y"]), sweep["z"]], 1).astype(np.float32)
    intensity, ring = np.array(sweep["intensity"]), np.array(sweep["ring"])
    if variant == "V2X-Real":
        cloud = np.fromfile(stem.with_suffix(".bin"), np.float32).reshape(-1, 4)
        assert np.array_equal(cloud[:, :3], expected) and np.allclose(cloud[:, 3], intensity)
        return expected.astype(float)
    points, red, rest = read_pcd(stem.with_suffix(".pcd"))
    assert np.array_equal(points, expected) and abs(red - intensity).max(initial=0) <= 0.5 / 255 + 1e-6 and not rest.any()
    beams = ring.max(initial=0) + 1
    for wanted in (32, 16):
        step = max(1, round(beams / wanted))
        thinned, _, _ = read_pcd(hetero.with_name(f"{stem.name}_{wanted}.pcd"))
        assert np.array_equal(thinned, expected[ring % step == 0]), f"{stem}: every {step}th beam"
    return points


def picture_place(pose, points):
    """Row and column of world points in a picture from above around a pose; its yaw alone counts."""
    x, y, _, _, yaw, _ = pose
    away = points[:, :2] - [x, y]
    c, s = np.cos(np.radians(yaw)), np.sin(np.radians(yaw))
    ahead, right = away[:, 0] * c + away[:, 1] * s, -away[:, 0] * s + away[:, 1] * c
    return np.stack([128 - 2.56 * ahead, 128 + 2.56 * right], 1)


def check_above(stem, frame, truth, everybody, lanes):
    """The pictures from above: objects, roads and lane lines."""
    pictures = {}
    for path in stem.parent.glob(f"{stem.name}_bev_*.png"):
        picture = np.asarray(Image.open(path))
        assert picture.shape == (256, 256) and picture.dtype == np.uint8, path
        pictures[path.stem.split("_bev_")[1]] = picture > 0
    assert {"dynamic", "visibility", "visibility_corp"} <= pictures.keys()
    pose = frame["true_ego_pos"]
    by_pixels = truth["sees by pixels"]
    seen = {row["id"] for row in truth["valid"] if row["num_pixels" if by_pixels else "num_lidar_pts"] > 0}
    listed = {row["id"] for row in truth["valid"] if row["class"] in CARS and row["id"] != truth["id"]}
    drawn = {"dynamic": listed, "visibility": listed & seen, "visibility_corp": listed & everybody}
    middles = np.stack(np.meshgrid(np.arange(256) + 0.5, np.arange(256) + 0.5, indexing="ij"), -1).reshape(-1, 2)
    for kind, ids in drawn.items():
        allowed = np.zeros(256 * 256, bool)
        for row in truth["boxes"]:
            if row["id"] not in ids:
                continue
            corners = np.array(row["corners_m"]).reshape(8, 3) * [1, -1, 1]
            places = picture_place(pose, corners[[0, 2, 6, 4]])
            middle = places.mean(0)
            if (middle > 1).all() and (middle < 255).all():
                assert pictures[kind][int(middle[0]), int(middle[1])], (stem, kind, row["id"])
            along, across = places[3] - places[0], places[1] - places[0]
            u = (middles - places[0]) @ along / (along @ along)
            v = (middles - places[0]) @ across / (across @ across)
            slack_u, slack_v = 1 / np.hypot(*along), 1 / np.hypot(*across)
            allowed |= (u > -slack_u) & (u < 1 + slack_u) & (v > -slack_v) & (v < 1 + slack_v)
        assert not (pictures[kind].ravel() & ~allowed).any(), f"{stem}: {kind} has more than its objects"
        found["lit pixels"] += int(pictures[kind].sum())
    if truth["road"] is not None:
        road, cell_m, cells = truth["road"]
        # Rows of the store go from ahead to behind, columns from left to right, as the picture's.
        at = np.floor(cells / 2 - (128 - (np.arange(256) + 0.5)) / 2.56 / cell_m).astype(int)
        assert (pictures["static"] == road[np.ix_(at, at)]).mean() > 0.999, f"{stem}: static"
        found["lit pixels"] += int(pictures["static"].sum())
    else:
        assert "static" not in pictures
    near = np.zeros((258, 258), bool)
    places = picture_place(pose, lanes)
    places = places[((places >= 0) & (places < 256)).all(1)].astype(int)
    for row in range(3):
        for column in range(3):
            near[places[:, 0] + row, places[:, 1] + column] = True
    lane = pictures["lane"]
    assert not (lane & ~near[1:-1, 1:-1]).any(), f"{stem}: lane lines where there are none"
    grown = np.zeros((258, 258), bool)
    for row in range(3):
        for column in range(3):
            grown[row : row + 256, column : column + 256] |= lane
    share = grown[1:-1, 1:-1][places[:, 0], places[:, 1]].mean() if len(places) else 1.0
    assert share > truth["lanes drawn"], f"{stem}: {share} of the lane lines are there"
    found["lit pixels"] += int(lane.sum())


def lane_points(store, name):
    """Points every 10 cm on the boundaries of driven lanes outside of junctions, left-handed."""
    rows = pq.read_table(store / f"maps/{name}.vector.parquet").to_pylist()
    points = [np.zeros((0, 3))]
    for row in rows:
        if row["kind"] != "lane_boundary" or row["is_junction"]:
            continue
        if not any(rows[lane]["lane_type"] == "Driving" for lane in row["lanes"]):
            continue
        line = np.stack([row["x_m"], -np.array(row["y_m"]), row["z_m"]], 1)
        for a, b in zip(line[:-1], line[1:]):
            steps = max(2, int(np.linalg.norm(b - a) / 0.1))
            points.append(a + (b - a) * np.linspace(0, 1, steps)[:, None])
    return np.concatenate(points)


def check_cameras(stem, hetero, frame, index, tables, boxes, to_world, ids_seen):
    """Pictures, poses and intrinsics: boxes of all agents land on the instance images."""
    lidar = to_world
    for number, table in enumerate(tables):
        name = table.stem.removeprefix("RGB-")
        camera = frame[f"camera{number}"]
        picture = np.asarray(Image.open(stem.with_name(f"{stem.name}_camera{number}.png")))
        stored = pq.read_table(table)["image"][index].as_py()
        jpeg = np.asarray(Image.open(io.BytesIO(stored)).convert("RGB"))
        assert picture.shape == jpeg.shape and abs(picture.astype(int) - jpeg).mean() < 2, f"{stem}: another picture"
        _, about = mounted(table)
        k = np.array(camera["intrinsic"])
        assert np.allclose(k, about["intrinsics"], atol=1e-5)
        world_from_camera = x_to_world(camera["cords"])
        assert np.allclose(np.linalg.inv(world_from_camera) @ lidar, camera["extrinsic"], atol=1e-4), "extrinsic"
        # As HEAL does: forward, right, up of the camera become right, down, forward.
        turn = np.eye(4)
        turn[:3, :3] = [[0, 0, 1], [1, 0, 0], [0, -1, 0]]
        optical_from_lidar = np.linalg.inv(np.linalg.inv(lidar) @ world_from_camera @ turn)
        stored = table.with_name(f"DPT-{name}.parquet")
        if stored.exists() and hetero:
            depth = hetero.with_name(f"{stem.name}_depth{number}.png")
            code = np.asarray(Image.open(io.BytesIO(pq.read_table(stored)["image"][index].as_py()))).astype(int)
            metres = (code[..., 0] + 256 * code[..., 1] + 65536 * code[..., 2]) / (2**24 - 1) * 1000
            grey = np.asarray(Image.open(depth))
            assert grey.dtype == np.uint8 and abs(grey - np.minimum(metres, 255)).max() <= 0.5 + 1e-6, depth
            found["depths"] += 1
        ist = table.with_name(f"IST-{name}.parquet")
        if not ist.exists():
            continue
        mask = np.asarray(Image.open(io.BytesIO(pq.read_table(ist)["image"][index].as_py()))).astype(int)
        mask = mask[..., 1] + 256 * mask[..., 2]
        for key, box in boxes.items():
            shown = np.argwhere(mask == key - FIRST)
            screen = moved(optical_from_lidar @ np.linalg.inv(lidar), box_corners(box))
            if len(shown) < 12 or (screen[:, 2] < 0.3).any():
                continue
            screen = screen @ k.T
            screen = screen[:, :2] / screen[:, 2:]
            low, high = screen.min(0), screen.max(0)
            within = ((shown[:, ::-1] + 0.5 >= low - 2) & (shown[:, ::-1] + 0.5 <= high + 2)).all(1)
            ids_seen[0] += int(within.sum())
            ids_seen[1] += len(shown)


def check_stand_ins(stem, frame, variant, anybody_sees):
    """HEAL opens four pictures of every agent: black ones where others have some."""
    pictures = [stem.with_name(f"{stem.name}_camera{number}.png") for number in range(4)]
    if variant != "OPV2V" or not anybody_sees:
        assert "camera0" not in frame and not any(picture.exists() for picture in pictures)
        return
    for number, picture in enumerate(pictures):
        rgb = np.asarray(Image.open(picture))
        assert rgb.ndim == 3 and rgb.shape[2] == 3 and not rgb.any(), picture
        k = np.array(frame[f"camera{number}"]["intrinsic"])
        assert np.allclose(k[:2, 2], [rgb.shape[1] / 2, rgb.shape[0] / 2]), k
        world_from_camera = x_to_world(frame[f"camera{number}"]["cords"])
        world_from_lidar = x_to_world(frame["lidar_pose"])
        extrinsic = np.linalg.inv(world_from_camera) @ world_from_lidar
        assert np.allclose(extrinsic, frame[f"camera{number}"]["extrinsic"], atol=1e-4), picture
    found["pictures that stand in"] += 1


def cameras_of(sensors, about_four):
    """The tables of the cameras ahead, right, left and back: those of that name, or the nearest to where these look."""
    tables = sorted(sensors.glob("RGB-*.parquet"))
    by_name = [t for n in range(4) for t in tables if t.stem == f"RGB-camera{n}"]
    if len(by_name) == 4:
        return by_name
    chosen = []
    for wanted in about_four:
        def off(table):
            ahead = mounted(table)[0][:3, 2]
            return abs((np.degrees(np.arctan2(ahead[1], ahead[0])) - wanted + 180) % 360 - 180)
        near = [t for t in tables if t not in chosen and off(t) <= 60]
        if not near:
            return []
        chosen.append(min(near, key=off))
    return chosen


def check_scenario(store, root, folder, variant):
    scene = int(folder.name.removeprefix("scene_"))
    source = store / f"scenes/{scene:04d}"
    info = json.loads((source / "log/scene.json").read_text())
    assert folder.parent.name == SPLITS[info["split"]]
    for word in ("train", "test", "validate", "yaml", "OPV2V", "camera0.png"):
        assert word not in folder.name
    by_name = {FIRST + agent["id"]: agent for agent in info["agents"] if agent["agent"].startswith("vehicle")}
    names = sorted(path.name for path in folder.iterdir() if path.is_dir())
    rsus = [agent for agent in info["agents"] if agent["agent"].startswith("rsu")]
    assert [n for n in names if int(n) > 0 and int(n) < 80000] == sorted(str(n) for n in by_name), "every vehicle"
    rows = pq.read_table(source / "agents.parquet").to_pylist()
    at = {(row["agent"], row["frame"]): row for row in rows}
    if by_name and rsus:
        ego = by_name[min(by_name)]["agent"]
        middle = info["frames"] // 2
        place = lambda agent: np.array(at[agent, middle]["xyz_m"])
        rsus.sort(key=lambda rsu: np.linalg.norm(place(rsu["agent"]) - place(ego)))
    for number, rsu in enumerate(rsus if variant == "V2X-Real" else rsus[:1]):
        by_name[-1 - number] = rsu
    assert {int(name) for name in names if int(name) < 80000} == set(by_name), (names, by_name)
    # The ego is the first as text, after one RSU went to the end: a vehicle, whenever there is one.
    order = names[1:] + names[:1] if names[0].startswith("-") else names
    if variant == "OPV2V" and any(name > 0 for name in by_name):
        assert int(order[0]) == min(name for name in by_name if name > 0), order
    stems = {name: sorted(path.stem for path in (folder / name).glob("*.yaml")) for name in names}
    assert len({tuple(stem) for stem in stems.values()}) == 1, "all agents have the ego's frames"
    assert len({len(stem) for stem in stems[names[0]]}) == 1 and stems[names[0]], "names of one width"
    members = {name: agent for name, agent in by_name.items() if str(name) in names}

    valid_rows = pq.read_table(source / "boxes_valid.parquet").to_pylist()
    box_rows = pq.read_table(source / "boxes.parquet").to_pylist()
    labels = {}
    for row, valid in zip(box_rows, valid_rows):
        labels.setdefault((row["agent"], row["frame"]), []).append((row, valid))
    lanes = lane_points(store, info["map"])
    config = json.loads((store / "dataset.json").read_text())["config"]["bev"]
    listed_classes = CARS if variant == "OPV2V" else set(TYPES)
    static = {name: load_static(source, agent["agent"]) for name, agent in members.items()}
    anybody_sees = any(of["cameras"] for of in static.values())
    on_masks = [0, 0]
    # Every third frame and the last: what differs from frame to frame is where things are.
    for stem in sorted({*stems[names[0]][::3], stems[names[0]][-1]}):
        number = int(stem)
        frames = {name: read_frame(folder / str(name) / stem) for name in members}
        seen_by = {}
        for name, agent in members.items():
            rows = labels.get((agent["agent"], number), [])
            key = "num_pixels" if static[name]["by_pixels"] else "num_lidar_pts"
            seen_by[name] = {valid["id"] for _, valid in rows if valid[key] > 0}
        everybody = set().union(*seen_by.values())
        union = {}
        poses = {name: x_to_world(frame["lidar_pose"]) for name, frame in frames.items()}
        for name, frame in frames.items():
            agent, of = members[name]["agent"], static[name]
            row = at[agent, number]
            world_from_agent = rigid(row["xyz_m"], row["quaternion"])
            assert np.allclose(poses[name], MIRROR @ world_from_agent @ of["lidar mount"] @ MIRROR, atol=1e-5), "lidar_pose"
            assert np.allclose(x_to_world(frame["true_ego_pos"]), MIRROR @ world_from_agent @ MIRROR, atol=1e-5)
            speed = 0 if name < 0 else 3.6 * np.linalg.norm(row["velocity_mps"])
            assert abs(frame["ego_speed"] - speed) < 1e-5 and frame["RSU"] == (name < 0)
            rows = labels.get((agent, number), [])
            expected = {
                FIRST + raw["id"]: raw
                for raw, valid in rows
                if raw["class"] in listed_classes and valid["num_lidar_pts"] > 0 and raw["id"] != members[name]["id"]
            }
            assert set(frame["vehicles"]) == set(expected), f"{stem} of {name}: other objects"
            for key, box in frame["vehicles"].items():
                raw = expected[key]
                corners = np.array(raw["corners_m"]).reshape(8, 3) * [1, -1, 1]
                ours = box_corners(box)
                # Both run rear to front, left to right, bottom to top.
                assert np.allclose(ours, corners, atol=1e-4), f"{stem}: box {key}"
                assert abs(box["speed"] - 3.6 * np.linalg.norm(raw["velocity_mps"])) < 1e-3
                assert np.allclose(np.add(box["location"], box["center"]) * [1, -1, 1], raw["center_m"], atol=1e-5)
                foot = corners[[0, 2, 4, 6]].mean(0)
                assert np.allclose(box["location"], foot, atol=1e-5), "location is the footprint's middle"
                if variant == "V2X-Real":
                    assert box["obj_type"] in TYPES[raw["class"]], box
                assert key not in union or np.allclose(box_corners(union[key]), ours, atol=1e-6), "one object, two boxes"
                union[key] = box
                # Averaged directions of edges are the heading, whoever the ego is.
                for other in poses.values():
                    in_lidar = moved(np.linalg.inv(other), ours)
                    ahead = in_lidar[4:].mean(0) - in_lidar[:4].mean(0)
                    error = loaders_yaw(in_lidar) - np.degrees(np.arctan2(ahead[1], ahead[0]))
                    assert abs((error + 180) % 360 - 180) < 1e-6, f"{stem}: box {key} is turned round for loaders"
                found["boxes"] += 1
        ego = poses[int(order[0])]
        for name, frame in frames.items():
            of = static[name]
            agent, path = members[name]["agent"], folder / str(name) / stem
            hetero = None
            if variant == "OPV2V":
                hetero = root / "OPV2V_Hetero" / folder.parent.name / folder.name / str(name) / stem
            index = number // of["lidar every"]
            sweep = {column: of["lidar"][column][index].as_py() for column in of["lidar"].column_names}
            points = check_clouds(path, hetero, sweep, variant)
            # Points in the ego's frame against boxes in the ego's frame.
            hit, in_ego = np.array(sweep["id"]), moved(np.linalg.inv(ego) @ poses[name], points)
            for key, box in union.items():
                own = in_ego[hit == key - FIRST]
                if len(own):
                    found["points in boxes"] += int(inside(moved(ego, own), box).sum())
                    of["points"][0] += int(inside(moved(ego, own), box).sum())
                    of["points"][1] += len(own)
                    found["points of partners"] += len(own) if name != int(order[0]) else 0
            truth = {
                "id": members[name]["id"],
                "valid": [valid for _, valid in labels.get((agent, number), [])],
                "boxes": [raw for raw, _ in labels.get((agent, number), [])],
                "sees by pixels": of["by_pixels"],
                "road": None,
                "lanes drawn": 0.8,
            }
            if of["bev"] is not None and number % config["every_n_frames"] == 0:
                masks = of["bev"][f"{number:04d}"]
                truth["road"] = (masks[config["classes"].index("road")], config["cell_m"], config["cells"])
            if variant == "OPV2V":
                check_above(path, frame, truth, everybody, lanes)
            if of["cameras"]:
                index = number // of["camera every"]
                check_cameras(path, hetero, frame, index, of["cameras"], union, poses[name], on_masks)
            else:
                check_stand_ins(path, frame, variant, anybody_sees)
            ahead = frame["plan_trajectory"]
            if name > 0 and ahead:
                later = at[agent, number + (int(stems[names[0]][1]) - int(stems[names[0]][0]))]
                assert np.allclose(ahead[0][:2], [later["xyz_m"][0], -later["xyz_m"][1]], atol=1e-5)
            found["frames"] += 1
    for name, of in static.items():
        inside_, all_ = of["points"]
        assert inside_ > 0.97 * all_, f"{folder.name} {name}: {inside_} of {all_} points are in their boxes"
    assert on_masks[0] >= 0.97 * on_masks[1], f"{folder.name}: {on_masks} pixels of masks are where boxes are"
    found["pixels on masks"] += on_masks[0]


def load_static(source, agent):
    """What does not change over a scene."""
    sensors = source / "sensors" / agent
    lidar = sensors / "LIDAR.parquet"
    mount, about = mounted(lidar)
    cameras = cameras_of(sensors, (0, -100, 100, 180))
    bev = source / f"bev/{agent}.npz"
    return {
        "lidar": pq.read_table(lidar, columns=["x", "y", "z", "intensity", "ring", "id"]),
        "lidar mount": mount,
        "lidar every": about.get("every_n_frames", 1),
        "cameras": cameras,
        "camera every": mounted(cameras[0])[1].get("every_n_frames", 1) if cameras else 1,
        "by_pixels": any(sensors.glob("IST-*.parquet")),
        "bev": np.load(bev) if bev.exists() else None,
        "points": [0, 0],
    }


STOCK = """
root_dir: 'elsewhere/train'
train_params: {batch_size: 2, max_cav: &max_cav 3}
preprocess:
  args: {voxel_size: &voxel_size [0.4, 0.4, 4], max_voxel_train: 32000}
  cav_lidar_range: &range [-140.8, -40, -3, 140.8, 40, 1]
postprocess: {anchor_args: {cav_lidar_range: *range, l: 3.9}, max_num: 100, gt_range: *range}
model: {args: {voxel_size: *voxel_size, lidar_range: *range, max_cav: *max_cav}}
optimizer: {args: {eps: 1e-10}}
fusion: {args: {data_aug_conf: {final_dim: [360, 480], H: 600, W: 800}}}
heter: {assignment_path: "opencood/logs/heter.json"}
"""


def check_hypes(export, variant):
    """Our values stand wherever a trainer's file says such a thing."""
    with tempfile.TemporaryDirectory() as folder:
        stock, ours = pathlib.Path(folder, "stock.yaml"), pathlib.Path(folder, "ours.yaml")

        def adapt(text, *args):
            stock.write_text(text)
            command = [sys.executable, export / "hypes/adapt_hypes.py", stock, ours, *args]
            return subprocess.run(command, capture_output=True, text=True, check=False)

        # Cells that the strides of a model no longer fit, and keys that are not there, are refused.
        for text, args, told in (
            (STOCK.replace("[0.4, 0.4, 4]", "[0.5, 0.5, 4]"), [], "307.2 cells along y, where 160 were"),
            (STOCK, ["--set", "train_params.batchsize=1"], "no such key"),
        ):
            refused = adapt(text, *args)
            assert refused.returncode == 1 and told in refused.stderr and not ours.exists(), refused
        done = adapt(STOCK, "--set", "train_params.batch_size=1")
        assert done.returncode == 0, done.stderr
        assert "train_params.batch_size: 2 -> 1\n" in done.stdout and "has no validate_dir" in done.stderr, done
        made = yaml.safe_load(ours.read_text())
    assert made["train_params"]["batch_size"] == 1
    z = [-3, 5] if variant == "OPV2V" else [-3, 1]
    expected = [-140.8, -76.8, z[0], 140.8, 76.8, z[1]]
    assert made["root_dir"] == str(export.resolve() / variant / "train")
    for place in (made["preprocess"]["cav_lidar_range"], made["postprocess"]["anchor_args"]["cav_lidar_range"]):
        assert place == expected, place
    assert made["model"]["args"]["lidar_range"] == expected and made["postprocess"]["gt_range"] == expected
    assert made["model"]["args"]["voxel_size"] == [0.4, 0.4, z[1] - z[0]] == made["preprocess"]["args"]["voxel_size"]
    assert made["postprocess"]["max_num"] >= 300 and made["train_params"]["max_cav"] >= 5
    assert made["model"]["args"]["max_cav"] == made["train_params"]["max_cav"]
    assert made["optimizer"]["args"]["eps"] == 1e-10 and made["preprocess"]["args"]["max_voxel_train"] == 32000
    values = yaml.safe_load((export / "hypes/values.yaml").read_text())
    size = made["fusion"]["args"]["data_aug_conf"]
    assert (size["W"], size["H"]) == (values.get("camera_width", 800), values.get("camera_height", 600))
    if variant == "OPV2V":
        assert pathlib.Path(made["heter"]["assignment_path"]).is_file()


def main(store, export):
    variant = "OPV2V" if (export / "OPV2V").is_dir() else "V2X-Real"
    root = export / variant
    assigned = {}
    for folder in sorted(root.glob("*/*")):
        assert folder.parent.name in SPLITS.values(), folder
        assert [path.name for path in folder.iterdir() if path.is_file()] == ["data_protocol.yaml"]
        check_scenario(store, export, folder, variant)
        assigned[folder.name] = {path.name for path in folder.iterdir() if path.is_dir()}
    assert assigned, "no scenario"
    if variant == "OPV2V":
        kinds = json.loads((export / "heter_modality_assign.json").read_text())
        assert {scene: set(agents) for scene, agents in kinds.items()} == assigned
        assert {kind for agents in kinds.values() for kind in agents.values()} <= {"m1", "m2", "m3", "m4"}
        for agents in kinds.values():
            vehicles = [name for name in agents if 0 < int(name) < 80000]
            assert list(agents)[: len(vehicles)] == sorted(vehicles, key=int), "vehicles first"
            assert not vehicles or agents[vehicles[0]] == "m1"
    unseen = [what for what, count in found.items() if count == 0 and not (variant == "V2X-Real" and what in COUNTS[5:])]
    if yaml:
        check_hypes(export, variant)
    else:
        unseen.append("YAML (no PyYAML)")
    print(f"{variant}: {found}")
    if unseen:
        print(f"note: {variant}: not looked at: {', '.join(unseen)}")
        return 77
    return 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])))
