"""Holds a store that was exported to SimBEV2X's layout and imported again against the first one: table by table, column by column.

Usage: python3 imported.py STORE IMPORTED [raw]

Columns that the layout cannot hold are named here, and in docs/import.md; every other one must be the same.
"""

import json
import pathlib
import sys
import zipfile

import numpy as np
import pyarrow.parquet as pq

# Worked out again from what the layout holds (corners, degrees, positions): equal but for rounding.
NEAR = {"boxes": {"center_m": 1e-6, "size_m": 1e-6, "rpy_rad": 1e-12, "angle_rad": 1e-12},
        "boxes_valid": {"angle_rad": 1e-12}, "hd_map": {"rpy_rad": 1e-12, "lane_offset_m": 0.1}}
LOST = {"hd_map": {"speed_limit_mps", "next_junction_id", "next_junction_m", "signal_ids", "stop_line_m", "crosswalk_id",
                   "crosswalk_m", "sidewalk_m"}}
ZERO = {"LIDAR": {"intensity", "ring", "time_offset_s", "cos_angle", "id", "tag"}, "SEG-LIDAR": {"intensity", "ring", "time_offset_s"},
        "RAD": {"rcs_dbsm", "snr_db", "id", "tag"}}
WEATHER = ["cloudiness", "precipitation", "precipitation_deposits", "wind_intensity", "sun_azimuth_deg", "sun_altitude_deg",
           "wetness", "fog_density", "fog_distance_m", "fog_falloff"]
compared = 0


def same(name, column, one, two):
    global compared
    compared += 1
    assert one.type == two.type, f"{name}.{column}: {one.type} and {two.type}"
    assert one.equals(two), f"{name}.{column} differs"


def near(name, column, one, two, tolerance):
    global compared
    compared += 1
    one, two = one.to_pylist(), two.to_pylist()
    assert [v is None for v in one] == [v is None for v in two], f"{name}.{column}: other nulls"
    a, b = (np.array([v for v in values if v is not None], float) for values in (one, two))
    assert a.shape == b.shape, f"{name}.{column}: other shapes"
    off = np.abs(a - b)
    if column.endswith("_rad"):
        # Degrees have -180 for all from 180 - 1e-6 on.
        turned = np.abs((a - b + np.pi) % (2 * np.pi) - np.pi)
        off = np.where(np.abs(a) > np.pi - 2e-8, np.maximum(turned - 2e-8, 0), off)
    assert off.max(initial=0) <= tolerance, f"{name}.{column} is off by {off.max()}"


def table(first, second, name):
    one, two = pq.read_table(first / f"{name}.parquet"), pq.read_table(second / f"{name}.parquet")
    assert one.column_names == two.column_names, name
    assert one.num_rows == two.num_rows, f"{name}: {one.num_rows} and {two.num_rows} rows"
    return one, two


def check_labels(first, second, is_processed):
    rsus = set()
    one, two = table(first, second, "agents")
    for row, other in zip(one.to_pylist(), two.to_pylist(), strict=True):
        is_rsu = row["agent"].startswith("rsu")
        assert (row["id"] == other["id"]) or is_rsu, "an agent has another id"
        rsus |= {other["id"]} if is_rsu else set()
    for column in set(one.column_names) - {"id"}:
        same("agents", column, one[column], two[column])
    listed = {row for row in pq.read_table(first / "boxes.parquet", columns=["id"])["id"].to_pylist()}
    assert not rsus & listed, "an RSU has an object's id"
    for name in ["boxes", "hd_map"] + (["boxes_valid"] if is_processed else []):
        one, two = table(first, second, name)
        for column in one.column_names:
            if column in LOST.get(name, ()):
                empty = [v for v in two[column].to_pylist() if v not in (None, [])]
                assert not empty, f"{name}.{column}: where from?"
            elif column in NEAR.get(name, {}):
                near(name, column, one[column], two[column], NEAR[name][column])
            elif (name, column) == ("hd_map", "junction_id"):
                # Outside of junctions the layout has none.
                wanted = [j if inside else None for j, inside in zip(one[column].to_pylist(), one["is_junction"].to_pylist())]
                assert two[column].to_pylist() == wanted
            else:
                same(name, column, one[column], two[column])


def check_log(first, second):
    one, two = table(first, second, "log/frames")
    for column in ["frame", "time_s"]:
        same("log/frames", column, one[column], two[column])
    for column in WEATHER:
        near("log/frames", column, one[column], two[column], 1e-9)
    known = {row["id"]: row for row in pq.read_table(first / "log/actors.parquet").to_pylist()}
    for row in pq.read_table(second / "log/actors.parquet").to_pylist():
        if row["kind"] == "rsu":
            continue
        source = known[row["id"]]
        for column in ["kind", "model", "parent", "opendrive_id", "attributes", "fixed"]:
            assert row[column] == source[column], (row["id"], column, row[column], source[column])
        assert set(row["semantic_tags"]) <= set(source["semantic_tags"])
        if row["kind"] == "vehicle":
            assert (row["role"], row["color"]) == (source["role"], source["color"]), row
    places = {(row["frame"], row["id"]): row for row in pq.read_table(first / "log/states.parquet").to_pylist()}
    for row in pq.read_table(second / "log/states.parquet").to_pylist():
        source = places[row["frame"], row["id"]]
        assert np.allclose(row["xyz_m"], source["xyz_m"], atol=1e-6), (row, source)
        assert abs(np.dot(row["quaternion"], source["quaternion"])) > 1 - 1e-9
        assert row["velocity_mps"] == source["velocity_mps"] and row["dormant"] == source["dormant"]
    states = {(row["frame"], row["id"]): row["state"] for row in pq.read_table(first / "log/signals.parquet").to_pylist()}
    for row in pq.read_table(second / "log/signals.parquet").to_pylist():
        assert states[row["frame"], row["id"]] == row["state"]


def check_facts(first, second):
    one, two = (json.loads((folder / "log/scene.json").read_text()) for folder in (first, second))
    assert two["imported"] is True
    for key in ["scene", "split", "map", "seed", "frames", "label_every_n_frames", "dynamic_weather", "street_lights_on",
                "building_lights_on", "street_light_intensity_change_lm", "n_vehicles", "n_walkers", "n_accident_hazards",
                "n_road_work_hazards", "n_reckless_vehicles", "n_distracted_vehicles", "walker_cross_factor",
                "standstill_gap_m", "green_time_s"]:
        assert one[key] == two[key], (key, one[key], two[key])
    assert abs(one["duration_s"] - two["duration_s"]) < 1e-9
    for which in ["initial_weather", "final_weather"]:
        for key in WEATHER:
            assert np.isclose(one[which][key], two[which][key], rtol=1e-12, atol=0), (which, key, one[which][key], two[which][key])
    for a, b in zip(one["agents"], two["agents"], strict=True):
        for key in ["agent", "reckless", "distracted"] + (["id", "model", "color"] if a["agent"].startswith("vehicle") else []):
            assert a[key] == b[key], (key, a, b)


def check_sensors(first, second):
    names = sorted(path.name for path in (first / "sensors").iterdir())
    assert names == sorted(path.name for path in (second / "sensors").iterdir())
    for agent in names:
        stems = lambda folder: {path.stem for path in (folder / "sensors" / agent).glob("*.parquet")}
        # RSUs have no receivers in the layout.
        lost = {"boxes_2d"} | ({"GNSS", "IMU"} if agent.startswith("rsu") else set())
        assert stems(first) - lost == stems(second), (agent, stems(first) ^ stems(second))
        for name in sorted(stems(second)):
            one, two = table(first / "sensors" / agent, second / "sensors" / agent, name)
            zero = ZERO.get(name, ZERO["RAD"] if name.startswith("RAD_") else set())
            meta = [pq.read_metadata(folder / f"sensors/{agent}/{name}.parquet") for folder in (first, second)]
            assert meta[0].num_row_groups == meta[1].num_row_groups, name
            said, found = (m.metadata.get(b"sensor") for m in meta)
            assert (said is None) == (found is None)
            if said:
                said, found = json.loads(said), json.loads(found)
                pose, other = said.pop("agent_from_sensor"), found.pop("agent_from_sensor")
                assert said == found, (said, found)
                assert all(np.allclose(pose[key], other[key], atol=1e-15) for key in ["translation", "quaternion"])
                assert set(json.loads(meta[1].metadata.get(b"zero_columns", b"[]"))) == zero
            for column in one.column_names:
                if column in zero:
                    values = two[column].combine_chunks().flatten().to_numpy()
                    assert not values.any() and len(values) == len(one[column].combine_chunks().flatten()), (name, column)
                else:
                    same(f"{agent} {name}", column, one[column], two[column])


def check_arrays(first, second, is_processed):
    for folder in ["bev", "occupancy"] + (["occupancy_filled"] if is_processed else []):
        names = sorted(path.name for path in (first / folder).iterdir())
        assert names == sorted(path.name for path in (second / folder).iterdir()), folder
        for name in names:
            comments = [json.loads(zipfile.ZipFile(root / folder / name).comment) for root in (first, second)]
            keys = ["cells", "cell_m"] if folder == "bev" else ["range_m", "voxel_m", "lower_m", "upper_m", "mount_z_m"]
            assert [comments[0][key] for key in keys] == [comments[1][key] for key in keys], comments
            with np.load(first / folder / name) as one, np.load(second / folder / name) as two:
                assert one.files == two.files
                for member in one.files:
                    assert one[member].dtype == two[member].dtype and np.array_equal(one[member], two[member]), (name, member)
    if not is_processed:
        assert not (second / "occupancy_filled").exists() and not (second / "boxes_valid.parquet").exists()


def check_counts(first, second):
    """What was counted is what was counted before, of what is there."""
    for path in sorted((second / "stats").glob("*.parquet")):
        if path.stem.startswith(("merge-tracks", "postprocess")):
            continue
        key = lambda row: (row["agent"], row["measure"], row["class"], row["bin"])
        one, two = ({key(row): row["count"] for row in pq.read_table(root / "stats" / path.name).to_pylist()}
                    for root in (first, second))
        for (agent, measure, name, number), count in two.items():
            if measure in ("sensor_bytes", "bev_grids"):
                continue
            assert one.get((agent, measure, name, number), 0) == count, (agent, measure, name)


def main():
    store, imported = (pathlib.Path(arg) for arg in sys.argv[1:3])
    is_processed = sys.argv[3:] != ["raw"]
    scenes = sorted(path.name for path in (imported / "scenes").iterdir())
    assert scenes
    for name in scenes:
        first, second = store / "scenes" / name, imported / "scenes" / name
        for manifest in (second / "_manifests").glob("*.json"):
            said = json.loads(manifest.read_text())
            assert said["code_version"] == "import" or said["stage"] == "merge-tracks", manifest
        check_labels(first, second, is_processed)
        check_log(first, second)
        check_facts(first, second)
        check_sensors(first, second)
        check_arrays(first, second, is_processed)
        check_counts(first, second)
    rows = pq.read_table(store / "plan/scenes.parquet").to_pylist()
    plan = {row["scene"]: row for row in rows}
    for row in pq.read_table(imported / "plan/scenes.parquet").to_pylist():
        for key in ["split", "map", "seed", "frames", "dynamic_weather", "walker_cross_factor"]:
            assert row[key] == plan[row["scene"]][key], key
    print(f"{len(scenes)} scenes, {compared} columns are the same")


main()
