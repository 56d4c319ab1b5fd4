"""Reads a store of format 1 and one of today, whose tables say the same, with the Python package.

Usage: python3 older.py OLD NEW
"""

import dataclasses
import pathlib
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "python/src"))

import numpy as np

import convoy

old, new = (convoy.Dataset(place) for place in sys.argv[1:3])
for one, two in zip(old.scenes(), new.scenes(), strict=True):
    assert (one.number, one.split, one.map_name, one.frames) == (two.number, two.split, two.map_name, two.frames)
scenes = [dataset.scene(0) for dataset in (old, new)]
found = 0
for number in range(scenes[0].frames):
    a, b = (scene.frame(number) for scene in scenes)
    for agent in a.agents:
        first, second = a.agent(agent), b.agent(agent)
        assert first.id == second.id and np.array_equal(first.pose, second.pose)
        mine, theirs = first.boxes(), second.boxes()
        for field in dataclasses.fields(mine):
            np.testing.assert_array_equal(getattr(mine, field.name), getattr(theirs, field.name), field.name)
        found += len(mine.id)
assert found
# Whole tables are those of today.
for name, columns in {
    "boxes": None,
    "boxes_valid": None,
    "log/actors": None,
    "log/signals": None,
    "tracks_frames": ["attributes", "id"],
    "boxes_valid ": ["is_ego", "scene", "distance_m"],
}.items():
    one, two = (scene.table(name.strip(), columns) for scene in scenes)
    assert one.schema.equals(two.schema), (name, one.schema, two.schema)
    assert one.equals(two), name
for name in ("scenes", "agents"):
    one, two = (dataset.plan(name) for dataset in (old, new))
    assert one.schema.equals(two.schema) and one.equals(two), name
assert old.table("boxes").equals(new.table("boxes"))
