"""What the tests know of a store without the package: its tables as they are, and matrices written out."""

import json
import os
import pathlib

import numpy as np
import pyarrow.parquet as pq

STORE = pathlib.Path(os.environ.get("CONVOY_STORE", "dataset")).resolve()
SCENE = STORE / "scenes/0000"


def rows(path, **wanted):
    """Rows of a table as dicts, those with these values."""
    filters = [(name, "=", value) for name, value in wanted.items()]
    return pq.read_table(path, filters=filters or None).to_pylist()


def matrix(translation, quaternion):
    """By turning the three axes with q v q*: other arithmetic than the package's."""

    def times(a, b):
        w, v = a[0] * b[0] - a[1:] @ b[1:], a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])
        return np.concatenate([[w], v])

    q = np.array(quaternion)
    back = q * [1, -1, -1, -1]
    columns = [times(times(q, np.concatenate([[0], axis])), back)[1:] for axis in np.eye(3)]
    return np.vstack([np.column_stack([*columns, translation]), [0, 0, 0, 1]])


def agent_pose(agent, frame):
    row = rows(SCENE / "agents.parquet", agent=agent, frame=frame)[0]
    return matrix(row["xyz_m"], row["quaternion"])


def sweep(agent, frame, name="LIDAR"):
    """Points in the world."""
    path = SCENE / f"sensors/{agent}/{name}.parquet"
    row = rows(path, frame=frame)[0]
    mount = json.loads(pq.read_metadata(path).metadata[b"sensor"])["agent_from_sensor"]
    points = np.array([row["x"], row["y"], row["z"], np.ones(len(row["x"]))], float)
    return (agent_pose(agent, frame) @ matrix(mount["translation"], mount["quaternion"]) @ points)[:3].T


def inside(points, corners, margin):
    """Which points lie between the three pairs of faces of a box, by its corners."""
    edges = [(corners[4] - corners[0]), (corners[2] - corners[0]), (corners[1] - corners[0])]
    kept = np.ones(len(points), bool)
    for edge in edges:
        length = np.linalg.norm(edge)
        along = (points - corners[0]) @ edge / length
        kept &= (along >= -margin) & (along <= length + margin)
    return kept
