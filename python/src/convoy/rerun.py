"""Shows a scene in Rerun: `python -m convoy.rerun STORE SCENE [--save FILE.rrd]`."""

from __future__ import annotations

import argparse
import sys
from typing import Any

import numpy as np

from convoy.boxes import Boxes
from convoy.dataset import Dataset, Scene
from convoy.errors import StoreError
from convoy.frame import Agent
from convoy.poses import Array, quaternion

_COLOURS = {
    "divider": (230, 230, 230),
    "kerb": (150, 150, 150),
    "crosswalk": (90, 160, 230),
    "stop_line": (230, 80, 80),
}
_HEIGHTS_M = (-1.0, 6.0)


def _rerun() -> Any:
    try:
        import rerun
    except ImportError as fault:
        raise ImportError("convoy.rerun needs Rerun: pip install rerun-sdk pillow") from fault
    return rerun


def show(scene: Scene, *, every: int = 2, save: str | None = None) -> None:
    """Opens Rerun's viewer on a scene (every n-th frame), or writes a recording. Of each agent points, radar, pictures and masks
    where they are there; merged boxes and the map's lines in the world, from a whole metre near the first agent."""
    rr = _rerun()
    name = scene.dataset.location.rpartition("/")[2]
    recording = rr.RecordingStream(f"convoy {name} {scene.number:04d}")
    if save is None:
        recording.spawn()
    else:
        recording.save(save)
    # Viewers count in f32: a millimetre must survive far from the map's origin.
    origin = np.round(scene.frame(0).agent(scene.agents[0]).pose[:3, 3])
    recording.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    _map(rr, recording, scene, origin)
    for agent in (scene.frame(0).agent(name) for name in scene.agents):
        for name in agent.sensors:
            if name.startswith("RGB-"):
                sensor = agent.sensor(name)
                path = f"world/{agent.name}/{sensor.name}"
                recording.log(path, _pose(rr, sensor.agent_from_sensor), static=True)
                lens = rr.Pinhole(image_from_camera=sensor.intrinsics, width=sensor.width, height=sensor.height)
                recording.log(path, lens, static=True)
    for number in range(0, scene.frames, every):
        frame = scene.frame(number)
        recording.set_time("frame", sequence=number)
        recording.set_time("time", duration=frame.time_s)
        if number % scene.label_every_n_frames == 0 and "merge-tracks" in scene.stages:
            recording.log("world/boxes", _boxes(rr, frame.boxes(valid=True), origin))
        for name in scene.agents:
            _agent(rr, recording, frame.agent(name), origin)
    recording.flush()


def _agent(rr: Any, recording: Any, agent: Agent, origin: Array) -> None:
    path, number = f"world/{agent.name}", agent.frame.number
    pose = agent.pose.copy()
    pose[:3, 3] -= origin
    recording.log(path, _pose(rr, pose))
    for name in agent.sensors:
        about = None if name in ("visible", "boxes_2d") else agent.sensor(name)
        if about is None or number % about.every_n_frames:
            continue
        if name == "LIDAR":
            points = agent.points(name)
            recording.log(f"{path}/{name}", rr.Points3D(points[:, :3], colors=_by_height(points[:, 2]), radii=0.04))
        elif name.startswith("RAD_"):
            found = agent.radar(name)
            across = np.cos(found["altitude"])
            rays = [across * np.cos(found["azimuth"]), across * np.sin(found["azimuth"]), np.sin(found["altitude"])]
            recording.log(f"{path}/{name}", _pose(rr, about.agent_from_sensor))
            recording.log(f"{path}/{name}", rr.Points3D((np.stack(rays) * found["depth"]).T, radii=0.1))
        elif name.startswith("RGB-"):
            camera = agent.camera(about.name)
            recording.log(f"{path}/{about.name}", rr.EncodedImage(contents=camera.encoded, media_type="image/jpeg"))
    drawn = agent.frame.scene._files.has(agent.frame.scene.key(f"bev/{agent.name}.npz"))
    if drawn and number % int(agent._archive("bev").get("every_n_frames", 1)) == 0:
        masks = agent.bev().masks
        numbers = np.arange(1, len(masks) + 1, dtype=np.uint8)[:, None, None]
        recording.log(f"bev/{agent.name}", rr.SegmentationImage((masks * numbers).max(axis=0)))


def _map(rr: Any, recording: Any, scene: Scene, origin: Array) -> None:
    try:
        lines = scene.vector_map()
    except StoreError:
        return  # Imported scenes have none.
    wanted = {kind: [] for kind in _COLOURS}  # type: dict[str, list[Array]]
    for row in lines.select(["kind", "x_m", "y_m", "z_m", "rings"]).to_pylist():
        if row["kind"] in wanted:
            line = np.stack([row["x_m"], row["y_m"], row["z_m"]], axis=1) - origin
            wanted[row["kind"]] += np.split(line, row["rings"][1:]) if row["rings"] else [line]
    for kind, strips in wanted.items():
        recording.log(f"world/map/{kind}", rr.LineStrips3D(strips, colors=_COLOURS[kind], radii=0.05), static=True)


def _boxes(rr: Any, boxes: Boxes, origin: Array) -> Any:
    return rr.Boxes3D(
        centers=boxes.center - origin,
        half_sizes=boxes.size / 2,
        quaternions=[np.roll(quaternion(turn), -1) for turn in boxes.rotation],
        labels=[f"{name} {number}" for name, number in zip(boxes.class_name, boxes.id, strict=True)],
        class_ids=boxes.label,
        show_labels=False,
    )


def _pose(rr: Any, matrix: Array) -> Any:
    return rr.Transform3D(translation=matrix[:3, 3], mat3x3=matrix[:3, :3])


def _by_height(z: Array) -> Array:
    """Blue is low, red is high."""
    low, high = _HEIGHTS_M
    share = np.clip((z - low) / (high - low), 0, 1)[:, None]
    colours: Array = (np.array([40, 90, 255]) * (1 - share) + np.array([255, 70, 40]) * share).astype(np.uint8)
    return colours


def main() -> int:
    """`python -m convoy.rerun`."""
    parser = argparse.ArgumentParser(prog="python -m convoy.rerun", description="Shows a scene in Rerun.")
    parser.add_argument("store", help="folder or URL of the data set")
    parser.add_argument("scene", type=int, help="number of the scene")
    parser.add_argument("--every", type=int, default=2, help="every n-th frame (2)")
    parser.add_argument("--save", metavar="FILE", help="write a recording (.rrd) instead of opening the viewer")
    asked = parser.parse_args()
    try:
        show(Dataset(asked.store).scene(asked.scene), every=asked.every, save=asked.save)
    except (StoreError, ImportError) as fault:
        print(f"convoy.rerun: {fault}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
