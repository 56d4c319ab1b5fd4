"""Reads an export's MCAP files with the format's own Python reader and holds them against the store.

Usage: python3 mcap.py STORE EXPORT [depth]: depth where the export has depth pictures
Needs mcap and mcap-protobuf-support (pip); with foxglove-schemas-protobuf the schemas are held against Foxglove's own.
Exit code 77: something could not be looked at.
"""

import importlib
import io
import json
import pathlib
import sys
import zipfile

import numpy as np
import pyarrow.parquet as pq
from facts import texts

# This script's own name must not stand before the package's.
sys.path = [p for p in sys.path if pathlib.Path(p or ".").resolve() != pathlib.Path(__file__).resolve().parent]
try:
    from mcap.reader import NonSeekingReader, make_reader
    from mcap_protobuf.decoder import DecoderFactory
except ImportError:
    print("note: skipped the check of MCAP exports: it needs mcap and mcap-protobuf-support")
    sys.exit(77)

EPOCH_NS, PERIOD_NS = 10**18, 50_000_000
KINDS = {"IST": "instance", "SEG": "semantic", "RGB": "image"}
WITH_DEPTH = sys.argv[3:] == ["depth"]
NUMPY = {1: "u1", 3: "<u2", 7: "<f4"}


def matrix(xyz, q):
    """4 x 4 of a position and a quaternion of named parts."""
    w, x, y, z = q.w, q.x, q.y, q.z
    turn = np.eye(4)
    turn[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    turn[:3, 3] = xyz.x, xyz.y, xyz.z
    return turn


def of_store(xyz, wxyz):
    """4 x 4 of the store's position and quaternion, by rotating the axes with it."""
    w, v = wxyz[0], np.array(wxyz[1:])
    turn = np.eye(4)
    for axis in range(3):
        e = np.eye(3)[axis]
        turn[:3, axis] = e + 2 * w * np.cross(v, e) + 2 * np.cross(v, np.cross(v, e))
    turn[:3, 3] = xyz
    return turn


def move(to_from, points):
    return points @ to_from[:3, :3].T + to_from[:3, 3]


def elements(message):
    """Packed elements as a structured array."""
    stride = getattr(message, "point_stride", 0) or message.cell_stride
    kind = np.dtype({
        "names": [f.name for f in message.fields],
        "formats": [NUMPY[f.type] for f in message.fields],
        "offsets": [f.offset for f in message.fields],
        "itemsize": stride,
    })
    return np.frombuffer(message.data, kind)


def corners(cube):
    """Corners of a cube in the order of the store: rear left bottom, rear left top, rear right bottom, ..."""
    half = np.array([cube.size.x, cube.size.y, cube.size.z]) / 2
    signs = [[x, y, z] for x in (-1, 1) for y in (1, -1) for z in (-1, 1)]
    return move(matrix(cube.pose.position, cube.pose.orientation), np.array(signs) * half)


def check_schemas(channels, schemas):
    """Every schema's messages are Foxglove's, field by field."""
    from google.protobuf.descriptor_pb2 import FileDescriptorSet

    try:
        importlib.import_module("foxglove_schemas_protobuf")
    except ImportError:
        return False
    for schema in schemas.values():
        assert schema.encoding == "protobuf"
        files = FileDescriptorSet.FromString(schema.data).file
        names = {f"{f.package}.{m.name}" for f in files for m in f.message_type}
        assert schema.name in names, (schema.name, names)
        for file in files:
            assert file.syntax == "proto3" and len(file.message_type) == 1
            if file.package != "foxglove":
                continue
            name = file.message_type[0].name
            theirs = importlib.import_module(f"foxglove_schemas_protobuf.{name}_pb2").DESCRIPTOR
            want = type(file)()
            theirs.CopyToProto(want)
            assert file.name == want.name, (file.name, want.name)
            fields = {f.name: f for f in want.message_type[0].field}
            for field in file.message_type[0].field:
                other = fields.pop(field.name)
                for part in ("number", "type", "label", "type_name"):
                    assert getattr(field, part) == getattr(other, part), (name, field.name, part)
            # What was added to Foxglove's schemas later, or what nobody sets.
            assert not fields or name == "LocationFix", (name, list(fields))
            enums = {e.name: e for e in want.message_type[0].enum_type}
            for enum in file.message_type[0].enum_type:
                values = {v.name: v.number for v in enums[enum.name].value}
                assert {v.name: v.number for v in enum.value} == values, (name, enum.name)
    return True


class Scene:
    """A scene of the store beside its file."""

    def __init__(self, store, number, file):
        self.folder = store / f"scenes/{number:04d}"
        self.info = json.loads((self.folder / "log/scene.json").read_text())
        self.agents = pq.read_table(self.folder / "agents.parquet").to_pylist()
        self.map = pq.read_table(store / f"maps/{self.info['map']}.vector.parquet")
        self.file = file
        self.topics = {}
        with open(file, "rb") as stream:
            reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
            self.summary = reader.get_summary()
            last = 0
            for _, channel, raw, message in reader.iter_decoded_messages():
                assert raw.log_time == raw.publish_time >= last
                last = raw.log_time
                frame = (raw.log_time - EPOCH_NS) // PERIOD_NS
                assert raw.log_time == EPOCH_NS + frame * PERIOD_NS and raw.sequence == frame
                if hasattr(message, "timestamp"):
                    assert message.timestamp.ToNanoseconds() == raw.log_time
                found = self.topics.setdefault(channel.topic, {})
                assert frame not in found, (channel.topic, frame)
                found[frame] = message
            self.metadata = {m.name: m.metadata for m in reader.iter_metadata()}
            self.attachments = {a.name: a.data for a in reader.iter_attachments()}
        with open(file, "rb") as stream:
            read = sum(1 for _ in NonSeekingReader(stream, validate_crcs=True).iter_messages())
        assert read == self.summary.statistics.message_count == sum(map(len, self.topics.values()))

    def pose(self, agent, frame):
        row = next(r for r in self.agents if r["agent"] == agent and r["frame"] == frame)
        return of_store(row["xyz_m"], row["quaternion"])

    def sensor(self, agent, name):
        return self.folder / f"sensors/{agent}/{name}.parquet"

    def about(self, agent, name):
        return json.loads(pq.read_metadata(self.sensor(agent, name)).metadata[b"sensor"])

    def check_counts(self):
        """Every topic has a message at every frame at which the store has a reading, and there is no other topic."""
        frames, every = range(self.info["frames"]), self.info["label_every_n_frames"]
        want = {"/tf": list(frames), "/tf_static": [0], "/map": [0], "/weather": list(frames)}
        want["/boxes"] = [f for f in frames if f % every == 0]
        for agent in (a["agent"] for a in self.info["agents"]):
            want[f"/{agent}/state"] = list(frames)
            want[f"/{agent}/boxes"] = [f for f in frames if f % every == 0]
            for path in sorted((self.folder / f"sensors/{agent}").glob("*.parquet")):
                name = path.stem
                if b"sensor" not in pq.read_metadata(path).metadata:
                    continue
                read = pq.read_table(path, columns=["frame"])["frame"].to_pylist()
                kind, _, camera = name.partition("-")
                if kind in KINDS and "image" in pq.read_schema(path).names:
                    want[f"/{agent}/{camera}/{KINDS[kind]}"] = read
                    want[f"/{agent}/{camera}/calibration"] = read
                elif kind == "DPT":
                    if WITH_DEPTH:
                        want[f"/{agent}/{camera}/depth"] = read
                elif kind != "FLW":
                    want[f"/{agent}/{name}"] = read
            for folder, topic in (("bev", "bev"), ("occupancy", "occupancy")):
                path = self.folder / f"{folder}/{agent}.npz"
                if path.exists():
                    want[f"/{agent}/{topic}"] = [int(n[:4]) for n in zipfile.ZipFile(path).namelist()]
        assert want.keys() == self.topics.keys(), want.keys() ^ self.topics.keys()
        for topic, read in want.items():
            assert sorted(self.topics[topic]) == read, topic
        counts = {c.topic: c.id for c in self.summary.channels.values()}
        for topic, read in want.items():
            assert self.summary.statistics.channel_message_counts[counts[topic]] == len(read), topic
        assert self.metadata["convoy"]["scene"] == str(self.info["scene"])
        assert json.loads(self.attachments["scene.json"]) == self.info

    def check_poses(self):
        """Agents and sensors are where the store has them."""
        for frame, message in self.topics["/tf"].items():
            assert [t.parent_frame_id for t in message.transforms] == ["world"] * len(self.info["agents"])
            for t in message.transforms:
                assert np.allclose(matrix(t.translation, t.rotation), self.pose(t.child_frame_id, frame), atol=1e-9)
        self.mounted = {}
        for t in self.topics["/tf_static"][0].transforms:
            agent, _, name = t.child_frame_id.partition("/")
            assert agent == t.parent_frame_id
            files = [p for p in (self.folder / f"sensors/{agent}").glob("*.parquet") if p.stem.endswith(name)]
            mount = next(a for a in (self.about(agent, p.stem) for p in files) if a["name"] == name)["agent_from_sensor"]
            self.mounted[t.child_frame_id] = matrix(t.translation, t.rotation)
            assert np.allclose(self.mounted[t.child_frame_id], of_store(mount["translation"], mount["quaternion"]))
        for row in self.agents:
            state = self.topics[f"/{row['agent']}/state"][row["frame"]]
            v, w = state.velocity_mps, state.angular_velocity_radps
            assert [v.x, v.y, v.z] == row["velocity_mps"] and [w.x, w.y, w.z] == row["angular_velocity_radps"]
            assert state.object_id == row["id"]
        for row in pq.read_table(self.folder / "log/frames.parquet").to_pylist():
            weather = self.topics["/weather"][row["frame"]]
            for field in weather.DESCRIPTOR.fields:
                assert field.name == "timestamp" or getattr(weather, field.name) == row[field.name], field.name

    def check_sensors(self, agent):
        """Points, fixes, readings and pictures are the store's."""
        for path in sorted((self.folder / f"sensors/{agent}").glob("*.parquet")):
            name, table = path.stem, pq.read_table(path)
            columns = table.column_names
            if "ring" in columns:
                for row in table.to_pylist():
                    cloud = self.topics[f"/{agent}/{name}"][row["frame"]]
                    points = elements(cloud)
                    assert cloud.frame_id == f"{agent}/{name}" and len(points) == len(row["x"])
                    for column in points.dtype.names:
                        assert (points[column] == np.array(row[column], points.dtype[column])).all(), (name, column)
                    assert set(columns) - {"scene", "frame", "time_s", "cos_angle"} == set(points.dtype.names)
            elif "snr_db" in columns:
                for row in table.to_pylist():
                    points = elements(self.topics[f"/{agent}/{name}"][row["frame"]])
                    assert len(points) == len(row["depth"])
                    x, y, z = (points[c].astype(float) for c in "xyz")
                    depth = np.sqrt(x * x + y * y + z * z)
                    assert np.allclose(depth, row["depth"], rtol=1e-5)
                    assert np.allclose(np.arctan2(y, x), row["azimuth"], atol=1e-5)
                    assert np.allclose(np.arcsin(z / depth), row["altitude"], atol=1e-5)
                    assert (points["velocity"] == np.array(row["velocity"], "f4")).all()
                    assert (points["id"] == row["id"]).all()
            elif "latitude_deg" in columns:
                for row in table.to_pylist():
                    fix = self.topics[f"/{agent}/{name}"][row["frame"]]
                    want = row["latitude_deg"], row["longitude_deg"], row["altitude_m"]
                    assert (fix.latitude, fix.longitude, fix.altitude) == want
            elif "compass_rad" in columns:
                for row in table.to_pylist():
                    imu = self.topics[f"/{agent}/{name}"][row["frame"]]
                    a, w = imu.acceleration_mps2, imu.gyroscope_radps
                    assert [a.x, a.y, a.z] == row["acceleration_mps2"] and [w.x, w.y, w.z] == row["gyroscope_radps"]
                    assert imu.compass_rad == row["compass_rad"]
            elif name[:3] in KINDS and "image" in columns:
                about, camera = self.about(agent, name), name[4:]
                for row in table.to_pylist():
                    image = self.topics[f"/{agent}/{camera}/{KINDS[name[:3]]}"][row["frame"]]
                    assert image.data == row["image"] and image.frame_id == f"{agent}/{camera}"
                    assert image.data.startswith(b"\xff\xd8\xff" if image.format == "jpeg" else b"\x89PNG")
                    cal = self.topics[f"/{agent}/{camera}/calibration"][row["frame"]]
                    assert np.allclose(np.reshape(cal.K, (3, 3)), about["intrinsics"])
                    assert (cal.width, cal.height) == (about["width"], about["height"])
                    assert cal.frame_id == image.frame_id and not any(cal.D)
            elif name.startswith("DPT-") and WITH_DEPTH:
                self.check_depth(agent, name[4:], table)

    def check_depth(self, agent, camera, table):
        from PIL import Image

        for row in table.to_pylist():
            raw = self.topics[f"/{agent}/{camera}/depth"][row["frame"]]
            assert raw.encoding == "32FC1" and raw.step == 4 * raw.width
            rgb = np.asarray(Image.open(io.BytesIO(row["image"]))).astype(float)
            metres = (rgb @ [1, 256, 65536]) * 1000 / (2**24 - 1)
            assert np.allclose(np.frombuffer(raw.data, "<f4").reshape(raw.height, raw.width), metres, atol=1e-4)

    def check_boxes(self):
        """Boxes are the store's, corner by corner."""
        raw, seen = (pq.read_table(self.folder / f"{n}.parquet").to_pylist() for n in ("boxes", "boxes_valid"))
        every = self.info["label_every_n_frames"]
        count = 0
        for row, valid in zip(raw, seen, strict=True):
            update = self.topics[f"/{row['agent']}/boxes"][row["frame"]]
            entity = next(e for e in update.entities if e.id == str(row["id"]))
            self.check_entity(entity, row, every, valid)
            facts = {m.key: m.value for m in entity.metadata}
            assert facts["valid_flag"] == str(valid["valid_flag"]).lower()
            assert facts["num_lidar_pts"] == str(valid["num_lidar_pts"]) and facts["num_pixels"] == str(valid["num_pixels"])
            assert facts["difficulty"] == valid["difficulty"] and facts["model"] == row["model"]
            assert json.loads(facts["attributes"]) == texts(row["attributes"])
            count += 1
        agents = [f"/{a['agent']}/boxes" for a in self.info["agents"]]
        assert count == sum(len(m.entities) for t in agents for m in self.topics[t].values())
        merged = pq.read_table(self.folder / "tracks_frames.parquet").to_pylist()
        for row in merged:
            entity = next(e for e in self.topics["/boxes"][row["frame"]].entities if e.id == str(row["id"]))
            self.check_entity(entity, row, every, row)
        assert len(merged) == sum(len(m.entities) for m in self.topics["/boxes"].values())
        assert count and merged

    def check_entity(self, entity, row, every, valid):
        (cube,), (text,) = entity.cubes, entity.texts
        assert entity.frame_id == "world" and not entity.frame_locked
        assert entity.lifetime.ToNanoseconds() == every * PERIOD_NS
        assert np.allclose(corners(cube), np.reshape(row["corners_m"], (8, 3)), atol=1e-4), (row["frame"], row["id"])
        assert text.text == f"{row['class']} {row['id']}"
        assert (cube.color.a > 0.3) == valid["valid_flag"]
        speed = np.linalg.norm(row["velocity_mps"])
        assert len(entity.arrows) == (speed >= 0.5)
        for arrow in entity.arrows:
            along = matrix(arrow.pose.position, arrow.pose.orientation)[:3, 0] * arrow.shaft_length
            assert np.allclose(along, row["velocity_mps"], atol=1e-5)

    def check_points_in_boxes(self):
        """Points of all agents, moved by the file's transforms, lie in the merged boxes of the objects that they hit."""
        inside = total = 0
        for frame, update in self.topics["/boxes"].items():
            boxes = {int(e.id): e.cubes[0] for e in update.entities if not e.id == "0"}
            for t in self.topics["/tf"][frame].transforms:
                cloud = self.topics.get(f"/{t.child_frame_id}/LIDAR", {}).get(frame)
                if cloud is None:
                    continue
                world = matrix(t.translation, t.rotation) @ self.mounted[cloud.frame_id]
                points = elements(cloud)
                xyz = move(world, np.stack([points[c].astype(float) for c in "xyz"], 1))
                for id_, cube in boxes.items():
                    own = xyz[points["id"] == id_]
                    if len(own) == 0 or not cube.size.x > 1:
                        continue
                    pose = np.linalg.inv(matrix(cube.pose.position, cube.pose.orientation))
                    half = np.array([cube.size.x, cube.size.y, cube.size.z]) / 2 + 0.15
                    inside += (abs(move(pose, own)) < half).all(1).sum()
                    total += len(own)
        assert total > 0 and inside > 0.97 * total, (inside, total)

    def check_boxes_in_pictures(self):
        """Pixels of an object lie within its box as the file's calibration and transforms project it."""
        from PIL import Image

        looked = 0
        for topic in [t for t in self.topics if t.endswith("/instance")]:
            agent, camera = topic.split("/")[1:3]
            for frame, image in list(self.topics[topic].items())[::5]:
                cal = self.topics[f"/{agent}/{camera}/calibration"][frame]
                t = next(t for t in self.topics["/tf"][frame].transforms if t.child_frame_id == agent)
                world = matrix(t.translation, t.rotation) @ self.mounted[cal.frame_id]
                rgb = np.asarray(Image.open(io.BytesIO(image.data)).convert("RGB")).astype(int)
                ids = rgb[:, :, 1] + 256 * rgb[:, :, 2]
                for entity in self.topics[f"/{agent}/boxes"].get(frame, type("N", (), {"entities": []})).entities:
                    shown = np.argwhere(ids == int(entity.id))
                    at = move(np.linalg.inv(world), corners(entity.cubes[0]))
                    # Poles of lights and signs have their ids and stand outside of their boxes.
                    if len(shown) < 20 or (at[:, 2] < 0.5).any() or entity.texts[0].text.startswith("traffic_"):
                        continue
                    uv = at @ np.reshape(cal.K, (3, 3)).T
                    uv = uv[:, :2] / uv[:, 2:]
                    low, high = uv.min(0) - 2, uv.max(0) + 2
                    where = shown[:, ::-1] + 0.5
                    assert ((where > low) & (where < high)).all(1).mean() > 0.97, (topic, frame, entity.id)
                    looked += 1
        assert looked > 0

    def check_masks(self, agent):
        """Each cell's classes are those of the mask at its place."""
        path = self.folder / f"bev/{agent}.npz"
        if not path.exists():
            return
        about = json.loads(zipfile.ZipFile(path).comment)
        half, masks = about["cells"] * about["cell_m"] / 2, np.load(path)
        for frame, grid in list(self.topics[f"/{agent}/bev"].items())[::4]:
            cells = elements(grid)
            i = np.arange(len(cells))
            rows, columns = i // grid.column_count, i % grid.column_count
            assert grid.row_stride == grid.column_count * grid.cell_stride
            flat = [(columns + 0.5) * grid.cell_size.x, (rows + 0.5) * grid.cell_size.y, 0 * i]
            world = move(matrix(grid.pose.position, grid.pose.orientation), np.stack(flat, 1))
            assert np.ptp(world[:, 2]) < 1e-9, "the grid is level"
            pose = self.pose(agent, frame)
            yaw = np.arctan2(pose[1, 0], pose[0, 0])
            d = world[:, :2] - pose[:2, 3]
            x, y = np.cos(yaw) * d[:, 0] + np.sin(yaw) * d[:, 1], np.cos(yaw) * d[:, 1] - np.sin(yaw) * d[:, 0]
            r, c = (np.floor((half - v) / about["cell_m"]).astype(int) for v in (x, y))
            mask = masks[f"{frame:04d}"][:, r, c]
            for bit in range(len(mask)):
                assert ((cells["classes"] >> bit & 1) == mask[bit]).all(), (agent, frame, about["classes"][bit])
            assert ((cells["alpha"] > 0) == mask.any(0)).all() and mask.any()

    def check_voxels(self, agent):
        """Each cell is occupied where one of those that it is made of is, and has one of their tags."""
        path = self.folder / f"occupancy/{agent}.npz"
        if not path.exists():
            return
        about, grids = json.loads(zipfile.ZipFile(path).comment), np.load(path)
        for frame, grid in list(self.topics[f"/{agent}/occupancy"].items())[::7]:
            cells, whole = elements(grid), grids[f"{frame:04d}"]
            assert grid.frame_id == agent
            shape = (len(cells) * grid.cell_stride // grid.slice_stride, grid.row_count, grid.column_count)
            tags = cells["tag"].reshape(shape)
            block = round(grid.cell_size.x / about["voxel_m"])
            corner = [grid.pose.position.x, grid.pose.position.y, grid.pose.position.z]
            origin = [-about["range_m"], -about["range_m"], about["lower_m"] + about["mount_z_m"]]
            first = np.round((np.array(corner) - origin) / about["voxel_m"]).astype(int)
            assert np.allclose(first * about["voxel_m"] + origin, corner)
            n = shape[2] * block
            part = whole[first[0]:first[0] + n, first[1]:first[1] + n]
            part = np.pad(part, ((0, 0), (0, 0), (0, shape[0] * block - part.shape[2])))
            blocks = part.reshape(shape[2], block, shape[1], block, shape[0], block)
            blocks = blocks.transpose(4, 2, 0, 1, 3, 5).reshape(*shape, -1)
            assert ((tags > 0) == (blocks > 0).any(-1)).all() and (tags > 0).any()
            assert ((blocks == tags[..., None]).any(-1) | (tags == 0)).all()
            assert ((cells["alpha"] > 0) == (cells["tag"] > 0)).all()

    def check_map(self):
        """Lines of the map are the store's, and none near an agent is missing."""
        rows = self.map.to_pylist()
        known = {}
        for row in rows:
            starts = row["rings"] or [0]
            points = np.stack([row["x_m"], row["y_m"], row["z_m"]], 1)
            for start, end in zip(starts, starts[1:] + [len(points)]):
                known.setdefault(row["kind"], set()).add(points[start:end].tobytes())
        drawn = {}
        for entity in self.topics["/map"][0].entities:
            assert entity.frame_id == "world" and entity.lifetime.ToNanoseconds() == 0
            for line in entity.lines:
                points = np.array([[p.x, p.y, p.z] for p in line.points]).tobytes()
                assert line.type == 0 and points in known[entity.id], entity.id
                drawn.setdefault(entity.id, set()).add(points)
        agents = np.array([r["xyz_m"][:2] for r in self.agents])
        near = 0
        for row in rows:
            points = np.stack([row["x_m"], row["y_m"], row["z_m"]], 1)
            close = np.linalg.norm(points[:, None, :2] - agents[None, ::20], axis=2).min() < 50
            if close and not row["rings"] and len(points) > 1:
                assert points.tobytes() in drawn[row["kind"]], (row["kind"], row["id"])
                near += 1
        assert near > 0


def main():
    store, export = map(pathlib.Path, sys.argv[1:3])
    plan = pq.read_table(store / "plan/scenes.parquet").to_pylist()
    files = {export / p["split"] / f"scene_{p['scene']:04d}.mcap": p["scene"] for p in plan}
    assert set(files) == set(export.rglob("*.mcap")), "a file for each scene"
    compared = True
    for file, number in files.items():
        scene = Scene(store, number, file)
        compared &= check_schemas(scene.summary.channels, scene.summary.schemas)
        scene.check_counts()
        scene.check_poses()
        for agent in (a["agent"] for a in scene.info["agents"]):
            scene.check_sensors(agent)
            scene.check_masks(agent)
            scene.check_voxels(agent)
        scene.check_boxes()
        scene.check_points_in_boxes()
        scene.check_boxes_in_pictures()
        scene.check_map()
        print(f"{file}: {scene.summary.statistics.message_count} messages in {len(scene.topics)} topics")
    if not compared:
        print("note: schemas were not held against Foxglove's: that needs foxglove-schemas-protobuf")
        sys.exit(77)


main()
