"""Groups of a store, as the Python package tells them: python groups.py STORE."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "python" / "src"))

import convoy  # noqa: E402

dataset = convoy.Dataset(sys.argv[1])
assert dataset.groups == {"": [0], "rain": [1], "empty": [2]}, dataset.groups
assert [scene.number for scene in dataset.scenes(group="rain")] == [1]
assert [scene.number for scene in dataset.scenes(edition=0)] == [0, 1, 2]
assert not dataset.scenes(edition=1) and not dataset.scenes("val", group="rain")
assert dataset.scene(2).group == "empty" and dataset.scene(2).edition == 0
assert len(dataset.editions) == 1 and dataset.editions[0] == dataset.config
try:
    dataset.scenes(group="snow")
except convoy.StoreError as error:
    assert "no group snow" in str(error), error
else:
    raise AssertionError("snow is no group")
