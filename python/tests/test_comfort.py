"""What makes the package pleasant: texts of objects, loops over frames, data frames, plots, the notebook."""

import contextlib
import importlib.util
import io
import os
import runpy
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
from plain import SCENE, STORE

import convoy

NOTEBOOK = Path(__file__).resolve().parents[1] / "examples/first_look.py"


def needs(*modules):
    lacking = [name for name in modules if importlib.util.find_spec(name) is None]
    return unittest.skipIf(lacking, f"{' and '.join(lacking)}, for plots and data frames")


class Texts(unittest.TestCase):
    def setUp(self):
        self.dataset = convoy.Dataset(STORE)
        self.scene = self.dataset.scene(0)
        self.frame = self.scene[12]
        self.agent = self.frame.agent("vehicle_0")

    def test_every_object_says_in_a_line_what_it_is(self):
        things = [
            self.dataset,
            self.scene,
            self.frame,
            self.agent,
            self.agent.boxes(),
            self.agent.bev(),
            self.agent.occupancy(),
            self.agent.camera("CAM_FRONT"),
            self.agent.sensor("LIDAR"),
            self.frame.cooperative("vehicle_0"),
        ]
        for thing in things:
            self.assertNotIn("\n", repr(thing))
            self.assertLess(len(repr(thing)), 400, repr(thing))
            self.assertIn(type(thing).__name__, repr(thing))
        self.assertEqual(repr(self.frame), "Frame(12 of scene 0, 0.60 s, 3 agents)")
        self.assertIn("160 x 90", repr(self.agent.camera("CAM_FRONT")))

    def test_a_summary_counts_what_is_there(self):
        summary = self.dataset.summary()
        tracks = pq.read_table(SCENE / "tracks.parquet")["class"].to_pylist()
        self.assertIn(f"{tracks.count('car')} car", summary)
        self.assertIn("1 of 2 scenes made", summary)
        self.assertIn("2 vehicles and 1 RSUs", summary)
        self.assertIn("LIDAR", summary)

    def test_a_scene_is_a_sequence_of_frames(self):
        self.assertEqual([frame.number for frame in self.scene], list(range(len(self.scene))))
        self.assertEqual([frame.number for frame in self.scene[2:9:3]], [2, 5, 8])
        self.assertEqual(self.scene[-1].number, self.scene.frames - 1)
        for outside in (self.scene.frames, -self.scene.frames - 1):
            with self.assertRaises(IndexError):
                self.scene[outside]

    def test_names_are_ours_alone(self):
        for name in dir(convoy):
            value = getattr(convoy, name) if name not in ("torch", "rerun") else convoy
            module = getattr(value, "__module__", None) or getattr(value, "__name__", "convoy")
            self.assertTrue(name.startswith("__") or isinstance(value, tuple) or module.startswith("convoy"), name)
        self.assertIn("Dataset", dir(convoy))

    def test_tables_of_all_scenes_say_their_scene(self):
        table = self.dataset.table("tracks", ["id", "class"])
        self.assertEqual(table.column_names, ["scene", "id", "class"])
        self.assertEqual(set(table["scene"].to_pylist()), {0})
        self.assertEqual(table.num_rows, pq.read_metadata(SCENE / "tracks.parquet").num_rows)

    def test_boxes_become_a_table(self):
        boxes = self.agent.boxes()
        table = boxes.to_arrow()
        self.assertEqual(table["id"].to_pylist(), boxes.id.tolist())
        np.testing.assert_array_equal(table["y_m"].to_numpy(), boxes.center[:, 1])
        np.testing.assert_array_equal(table["width_m"].to_numpy(), boxes.size[:, 1])
        self.assertEqual(table["class"].to_pylist(), boxes.class_name)

    @needs("pandas", "polars")
    def test_data_frames(self):
        boxes = self.agent.boxes()
        self.assertEqual(len(boxes.to_pandas()), len(boxes))
        self.assertEqual(boxes.to_polars().columns, list(boxes.to_pandas().columns))
        self.assertEqual(len(self.dataset.to_pandas("tracks")), self.dataset.to_polars("tracks").height)

    @needs("matplotlib", "PIL")
    def test_plots_show_points_boxes_and_pictures(self):
        import matplotlib

        matplotlib.use("Agg")
        axes = self.frame.plot_bev("vehicle_1", radius_m=40)
        x, y = self.frame.agent("vehicle_1").points()[:, :2].T
        inside = (np.abs(x) < 40) & (np.abs(y) < 40)
        drawn = [len(points.get_offsets()) for points in axes.collections if len(points.get_offsets())]
        self.assertIn(int(inside.sum()), drawn)
        labels = [text.get_text() for text in axes.get_legend().get_texts()]
        self.assertTrue({"vehicle_0", "rsu_0", "seen by the ego"} <= set(labels), labels)
        pictures = np.asarray(self.agent.plot_cameras(["CAM_FRONT", "CAM_BACK"])).ravel()
        np.testing.assert_array_equal(pictures[0].images[0].get_array(), self.agent.camera("CAM_FRONT").image())
        matplotlib.pyplot.close("all")

    @needs("matplotlib", "PIL", "pandas")
    def test_the_notebook_runs(self):
        here = os.getcwd()
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()) as said:
            Path(folder, "dataset").symlink_to(STORE)
            os.chdir(folder)
            try:
                runpy.run_path(str(NOTEBOOK))
            finally:
                os.chdir(here)
        self.assertIn("scenes made", said.getvalue())


if __name__ == "__main__":
    unittest.main()
