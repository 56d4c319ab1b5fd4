"""The tutorial, as a reader follows it: files written as they stand, commands typed one after another, the example in
Python. The dataset is made smaller."""

import contextlib
import io
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import convoy

PAGE = Path(__file__).resolve().parents[2] / "docs/tutorial.md"
BLOCK = re.compile(r"^```(sh|toml|python)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
SMALLER = {
    '"town.xodr" = 2': '"town.xodr" = 1',
    "[timing]": "[timing]\nwarmup_s = 0.5",
    "_duration_s = 2": "_duration_s = 1",
    "= 640": "= 160",
    "= 360": "= 90",
    "channels = 32": "channels = 8",
    "columns = 1024": "columns = 128",
    "= 40": "= 10",
}
"""One second instead of two, thumbnails, few beams."""


class Tutorial(unittest.TestCase):
    def test_it_can_be_followed(self):
        try:
            program = Path(convoy.evaluation.found()).resolve()
        except convoy.ProgramError:
            self.skipTest("the program convoy, for docs/tutorial.md")
        blocks = BLOCK.findall(PAGE.read_text())
        town, night = (text for kind, text in blocks[:3] if kind == "toml")
        for whole, part in SMALLER.items():
            self.assertIn(whole, night)
            night = night.replace(whole, part)
        variables = {**os.environ, "PATH": f"{program.parent}{os.pathsep}{os.environ['PATH']}"}
        here, typed = os.getcwd(), 0
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "town.toml").write_text(town)
            Path(folder, "night.toml").write_text(night)
            for kind, text in blocks:
                for line in text.splitlines() if kind == "sh" else []:
                    done = subprocess.run(
                        line.split(), check=False, cwd=folder, env=variables, capture_output=True, text=True
                    )
                    self.assertEqual(done.returncode, 0, f"{line}\n{done.stdout}\n{done.stderr}")
                    typed += 1
            self.assertTrue(Path(folder, "preview.jpg").is_file() and Path(folder, "traffic.png").is_file())
            os.chdir(folder)
            try:
                with contextlib.redirect_stdout(io.StringIO()) as said:
                    for kind, text in blocks:
                        if kind == "python":
                            exec(compile(text, str(PAGE), "exec"), {})  # noqa: S102
            finally:
                os.chdir(here)
        self.assertEqual(typed, 7)
        self.assertIn("2 of 2 scenes made", said.getvalue())
        self.assertIn("LIDAR_FRONT", said.getvalue())


if __name__ == "__main__":
    unittest.main()
