"""Reads the info files of an export in nuScenes' layout as mmdet3d does, and holds them against its tables and points.

Usage: python3 infos.py EXPORT
"""

import json
import pathlib
import pickle
import sys

import numpy as np

CLASSES = ["car", "truck", "trailer", "bus", "construction_vehicle", "bicycle", "motorcycle", "pedestrian", "traffic_cone", "barrier"]


def matrix(rotation, translation):
    w, x, y, z = np.array(rotation) / np.linalg.norm(rotation)
    m = np.eye(4)
    m[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    m[:3, 3] = translation
    return m


def tables(folder):
    read = lambda name: {row["token"]: row for row in json.loads((folder / f"{name}.json").read_text())}
    return {name: read(name) for name in ("sample", "sample_data", "calibrated_sensor", "ego_pose", "sample_annotation")}


def main():
    root = pathlib.Path(sys.argv[1])
    all_tables = {}
    for folder in root.glob("*/sample.json"):
        for name, rows in tables(folder.parent).items():
            all_tables.setdefault(name, {}).update(rows)
    data, poses = all_tables["sample_data"], all_tables["ego_pose"]
    mounts, annotations = all_tables["calibrated_sensor"], all_tables["sample_annotation"]
    by_sample = {}
    for row in annotations.values():
        by_sample.setdefault(row["sample_token"], []).append(row)

    def sensor_in_global(reading):
        pose, mount = poses[reading["ego_pose_token"]], mounts[reading["calibrated_sensor_token"]]
        return matrix(pose["rotation"], pose["translation"]) @ matrix(mount["rotation"], mount["translation"])

    lidar_of = {r["sample_token"]: r for r in data.values() if r["is_key_frame"] and "/LIDAR_TOP/" in r["filename"]}
    paths = sorted(root.glob("infos/mmdet3d_*.pkl"))
    current = [path for path in paths if "_0x_" not in path.name]
    assert current and len(current) * 2 == len(paths), paths
    seen, on_points, boxes, sweeps_seen, cameras = 0, 0, 0, 0, 0
    for path in current:
        new = pickle.loads(path.read_bytes())
        old = pickle.loads((path.parent / path.name.replace("mmdet3d_", "mmdet3d_0x_")).read_bytes())
        assert list(new["metainfo"]["categories"]) == CLASSES and old["metadata"]["version"] == new["metainfo"]["version"]
        assert len(new["data_list"]) == len(old["infos"]) > 0
        for number, (one, other) in enumerate(zip(new["data_list"], old["infos"])):
            seen += 1
            assert one["sample_idx"] == number and one["token"] == other["token"]
            lidar = lidar_of[one["token"]]
            global_from_lidar = sensor_in_global(lidar)
            ours = np.array(one["ego2global"]) @ np.array(one["lidar_points"]["lidar2ego"])
            assert np.abs(ours - global_from_lidar).max() < 1e-6
            theirs = matrix(other["ego2global_rotation"], other["ego2global_translation"])
            theirs = theirs @ matrix(other["lidar2ego_rotation"], other["lidar2ego_translation"])
            assert np.abs(theirs - global_from_lidar).max() < 1e-6
            assert other["lidar_path"] == lidar["filename"] and other["timestamp"] == lidar["timestamp"]
            assert root / "samples/LIDAR_TOP" / one["lidar_points"]["lidar_path"] == root / lidar["filename"]
            points = np.fromfile(root / lidar["filename"], np.float32).reshape(-1, one["lidar_points"]["num_pts_feats"])[:, :3]

            # Boxes: each annotation is there, in the lidar's frame, and has its points within.
            wanted = {tuple(np.round(row["translation"], 3)): row for row in by_sample.get(one["token"], [])}
            instances = one["instances"]
            assert len(instances) == len(wanted) == len(other["gt_boxes"]) == len(other["gt_names"])
            for i, found in enumerate(instances):
                center, (length, width, height, yaw) = np.array(found["bbox_3d"][:3]), found["bbox_3d"][3:]
                at = (global_from_lidar @ np.append(center, 1))[:3]
                near = min(wanted.values(), key=lambda row: np.abs(np.array(row["translation"]) - at).max())
                assert np.abs(np.array(near["translation"]) - at).max() < 1e-3
                assert np.allclose([width, length, height], near["size"], atol=1e-6)
                ahead = (global_from_lidar[:3, :3] @ [np.cos(yaw), np.sin(yaw), 0])[:2]
                meant = matrix(near["rotation"], [0, 0, 0])[:2, 0]
                assert ahead @ meant / np.linalg.norm(ahead) / np.linalg.norm(meant) > 0.999
                assert found["bbox_3d_isvalid"] == bool(other["valid_flag"][i]) == (near["num_lidar_pts"] + near["num_radar_pts"] > 0)
                assert found["num_lidar_pts"] == other["num_lidar_pts"][i] == near["num_lidar_pts"]
                label = found["bbox_label_3d"]
                assert label == -1 or CLASSES[label] == other["gt_names"][i]
                assert np.allclose(other["gt_boxes"][i], [*center, width, length, height, -yaw - np.pi / 2], atol=1e-9)
                assert np.allclose(other["gt_velocity"][i], found["velocity"], equal_nan=True)
                if near["num_lidar_pts"] >= 20:
                    local = points - center
                    x, y = local[:, 0] * np.cos(yaw) + local[:, 1] * np.sin(yaw), local[:, 1] * np.cos(yaw) - local[:, 0] * np.sin(yaw)
                    inside = (np.abs(x) < length / 2 + 0.1) & (np.abs(y) < width / 2 + 0.1) & (np.abs(local[:, 2]) < height / 2 + 0.1)
                    boxes += 1
                    on_points += inside.sum() >= 10

            # Sweeps: moved into the key sweep they lie where the tables say, within 2 cm.
            assert len(one["lidar_sweeps"]) == len(other["sweeps"]) <= 10
            last = one["timestamp"]
            for sweep, before in zip(one["lidar_sweeps"], other["sweeps"]):
                reading = data[sweep["sample_data_token"]]
                assert reading["filename"] == sweep["lidar_points"]["lidar_path"] == before["data_path"]
                assert sweep["timestamp"] < last and abs(sweep["timestamp"] - reading["timestamp"] / 1e6) < 1e-6
                last = sweep["timestamp"]
                cloud = np.fromfile(root / reading["filename"], np.float32).reshape(-1, 5)[:, :3]
                moved = np.linalg.inv(global_from_lidar) @ sensor_in_global(reading)
                meant = cloud @ moved[:3, :3].T + moved[:3, 3]
                back = np.linalg.inv(np.array(sweep["lidar_points"]["lidar2sensor"]))
                assert np.abs(cloud @ back[:3, :3].T + back[:3, 3] - meant).max() < 0.02
                old_way = cloud @ before["sensor2lidar_rotation"].T + before["sensor2lidar_translation"]
                assert np.abs(old_way - meant).max() < 0.02
                sweeps_seen += 1

            # Cameras: the middle of the lidar's picture of a point is the tables' own.
            assert set(one["images"]) == set(other["cams"])
            for channel, camera in one["images"].items():
                reading = data[camera["sample_data_token"]]
                assert f"samples/{channel}/{camera['img_path']}" == reading["filename"] == other["cams"][channel]["data_path"]
                meant = np.linalg.inv(sensor_in_global(reading)) @ global_from_lidar
                assert np.abs(np.array(camera["lidar2cam"]) - meant).max() < 1e-6
                assert np.allclose(camera["cam2img"], mounts[reading["calibrated_sensor_token"]]["camera_intrinsic"])
                assert np.allclose(other["cams"][channel]["cam_intrinsic"], camera["cam2img"])
                cameras += 1
    assert seen == len(lidar_of), (seen, len(lidar_of))
    assert boxes == 0 or on_points >= 0.9 * boxes, (on_points, boxes)
    print(f"{seen} samples, {boxes} boxes with 20 points and more, {on_points} of them hold ten, {sweeps_seen} sweeps, {cameras} pictures")


main()
