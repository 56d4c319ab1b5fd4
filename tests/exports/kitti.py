"""Reads an export in KITTI's layout as the benchmarks' development kits describe it, and holds it against the store.

Usage: python3 kitti.py STORE EXPORT
Exit code 77: something could not be looked at.
"""

import io
import json
import pathlib
import sys

import numpy as np
import pyarrow.parquet as pq
from PIL import Image

try:
    import yaml
except ImportError:
    yaml = None

CONFIG = pathlib.Path(__file__).resolve().parents[2] / "configs/trainers/openpcdet/pointpillar.yaml"
KINDS = {"Car", "Van", "Truck", "Pedestrian", "Person_sitting", "Cyclist", "Misc"}


def calibration(path):
    """Key to numbers, with or without colons."""
    lines = [line.split() for line in path.read_text().splitlines() if line.strip()]
    return {line[0].rstrip(":"): np.array(line[1:], float) for line in lines}


def rigid(numbers):
    """4 x 4 of the 12 numbers of its upper rows."""
    return np.vstack([numbers.reshape(3, 4), [0, 0, 0, 1]])


def corners(label):
    """Corners of a label's box in the camera's frame, as the development kit computes them: 8 x 3."""
    h, w, l, x, y, z, ry = (float(v) for v in label[:7])
    xs = np.array([l, l, -l, -l, l, l, -l, -l]) / 2
    ys = np.array([0, 0, 0, 0, -h, -h, -h, -h])
    zs = np.array([w, -w, -w, w, w, -w, -w, w]) / 2
    turn = np.array([[np.cos(ry), 0, np.sin(ry)], [0, 1, 0], [-np.sin(ry), 0, np.cos(ry)]])
    return (turn @ np.vstack([xs, ys, zs])).T + [x, y, z]


def inside(points, label):
    """Which points (camera frame) are in a label's box."""
    h, w, l, x, y, z, ry = (float(v) for v in label[:7])
    turn = np.array([[np.cos(ry), 0, np.sin(ry)], [0, 1, 0], [-np.sin(ry), 0, np.cos(ry)]])
    own = (points - [x, y, z]) @ turn
    slack = 0.1
    return (abs(own[:, 0]) < l / 2 + slack) & (own[:, 1] < slack) & (own[:, 1] > -h - slack) & (abs(own[:, 2]) < w / 2 + slack)


def check_sequence(store, root, scene, frames):
    """A sequence of the tracking benchmark and its frames in the object benchmark."""
    agent = root.name
    sensors = store / f"scenes/{scene:04d}/sensors/{agent}"
    tracking, objects = root / "tracking/training", root / "object/training"
    cal = calibration(tracking / f"calib/{scene:04d}.txt")
    camera_from_lidar, k = rigid(cal["Tr_velo_cam"]), cal["P2"].reshape(3, 4)
    assert np.allclose(camera_from_lidar[:3, :3] @ camera_from_lidar[:3, :3].T, np.eye(3)), "no rotation"
    about = json.loads(pq.read_metadata(sensors / "RGB-CAM_FRONT.parquet").metadata[b"sensor"])
    assert np.allclose(k[:, :3], about["intrinsics"]) and np.allclose(k[:, 3], 0)
    lidar = pq.read_table(sensors / "LIDAR.parquet")
    rgb = pq.read_table(sensors / "RGB-CAM_FRONT.parquet")["image"]
    ist = sensors / "IST-CAM_FRONT.parquet"
    ist = pq.read_table(ist)["image"] if ist.exists() else None
    agents = pq.read_table(store / f"scenes/{scene:04d}/agents.parquet")
    rows = [row for row in agents.to_pylist() if row["agent"] == agent]
    table = pq.read_table(store / f"scenes/{scene:04d}/boxes.parquet").to_pylist()
    raw = {(row["frame"], row["id"]): row for row in table if row["agent"] == agent}

    tracked = [line.split() for line in (tracking / f"label_02/{scene:04d}.txt").read_text().splitlines()]
    points_in_boxes = points_of_boxes = 0
    on_mask = off_mask = 0
    for frame in range(frames):
        number = f"{1000 * scene + frame:06d}"
        image = tracking / f"image_02/{scene:04d}/{frame:06d}.png"
        assert image.read_bytes() == (objects / f"image_2/{number}.png").read_bytes()
        picture = np.asarray(Image.open(image))
        jpeg = np.asarray(Image.open(io.BytesIO(rgb[frame].as_py())).convert("RGB"))
        assert picture.shape == jpeg.shape and abs(picture.astype(int) - jpeg).mean() < 2, "another picture"
        sweep = tracking / f"velodyne/{scene:04d}/{frame:06d}.bin"
        assert sweep.read_bytes() == (objects / f"velodyne/{number}.bin").read_bytes()
        cloud = np.fromfile(sweep, np.float32).reshape(-1, 4)
        for column, name in enumerate(["x", "y", "z", "intensity"]):
            assert np.array_equal(cloud[:, column], np.array(lidar[name][frame].as_py(), np.float32)), name
        ids = np.array(lidar["id"][frame].as_py())
        points = cloud[:, :3] @ camera_from_lidar[:3, :3].T + camera_from_lidar[:3, 3]

        labels = [line.split() for line in (objects / f"label_2/{number}.txt").read_text().splitlines()]
        own = [line for line in tracked if int(line[0]) == frame]
        assert len(own) == len(labels)
        own_cal = calibration(objects / f"calib/{number}.txt")
        assert all(np.allclose(own_cal[key], cal[key]) for key in ["P0", "P1", "P2", "P3"])
        assert np.allclose(own_cal["Tr_velo_to_cam"], cal["Tr_velo_cam"]) and np.allclose(own_cal["R0_rect"].reshape(3, 3), np.eye(3))
        mask = np.asarray(Image.open(io.BytesIO(ist[frame].as_py()))).astype(int) if ist is not None else None
        for label, line in zip(labels, own):
            identity = int(line[1])
            assert len(label) == 15 and len(line) == 17 and label[0] in KINDS and label[0] == line[2]
            assert line[5:] == label[3:] and line[3] in "012" and line[4] == label[2] and label[2] in "0123"
            left, top, right, bottom = (float(v) for v in label[4:8])
            assert 0 <= left < right <= picture.shape[1] and 0 <= top < bottom <= picture.shape[0]
            box = [float(v) for v in label[8:15]]
            alpha, ry, x, z = float(label[3]), box[6], box[3], box[5]
            turn = (ry - np.arctan2(x, z) - alpha + np.pi) % (2 * np.pi) - np.pi
            assert abs(turn) < 1e-4 and z > 0, "alpha"
            # The same box as the store's: size, and place in the world by the agent's pose and the camera's.
            truth = raw[(frame, identity)]
            assert np.allclose([box[2], box[1], box[0]], truth["size_m"], atol=1e-3)
            w, xq, yq, zq = rows[frame]["quaternion"]
            turned = np.array(
                [
                    [1 - 2 * (yq * yq + zq * zq), 2 * (xq * yq - w * zq), 2 * (xq * zq + w * yq)],
                    [2 * (xq * yq + w * zq), 1 - 2 * (xq * xq + zq * zq), 2 * (yq * zq - w * xq)],
                    [2 * (xq * zq - w * yq), 2 * (yq * zq + w * xq), 1 - 2 * (xq * xq + yq * yq)],
                ]
            )
            lidar_from_agent = rigid(cal["Tr_imu_velo"])
            middle = np.array([x, box[4], z]) - [0, box[0] / 2, 0]
            in_agent = np.linalg.inv(camera_from_lidar @ lidar_from_agent) @ [*middle, 1]
            in_world = turned @ in_agent[:3] + rows[frame]["xyz_m"]
            assert np.linalg.norm(in_world - truth["center_m"]) < 0.25, (identity, in_world, truth["center_m"])
            ahead = np.array(truth["corners_m"]).reshape(8, 3)
            ahead = (ahead[4] - ahead[0]) @ turned
            ahead = camera_from_lidar[:3, :3] @ lidar_from_agent[:3, :3] @ ahead
            assert np.cos(ry) * ahead[0] - np.sin(ry) * ahead[2] > 0.99 * np.hypot(ahead[0], ahead[2]), "heading"
            # Points of the object lie in its box.
            hits = points[ids == identity]
            points_of_boxes += len(hits)
            points_in_boxes += int(inside(hits, box).sum())
            # The middle of its pixels lies within its projected corners.
            if mask is not None:
                seen = np.argwhere(mask[..., 1] + 256 * mask[..., 2] == identity)
                seen = seen[(seen[:, 1] >= left - 1) & (seen[:, 1] <= right)]
                ahead_of = corners(box)
                if len(seen) and (ahead_of[:, 2] > 0.1).all():
                    screen = ahead_of @ k[:, :3].T
                    screen = screen[:, :2] / screen[:, 2:]
                    within = (seen[:, ::-1] >= screen.min(0) - 2) & (seen[:, ::-1] <= screen.max(0) + 2)
                    on_mask += int(within.all(1).sum())
                    off_mask += int((~within.all(1)).sum())
    assert points_of_boxes == 0 or points_in_boxes > 0.9 * points_of_boxes, (points_in_boxes, points_of_boxes)
    assert on_mask > 9 * off_mask, (on_mask, off_mask)
    return len(tracked), points_of_boxes, on_mask


def check_configuration():
    """Our configuration of OpenPCDet: classes of the export, a grid and anchors that fit the strides of the model."""
    ours = yaml.safe_load(CONFIG.read_text())
    classes, data, head = ours["CLASS_NAMES"], ours["DATA_CONFIG"], ours["MODEL"]["DENSE_HEAD"]
    assert set(classes) == KINDS - {"Person_sitting", "Misc"}
    anchors = head["ANCHOR_GENERATOR_CONFIG"]
    assert [anchor["class_name"] for anchor in anchors] == classes
    sampled = data["DATA_AUGMENTOR"]["AUG_CONFIG_LIST"][0]
    for listed in (sampled["SAMPLE_GROUPS"], sampled["PREPARE"]["filter_by_min_points"]):
        assert [each.split(":")[0] for each in listed] == classes
    low, high = np.array(data["POINT_CLOUD_RANGE"]).reshape(2, 3)
    voxels = next(step for step in data["DATA_PROCESSOR"] if step["NAME"] == "transform_points_to_voxels")
    cells = (high - low) / voxels["VOXEL_SIZE"]
    assert np.allclose(cells, np.round(cells)) and round(cells[2]) == 1, "pillars"
    backbone = ours["MODEL"]["BACKBONE_2D"]
    strides, ups = np.cumprod(backbone["LAYER_STRIDES"]), backbone["UPSAMPLE_STRIDES"]
    assert all(round(count) % strides[-1] == 0 for count in cells[:2]), cells
    # All levels are brought to one size, which is that of the anchors' grid.
    assert {int(down / up) for down, up in zip(strides, ups)} == {anchor["feature_map_stride"] for anchor in anchors}
    assert data["POINT_FEATURE_ENCODING"]["src_feature_list"] == ["x", "y", "z", "intensity"]
    assert data["DATA_SPLIT"] == {"train": "train", "test": "val"}


def main(store, export):
    if yaml:
        check_configuration()
    looked = [0, 0, 0, 0]
    for root in sorted(p for p in export.iterdir() if not p.name.startswith(".")):
        for seqmap in sorted((root / "tracking").glob("evaluate_tracking.seqmap.*")):
            split = seqmap.name.rsplit(".", 1)[1]
            names = (root / f"object/ImageSets/{split}.txt").read_text().split()
            expected = []
            for line in seqmap.read_text().splitlines():
                scene, empty, first, frames = line.split()
                assert empty == "empty" and int(first) == 0
                expected += [f"{1000 * int(scene) + frame:06d}" for frame in range(int(frames))]
                found = check_sequence(store, root, int(scene), int(frames))
                looked = [a + b for a, b in zip(looked, [1, *found])]
            assert names == expected
    assert looked[0] > 0, "no sequence"
    if 0 in looked or not yaml:
        if not yaml:
            print("note: kitti: the configuration of OpenPCDet is not looked at (no PyYAML)")
        print(f"note: kitti: {looked} sequences, labels, points and pixels of them")
        return 77
    return 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])))
