"""Manifests without a Kubernetes: `kubernetes.py validate FILE...` holds them against the schemas of the last three versions.

Anything else is a call of kubectl, as `submit.sh` makes it: the containers' commands run here, index by index, and end a Job as
its `podFailurePolicy` and limits say. The folder STAND_IN keeps what the cluster would. The first try of index STAND_IN_KILL is
killed while it works (SIGKILL), that of STAND_IN_TERM is told to stop (SIGTERM).
"""

import json
import os
import pathlib
import signal
import subprocess
import sys
import time

import yaml

# What a task says once it knows its scenes.
BEGUN = b"scenes to make"


def validate(files: list[str]) -> None:
    import kubernetes_validate

    by_minor = {".".join(version.split(".")[:2]): version for version in kubernetes_validate.utils.all_versions()}
    versions = sorted(by_minor.values(), key=lambda version: [int(part) for part in version.split(".")])[-3:]
    for file in files:
        for document in yaml.safe_load_all(pathlib.Path(file).read_text()):
            for version in versions:
                kubernetes_validate.validate(document, version, strict=True)
            print(f"{pathlib.Path(file).name}: {document['kind']} {document['metadata']['name']}")
    print(f"{len(files)} files are good by the schemas of {', '.join(versions)}")


class Cluster:
    """What is kept between calls."""

    def __init__(self, folder: str) -> None:
        self.folder = pathlib.Path(folder)

    def path(self, kind: str, name: str) -> pathlib.Path:
        return self.folder / f"{kind.lower()}-{name}.json"

    def apply(self, document: dict) -> None:
        kind, name = document["kind"], document["metadata"]["name"]
        path = self.path(kind, name)
        if kind == "Job" and path.exists():
            sys.exit(f"job {name} is there, and cannot be changed")
        path.write_text(json.dumps(document))
        print(f"{kind.lower()}/{name} applied", flush=True)
        if kind == "Job":
            document["status"] = self.run(document["spec"], name)
            path.write_text(json.dumps(document))

    def run(self, spec: dict, name: str) -> dict:
        """Runs a Job's pods; its state."""
        indexed = spec.get("completionMode") == "Indexed"
        log = self.folder / f"{name}.log"
        log.write_bytes(b"")
        failed = []
        for index in range(spec.get("completions", 1)):
            tries = 0
            while True:
                code = self.pod(spec["template"]["spec"], index if indexed else None, log, tries)
                action = "Count" if code else "Done"
                for rule in spec["podFailurePolicy"]["rules"]:
                    codes = rule.get("onExitCodes")
                    if codes and codes["operator"] == "In" and code in codes["values"]:
                        action = rule["action"]
                        break
                if action == "Done":
                    break
                limit = spec["backoffLimitPerIndex" if indexed else "backoffLimit"]
                again = action == "Count" and tries < limit
                what = f"index {index}" if indexed else name
                print(f"{what}: exit {code}, {'again' if again else action}", flush=True)
                if not again:
                    failed.append(index)
                    break
                tries += 1
        condition = {"type": "Failed" if failed else "Complete", "status": "True"}
        return {"conditions": [condition], "failedIndexes": ",".join(map(str, failed))}

    def pod(self, spec: dict, index: int | None, log: pathlib.Path, tries: int) -> int:
        """Runs a pod's container to its end; its exit code."""
        assert spec["restartPolicy"] == "Never"
        (container,) = spec["containers"]
        args = container["args"]
        volumes = {volume["name"]: volume for volume in spec.get("volumes", [])}
        for mount in container.get("volumeMounts", []):
            volume = volumes[mount["name"]]
            if "configMap" in volume:
                there = self.config(volume["configMap"])
                args = [arg.replace(mount["mountPath"], str(there)) for arg in args]
        env = {"PATH": os.environ["PATH"], "HOME": str(self.folder)}
        for source in container.get("envFrom", []):
            secret = json.loads(self.path("Secret", source["secretRef"]["name"]).read_text())
            env |= secret["stringData"]
        if index is not None:
            env["JOB_COMPLETION_INDEX"] = str(index)
        begun = log.read_bytes().count(BEGUN)
        with open(log, "ab") as output:
            process = subprocess.Popen(
                [*container["command"], *args],
                env=env,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=output,
                start_new_session=True,
            )
            if index is not None and tries == 0 and str(index) == os.environ.get("STAND_IN_KILL"):
                self.wait_for_work(process, log, begun)
                # Of a container all processes are killed.
                os.killpg(process.pid, signal.SIGKILL)
            if index is not None and tries == 0 and str(index) == os.environ.get("STAND_IN_TERM"):
                self.wait_for_work(process, log, begun)
                # The first process of a container alone is told.
                process.terminate()
            code = process.wait()
        return code if code >= 0 else 128 - code

    def wait_for_work(self, process: subprocess.Popen, log: pathlib.Path, begun: int) -> None:
        """Waits until a task has begun with its scenes, and a moment more."""
        while process.poll() is None and log.read_bytes().count(BEGUN) == begun:
            time.sleep(0.02)
        time.sleep(0.5)
        assert process.poll() is None, "it has ended already"

    def config(self, volume: dict) -> pathlib.Path:
        """A ConfigMap as files."""
        folder = self.folder / "mounts" / volume["name"]
        data = json.loads(self.path("ConfigMap", volume["name"]).read_text())["data"]
        for item in volume["items"]:
            (folder / item["path"]).parent.mkdir(parents=True, exist_ok=True)
            (folder / item["path"]).write_text(data[item["key"]])
        return folder


def kubectl(words: list[str]) -> int:
    cluster = Cluster(os.environ["STAND_IN"])
    options = [word for word in words if word.startswith("--")]
    words = [word for word in words if not word.startswith("--")]
    verb, *rest = words
    if verb == "auth":
        print("yes")
        return 0
    if verb in ("apply", "delete"):
        for document in yaml.safe_load_all(pathlib.Path(rest[rest.index("-f") + 1]).read_text()):
            if verb == "apply":
                cluster.apply(document)
            else:
                cluster.path(document["kind"], document["metadata"]["name"]).unlink(missing_ok=True)
        return 0
    name = next(word for word in rest if "/" in word).removeprefix("job/")
    path = cluster.path("Job", name)
    job = json.loads(path.read_text()) if path.exists() else None
    if verb == "wait":
        wanted = next(word for word in options if word.startswith("--for=condition=")).split("=")[2]
        return 0 if job and any(condition["type"] == wanted for condition in job["status"]["conditions"]) else 1
    if verb == "get":
        if job:
            print(
                job["status"]["failedIndexes"] if any("failedIndexes" in word for word in rest) else f"job.batch/{name}"
            )
        return 0
    if verb == "logs":
        print((cluster.folder / f"{name}.log").read_text())
        return 0
    print(f"the stand-in for kubectl does not know: {' '.join(words)}", file=sys.stderr)
    return 1


if __name__ == "__main__":
    if sys.argv[1] == "validate":
        validate(sys.argv[2:])
    else:
        sys.exit(kubectl(sys.argv[1:]))
