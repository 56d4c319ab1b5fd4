"""The page of results, made from all runs that are there."""

from __future__ import annotations

from collections.abc import Sequence

from convoy_baseline.benchmark import published
from convoy_baseline.benchmark.published import BOX_CLASSES, MASK_CLASSES, MODELS, name_of
from convoy_baseline.benchmark.records import RINGS, Record
from convoy_baseline.benchmark.table import Seeds, markdown, percent, plain, points

THRESHOLDS_M = (0.5, 1.0, 2.0, 4.0)
LEVELS = ("all", "easy", "medium", "hard", "ego", "partners", *RINGS)
LEVEL_NAMES = (
    "all",
    "easy",
    "medium",
    "hard",
    "seen by the ego",
    "seen by partners only",
    "up to 20 m",
    "20 to 40 m",
    "beyond 40 m",
)
INTRODUCTION = """# Results

The paper's three tables (SimBEV2X), with its rows, and below them ours, on data that Convoy made: not the paper's data, so that the two
are no race; what can be held against each other is what cooperation changes. Each run of `make benchmark` leaves a file in
[results](results/README.md), and this page is made from all that are there ([how](python.md#the-benchmark)); all scores are
`convoy evaluate`'s ([rules](evaluation.md)), in per cent unless a unit is named."""
SIZES = """Parameters part by part of the paper's nine models as `benchmark-full` trains them, a detector and a segmenter each, what a partner
hands on (channels by cells, in half precision) and how many bytes that is a keyframe. Made by `python -m convoy_baseline.parts`."""
DIFFERENCES = """## What differs from the paper

* Data: Convoy's own towns, traffic and sensors, with fewer scenes; the paper has 168 scenes to learn from and 60 to be tested on.
* Models: own code of the same parts; `benchmark-gpu` trains small ones ([sizes](#runs)), `benchmark` smaller ones yet, with pillars of
  0.8 m for voxels; both one model for boxes and masks where the paper has two.
* Training: so many steps as [Runs](#runs) says; the paper has 20 epochs of 209,696 samples. No pasted objects.
* Lidars: as each plan's configuration has them; the paper thins 128 beams to 32 and adds 9 earlier sweeps.
* Ground: targets and predictions within the model's ground count; the paper leaves out targets alone.
* Masks: cells of the model's own grid; which grid the paper's numbers are of is not published.
* The same: frames at 2 Hz, partners within 80 m and 4.8 m, targets seen by anybody in reach (the ego itself among them where others have
  seen it), surest predictions of a class, difficulty, distances, thresholds, SDS.
* Speed and memory are of one ego with its partners, on the machine of the run; the paper's are of an RTX 4090. Without a graphics card
  memory is that of the whole process.
* An interval has 95 % of the scores of 1,000 draws of the test scenes; of several seeds it is the mean of theirs. Seeds are another
  matter: each is told by itself above, where there are several."""


def page(records: Sequence[Record], plans: Sequence[str] = (), pictures: Sequence[str] = (), sizes: str = "") -> str:
    """Everything, as Markdown. Of models of `plans` that have not run, it is said so; `pictures` are names in the folder of results,
    `sizes` is a table of the models in full size."""
    models = [records for records in grouped(records) if records.first.share == 1 and not records.first.spoil]
    boxes = [model for model in models if model.first.boxes]
    masks = [model for model in models if model.first.masks]
    parts = [
        INTRODUCTION,
        open_rows(models, plans),
        "## Detection",
        _detection(boxes),
        "### By class",
        "AP of each class, the mean over 0.5, 1, 2 and 4 m.",
        _by_class(boxes),
        "## Masks from above",
        "Intersection over union at a score of 0.5, and its mean over the classes at others and by distance from the ego.",
        _masks(masks),
        *gains(boxes, masks),
        *unseen(boxes, masks),
        *_modes(boxes),
        *_conditions(boxes),
        *_pictures(pictures),
        *_curves(records),
        *_labels(records),
        *_seeds(models),
        DIFFERENCES,
        "## Runs",
        *_runs(models),
        *(["## Models in full size", SIZES, sizes] if sizes else []),
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def grouped(records: Sequence[Record]) -> list[Seeds]:
    """Runs that differ in their seed alone, in the order of the paper's tables."""
    groups: dict[tuple[str, str], list[Record]] = {}
    for record in records:
        groups.setdefault((record.plan, record.entry), []).append(record)
    place = {model: i for i, model in enumerate(MODELS)}
    order = sorted(groups, key=lambda key: (key[0], place.get(groups[key][0].model, len(MODELS)), key[1]))
    return [Seeds(sorted(groups[key], key=lambda record: record.seed)) for key in order]


def label(model: Seeds) -> str:
    """A row's name."""
    seeds = len(model.records)
    return f"{name_of(model.first.model)}, {model.first.plan}, {seeds} seed{'s' if seeds > 1 else ''}"


def open_rows(models: Sequence[Seeds], plans: Sequence[str]) -> str:
    """Which rows have no run."""
    lines = []
    for plan in plans:
        ran = {model.first.model for model in models if model.first.plan == plan}
        missing = [name_of(model) for model in MODELS if model not in ran]
        if len(missing) == len(MODELS):
            lines.append(f"* `{plan}`: all of it, it has not been run yet.")
        elif missing:
            lines.append(f"* `{plan}`: {', '.join(missing)}.")
    return "\n".join(["Open, as without any run:", "", *lines]) if lines else ""


def _size(model: Seeds) -> list[str]:
    first = model.first
    sent = first.heard.get(first.mode, [0, 0, 0])
    return [
        f"{model.about(lambda record: record.speed['fps']):.1f}",
        f"{model.about(lambda record: record.speed['memory_bytes']) / 1e9:.1f}",
        f"{first.parameters / 1e6:.2f} M",
        f"{sent[2] / 1e6:.2f} MB" if first.mode != "none" else "-",
    ]


def _detection(models: Sequence[Seeds]) -> str:
    head = [
        "model",
        "mAP",
        "easy",
        "medium",
        "hard",
        "mATE",
        "mAOE",
        "mASE",
        "mAVE",
        "SDS",
        "FPS",
        "GB",
        "parameters",
        "a partner sends",
    ]
    rows = [
        [f"{name_of(model)}, the paper", *cells, "-", "-"]
        for model, cells in zip(MODELS, published.rows(published.DETECTION), strict=True)
    ]
    for model in models:
        cells = [percent(model.value("boxes", "mAP", level=level), interval=level == "all") for level in LEVELS[:4]]
        cells += [plain(model.value("boxes", error)) for error in ("mATE", "mAOE", "mASE", "mAVE")]
        cells.append(percent(model.value("boxes", "SDS")))
        rows.append([label(model), *cells, *_size(model)])
    return markdown(head, rows)


def _by_class(models: Sequence[Seeds]) -> str:
    rows = [
        [f"{name_of(model)}, the paper", *cells]
        for model, cells in zip(MODELS, published.rows(published.BY_CLASS), strict=True)
    ]
    for model in models:
        rows.append([label(model), *(percent(model.precision(name, THRESHOLDS_M)) for name in BOX_CLASSES)])
    return markdown(["model", *(name.replace("_", " ") for name in BOX_CLASSES)], rows)


def _masks(models: Sequence[Seeds]) -> str:
    head = ["model", *(name.replace("_", " ") for name in MASK_CLASSES), "mIoU", "at 0.7", "at 0.9"]
    head += ["up to 20 m", "20 to 40 m", "beyond 40 m", "FPS", "GB"]
    rows = [
        [f"{name_of(model)}, the paper", *cells]
        for model, cells in zip(MODELS, published.rows(published.MASKS), strict=True)
    ]
    for model in models:
        cells = [percent(model.value("masks", "IoU", of=name, at=0.5)) for name in MASK_CLASSES]
        cells += [percent(model.value("masks", "mIoU", at=at), interval=at == 0.5) for at in (0.5, 0.7, 0.9)]
        cells += [percent(model.value("masks", "mIoU", level=ring, at=0.5)) for ring in RINGS]
        rows.append([label(model), *cells, *_size(model)[:2]])
    return markdown(head, rows)


def gains(boxes: Sequence[Seeds], masks: Sequence[Seeds]) -> list[str]:
    """What cooperation gains over the model of the same sensors that never knew it; and over itself without partners."""
    head = ["model", "over", *LEVEL_NAMES]
    rows = []
    for model in boxes:
        for part, over in (("gain_boxes", "a model that learnt alone"), ("boxes", "itself without partners")):
            cells = [points(model.gain(part, "mAP", level=level)) for level in LEVELS]
            if set(cells) != {"-"}:
                rows.append([label(model), over, *cells])
    mask_rows = []
    for model in masks:
        for part, over in (("gain_masks", "a model that learnt alone"), ("masks", "itself without partners")):
            cells = [points(model.gain(part, "mIoU", level=level, at=0.5)) for level in ("all", *RINGS)]
            if set(cells) != {"-"}:
                mask_rows.append([label(model), over, *cells])
    if not rows and not mask_rows:
        return []
    words = (
        "How many points of mAP, or of mIoU at 0.5, a model has more that works together, and the interval of this difference: both are "
        "scored on the same draws of scenes. Bold: the interval does not hold nought. In the paper, by its table, hard objects gain most "
        "(25.6 to 48.5 and 51.7 by lidar), medium ones 2.5 and 5.3, and easy ones -3.3 and 0.1."
    )
    found = ["## What cooperation gains", words]
    found += [markdown(head, rows)] if rows else []
    found += [markdown(["masks", "over", "all", *LEVEL_NAMES[-3:]], mask_rows)] if mask_rows else []
    return found


def unseen(boxes: Sequence[Seeds], masks: Sequence[Seeds]) -> list[str]:
    """Scores town by town, those apart that no model has learnt from."""
    rows = []
    for model in boxes:
        table = model.tables("boxes")[0]
        maps = sorted({str(key[0]) for key in table if key[0] is not None})
        for place in sorted(maps, key=lambda name: (name in model.first.seen_maps, name)):
            cells = [percent(model.value("boxes", "mAP", level=level, place=place)) for level in LEVELS[:4]]
            gain = points(model.gain("gain_boxes", "mAP", place=place))
            mean_iou = percent(model.value("masks", "mIoU", at=0.5, place=place)) if model in masks else "-"
            known = "" if place in model.first.seen_maps else "**not learnt from**"
            rows.append([place, known, label(model), *cells, gain, mean_iou])
    if not rows:
        return []
    head = ["town", "", "model", "mAP", "easy", "medium", "hard", "gain over alone", "mIoU"]
    return [
        "## Town by town",
        "Scenes of the test are none of those that were learnt from; some towns were not learnt from at all.",
        markdown(head, rows),
    ]


def _modes(models: Sequence[Seeds]) -> list[str]:
    rows = []
    for model in models:
        if model.first.mode != "none":
            for mode in ("none", "x2v", "x2i", "x2x"):
                heard = model.first.heard.get(mode, [0, 0, 0])
                cells = [percent(model.value("boxes", "mAP", mode=mode, level=level)) for level in LEVELS]
                rows.append([label(model), mode, f"{heard[1]:.2f}", *cells])
    if not rows:
        return []
    words = (
        "The same models with nobody, with vehicles (x2v), with RSUs (x2i) and with both (x2x), on the same targets."
    )
    return ["## With whom", words, markdown(["model", "mode", "partners", *LEVEL_NAMES], rows)]


def _conditions(models: Sequence[Seeds]) -> list[str]:
    rows = []
    for model in models:
        for name in sorted({name for record in model.records for name in record.conditions}, key=_order):
            cells = [
                percent(model.value(name, "mAP", mode="x2x", level=level)) for level in ("all", "hard", "partners")
            ]
            heard = next(record.heard[name] for record in model.records if name in record.heard)
            rows.append([label(model), name, f"{heard[1]:.2f}", *cells])
    if not rows:
        return []
    words = (
        "One of the models in mode x2x, where each partner takes part with a chance; where partners' places and yaws are believed with "
        "errors of this standard deviation; where what they say is so many frames of 0.05 s old; and with poses the wrong way round, "
        "which must not do. The first seed alone."
    )
    return [
        "## Partners, poses, delay",
        words,
        markdown(["model", "condition", "partners", "all", "hard", "partners only"], rows),
    ]


def _pictures(names: Sequence[str]) -> list[str]:
    words = (
        "Of six scenes of the test the moment in which partners helped most, so not a fair sample: boxes with a score of 0.3 or more that "
        "a model said alone and with partners, over what is there, in colours that tell who has seen it."
    )
    return ["## What cooperation found", words, "\n".join(f"![](results/{name})" for name in names)] if names else []


def _order(condition: str) -> tuple[str, list[float]]:
    words = condition.split()
    return words[0], [float(word) for word in words[1:] if word.replace(".", "").isdigit()]


def _curves(records: Sequence[Record]) -> list[str]:
    models = grouped([record for record in records if not record.spoil and record.boxes])
    rows = []
    for whole in models:
        own = [m for m in models if (m.first.plan, m.first.model) == (whole.first.plan, whole.first.model)]
        if whole.first.share == 1 and len(own) > 1:
            for model in sorted(own, key=lambda m: m.first.share):
                cells = [
                    percent(model.value("boxes", "mAP", level=level), interval=level == "all") for level in LEVELS[:4]
                ]
                mean_iou = percent(model.value("masks", "mIoU", at=0.5), interval=True)
                rows.append([label(whole), f"{model.first.share:g}", *cells, mean_iou])
    if not rows:
        return []
    words = "The same models, with as many steps, on a part of the scenes."
    return [
        "## Fewer scenes to learn from",
        words,
        markdown(["model", "share", "mAP", "easy", "medium", "hard", "mIoU"], rows),
    ]


def _labels(records: Sequence[Record]) -> list[str]:
    rows = []
    for model in grouped([record for record in records if record.spoil]):
        boxes, masks = model.value("boxes", "mAP"), model.value("masks", "IoU", of="road", at=0.5)
        rows.append(
            [name_of(model.first.model), model.first.spoil, str(model.first.steps), percent(boxes), percent(masks)]
        )
    if not rows:
        return []
    words = "Models on labels that were spoilt in training, scored against the true ones: scores that would not fall would say nothing."
    return ["## Labels that are wrong", words, markdown(["model", "labels", "steps", "mAP", "IoU of the road"], rows)]


def _seeds(models: Sequence[Seeds]) -> list[str]:
    rows = []
    for model in models:
        for record in model.records if len(model.records) > 1 else []:
            one = Seeds([record])
            cells = [percent(one.value("boxes", "mAP", level=level)) for level in LEVELS[:4]]
            cells += [points(one.gain("gain_boxes", "mAP", level=level)) for level in LEVELS[:4]]
            mean_iou = percent(one.value("masks", "mIoU", at=0.5))
            rows.append([f"{name_of(record.model)}, {record.plan}", str(record.seed), *cells, mean_iou])
    if not rows:
        return []
    head = ["model", "seed", "mAP", "easy", "medium", "hard", "gain", "easy", "medium", "hard", "mIoU"]
    return ["## Seeds", "Gains are over the model of the same seed that learnt alone.", markdown(head, rows)]


def _runs(models: Sequence[Seeds]) -> list[str]:
    rows, data = [], []
    for model in models:
        for record in model.records:
            settings = record.settings
            cells = f"{settings['cells']} x {settings['cells']} of {settings['cell_m']:g} m"
            rows.append(
                [
                    f"{name_of(record.model)}, {record.plan}", str(record.seed), cells, f"{record.parameters:,}",
                    f"{record.steps:,} of {settings['frames_a_step']}", f"{record.train_s:,.0f} s", record.commit, record.machine,
                ]
            )  # fmt: skip
            data += [f"* `{record.plan}`, {line}" for line in record.data]
    if not rows:
        return ["None yet."]
    head = ["model", "seed", "ground", "parameters", "steps of keyframes", "learnt in", "commit", "machine"]
    return ["\n".join(dict.fromkeys(data)), markdown(head, rows)]
