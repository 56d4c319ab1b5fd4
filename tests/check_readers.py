"""Opens every table of a store in pyarrow and every array in numpy, and checks what a reader relies on.

Usage: python3 check_readers.py STORE
"""

import json
import pathlib
import sys

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq


def png_size(data):
    assert data[:8] == b"\x89PNG\r\n\x1a\n", "no PNG"
    return int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")


def jpeg_size(data):
    assert data[:2] == b"\xff\xd8", "no JPEG"
    at = 2
    while True:
        marker, length = data[at + 1], int.from_bytes(data[at + 2 : at + 4], "big")
        if 0xC0 <= marker <= 0xC3:
            return int.from_bytes(data[at + 7 : at + 9], "big"), int.from_bytes(data[at + 5 : at + 7], "big")
        at += 2 + length


def check_sensor(path, file, frames):
    about = json.loads(file.metadata.metadata[b"sensor"])
    assert len(about["agent_from_sensor"]["quaternion"]) == 4
    table = file.read()
    assert table.num_rows == frames, f"{table.num_rows} rows, {frames} frames"
    assert table["frame"].to_pylist() == list(range(frames))
    lists = [name for name in table.column_names if pa.types.is_list(table.schema.field(name).type)]
    if "image" in table.column_names:
        assert file.num_row_groups == frames, "one frame must be readable alone"
        for image in table["image"].to_pylist():
            size = jpeg_size if image[:2] == b"\xff\xd8" else png_size
            assert size(image) == (about["width"], about["height"])
    elif lists:
        # An image in columns, or the returns of a sensor: in every row all lists are equally long, and none is empty.
        assert file.num_row_groups == frames, "one frame must be readable alone"
        for frame in range(frames):
            row = file.read_row_group(frame).to_pylist()[0]
            lengths = {len(row[name]) for name in lists}
            assert len(lengths) == 1, f"columns of {lengths} lengths"
            length = lengths.pop()
            assert length > 0, "nothing was hit"
            assert "width" not in about or length == row["width"] * row["height"] == about["width"] * about["height"]


def check_vector_map(path):
    table = pq.read_table(path)
    columns = table.to_pydict()
    kinds, count = columns["kind"], table.num_rows
    assert columns["id"] == list(range(count)), "ids are not the rows"
    lane_count = kinds.count("lane_centreline")
    assert lane_count > 0 and set(kinds[:lane_count]) == {"lane_centreline"}
    # References stay in the table and are symmetric.
    for forth, back in (("successors", "predecessors"), ("predecessors", "successors")):
        pairs = {(i, j) for i, to in enumerate(columns[forth]) for j in to}
        assert pairs == {(i, j) for j, to in enumerate(columns[back]) for i in to}, forth
    signals = {(i, j) for i in range(lane_count) for j in columns["signals"][i]}
    assert signals == {(i, j) for j, kind in enumerate(kinds) if kind == "signal" for i in columns["lanes"][j]}
    for i in range(count):
        points = np.stack([columns[axis][i] for axis in ("x_m", "y_m", "z_m")], axis=1)
        assert points.dtype == np.float64 and np.isfinite(points).all() and len(points) > (kinds[i] != "signal")
        assert all(j < lane_count for j in columns["lanes"][i]), i
        for number, ring in enumerate(np.split(points, columns["rings"][i][1:]) if columns["rings"][i] else []):
            assert (ring[0] == ring[-1]).all(), f"element {i} is open"
            x, y = (ring[:, :2] - ring[0, :2]).T
            assert (x[:-1] @ y[1:] - x[1:] @ y[:-1] > 0) == (number == 0), f"element {i} runs the wrong way"
        if i < lane_count:
            left, right = (np.stack([columns[a][j] for a in ("x_m", "y_m", "z_m")], axis=1) for j in columns["boundaries"][i])
            if np.linalg.norm(left[0] + right[0] - 2 * points[0]) > 1e-6:
                left, right = left[::-1], right[::-1]
            assert np.allclose(0.5 * (left + right), points, atol=1e-6), f"lane {i} is not between its boundaries"
    return lane_count


def check_store(root):
    tables = arrays = 0
    lane_counts = {}
    for path in sorted((root / "maps").rglob("*.vector.parquet")):
        try:
            lane_counts[path.relative_to(root / "maps").as_posix().removesuffix(".vector.parquet")] = check_vector_map(path)
        except AssertionError as fault:
            raise SystemExit(f"{path}: {fault}")
        tables += 1
    for scene in sorted((root / "scenes").iterdir()):
        info = json.loads((scene / "log/scene.json").read_text())
        frames, agents = info["frames"], [a["agent"] for a in info["agents"]]
        for path in sorted(scene.rglob("*.parquet")):
            file = pq.ParquetFile(path)
            try:
                if path.parent.parent.name == "sensors" and path.stem != "visible":
                    check_sensor(path, file, frames)
                else:
                    file.read()
            except AssertionError as fault:
                raise SystemExit(f"{path}: {fault}")
            tables += 1
        hd_map = pq.read_table(scene / "hd_map.parquet").to_pydict()
        assert max(hd_map["lane"]) < lane_counts[info["map"]], "hd_map names a lane that its map does not have"
        boxes = pq.read_table(scene / "boxes.parquet").to_pydict()
        valid = pq.read_table(scene / "boxes_valid.parquet").to_pydict()
        assert [boxes[c] for c in ("frame", "agent", "id")] == [valid[c] for c in ("frame", "agent", "id")]
        corners = np.array(boxes["corners_m"]).reshape(-1, 8, 3)
        edges = np.linalg.norm(corners[:, [4, 2, 1]] - corners[:, [0]], axis=2)
        assert np.allclose(edges, np.array(boxes["size_m"]), atol=1e-6), "corner order and sizes disagree"
        assert np.allclose(corners.mean(axis=1), np.array(boxes["center_m"]), atol=1e-6)
        poses = pq.read_table(scene / "agents.parquet")
        assert poses.num_rows == frames * len(agents)
        for path in sorted(scene.rglob("*.npz")):
            with np.load(path) as archive:
                assert archive.files == [f"{k:04}" for k in range(frames)], path
                for name in archive.files:
                    array = archive[name]
                    kind = path.parent.name
                    want = (np.bool_, 3) if kind == "bev" else (np.uint8, 3)
                    assert (array.dtype.type, array.ndim) == want, f"{path} {name}: {array.dtype} {array.shape}"
                    assert array.any(), f"{path} {name} is empty"
                    arrays += 1
            if path.parent.name == "occupancy_filled":
                with np.load(path) as full, np.load(scene / "occupancy" / path.name) as hollow:
                    for name in full.files:
                        same = full[name][hollow[name] != 0] == hollow[name][hollow[name] != 0]
                        assert same.all(), f"{path} {name}: filling changed an occupied voxel"
    for path in sorted([*(root / "plan").glob("*.parquet"), *(root / "stats").glob("*.parquet")]):
        pq.read_table(path)
        tables += 1
    print(f"{tables} tables and {arrays} arrays read")


if __name__ == "__main__":
    check_store(pathlib.Path(sys.argv[1]))
