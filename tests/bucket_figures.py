"""What a bucket costs beside a disk, and what tasks at once ask of it: bucket_figures.py FOLDER_OF_PROGRAMS [ROUNDS].

Needs `s3s-fs` (cargo install s3s-fs --version 0.14.1 --features binary). CONFIG names what is made, `configs/demo.toml`
without; TASKS what the tasks make, eight of the smallest scenes without.
"""

import os
import pathlib
import shutil
import socket
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).parent
SERVER, PROXY = 18024, 18025
KEYS = {"AWS_ACCESS_KEY_ID": "test", "AWS_SECRET_ACCESS_KEY": "testsecret", "AWS_REGION": "us-east-1"}


def listens(port):
    for _ in range(100):
        with socket.socket() as client:
            if client.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.1)
    sys.exit(f"error: nothing listens on port {port}")


class Bucket:
    """A server with an empty bucket, behind a proxy that delays and counts."""

    def __init__(self, folder, delay_ms):
        (folder / "sets").mkdir(parents=True)
        self.folder, self.delay_ms = folder, delay_ms

    def __enter__(self):
        words = ["--host", "127.0.0.1", "--port", str(SERVER), "--access-key", "test", "--secret-key", "testsecret"]
        self.server = subprocess.Popen(["s3s-fs", *words, self.folder], stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL)
        listens(SERVER)
        self.proxy, self.port = None, SERVER
        if self.delay_ms is not None:
            script = [sys.executable, HERE / "slow_proxy.py", str(PROXY), str(SERVER), str(self.delay_ms)]
            self.proxy, self.port = subprocess.Popen(script, stdout=subprocess.PIPE, text=True), PROXY
            listens(PROXY)
        return self

    def environment(self):
        return KEYS | {"AWS_ENDPOINT_URL": f"http://127.0.0.1:{self.port}"}

    def __exit__(self, *_):
        self.counts = ""
        if self.proxy:
            self.proxy.terminate()
            self.counts = self.proxy.communicate()[0].strip()
        self.server.terminate()
        self.server.wait()
        shutil.rmtree(self.folder)


def run(convoy, environment, *words):
    """Seconds, seconds of cores, and the memory of the largest process, MB."""
    begun = time.monotonic()
    child = subprocess.Popen([convoy, "run", "--progress", "none", *words], env=os.environ | environment,
                             stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    said = child.stderr.read().decode()
    _, status, used = os.wait4(child.pid, 0)
    if os.waitstatus_to_exitcode(status) != 0:
        sys.exit(f"error: {' '.join(map(str, words))}: {said.strip()[-500:]}")
    return time.monotonic() - begun, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def beside_the_disk(convoy, work, config, rounds):
    for number in range(rounds):
        for name, delay_ms in [("disk", None), ("bucket", None), ("bucket, 20 ms", 20)]:
            words = ["--config", config, "--store"]
            if name == "disk":
                seconds, cores, memory = run(convoy, {}, *words, work / "disk")
                shutil.rmtree(work / "disk")
                counts = ""
            else:
                with Bucket(work / "s3", delay_ms) as bucket:
                    seconds, cores, memory = run(convoy, bucket.environment(), *words, "s3://sets/one")
                counts = bucket.counts
            print(f"round {number}: {name}: {seconds:.1f} s, {cores:.1f} s of cores, {memory:.0f} MB; {counts}", flush=True)


def tasks_at_once(convoy, work, config):
    for number in [1, 2, 4, 8]:
        with Bucket(work / "s3", 0) as bucket:
            words = ["--store", "s3://sets/one", "--stages"]
            run(convoy, bucket.environment(), *words, "plan", "--config", config)
            begun = time.monotonic()
            scenes = [*words, "scenes", "--threads", str(max(1, 2 // number)), "--shard"]
            command = [convoy, "run", "--progress", "none", *scenes]
            tasks = [subprocess.Popen([*command, f"{task}/{number}"], env=os.environ | bucket.environment(),
                                      stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) for task in range(number)]
            codes = [task.wait() for task in tasks]
            seconds = time.monotonic() - begun
            if any(codes):
                sys.exit(f"error: tasks ended with {codes}")
            run(convoy, bucket.environment(), *words, "stats")
        print(f"{number} tasks: {seconds:.1f} s; {bucket.counts}, plan and statistics among them", flush=True)


def main(programs, rounds="2"):
    convoy = pathlib.Path(programs).resolve() / "convoy"
    if shutil.which("s3s-fs") is None:
        sys.exit("error: s3s-fs is not installed")
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        small = work / "tasks.toml"
        text = (HERE / "configurations/least.toml").read_text()
        small.write_text(text.replace('"convoy/demo" = 1', '"convoy/demo" = 8'))
        tasks_at_once(convoy, work, os.environ.get("TASKS", small))
        beside_the_disk(convoy, work, os.environ.get("CONFIG", "configs/demo.toml"), int(rounds))


if __name__ == "__main__":
    main(*sys.argv[1:])
