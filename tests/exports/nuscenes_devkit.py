"""Opens an export in nuScenes' layout with nuscenes-devkit, draws what it can draw, and evaluates the targets as predictions, as they are
and disturbed. Of both, `convoy evaluate` must say the same to 1e-9 without an option given.

Usage: DEVKIT_PYTHON nuscenes_devkit.py EXPORT PICTURES STORE PROGRAM
PROGRAM: Convoy's program `evaluate`.
Wants nuscenes-devkit (pip), in an environment of its own: it needs a numpy before 2. Pictures are written for looking at.
Exit code 77: something could not be drawn, as the export has nothing of it.
"""

import json
import math
import pathlib
import subprocess
import sys

# Beside this file stands one of the package's name.
sys.path.pop(0)

import matplotlib  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from nuscenes import NuScenes  # noqa: E402
from nuscenes.eval.common.config import config_factory  # noqa: E402
from nuscenes.eval.detection.evaluate import DetectionEval  # noqa: E402
from nuscenes.eval.detection.utils import category_to_detection_name  # noqa: E402
from nuscenes.utils.data_classes import LidarPointCloud, RadarPointCloud  # noqa: E402

missing = []


def draw(nusc, pictures):
    """Each kind of picture of the first scene of the first vehicle that sees something."""
    scene = next((s for s in nusc.scene if "-vehicle_" in s["name"]), nusc.scene[0])
    sample = nusc.get("sample", nusc.get("sample", scene["first_sample_token"])["next"] or scene["first_sample_token"])
    named = lambda name: str(pictures / f"{nusc.version}-{name}.png")  # noqa: E731
    nusc.list_scenes()
    nusc.list_sample(sample["token"])
    nusc.render_sample(sample["token"], out_path=named("sample"), verbose=False)
    plt.close("all")
    lidar = sample["data"]["LIDAR_TOP"]
    nusc.render_sample_data(lidar, nsweeps=1, underlay_map=True, out_path=named("lidar-over-map"), verbose=False)
    if hasattr(nusc, "lidarseg"):
        nusc.render_sample_data(
            lidar, show_lidarseg=True, show_lidarseg_legend=True, underlay_map=False, out_path=named("lidarseg"), verbose=False
        )
    location = nusc.get("log", scene["log_token"])["location"]
    nusc.render_egoposes_on_map(log_location=location, out_path=named("map"))
    plt.close("all")
    if "CAM_FRONT" in sample["data"]:
        nusc.render_pointcloud_in_image(
            sample["token"], pointsensor_channel="LIDAR_TOP", camera_channel="CAM_FRONT", out_path=named("points-in-image"), verbose=False
        )
    radars = [channel for channel in sample["data"] if channel.startswith("RADAR_")]
    if radars:
        nusc.render_sample_data(sample["data"][radars[0]], out_path=named("radar"), underlay_map=False, verbose=False)
    # The annotation with most points that a camera shows.
    shown = set()
    for channel, token in sample["data"].items():
        if channel.startswith("CAM"):
            _, boxes, _ = nusc.get_sample_data(token)
            shown |= {box.token for box in boxes}
    if shown:
        best = max(shown, key=lambda token: nusc.get("sample_annotation", token)["num_lidar_pts"])
        nusc.render_annotation(best, out_path=named("annotation"))
    else:
        missing.append(f"{nusc.version}: no annotation in a picture")
    plt.close("all")
    return sample


def read_clouds(nusc, sample):
    """Clouds through the devkit, sweeps gathered over time where there are any."""
    for channel, token in sample["data"].items():
        path = nusc.get_sample_data_path(token)
        if channel.startswith("LIDAR"):
            assert LidarPointCloud.from_file(path).points.shape[0] == 4
            points, times = LidarPointCloud.from_file_multisweep(nusc, sample, channel, "LIDAR_TOP", nsweeps=5)
            assert points.points.shape[1] == times.shape[1]
        elif channel.startswith("RADAR"):
            assert RadarPointCloud.from_file(path).points.shape[0] == 18


def evaluate(nusc, split, folder, judge):
    """Targets as predictions: every class that has targets is found perfectly."""
    results, present = {}, set()
    config = config_factory("detection_cvpr_2019")
    names = set(json.loads((pathlib.Path(nusc.table_root) / "splits.json").read_text())[split])
    for sample in nusc.sample:
        if nusc.get("scene", sample["scene_token"])["name"] not in names:
            continue
        boxes = results[sample["token"]] = []
        ego = nusc.get("ego_pose", nusc.get("sample_data", sample["data"]["LIDAR_TOP"])["ego_pose_token"])["translation"]
        for token in sample["anns"]:
            target = nusc.get("sample_annotation", token)
            name = category_to_detection_name(target["category_name"])
            if name is None or target["num_lidar_pts"] + target["num_radar_pts"] == 0:
                continue
            if np.hypot(target["translation"][0] - ego[0], target["translation"][1] - ego[1]) < config.class_range[name]:
                present.add(name)
            velocity = np.nan_to_num(nusc.box_velocity(token)[:2])
            attributes = [nusc.get("attribute", a)["name"] for a in target["attribute_tokens"]]
            boxes.append(
                {
                    "sample_token": sample["token"],
                    "translation": target["translation"],
                    "size": target["size"],
                    "rotation": target["rotation"],
                    "velocity": velocity.tolist(),
                    "detection_name": name,
                    "detection_score": 0.5,
                    "attribute_name": attributes[0] if attributes else "",
                }
            )
    folder.mkdir(parents=True, exist_ok=True)
    metrics = held(nusc, split, results, folder, f"{nusc.version}-{split}", judge)
    found = metrics["mean_dist_aps"]
    for name, precision in found.items():
        assert abs(precision - (name in present)) < 1e-9, f"AP of {name} is {precision}"
    assert present and abs(metrics["mean_ap"] - 0.1 * len(present)) < 1e-9
    errors = {k: round(v, 4) for k, v in metrics["tp_errors"].items()}
    print(f"{nusc.version} {split}: {len(results)} samples, AP 1 for {sorted(present)}, mAP {metrics['mean_ap']:.3f}, errors {errors}")
    for name in present:
        exact = metrics["label_tp_errors"][name]
        assert all(exact[k] < 1e-6 for k in ("trans_err", "scale_err")), (name, exact)
    metrics = held(nusc, split, disturbed(results), folder, f"{nusc.version}-{split}-disturbed", judge)
    print(f"{nusc.version} {split}, disturbed: mAP {metrics['mean_ap']:.4f}, the same by `evaluate`")


def disturbed(results):
    """Boxes moved, turned, scaled, some left out or said twice, with scores of which many are equal, wrong classes and attributes."""
    draw = np.random.default_rng(5)
    classes = sorted({box["detection_name"] for boxes in results.values() for box in boxes})
    attributes = {box["detection_name"]: box["attribute_name"] for boxes in results.values() for box in boxes}
    after = {}
    for token, boxes in sorted(results.items()):
        after[token] = []
        for box in boxes:
            for _ in range(int(draw.choice([0, 1, 1, 1, 2]))):
                yaw = float(draw.normal(0, 0.3))
                w, x, y, z = box["rotation"]
                cos, sin = math.cos(yaw / 2), math.sin(yaw / 2)
                name = box["detection_name"] if draw.random() < 0.9 else str(draw.choice(classes))
                after[token].append(
                    {
                        "sample_token": token,
                        "translation": (np.array(box["translation"]) + draw.normal(0, 0.7, 3)).tolist(),
                        "size": (np.array(box["size"]) * draw.uniform(0.8, 1.25, 3)).tolist(),
                        "rotation": [cos * w - sin * z, cos * x - sin * y, cos * y + sin * x, cos * z + sin * w],
                        "velocity": (np.array(box["velocity"]) + draw.normal(0, 1, 2)).tolist(),
                        "detection_name": name,
                        "detection_score": round(float(draw.random()), 1),
                        "attribute_name": attributes[name],
                    }
                )
    return after


def held(nusc, split, results, folder, name, judge):
    """What the devkit says of results; `evaluate` must say the same to 1e-9."""
    uses = {f"use_{what}": False for what in ("camera", "lidar", "radar", "map", "external")}
    path = folder / f"{name}.json"
    path.write_text(json.dumps({"meta": uses, "results": results}))
    config = config_factory("detection_cvpr_2019")
    metrics = DetectionEval(nusc, config, str(path), split, str(folder), verbose=False).main(plot_examples=0, render_curves=False)
    store, program = judge
    out = folder / f"{name}-ours.json"
    export = pathlib.Path(nusc.table_root)
    command = [program, "--predictions", path, "--nuscenes", export, "--store", store, "--metrics", "nuscenes", "--out", out]
    subprocess.run([str(word) for word in command], check=True, stdout=subprocess.DEVNULL)
    ours = {(row["class"], row["measure"], row["threshold"]): row["value"] for row in json.loads(out.read_text())}
    theirs = {("all", "mAP", None): metrics["mean_ap"], ("all", "NDS", None): metrics["nd_score"]}
    names = {"trans_err": "ATE", "scale_err": "ASE", "orient_err": "AOE", "vel_err": "AVE", "attr_err": "AAE"}
    for key, short in names.items():
        theirs["all", f"m{short}", None] = metrics["tp_errors"][key]
        for of, errors in metrics["label_tp_errors"].items():
            theirs[of, short, 2.0] = errors[key]
    for of, precisions in metrics["label_aps"].items():
        theirs |= {(of, "AP", float(at)): value for at, value in precisions.items()}
    wrong = []
    for key, value in theirs.items():
        own = ours[key]
        same = math.isnan(value) if own is None else abs(own - value) < 1e-9
        if not same:
            wrong.append(f"{key}: {value} by the devkit, {own} by evaluate")
    assert not wrong, f"{name}: {wrong}"
    assert len(theirs) > 90, "classes, distances and errors"
    return metrics


def main(export, pictures, judge):
    pictures.mkdir(parents=True, exist_ok=True)
    versions = sorted(path.parent.name for path in export.glob("*/category.json"))
    assert versions, "no version"
    for version in versions:
        nusc = NuScenes(version=version, dataroot=str(export), verbose=False)
        read_clouds(nusc, draw(nusc, pictures))
        for split in json.loads((export / version / "splits.json").read_text()):
            evaluate(nusc, split, pictures / "evaluation", judge)
    for what in missing:
        print(f"note: devkit: {what}")
    return 77 if missing else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), (sys.argv[3], sys.argv[4])))
