"""Reads the info files of an export in nuScenes' layout as mmdet3d does, and holds them against its tables and points.

Usage: python3 infos.py EXPORT
"""

import json
import pathlib
import pickle
import re
import sys
import types

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


CONFIGS = pathlib.Path(__file__).resolve().parents[2] / "configs/trainers/mmdet3d"


def configuration(name, **variables):
    """What a configuration of ours says by itself, with variables of the environment put in as mmengine does."""
    text = (CONFIGS / f"{name}.py").read_text()
    text = re.sub(r"\{\{\$(\w+):(.*?)\}\}", lambda found: str(variables.get(found[1], found[2])), text)
    said = {}
    exec(compile(text, name, "exec"), said)
    return types.SimpleNamespace(**said)


def check_configurations():
    """Configurations of ours: their classes, the files that they name, grids that fit the strides of their models."""
    for variables in ({}, {"CONVOY_REACH_M": 25.6, "CONVOY_CELL_M": 0.4, "CONVOY_EXPORT": "/data", "CONVOY_SWEEPS": 9}):
        data = configuration("data", **variables)
        assert set(data.class_names) | {"construction_vehicle"} == set(CLASSES) and len(data.class_names) == 9
        assert data.train_dataloader["dataset"]["ann_file"] == "infos/mmdet3d_train.pkl"
        assert data.val_evaluator["ann_file"] == data.data_root + data.val_dataloader["dataset"]["ann_file"]
        assert data.data_root == f"{variables.get('CONVOY_EXPORT', 'export')}/"
        for loader in (data.train_dataloader, data.val_dataloader):
            kinds = {step["type"]: step for step in loader["dataset"]["pipeline"]}
            assert kinds["LoadPointsFromFile"]["load_dim"] == 5, "a point is x, y, z, intensity, ring"
            assert kinds["LoadPointsFromMultiSweeps"]["sweeps_num"] == variables.get("CONVOY_SWEEPS", 0)
            assert kinds["PointsRangeFilter"]["point_cloud_range"] == data.point_cloud_range
        for name in ("centerpoint", "pointpillars"):
            ours = configuration(name, **variables)
            model = ours.model
            assert ours.point_cloud_range == data.point_cloud_range
            low, high = np.array(ours.point_cloud_range).reshape(2, 3)
            cells = (high - low) / ours.voxel_size
            assert np.allclose(cells, np.round(cells)) and np.round(cells[2]) == 1, "pillars"
            shape = [round(count) for count in cells[:2]]
            assert list(model["pts_middle_encoder"]["output_shape"]) == shape and all(count % 8 == 0 for count in shape)
            for part in (model["data_preprocessor"]["voxel_layer"], model["pts_voxel_encoder"]):
                assert part["point_cloud_range"] == ours.point_cloud_range and part["voxel_size"] == ours.voxel_size
            head = model["pts_bbox_head"]
            if name == "centerpoint":
                # The n-th label is the n-th class of all tasks one after another.
                assert [found for task in head["tasks"] for found in task["class_names"]] == data.class_names
                assert all(task["num_class"] == len(task["class_names"]) for task in head["tasks"])
                assert model["train_cfg"]["pts"]["grid_size"] == [*shape, 1]
                for coder in (head["bbox_coder"], model["test_cfg"]["pts"]):
                    assert coder["pc_range"] == ours.point_cloud_range[:2] and coder["voxel_size"] == ours.voxel_size[:2]
            else:
                assert head["num_classes"] == len(data.class_names)
                x0, y0, _, x1, y1, _ = head["anchor_generator"]["ranges"][0]
                assert [x0, y0, x1, y1] == [*low[:2], *high[:2]], "anchors are where the grid is"
    # Any other configuration: datasets and metrics at any depth, without what an export has not.
    sys.modules["mmengine"] = types.SimpleNamespace(Config=None)
    said = {}
    exec(compile((CONFIGS / "adapt.py").read_text(), "adapt", "exec"), said)
    inner = {"type": "NuScenesDataset", "data_root": "data/", "ann_file": "x", "pipeline": [{"type": "A", "db_sampler": {}}, {"type": "B"}]}
    stock = {
        "train_dataloader": {"dataset": {"type": "CBGSDataset", "dataset": inner}},
        "val_dataloader": {"dataset": inner},
        "val_evaluator": [{"type": "NuScenesMetric", "data_root": "data/", "ann_file": "y"}],
        "lr": 0.1,
    }
    made = said["adapted"](stock, "/e", "val", "results")
    train, val = (made[f"{split}_dataloader"]["dataset"] for split in ("train", "val"))
    assert train == {**inner, "data_root": "/e/", "ann_file": "infos/mmdet3d_train.pkl", "pipeline": [{"type": "B"}]}
    assert val["ann_file"] == "infos/mmdet3d_val.pkl" and made["lr"] == 0.1
    assert made["val_evaluator"][0] == {
        "type": "NuScenesMetric", "data_root": "/e/", "ann_file": "/e/infos/mmdet3d_val.pkl", "format_only": True,
        "jsonfile_prefix": "results",
    }  # fmt: skip


def main():
    check_configurations()
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
