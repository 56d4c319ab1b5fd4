"""Writes golden/cases.json, golden/nuscenes.json and golden/simbev2x.json.

    golden.py cases            random cases (numpy alone)
    golden.py nuscenes         their scores by nuscenes-devkit's own algorithms (1.2.0, numpy 1.26)
    golden.py simbev2x [FILE]  their scores by the implementation below, which is written from the definition of SimBEV2X's
                               metrics and shares nothing with the Rust one (numpy alone)

A box is [class, x, y, z, length, width, height, yaw, vx, vy, score or level, attribute or -1]; null is NaN. Coarse numbers make ties
of scores; there are classes without targets, without predictions, with one target, and predictions that come twice.
"""

import json
import math
import os
import sys

import numpy as np

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "golden")
NUSCENES = ["car", "truck", "bus", "trailer", "construction_vehicle", "pedestrian", "motorcycle", "bicycle", "traffic_cone", "barrier"]
ATTRIBUTES = ["vehicle.moving", "vehicle.parked", "pedestrian.moving"]
THRESHOLDS = [0.5, 1.0, 2.0, 4.0]


def load(name):
    with open(os.path.join(FOLDER, name)) as file:
        return json.load(file)


def save(path, value):
    with open(path, "w") as file:
        json.dump(value, file, separators=(",", ":"))
        file.write("\n")


def clean(value):
    return None if value is None or math.isnan(value) else float(value)


def write_cases():
    rng = np.random.default_rng(20240607)
    cases = []
    for case in range(8):
        used = [[0, 5, 9], [0, 1, 8, 9], [2, 5], list(range(10)), [0], [3, 7], [0, 5, 6], [9, 8]][case]
        noise = [0.6, 0.3, 1.5, 0.6, 0.05, 0.8, 3.0, 0.5][case]
        targets, predictions = [], []
        for sample in range(24 if case == 0 else 10):
            here, found = [], []
            for _ in range(int(rng.integers(0, 16))):
                kind = int(rng.choice(used))
                x, y, z = rng.uniform(-25, 25, 2).tolist() + [float(rng.normal(0, 0.5))]
                size = rng.uniform(0.5, 5.0, 3).tolist()
                velocity = [math.nan] * 2 if rng.random() < 0.15 else rng.normal(0, 4, 2).tolist()
                attribute = -1 if rng.random() < 0.3 else int(rng.integers(0, 3))
                box = [kind, x, y, z, *size, float(rng.uniform(-math.pi, math.pi)), *velocity]
                here.append([*box, int(rng.integers(0, 3)), attribute])
                for _ in range(int(rng.choice([0, 1, 1, 1, 2]))):
                    guess = list(box)
                    for axis in (1, 2, 3):
                        guess[axis] += float(rng.normal(0, noise))
                    for axis in (4, 5, 6):
                        guess[axis] *= float(rng.uniform(0.8, 1.2))
                    guess[7] += float(rng.normal(0, 0.5))
                    guess[8:10] = [math.nan] * 2 if rng.random() < 0.1 else rng.normal(0, 4, 2).tolist()
                    score = round(float(rng.uniform(0, 1)), 1 if case % 2 else 2)
                    found.append([*guess, score, int(rng.integers(-1, 3))])
            for _ in range(int(rng.integers(0, 6))):
                # Of nothing; some of classes that have no targets.
                place = rng.uniform(-25, 25, 2).tolist()
                score = round(float(rng.uniform(0, 0.6)), 2)
                found.append([int(rng.integers(0, 10)), *place, 0.0, 4.0, 2.0, 1.5, 0.3, 1.0, 0.0, score, -1])
            rng.shuffle(found)
            targets.append(here)
            predictions.append([[*p[:11], p[11]] for p in map(list, found)])
        if case == 6:
            # One target, the only one of its class.
            targets[3].append([7, 1.0, 2.0, 0.0, 1.8, 0.6, 1.4, 0.1, 2.0, 0.0, 2, -1])
            predictions[3].append([7, 1.2, 2.1, 0.1, 1.8, 0.7, 1.4, 0.2, 2.0, 0.5, 0.5, -1])
        cases.append({"targets": targets, "predictions": predictions})
    def short(value):
        return value if isinstance(value, int) else None if math.isnan(value) else round(value, 4)
    for case in cases:
        for side in ("targets", "predictions"):
            case[side] = [[[int(b[0]), *map(short, map(float, b[1:10])), short(b[10]) if side == "predictions" else int(b[10]), int(b[11])] for b in sample] for sample in case[side]]
    save(os.path.join(FOLDER, "cases.json"), cases)


def write_nuscenes():
    from nuscenes.eval.common.data_classes import EvalBoxes
    from nuscenes.eval.common.utils import center_distance
    from nuscenes.eval.detection.algo import accumulate, calc_ap, calc_tp
    from nuscenes.eval.detection.config import config_factory
    from nuscenes.eval.detection.constants import TP_METRICS
    from nuscenes.eval.detection.data_classes import DetectionBox, DetectionMetrics

    def boxes(samples, is_prediction):
        all_boxes = EvalBoxes()
        for i, sample in enumerate(samples):
            token = f"sample {i}"
            # Also of samples without boxes.
            all_boxes.add_boxes(token, [])
            for b in sample:
                v = [math.nan if x is None else x for x in b[8:10]]
                all_boxes.add_boxes(token, [DetectionBox(
                    sample_token=token, translation=tuple(b[1:4]), size=(b[5], b[4], b[6]),
                    rotation=(math.cos(b[7] / 2), 0.0, 0.0, math.sin(b[7] / 2)), velocity=tuple(v), num_pts=1,
                    detection_name=NUSCENES[b[0]], detection_score=float(b[10]) if is_prediction else -1.0,
                    attribute_name=ATTRIBUTES[b[11]] if b[11] >= 0 else "",
                )])
        return all_boxes

    cfg = config_factory("detection_cvpr_2019")
    results = []
    for case in load("cases.json"):
        truth, found = boxes(case["targets"], False), boxes(case["predictions"], True)
        metrics = DetectionMetrics(cfg)
        data = {(name, t): accumulate(truth, found, name, center_distance, t) for name in NUSCENES for t in cfg.dist_ths}
        for name in NUSCENES:
            for t in cfg.dist_ths:
                metrics.add_label_ap(name, t, calc_ap(data[name, t], cfg.min_recall, cfg.min_precision))
            for metric in TP_METRICS:
                none = name == "traffic_cone" and metric in ("attr_err", "vel_err", "orient_err")
                none = none or name == "barrier" and metric in ("attr_err", "vel_err")
                error = math.nan if none else calc_tp(data[name, cfg.dist_th_tp], cfg.min_recall, metric)
                metrics.add_label_tp(name, metric, error)
        metrics.add_runtime(0.0)
        results.append({
            "ap": [[metrics.get_label_ap(name, t) for t in THRESHOLDS] for name in NUSCENES],
            "errors": [[clean(metrics.get_label_tp(name, m)) for m in TP_METRICS] for name in NUSCENES],
            "mean_ap": metrics.mean_ap,
            "mean_errors": [clean(metrics.tp_errors[m]) for m in TP_METRICS],
            "nds": metrics.nd_score,
        })
        assert TP_METRICS == ["trans_err", "scale_err", "orient_err", "vel_err", "attr_err"]
    save(os.path.join(FOLDER, "nuscenes.json"), results)


# SimBEV2X: classes are traffic light, sign, pedestrian, car, truck, bus, motorcycle, bicycle, cone, barrier.
CAPS = [40, 60, 100, 100, 20, 20, 20, 20, 40, 20]


def curve_area(scores, owners, level, count):
    """owners: -1 of nothing, else the level of the target."""
    if count == 0:
        return math.nan
    order = np.argsort(-np.asarray(scores, float), kind="stable")
    owners = np.asarray(owners, int)[order]
    right = np.cumsum((owners >= 0) if level is None else (owners == level))
    wrong = np.cumsum(owners == -1)
    total = right + wrong
    precision = np.where(total > 0, right / np.maximum(total, 1), 0.0)
    recall = right / count
    keep = precision >= 0.1
    precision = np.concatenate([[1.0], precision[keep]])
    recall = np.concatenate([[0.0], recall[keep]])
    return float(np.clip(np.sum(np.diff(recall) * (precision[1:] + precision[:-1]) * 0.5), 0.0, 1.0))


def nan_mean(values):
    values = np.asarray(values, float).ravel()
    values = values[~np.isnan(values)]
    return float(values.mean()) if len(values) else math.nan


def simbev2x_of(case):
    def table(sample):
        return np.array([[math.nan if x is None else x for x in b] for b in sample], float).reshape(-1, 12)
    truth, found = [table(s) for s in case["targets"]], [table(s) for s in case["predictions"]]
    aps, errors = [], []
    for kind in range(10):
        for threshold in THRESHOLDS:
            scores, owners, pairs, levels = [], [], [], []
            for targets, guesses in zip(truth, found):
                targets, guesses = targets[targets[:, 0] == kind], guesses[guesses[:, 0] == kind]
                levels += targets[:, 10].astype(int).tolist()
                guesses = guesses[np.argsort(-guesses[:, 10], kind="stable")][: CAPS[kind]]
                free = np.ones(len(targets), bool)
                for guess in guesses:
                    scores.append(guess[10])
                    owners.append(-1)
                    away = np.where(free, np.linalg.norm(targets[:, 1:4] - guess[1:4], axis=1), np.inf)
                    if len(away) and away.min() <= threshold:
                        nearest = int(away.argmin())
                        free[nearest] = False
                        owners[-1] = int(targets[nearest, 10])
                        pairs.append((targets[nearest], guess))
            levels = np.array(levels, int)
            aps.append([curve_area(scores, owners, level, len(levels) if level is None else int((levels == level).sum())) for level in (None, 0, 1, 2)])
            if not pairs:
                errors.append([math.nan] * 4)
                continue
            a, b = np.array([p[0] for p in pairs]), np.array([p[1] for p in pairs])
            turn = np.angle(np.exp(1j * (a[:, 7] - b[:, 7])))
            common = np.minimum(a[:, 4:7], b[:, 4:7]).prod(axis=1)
            overlap = common / (a[:, 4:7].prod(axis=1) + b[:, 4:7].prod(axis=1) - common)
            speed = np.nan_to_num(a[:, 8:10]) - np.nan_to_num(b[:, 8:10])
            errors.append([
                np.linalg.norm(a[:, 1:4] - b[:, 1:4], axis=1).mean(), np.abs(turn).mean(), 1 - overlap.mean(),
                np.linalg.norm(speed, axis=1).mean(),
            ])
    aps, errors = np.array(aps).reshape(10, 4, 4), np.array(errors).reshape(10, 4, 4)
    mean_ap = [nan_mean(aps[:, :, level]) for level in range(4)]
    mean_errors = [nan_mean(errors[:, :, i]) for i in range(4)]
    sds = (4 * mean_ap[0] + sum(max(0.0, 1.0 - e) for e in mean_errors if not math.isnan(e))) / 8
    plain = lambda array: [[[clean(v) for v in row] for row in kind] for kind in array]
    return {
        "ap": plain(aps), "errors": plain(errors), "mean_ap": [clean(v) for v in mean_ap],
        "mean_errors": [clean(v) for v in mean_errors], "sds": clean(sds),
    }


def main():
    what = sys.argv[1]
    os.makedirs(FOLDER, exist_ok=True)
    if what == "cases":
        write_cases()
    elif what == "nuscenes":
        write_nuscenes()
    elif what == "simbev2x":
        path = sys.argv[2] if len(sys.argv) > 2 else os.path.join(FOLDER, "simbev2x.json")
        save(path, [simbev2x_of(case) for case in load("cases.json")])


main()
