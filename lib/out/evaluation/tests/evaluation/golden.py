"""Writes golden/cases.json, golden/nuscenes.json, golden/simbev2x.json, golden/simbev2x_iou.json, golden/opv2v.json and golden/masks.json.

    golden.py cases            random cases (numpy alone)
    golden.py nuscenes         their scores by nuscenes-devkit's own algorithms (1.2.0, numpy 1.26)
    golden.py simbev2x [FILE]  their scores by the implementation below, which is written from the definition of SimBEV2X's
                               metrics and shares nothing with the Rust one (numpy alone)
    golden.py simbev2x_iou [FILE]  likewise of its mode by overlap: APs of all targets, means
    golden.py opv2v [FILE]     likewise by OPV2V's definition, all boxes as one class; overlaps by other means than ours
    golden.py masks [FILE]     random BEV masks and their scores, cell by cell (numpy alone)
    golden.py live FOLDER SEED cases.json and nuscenes.json of other random cases, into a folder

A box is [class, x, y, z, length, width, height, yaw, vx, vy, score or level, attribute or -1]; null is NaN. Coarse numbers make ties
of scores; there are classes without targets, without predictions, with one target, and predictions that come twice. The ego
stands at EGO; target i of a sample has points of the ego's lidars (i % 3 = 0), of partners' alone (1), of nobody's (2).
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
EGO = [-15.0, 5.0]


def load(name, folder=FOLDER):
    with open(os.path.join(folder, name)) as file:
        return json.load(file)


def save(path, value):
    with open(path, "w") as file:
        json.dump(value, file, separators=(",", ":"))
        file.write("\n")


def clean(value):
    return None if value is None or math.isnan(value) else float(value)


def write_cases(folder=FOLDER, seed=20240607):
    rng = np.random.default_rng(seed)
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
    save(os.path.join(folder, "cases.json"), cases)


def write_nuscenes(folder=FOLDER):
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
    for case in load("cases.json", folder):
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
    save(os.path.join(folder, "nuscenes.json"), results)


# SimBEV2X: classes are traffic light, sign, pedestrian, car, truck, bus, motorcycle, bicycle, cone, barrier.
CAPS = [40, 60, 100, 100, 20, 20, 20, 20, 40, 20]


def curve_area(scores, signs, count):
    """signs: 1 of what is right, -1 of what is wrong, 0 of what does not count."""
    if count == 0:
        return math.nan
    order = np.argsort(-np.asarray(scores, float), kind="stable")
    signs = np.asarray(signs, int)[order]
    right, wrong = np.cumsum(signs == 1), np.cumsum(signs == -1)
    total = right + wrong
    precision = np.where(total > 0, right / np.maximum(total, 1), 0.0)
    recall = right / count
    keep = precision >= 0.1
    precision = np.concatenate([[1.0], precision[keep]])
    recall = np.concatenate([[0.0], recall[keep]])
    return float(np.clip(np.sum(np.diff(recall) * (precision[1:] + precision[:-1]) * 0.5), 0.0, 1.0))


def rings_of(boxes):
    """0 up to 20 m from the ego, 1 up to 40 m, 2 beyond."""
    away = np.hypot(boxes[:, 1] - EGO[0], boxes[:, 2] - EGO[1])
    return np.digitize(away, [20.0, 40.0], right=True)


def nan_mean(values):
    values = np.asarray(values, float).ravel()
    values = values[~np.isnan(values)]
    return float(values.mean()) if len(values) else math.nan


def simbev2x_of(case):
    """By the distance of centres."""
    def nearness(guess, targets):
        return -np.linalg.norm(targets[:, 1:4] - guess[1:4], axis=1)
    aps, errors = simbev2x_tables(case, nearness, [-t for t in THRESHOLDS])
    plain = lambda array: [[[clean(v) for v in row] for row in kind] for kind in array]
    return {"ap": plain(aps), "errors": plain(errors), **simbev2x_means(aps, errors)}


def simbev2x_iou_of(case):
    """By the overlap of volumes; means are over 0.3 to 0.9."""
    def nearness(guess, targets):
        return np.array([volume_overlap(guess, target) for target in targets])
    aps, errors = simbev2x_tables(case, nearness, [round(0.1 * i, 1) for i in range(1, 10)])
    plain = [[clean(v) for v in kind] for kind in aps[:, :, 0]]
    return {"ap": plain, **simbev2x_means(aps[:, 2:], errors[:, 2:])}


def volume_overlap(a, b):
    """From that of the areas: both boxes stand upright."""
    areas = [a[4] * a[5], b[4] * b[5]]
    share = overlap(a, b)
    both = share * sum(areas) / (1 + share)
    height = min(a[3] + a[6] / 2, b[3] + b[6] / 2) - max(a[3] - a[6] / 2, b[3] - b[6] / 2)
    both *= max(0.0, height)
    return both / (areas[0] * a[6] + areas[1] * b[6] - both)


def simbev2x_means(aps, errors):
    mean_ap = [nan_mean(aps[:, :, level]) for level in range(9)]
    mean_errors = [nan_mean(errors[:, :, i]) for i in range(4)]
    sds = (4 * mean_ap[0] + sum(max(0.0, 1.0 - e) for e in mean_errors if not math.isnan(e))) / 8
    return {"mean_ap": [clean(v) for v in mean_ap], "mean_errors": [clean(v) for v in mean_errors], "sds": clean(sds)}


def simbev2x_tables(case, nearness, thresholds):
    """APs [class, threshold, level] and errors [class, threshold, error]; targets are found from a nearness on."""
    def table(sample):
        return np.array([[math.nan if x is None else x for x in b] for b in sample], float).reshape(-1, 12)
    truth, found = [table(s) for s in case["targets"]], [table(s) for s in case["predictions"]]
    aps, errors = [], []
    for kind in range(10):
        for threshold in thresholds:
            scores, owners, pairs, groups = [], [], [], []
            for targets, guesses in zip(truth, found):
                of_kind = targets[:, 0] == kind
                seen = (np.arange(len(targets)) % 3)[of_kind]
                targets, guesses = targets[of_kind], guesses[guesses[:, 0] == kind]
                first = len(groups)
                groups += list(zip(targets[:, 10].astype(int), rings_of(targets), seen))
                guesses = guesses[np.argsort(-guesses[:, 10], kind="stable")][: CAPS[kind]]
                free = np.ones(len(targets), bool)
                for guess, ring in zip(guesses, rings_of(guesses)):
                    scores.append(guess[10])
                    owners.append((-1, ring))
                    near = np.where(free, nearness(guess, targets), -np.inf)
                    if len(near) and near.max() >= threshold:
                        nearest = int(near.argmax())
                        free[nearest] = False
                        owners[-1] = (first + nearest, ring)
                        pairs.append((targets[nearest], guess))
            area = []
            for part, value in [(None, 0), (0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2), (2, 0), (2, 1)]:
                is_in = [part is None or group[part] == value for group in groups]
                # Who finds nothing is wrong at all levels, but of rings only in its own.
                miss = [-1 if part != 1 or ring == value else 0 for _, ring in owners]
                signs = [m if owner < 0 else int(is_in[owner]) for (owner, _), m in zip(owners, miss)]
                area.append(curve_area(scores, signs, sum(is_in)))
            aps.append(area)
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
    return np.array(aps).reshape(10, -1, 9), np.array(errors).reshape(10, -1, 4)


def crossing(a, b, c, d):
    """Where segments a-b and c-d meet, if they do in one point."""
    u, v = b - a, d - c
    det = u[0] * v[1] - u[1] * v[0]
    if abs(det) < 1e-12:
        return None
    w = c - a
    s, t = (w[0] * v[1] - w[1] * v[0]) / det, (w[0] * u[1] - w[1] * u[0]) / det
    return a + s * u if 0 <= s <= 1 and 0 <= t <= 1 else None


def overlap(a, b):
    """IoU of two boxes from above: the hull of all crossings of sides and of the corners of each within the other."""
    def corners(box):
        turn = np.array([[math.cos(box[7]), -math.sin(box[7])], [math.sin(box[7]), math.cos(box[7])]])
        return np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * (box[4:6] / 2) @ turn.T + box[1:3]
    def within(points, box):
        turn = np.array([[math.cos(box[7]), math.sin(box[7])], [-math.sin(box[7]), math.cos(box[7])]])
        return points[(np.abs((points - box[1:3]) @ turn.T) <= box[4:6] / 2 + 1e-12).all(axis=1)]
    one, two = corners(a), corners(b)
    meet = [crossing(one[i - 1], one[i], two[j - 1], two[j]) for i in range(4) for j in range(4)]
    points = np.array([*(p for p in meet if p is not None), *within(one, b), *within(two, a)]).reshape(-1, 2)
    both = 0.0
    if len(points) >= 3:
        middle = points.mean(axis=0)
        around = points[np.argsort(np.arctan2(*(points - middle).T[::-1]))] - middle
        both = 0.5 * abs(np.sum(around[:, 0] * np.roll(around[:, 1], -1) - around[:, 1] * np.roll(around[:, 0], -1)))
    return both / (a[4] * a[5] + b[4] * b[5] - both)


def opv2v_of(case):
    """Of each threshold the AP with and without sorting all frames' predictions together."""
    def area(flags, count):
        right = np.cumsum(flags)
        recall = np.concatenate([[0.0], right / count, [1.0]])
        precision = np.concatenate([[0.0], right / np.arange(1, len(flags) + 1), [0.0]])
        for i in range(len(precision) - 2, -1, -1):
            precision[i] = max(precision[i], precision[i + 1])
        return float(np.sum(np.diff(recall) * precision[1:]))
    result = {"sorted": [], "by_frame": []}
    for threshold in (0.3, 0.5, 0.7):
        scores, flags, count = [], [], 0
        for targets, guesses in zip(case["targets"], case["predictions"]):
            left = [np.array(t[:8], float) for t in targets]
            count += len(left)
            for guess in sorted(guesses, key=lambda g: -g[10]):
                shares = [overlap(np.array(guess[:8], float), t) for t in left]
                scores.append(guess[10])
                flags.append(bool(shares) and max(shares) >= threshold)
                if flags[-1]:
                    left.pop(int(np.argmax(shares)))
        flags = np.array(flags)
        result["sorted"].append(area(flags[np.argsort(-np.array(scores), kind="stable")], count))
        result["by_frame"].append(area(flags, count))
    return result


def masks():
    """Cases of 3 frames: labels and scores as digits (0 to 9 and A of tenths), [frame][class][row]."""
    rng = np.random.default_rng(97)
    cases = []
    # Cells of labels and predictions a side, their size in metres; 96 m, a crop of 48 m, cells twice as large.
    for labelled, labelled_m, predicted, predicted_m in [(24, 4.0, 24, 4.0), (24, 4.0, 12, 4.0), (24, 4.0, 10, 8.0)]:
        frames = []
        for _ in range(3):
            truth = rng.random((3, labelled, labelled)) < np.array([0.4, 0.1, 0.0])[:, None, None]
            score = rng.integers(0, 11, (3, predicted, predicted))
            frames.append((truth, score))
        # What the definition says, cell by cell of the labels.
        hits = {}
        confusion = np.zeros((3, 3), int)
        for truth, score in frames:
            for row in range(labelled):
                for column in range(labelled):
                    x = (row + 0.5 - labelled / 2) * labelled_m
                    y = (column + 0.5 - labelled / 2) * labelled_m
                    r = math.floor(x / predicted_m + predicted / 2)
                    c = math.floor(y / predicted_m + predicted / 2)
                    if not (0 <= r < predicted and 0 <= c < predicted):
                        continue
                    away = math.sqrt(x * x + y * y)
                    ring = 1 if away <= 20 else 2 if away <= 40 else 3
                    for kind in range(3):
                        for t in range(9):
                            guess = score[kind, r, c] >= t + 1
                            for level in (0, ring):
                                n = hits.setdefault((level, kind, t), [0, 0, 0])
                                n[0] += bool(guess and truth[kind, row, column])
                                n[1] += bool(guess and not truth[kind, row, column])
                                n[2] += bool(not guess and truth[kind, row, column])
                        for p in range(3):
                            confusion[kind, p] += bool(truth[kind, row, column] and score[p, r, c] >= 5)
        def iou(level, kind, t):
            right, wrong, missed = hits.get((level, kind, t), [0, 0, 0])
            return right / (right + wrong + missed + 1e-6)
        ious = [[[iou(level, kind, t) for t in range(9)] for level in range(4)] for kind in range(3)]
        cases.append({
            "grid": [labelled, labelled_m, predicted, predicted_m],
            "labels": [[["".join("01"[int(v)] for v in row) for row in kind] for kind in truth] for truth, _ in frames],
            "scores": [[["".join("0123456789A"[v] for v in row) for row in kind] for kind in score] for _, score in frames],
            "iou": ious,
            "mean_iou": np.array(ious).mean(axis=0).tolist(),
            "confusion": confusion.tolist(),
        })
    return cases


def main():
    what = sys.argv[1]
    os.makedirs(FOLDER, exist_ok=True)
    if what == "cases":
        write_cases()
    elif what == "nuscenes":
        write_nuscenes()
    elif what == "live":
        write_cases(sys.argv[2], int(sys.argv[3]))
        write_nuscenes(sys.argv[2])
    else:
        of = {"simbev2x": simbev2x_of, "simbev2x_iou": simbev2x_iou_of, "opv2v": opv2v_of}
        path = sys.argv[2] if len(sys.argv) > 2 else os.path.join(FOLDER, f"{what}.json")
        save(path, masks() if what == "masks" else [of[what](case) for case in load("cases.json")])


main()
