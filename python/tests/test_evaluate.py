"""Scores by the program: perfect predictions, and what goes wrong."""

import os
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import pyarrow as pa
import pyarrow.parquet as pq
from plain import SCENE, STORE, rows

import convoy


def truth(folder, **changes):
    """Predictions that are the targets themselves."""
    found = [
        {
            "scene": 0,
            "frame": row["frame"],
            "agent": row["agent"],
            "mode": "x2x",
            "class": row["class"],
            "score": 0.5,
            **{name: row[name] for name in ("center_m", "size_m", "velocity_mps")},
            "quaternion": [1.0, 0.0, 0.0, 0.0],
        }
        | changes
        for row in rows(SCENE / "boxes.parquet")
        if row["agent"] != "rsu_0"
    ]
    path = Path(folder, "predictions.parquet")
    pq.write_table(pa.Table.from_pylist(found), path)
    return path


class Evaluate(unittest.TestCase):
    def setUp(self):
        try:
            self.program = convoy.evaluation.found()
        except convoy.ProgramError:
            self.skipTest("the program convoy, for convoy.evaluate (CONVOY_PROGRAM names it)")

    def test_the_targets_themselves_find_every_target(self):
        with tempfile.TemporaryDirectory() as folder:
            found = convoy.evaluate(truth(folder), STORE, every=10, metrics=["simbev2x"], options=["--seen", "nobody"])
        self.assertEqual(found.program, self.program)
        self.assertRegex(found.version, r"^convoy \d")
        self.assertEqual({row["metrics"] for row in found.rows}, {"simbev2x"})
        self.assertLess(found.value("mATE", mode="x2x"), 1e-6)
        # The ego's own box is none of its targets.
        self.assertGreater(found.value("AP", mode="x2x", of_class="pedestrian", threshold=0.5), 0.99)

    def test_faults_are_those_of_the_program(self):
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaisesRegex(convoy.ProgramError, "(?s)ended with 2: .*999"):
                convoy.evaluate(truth(folder, frame=999), STORE)
            with self.assertRaisesRegex(convoy.ProgramError, "no program /no/such"):
                convoy.evaluate(truth(folder), STORE, program="/no/such")
            broken = Path(folder, "broken")
            broken.write_text("neither a script nor a program")
            os.chmod(broken, 0o755)
            with self.assertRaisesRegex(convoy.ProgramError, "does not start"):
                convoy.evaluate(truth(folder), STORE, program=broken)

class Places(unittest.TestCase):
    def test_the_environments_own_program_comes_before_the_paths(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("own", "path"):
                program = Path(folder, name, "convoy")
                program.parent.mkdir()
                program.write_text("#!/bin/sh\n")
                os.chmod(program, 0o755)
            variables = {k: v for k, v in os.environ.items() if k != "CONVOY_PROGRAM"}
            with mock.patch.dict(os.environ, variables | {"PATH": str(Path(folder, "path"))}, clear=True):
                with mock.patch("sysconfig.get_path", return_value=str(Path(folder, "own"))):
                    self.assertEqual(convoy.evaluation.found(), str(Path(folder, "own", "convoy")))
                with mock.patch("sysconfig.get_path", return_value=str(Path(folder, "nothing"))):
                    self.assertEqual(convoy.evaluation.found(), str(Path(folder, "path", "convoy")))
                os.environ["CONVOY_PROGRAM"] = "named"
                with self.assertRaisesRegex(convoy.ProgramError, "no program named"):
                    convoy.evaluation.found()


if __name__ == "__main__":
    unittest.main()
