"""Files of runs, and the page that is made of them: made-up numbers, and the published ones held against each other."""

import pathlib
import tempfile
import unittest
from dataclasses import asdict, replace

import convoy

from convoy_baseline.benchmark import published
from convoy_baseline.benchmark.page import page
from convoy_baseline.benchmark.records import Record, box_rows, mask_rows, read_all
from convoy_baseline.benchmark.table import Number, Seeds, mean, percent, points
from convoy_baseline.settings import Settings

ALONE = Record(
    "benchmark", "bevfusion-l", "bevfusion-l", "none", 0, 1.0, "", "abc", "a machine", "convoy 1", asdict(Settings()), 30, 12.0, 1234567,
    {"fps": 4.0, "memory_bytes": 2e9, "samples": 20}, {"none": [10, 0.0, 0.0]}, ["train: 8 keyframes", "test: 4 keyframes"], ["town/a"],
)  # fmt: skip
TOGETHER = replace(
    ALONE, entry="coopdet3d-l", model="coopdet3d-l", mode="x2x", heard={"x2x": [10, 1.5, 3e5], "none": [10, 0.0, 0.0]}
)


def row(mode, value, *, of="all", level="all", measure="mAP", threshold=None, place=None, **more):
    """As `convoy evaluate` writes one."""
    return {
        "metrics": "simbev2x", "map": place, "mode": mode, "class": of, "level": level, "measure": measure, "threshold": threshold,
        "value": value, "low": None, "high": None, "gain": None, "gain_low": None, "gain_high": None, **more,
    }  # fmt: skip


class Published(unittest.TestCase):
    def test_rows_agree_with_each_other(self):
        """Typed numbers: classes' means are mAP and mIoU, and SDS follows from the others."""
        detection, by_class, masks = map(published.rows, (published.DETECTION, published.BY_CLASS, published.MASKS))
        self.assertEqual({len(table) for table in (detection, by_class, masks)}, {len(published.MODELS)})
        self.assertEqual(set(published.BOX_CLASSES), set(convoy.CLASSES))
        for whole, classes, ious in zip(detection, by_class, masks, strict=True):
            whole, classes, ious = ([float(cell) for cell in cells] for cells in (whole, classes, ious))
            self.assertEqual((len(whole), len(classes), len(ious)), (11, len(published.BOX_CLASSES), 22))
            self.assertLess(abs(sum(classes) / 10 - whole[0]), 0.06)
            self.assertLess(abs(sum(ious[:14]) / 14 - ious[14]), 0.12)
            sds = (4 * whole[0] + sum(100 * max(0.0, 1 - error) for error in whole[4:8])) / 8
            self.assertLess(abs(sds - whole[8]), 0.1)
        self.assertEqual([published.name_of(m) for m in ("bevfusion", "cobevfusion-l")], ["BEVFusion", "CoBEVFusion-L"])


class Files(unittest.TestCase):
    def test_a_record_comes_back_and_strangers_are_named(self):
        rows = [
            row("x2x", 0.5, low=0.4, high=0.6),
            row("x2x", 0.25, of="car", measure="AP", threshold=2.0),
            row("x2v", 0.25, of="car", measure="AP", threshold=2.0),
            row("x2x", 0.25, of="bus", measure="AP", threshold=2.0),
            row("x2x", None, level="hard"),
            row("x2x", 0.3, measure="ATE", of="car", threshold=2.0),
        ]
        kept = box_rows(rows, ("car",), ("none", "x2x"))
        self.assertEqual(
            kept,
            [[None, "x2x", "all", "all", "mAP", None, 0.5, 0.4, 0.6], [None, "x2x", "car", "all", "AP", 2.0, 0.25]],
        )
        masks = [row("x2x", 0.1 * k, measure="mIoU", threshold=k / 10) for k in range(1, 10)]
        self.assertEqual([line[5] for line in mask_rows(masks, ("x2x",))], [0.5, 0.7, 0.9])
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            record = replace(TOGETHER, boxes=kept, conditions={"delay 5": kept})
            path = record.write(folder)
            self.assertEqual(path.name, "benchmark-coopdet3d-l-0.json")
            self.assertEqual(read_all(folder)[0].boxes, kept)
            self.assertEqual(read_all(folder)[0].conditions, {"delay 5": kept})
            path.write_text('{"version": 1}')
            with self.assertRaisesRegex(ValueError, "benchmark-coopdet3d-l-0.json is no result"):
                read_all(folder)

    def test_seeds_are_means_and_a_gain_is_bold_where_nought_is_outside(self):
        self.assertEqual(mean([Number(1, 0, 2), None, Number(3, 1, 6)]), Number(2, 0.5, 4))
        self.assertEqual(mean([Number(1, 0, 2), Number(3)]), Number(2))
        self.assertIsNone(mean([None]))
        self.assertEqual(percent(Number(0.5, 0.25, 0.75), interval=True), "50.0 (25.0 to 75.0)")
        self.assertEqual(points(Number(-0.02, -0.05, 0.01)), "-2.0 (-5.0 to +1.0)")
        self.assertEqual(points(Number(0.02, 0.01, 0.05)), "**+2.0** (+1.0 to +5.0)")

    def test_a_page_has_published_rows_ours_gains_and_what_is_open(self):
        empty = page([], ("benchmark", "benchmark-full"))
        self.assertIn("`benchmark-full`: all of it", empty)
        self.assertIn("| CoBEVFusion-L, the paper | 76.1 | 89.2 |", empty)
        self.assertIn("None yet.", empty)
        numbers = {0: (0.4, 0.06), 1: (0.5, 0.02)}
        records = [replace(ALONE, seed=s, boxes=box_rows([row("none", 0.3)], (), ("none",))) for s in numbers]
        for seed, (value, gain) in numbers.items():
            whole = row("x2x", value, low=value - 0.1, high=value + 0.1)
            medium = row("x2x", 0.2, level="medium", gain=-0.02, gain_low=-0.05, gain_high=0.01)
            gained = row("x2x", value, gain=gain, gain_low=gain - 0.01, gain_high=gain + 0.01)
            there = {**gained, "map": "town/b"}
            records.append(
                replace(
                    TOGETHER, seed=seed,
                    boxes=box_rows([whole, {**whole, "map": "town/b"}, row("x2x", 0.6, of="car", measure="AP", threshold=0.5)],
                                   ("car",), ("x2x",)),
                    gain_boxes=box_rows([gained, medium, there], (), ()),
                )
            )  # fmt: skip
        text = page(records, ("benchmark",))
        for part in (
            "* `benchmark`: BEVFusion-C, CoopDet3D-C, CoBEVFusion-C, CoBEVFusion-L, BEVFusion, CoopDet3D, CoBEVFusion.",
            "| CoopDet3D-L, benchmark, 2 seeds | 45.0 (35.0 to 55.0) | - |",
            "| 4.0 | 2.0 | 1.23 M | 0.30 MB |",
            "| a model that learnt alone | **+4.0** (+3.0 to +5.0) | - | -2.0 (-5.0 to +1.0) |",
            "| town/b | **not learnt from** | CoopDet3D-L, benchmark, 2 seeds | 45.0 |",
            "| CoopDet3D-L, benchmark | 1 | 50.0 |",
            "* `benchmark`, test: 4 keyframes",
        ):
            self.assertIn(part, text)
        self.assertEqual(Seeds(records[2:]).precision("car", (0.5, 1.0)), Number(0.6))


if __name__ == "__main__":
    unittest.main()
