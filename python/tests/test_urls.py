"""Stores in a bucket, beside the same ones in a folder; what is said of URLs and services that are wrong."""

import dataclasses
import multiprocessing
import os
import pickle
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
import pyarrow as pa
from bucket import VARIABLES, Server, variables
from plain import STORE

import convoy
from convoy import clouds, places

FRAME = 10
"""There is everything at it."""
FAR = {"comm_range_m": 1000.0, "elevation_m": 100.0}
IMAGES = {"RGB": "image", "SEG": "image", "IST": "instances", "DPT": "depth"}
ARRAYS = ("bev_paint", "bev_ids", "bev_heights", "occupancy_ids", "occupancy_flow", "occupancy_observed")
SECRET = "AKIAEXAMPLE"


def of_agent(agent, decode):
    """All that is there of an agent, by name."""
    own = agent.name != "rsu_0"
    yield from ((name, getattr(agent, name)) for name in ("id", "pose", "velocity", "angular_velocity", "sensors"))
    for name in agent.sensors:
        if name in ("visible", "boxes_2d"):
            continue
        yield f"sensor {name}", agent.sensor(name)
        kind, _, camera = name.partition("-")
        if kind in IMAGES and camera.startswith("CAM"):
            picture = agent.camera(camera, kind)
            yield name, (picture.encoded, getattr(picture, IMAGES[kind])() if decode else None)
        elif kind == "FLW":
            yield name, agent.flow(camera)
        elif name in ("GNSS", "IMU"):
            yield name, (agent.gnss if name == "GNSS" else agent.imu)()
        else:
            yield name, agent._readings(name)
    yield "points", agent.points()
    yield "boxes_2d", agent.boxes_2d() if own else None
    yield from (("hd_map", agent.hd_map()), ("boxes", agent.boxes()), ("seen", agent.boxes(valid=True)))
    yield from (("bev", agent.bev()), ("voxels", agent.occupancy()), ("hollow", agent.occupancy(filled=False)))
    for kind in ARRAYS:
        if agent.frame.scene._files.has(agent.frame.scene.key(f"{kind}/{agent.name}.npz")):
            yield kind, agent.array(kind)


def of_store(dataset, decode):
    """All that is there of a store, by name."""
    yield from ((name, getattr(dataset, name)) for name in ("splits", "groups", "config", "editions"))
    yield from ((name, dataset.plan(name)) for name in ("scenes", "agents", "hazards"))
    for scene in dataset.scenes():
        named = f"scene {scene.number}"
        yield named, (scene.split, scene.frames, scene.edition, scene.group, scene.stages, scene.info, scene.agents)
        tables = ("tracks", "log/actors", "boxes_valid")
        yield from ((f"{named}, {name}", scene.table(name)) for name in tables)
        yield f"{named}, map", scene.vector_map()
        frame = scene.frame(FRAME)
        heard = frame.cooperative("vehicle_1", "x2x", 1000, 100)
        yield from ((f"{named}, boxes", frame.boxes()), (f"{named}, heard", (heard.points(), heard.ego_from_agent)))
        for name in frame.agents:
            for what, value in of_agent(frame.agent(name), decode):
                yield f"{named}, {name}, {what}", value
    for kind, samples in of_samples(dataset).items():
        yield from ((f"{kind} {number}", samples[number]) for number in range(0, len(samples), 3))


def of_samples(dataset):
    return {
        "detection": convoy.DetectionSamples(dataset, mode="x2x", **FAR),
        "segmentation": convoy.SegmentationSamples(dataset, mode="x2i", points="agent", **FAR),
    }


def same(a, b):
    """Equal in all parts; NaN is NaN."""
    if dataclasses.is_dataclass(a):
        return all(same(getattr(a, field.name), getattr(b, field.name)) for field in dataclasses.fields(a))
    if isinstance(a, np.ndarray):
        kinds = a.dtype == b.dtype and a.shape == b.shape
        return kinds and (np.array_equal(a, b) or np.array_equal(a, b, equal_nan=a.dtype.kind == "f"))
    if isinstance(a, pa.Table):
        return a.equals(b)
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(value, b[key]) for key, value in a.items())
    if isinstance(a, list | tuple):
        return len(a) == len(b) and all(same(x, y) for x, y in zip(a, b, strict=True))
    return type(a) is type(b) and a == b


def two_scenes(folder):
    """The store with its scene 0 as scene 1, too."""
    shutil.copytree(STORE, folder, ignore=shutil.ignore_patterns("tiles", "stats", "_locks"))
    shutil.rmtree(folder / "scenes/0001", ignore_errors=True)
    shutil.copytree(folder / "scenes/0000", folder / "scenes/0001")
    for manifest in (folder / "scenes/0001/_manifests").glob("*.json"):
        manifest.write_text(manifest.read_text().replace("scenes/0000", "scenes/0001"))


def sums(samples):
    return [float(samples[number]["points"][0].sum(dtype=np.float64)) for number in range(4)]


def until(over, scene):
    """Asks the service, and does nothing more: what imports modules, as pyarrow does when it converts, may not run when a process
    forks."""
    while not over.is_set():
        scene.table("log/actors")
        convoy.files._handles.clear()


def in_a_worker(samples, queue):
    try:
        queue.put(sums(samples))
    except (convoy.StoreError, OSError, ValueError) as fault:
        queue.put(repr(fault))


class Buckets(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        try:
            cls.server = Server()
        except ImportError:
            raise unittest.SkipTest("moto, for stores in buckets (pip install 'moto[server]')") from None
        cls.addClassCleanup(cls.server.close)
        around = variables(**VARIABLES, AWS_ENDPOINT_URL=cls.server.url)
        around.start()
        cls.addClassCleanup(around.stop)
        place = tempfile.TemporaryDirectory()
        cls.addClassCleanup(place.cleanup)
        cls.folder = Path(place.name) / "store"
        two_scenes(cls.folder)
        cls.server.put("v2x")
        for path in cls.folder.rglob("*.*"):
            cls.server.put(f"v2x/sets/one/{path.relative_to(cls.folder)}", path.read_bytes())
        cls.url = "s3://v2x/sets/one"

    def tearDown(self):
        self.server.fail()

    def fault(self, url):
        with self.assertRaises(convoy.StoreError) as caught:
            convoy.Dataset(url).scene(0).frame(0).agent("vehicle_0").lidar()
        self.assertEqual(str(pickle.loads(pickle.dumps(caught.exception))), str(caught.exception))
        self.assertNotIn("\n", str(caught.exception))
        self.assertNotIn("hush", str(caught.exception))
        return str(caught.exception)

    def test_everything_is_as_in_a_folder(self):
        try:
            import PIL  # noqa: F401

            decode = True
        except ImportError:
            decode = False
        dataset = convoy.Dataset(self.url + "/")
        self.assertEqual((dataset.location, dataset.path), (self.url, None))
        self.assertEqual(repr(dataset), f"Dataset({self.url!r})")
        wanted = dict(of_store(convoy.Dataset(self.folder), decode))
        self.assertGreater(len(wanted), 250)
        self.assertEqual([scene.number for scene in dataset.scenes()], [0, 1])
        # As it is; then all objects as if they were large, with ends that are longer than what is read first.
        for whole, tail in ((places.WHOLE, places.TAIL), (0, 1000)):
            with mock.patch.multiple(places, WHOLE=whole, TAIL=tail):
                found = dict(of_store(convoy.Dataset(self.url), decode))
            self.assertEqual(found.keys(), wanted.keys())
            for name, value in wanted.items():
                self.assertTrue(same(value, found[name]), f"{name}, whole up to {whole}")
            convoy.files._handles.clear()

    def test_little_is_asked(self):
        asked, made = self.server.requests, {}
        convoy.files._handles.clear()

        def opened():
            made["dataset"] = convoy.Dataset(self.url)

        def seen():
            made["agent"] = made["dataset"].scene(0).frame(FRAME).agent("vehicle_0")

        # Manifest, dataset.json, scenes and roster: each is asked for its size and read.
        self.assertEqual(asked(opened), "HG" * 4)
        found = asked(lambda: made["dataset"].scene(0))
        self.assertEqual("".join(sorted(found)), "G" * 6 + "H" * 6 + "L")
        self.assertEqual(asked(seen), "HG")  # Poses, to know the agents.
        agent = made["agent"]
        with mock.patch.multiple(places, WHOLE=0):  # As large files are read.
            self.assertEqual(asked(agent.lidar), "HGG")
            self.assertEqual(asked(lambda: made["dataset"].scene(0).frame(0).agent("vehicle_0").lidar()), "G")
            self.assertEqual(asked(lambda: agent.camera("CAM_FRONT")), "HGG")
        self.assertEqual(asked(agent.bev), "HG")
        self.assertEqual(asked(made["dataset"].scene(0).frame(0).agent("vehicle_0").bev), "")
        self.assertEqual(asked(lambda: made["dataset"].scenes("train")), "")

    def test_members_of_a_large_archive_are_a_request_each(self):
        convoy.files._handles.clear()
        frames = [convoy.Dataset(self.url).scene(0).frame(k).agent("vehicle_0") for k in (2, 4, 4, 6)]
        with mock.patch.multiple(places, WHOLE=0, TAIL=4000):
            found = [self.server.requests(frame.bev) for frame in frames]
        # The end, all that may be the archive's comment, a member.
        self.assertEqual(found, ["HGGG", "G", "", "G"])

    def test_workers_read_for_themselves(self):
        samples = convoy.DetectionSamples(self.url, mode="x2v", **FAR)
        wanted = sums(samples)  # The parent has connections now.
        self.assertEqual(sums(pickle.loads(pickle.dumps(samples))), wanted)
        # A thread that asks all the time must not hold locks of Amazon's library when the fork comes.
        over = threading.Event()
        other = threading.Thread(target=until, args=(over, convoy.Dataset(self.url).scene(1)))
        other.start()
        self.addCleanup(other.join)
        self.addCleanup(over.set)
        for method, count in (("fork", 3), ("spawn", 1)):
            context = multiprocessing.get_context(method)
            queue = context.Queue()
            workers = [context.Process(target=in_a_worker, args=(samples, queue)) for _ in range(count)]
            for worker in workers:
                worker.start()
            again = sums(samples)
            found = [queue.get(timeout=120) for _ in workers]
            for worker in workers:
                worker.join()
            self.assertEqual(found, [wanted] * count, method)
            self.assertEqual(again, wanted)
        self.assertEqual(sums(samples), wanted)

    def test_profiles_are_known(self):
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "keys").write_text(
                "[other]\naws_access_key_id = another\naws_secret_access_key = hush\n"
                "[default]\naws_access_key_id = default\naws_secret_access_key = hush\n"
            )
            around = {name: value for name, value in os.environ.items() if not name.startswith("AWS_")}
            around |= {"AWS_PROFILE": "other", "AWS_SHARED_CREDENTIALS_FILE": f"{folder}/keys"}
            Path(folder, "config").write_text(
                f"[default]\nendpoint_url = http://127.0.0.1:9\n[profile other]\nendpoint_url = {self.server.url}\n"
            )
            around |= {"AWS_CONFIG_FILE": f"{folder}/config", "AWS_EC2_METADATA_DISABLED": "true"}
            around |= {"PYTHONPATH": str(Path(convoy.__file__).parents[1])}
            code = f"import convoy; print(convoy.Dataset({self.url!r}).splits)"
            # In another process, as Amazon's library reads the files once.
            command = [sys.executable, "-c", code]
            users = self.server.users(
                lambda: subprocess.run(command, env=around, check=True, stdout=subprocess.DEVNULL)
            )
        self.assertEqual(users, {"another"})

    def test_stores_that_are_not_there(self):
        self.assertIn("there is no bucket nowhere [", self.fault("s3://nowhere/sets/one"))
        self.assertIn("bucket v2x has no store under the prefix sets/two [", self.fault("s3://v2x/sets/two"))
        self.assertIn("bucket v2x has no store at its root [", self.fault("s3://v2x"))

    def test_services_that_refuse_or_are_away(self):
        with mock.patch.object(clouds, "ATTEMPTS", 1), mock.patch.object(clouds, "_systems", {}):
            self.server.fail("403 Forbidden", "AccessDenied")
            self.assertIn("the credentials for bucket v2x are refused (ACCESS_DENIED)", self.fault(self.url))
            self.server.fail("301 Moved Permanently", "PermanentRedirect")
            self.assertIn("bucket v2x is in another region than was asked", self.fault(self.url))
            self.server.fail("503 Slow Down", "SlowDown")
            away = f"the endpoint {self.server.url} does not answer (UNKNOWN (HTTP status 503)) ["
            self.assertIn(away, self.fault(self.url))
            self.server.fail()
            dataset = convoy.Dataset(self.url)
            convoy.files._handles.clear()
            self.server.fail("403 Forbidden", "InvalidAccessKeyId")
            # A list has words that an answer to HEAD has not.
            with self.assertRaisesRegex(convoy.StoreError, r"scene 0: .* refused \(INVALID_ACCESS_KEY_ID\)"):
                dataset.scene(0)
            with socket.socket() as nobody:
                nobody.bind(("127.0.0.1", 0))
                with mock.patch.dict(os.environ, AWS_ENDPOINT_URL=f"http://127.0.0.1:{nobody.getsockname()[1]}"):
                    self.assertRegex(self.fault(self.url), r"the endpoint http://127\S+ does not answer \(curlCode: 7")

    def test_objects_that_are_not_as_their_manifest_says(self):
        key = "scenes/0001/sensors/rsu_0/LIDAR.parquet"
        file, whole = f"v2x/sets/one/{key}", (self.folder / key).read_bytes()
        agent = convoy.Dataset(self.url).scene(1).frame(FRAME).agent("rsu_0")
        convoy.files._handles.clear()
        try:
            for damage, words in {
                whole[:-7]: "its manifest says",
                b"?" * len(whole): "cannot be read (",
                None: "cannot be read (No such file)",
            }.items():
                self.server.put(file, damage)
                for limit in (0, places.WHOLE):
                    with self.subTest(words), mock.patch.object(places, "WHOLE", limit):
                        with self.assertRaises(convoy.StoreError) as caught:
                            agent.lidar()
                        self.assertIn("scene 1, frame 10, agent rsu_0, sensor LIDAR: ", str(caught.exception))
                        self.assertIn(words, str(caught.exception))
                        self.assertIn("STAGE=render-sensors FORCE=1 SCENES=1", str(caught.exception))
        finally:
            self.server.put(file, whole)
        self.assertGreater(len(agent.lidar()), 0)


class Urls(unittest.TestCase):
    def setUp(self):
        around = variables()
        around.start()
        self.addCleanup(around.stop)

    def said(self, url, **environment):
        with mock.patch.dict(os.environ, environment), self.assertRaises(convoy.StoreError) as caught:
            convoy.Dataset(url)
        self.assertNotIn("\n", str(caught.exception))
        self.assertNotIn(SECRET, str(caught.exception))
        return str(caught.exception)

    def test_what_is_wrong_with_a_url(self):
        for url, words in {
            f"http://me:{SECRET}@host/set": "there is no store of kind http://; give a folder or file://, s3://, gs:// or az://",
            "S3://bucket/set": "no store of kind S3://",
            f"s3://{SECRET}:{SECRET}@bucket/set": "takes no credentials",
            f"gs://{SECRET}@bucket": "takes no credentials",
            f"az://box/set?sig={SECRET}": "takes no options",
            "s3://bucket/a//b": "has no such parts",
            "gs://bucket/../b": "has no such parts",
            "s3://": "a s3:// URL names no bucket; give s3://BUCKET/PREFIX",
            "s3:///set": "names no bucket",
            "az:///set": "names no container; give az://CONTAINER/PREFIX",
            "s3://a bucket/set": "no such name",
            "file://server/data": "file:///FOLDER",
            Path("s3://bucket/set"): "give it as a str",
        }.items():
            with self.subTest(url):
                self.assertIn(words, self.said(url))
        with self.assertRaisesRegex(convoy.StoreError, "takes no credentials"):
            convoy.evaluate("predictions.parquet", f"s3://me:{SECRET}@bucket", program=sys.executable)

    def test_file_urls_are_folders(self):
        with tempfile.TemporaryDirectory() as folder:
            named = Path(folder, "a store")
            named.symlink_to(STORE)
            for url in (f"file://{folder}/a%20store", f"file://localhost{named}", str(named), named):
                dataset = convoy.Dataset(url)
                self.assertEqual((dataset.path, dataset.location), (named, str(named)))
        self.assertIn("there is no finished plan here [/no/such/", self.said("file:///no/such"))

    def test_what_is_wrong_with_the_environment(self):
        self.assertIn("only one of", self.said("s3://bucket/set", AWS_SECRET_ACCESS_KEY=SECRET))
        self.assertIn(
            "AWS_ENDPOINT_URL, or that of the profile, is no address",
            self.said("s3://bucket/set", AWS_ENDPOINT_URL=f"http://me:{SECRET}@host"),
        )
        self.assertRegex(self.said("az://box/set"), "set AZURE_STORAGE_ACCOUNT_NAME|knows no az://")
        try:
            from pyarrow import fs
        except ImportError:
            return
        for scheme, name in {"s3": "S3FileSystem", "gs": "GcsFileSystem", "az": "AzureFileSystem"}.items():
            with mock.patch.dict(vars(fs)):  # A build without it.
                vars(fs).pop(name, None)
                self.assertIn(f"knows no {scheme}://; install", self.said(f"{scheme}://bucket/set"))

    def test_endpoints_are_those_of_the_variables(self):
        for given, wanted in {
            ("http://127.0.0.1:9000/", ""): ("http", "127.0.0.1:9000"),
            ("https://s3.example.org/base", ""): ("https", "s3.example.org/base"),
            ("s3.example.org:9000", ""): ("https", "s3.example.org:9000"),
            ("localhost:9000", "TRUE"): ("http", "localhost:9000"),
        }.items():
            with mock.patch.dict(os.environ, AWS_ENDPOINT_URL=given[0], AWS_ALLOW_HTTP=given[1]):
                self.assertEqual(clouds._s3_endpoint(), wanted)
        self.assertIsNone(clouds._s3_endpoint())
        both = {"AWS_ENDPOINT_URL": "http://one", "AWS_ENDPOINT_URL_S3": "http://other"}
        with mock.patch.dict(os.environ, both):
            self.assertEqual(clouds._s3_endpoint(), ("http", "other"))


if __name__ == "__main__":
    unittest.main()
