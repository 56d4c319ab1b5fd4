"""The manual's examples, run one after another beside a store that is called `dataset`."""

import contextlib
import io
import os
import re
import tempfile
import unittest
from pathlib import Path

from plain import STORE

import convoy

PAGE = Path(__file__).resolve().parents[2] / "docs/python.md"
PREDICTIONS = PAGE.with_name("evaluation.md")
"""Its example writes what an example of the page scores."""
OTHERS = (PAGE.parents[1] / "README.md", *(PAGE.with_name(f"{name}.md") for name in ("vector-maps", "faq", "frames")))
"""Pages whose examples stand each for itself."""
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NEEDS = {"torch": "PyTorch, for an example of docs/python.md", "PIL": "Pillow, to decode pictures"}


def missing(code):
    for module, why in NEEDS.items():
        if module in code or (module == "PIL" and re.search(r"\.(image|depth|instances)\(\)", code)):
            try:
                __import__(module)
            except ImportError:
                yield why
    if "convoy.evaluate" in code:
        try:
            convoy.evaluation.found()
        except convoy.ProgramError:
            yield "the program convoy, for an example of docs/python.md"


class Page(unittest.TestCase):
    def test_every_example_runs(self):
        examples, names = BLOCK.findall(PAGE.read_text()), {}
        self.assertGreater(len(examples), 4)
        skipped, here = set(), os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "dataset").symlink_to(STORE)
            os.chdir(folder)
            try:
                exec(BLOCK.findall(PREDICTIONS.read_text())[0], {})  # noqa: S102
                for code in examples:
                    if lacks := set(missing(code)):
                        skipped |= lacks
                        continue
                    with contextlib.redirect_stdout(io.StringIO()):
                        exec(compile(code, str(PAGE), "exec"), names)  # noqa: S102
            finally:
                os.chdir(here)
        if skipped:
            self.skipTest("; ".join(sorted(skipped)))

    def test_examples_of_other_pages_run(self):
        here = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "dataset").symlink_to(STORE)
            os.chdir(folder)
            try:
                for page in OTHERS:
                    examples = BLOCK.findall(page.read_text())
                    self.assertTrue(examples, page)
                    for code in examples:
                        with contextlib.redirect_stdout(io.StringIO()) as said:
                            exec(compile(code, str(page), "exec"), {})  # noqa: S102
                    if page.name == "README.md":
                        self.assertIn("vehicle_0", said.getvalue())
            finally:
                os.chdir(here)


if __name__ == "__main__":
    unittest.main()
