"""Makes a dataset with Ray: `python -m convoy.ray --config rain.toml --store /scratch/rain`.

Each Ray task is a call of `convoy run` on some node. Words travel there and the last lines of its output
travel back; data never does: all nodes see the store. docs/clusters.md is the manual.
"""

from __future__ import annotations

import argparse
import collections
import dataclasses
import heapq
import itertools
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping, MutableMapping, Sequence
from typing import Any, Protocol

# Exit codes of `convoy run`.
DONE, SOME_FAILED, USAGE, TRY_AGAIN, KILLED = 0, 1, 2, 75, 137
# A call that could not end is tried again so many times.
MOST_RETRIES = 5
# The stages of scenes, in running order (pipeline.toml).
STAGES = ("simulate-and-log", "render-sensors", "bev-gt", "occupancy-gt", "postprocess-valid", "merge-tracks")
# What is kept of a call's output.
_KEPT_BYTES = 64 << 10


@dataclasses.dataclass(frozen=True)
class Call:
    """A call of the program on some node."""

    name: str
    words: tuple[str, ...]
    resource: str | None = None
    """What the node must have: `GPU`, or a resource of Ray's by its name."""


@dataclasses.dataclass(frozen=True)
class Ended:
    """How a call ended."""

    code: int
    lines: tuple[str, ...] = ()
    """The last ones that it said, errors before all."""
    place: str = ""
    """Where, and in what time; of one that was lost nobody knows."""


class Engine(Protocol):
    """What runs calls."""

    def clock(self) -> float: ...
    def start(self, call: Call) -> None: ...
    def ended(self, within_s: float) -> list[tuple[Call, Ended]]:
        """Those that ended; waits for the first, no longer than `within_s`."""


# Policy.


def pause_s(code: int, retries: int) -> float | None:
    """Seconds until a call that ended so is tried again; None where it is not: what fails by itself (1, 2)
    would fail again."""
    if code not in (TRY_AGAIN, KILLED) or retries >= MOST_RETRIES:
        return None
    return float(min(15 << retries, 240))


def verdict(codes: Iterable[int]) -> int:
    """The exit code of all: what a person must mend goes first, then what another run may do."""
    found = {TRY_AGAIN if code == KILLED else code for code in codes}
    return next((code for code in (USAGE, TRY_AGAIN, SOME_FAILED) if code in found), DONE)


def exit_code(returned: int) -> int:
    """The exit code of a program that a signal may have ended, as a shell or as Python says it."""
    code = 128 - returned if returned < 0 else returned
    if code in (128 + signal.SIGTERM, 128 + signal.SIGINT, 128 + signal.SIGHUP):
        return TRY_AGAIN
    return code if code in (DONE, USAGE, TRY_AGAIN, KILLED) else SOME_FAILED


def told(text: str) -> tuple[str, ...]:
    """The lines of an output that say what went wrong, else the last ones."""
    lines = [line.rstrip() for line in text.splitlines() if line.strip()]
    errors = [line for line in lines if line.lstrip().startswith("ERROR")]
    return tuple((errors or lines)[-5:])


# Command lines.


def split(text: str) -> tuple[tuple[str, ...], str]:
    """Stages that want something of their nodes: `render-sensors=GPU`, several with commas."""
    names, _, resource = text.partition("=")
    stages = tuple(name.strip() for name in names.split(","))
    if not resource:
        raise argparse.ArgumentTypeError("expected STAGES=RESOURCE")
    for name in stages:
        if name not in STAGES:
            raise argparse.ArgumentTypeError(f"there is no stage of scenes {name!r}; there are {', '.join(STAGES)}")
    return stages, resource


def groups(splits: Sequence[tuple[tuple[str, ...], str]]) -> list[tuple[str, str | None]]:
    """The stages of a share's calls, as --stages takes them, and what each call wants of its node."""
    wanted = {stage: resource for stages, resource in splits for stage in stages}
    runs = [(list(stages), resource) for resource, stages in itertools.groupby(STAGES, wanted.get)]
    return [("scenes" if len(stages) == len(STAGES) else ",".join(stages), resource) for stages, resource in runs]


def plan_call(asked: argparse.Namespace) -> Call:
    words = [asked.program, "run", "--stages", "plan", "--config", asked.config, "--store", asked.store]
    words += ["--maps", asked.maps] if asked.maps else []
    return Call("plan", (*words, "--progress", "plain"))


def share_calls(asked: argparse.Namespace, index: int) -> list[Call]:
    """The calls of one share of the scenes, in their order."""
    calls = []
    for stages, resource in groups(asked.split):
        # With the number in full no variable of another engine is asked.
        words = [asked.program, "run", "--stages", stages, "--shard", f"{index}/{asked.tasks}", "--store", asked.store]
        words += ["--threads", str(asked.cpus), *(["--device", "gpu"] if resource == "GPU" else []), "--progress", "plain"]
        calls.append(Call(f"{stages}-{index}", tuple(words), resource))
    return calls


def join_call(asked: argparse.Namespace) -> Call:
    words = (asked.program, "run", "--stages", "stats", "--store", asked.store, "--progress", "plain")
    return Call("join", words)


# The run.


def drive(
    chains: Sequence[Sequence[Call]],
    engine: Engine,
    tell: Callable[[str], None],
) -> list[tuple[Call, Ended]]:
    """Makes the calls of every chain one after the other, chains side by side; how each call ended at last.

    A call follows one of which some scenes failed, too: all others are there.
    """
    clock = engine.clock
    left = {chain[0].name: list(chain) for chain in chains}
    head_of = {call.name: chain[0].name for chain in chains for call in chain}
    retries: collections.Counter[str] = collections.Counter()
    later: list[tuple[float, str]] = []
    found: list[tuple[Call, Ended]] = []
    all_calls, running = sum(map(len, chains)), 0
    for chain in chains:
        engine.start(chain[0])
        running += 1
    while running or later:
        while later and later[0][0] <= clock():
            engine.start(left[heapq.heappop(later)[1]][0])
            running += 1
        for call, end in engine.ended(max(0.0, later[0][0] - clock()) if later else 60.0):
            running -= 1
            pause = pause_s(end.code, retries[call.name])
            if pause is not None:
                retries[call.name] += 1
                why = end.lines[-1] if end.lines else f"exit code {end.code}"
                tell(f"{call.name}: again in {pause:.0f} s ({retries[call.name]} of {MOST_RETRIES}): {why}")
                heapq.heappush(later, (clock() + pause, head_of[call.name]))
                continue
            found.append((call, end))
            rest = left[head_of[call.name]]
            rest.pop(0)
            if end.code not in (DONE, SOME_FAILED):
                all_calls -= len(rest)
                rest.clear()
            if rest:
                engine.start(rest[0])
                running += 1
            tell(f"{len(found)} of {all_calls}: {call.name} {_outcome(end.code)}{end.place}")
    return found


def _outcome(code: int) -> str:
    words = {
        DONE: "done",
        SOME_FAILED: "ended, some scenes failed",
        USAGE: "ended with wrong arguments or configuration",
        KILLED: "was killed by the system (out of memory?)",
    }
    return words.get(code, "did not end")


def summary(found: Sequence[tuple[Call, Ended]]) -> list[str]:
    """Of what is not done, what it said last; calls that said the same are one."""
    alike: dict[tuple[int, tuple[str, ...]], list[str]] = {}
    for call, end in found:
        if end.code != DONE:
            alike.setdefault((end.code, end.lines), []).append(call.name + end.place)
    lines = []
    for (code, said), names in sorted(alike.items()):
        more = f" and {len(names) - 3} more" if len(names) > 3 else ""
        lines += [f"exit code {code}: {', '.join(names[:3])}{more}", *(f"    {line}" for line in said)]
    return lines


def make(asked: argparse.Namespace, engine: Engine, tell: Callable[[str], None]) -> int:
    """Plans, makes all shares, joins; the exit code."""
    found: list[tuple[Call, Ended]] = []
    if asked.config:
        found += drive([[plan_call(asked)]], engine, tell)
    if verdict(end.code for _, end in found) == DONE:
        found += drive([share_calls(asked, index) for index in range(asked.tasks)], engine, tell)
        # Whatever happened: manifests tell what is done.
        found += drive([[join_call(asked)]], engine, tell)
    code = verdict(end.code for _, end in found)
    for line in summary(found):
        tell(line)
    first = "mend that first: " if code == USAGE else ""
    state = "all is done" if code == DONE else f"not all is done ({code}); {first}the same command goes on where it was"
    tell(f"{state}; convoy status --store {asked.store} tells of every scene")
    return code


# On a node. This travels by value: nodes need Ray and the program, not this package.

# Ray kills the processes that a worker started when the worker goes, but not what these started: a stage
# would go on by itself. So the program is the child of a keeper, and is told to stop when that is gone
# (PR_SET_PDEATHSIG): it then ends its stage at a frame.
_KEEPER = """
import ctypes, signal, subprocess, sys
libc = ctypes.CDLL(None)
tie = lambda: libc.prctl(1, int(signal.SIGTERM), 0, 0, 0)
tie()
try:
    child = subprocess.Popen(sys.argv[1:], preexec_fn=tie)
except OSError as fault:
    print(f"error: {sys.argv[1]} does not start: {fault.strerror}")
    sys.exit(2)
signal.signal(signal.SIGTERM, lambda *_: child.terminate())
code = child.wait()
sys.exit(code if code >= 0 else 128 - code)
"""


def _called(words: Sequence[str], log: str | None) -> tuple[int, str, str, float]:
    """Runs a command here: exit code, the end of its output, this host, seconds."""
    # A cancelled task hears of it by SIGINT, which whatever a script starts in the background ignores: a Ray, too.
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    host, start = socket.gethostname(), time.monotonic()
    program = shutil.which(words[0])
    if program is None:
        where = "is not there" if os.sep in words[0] else "is not on the PATH of Ray there (--program names it)"
        return USAGE, f"error: {words[0]} {where}", host, 0.0
    try:
        if log:
            os.makedirs(os.path.dirname(log), exist_ok=True)
        # Appended to: a call that is tried again does not lose what it said before.
        with open(log, "a+b") if log else tempfile.TemporaryFile() as output:
            began = output.seek(0, os.SEEK_END)
            child = subprocess.Popen(
                [sys.executable, "-c", _KEEPER, program, *words[1:]],
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                # Not in the group that Ray kills as a whole.
                start_new_session=True,
                env=os.environ | {"NO_COLOR": "1"},
            )
            try:
                # Short, because Ray's interrupt ends no wait in the system.
                while child.poll() is None:
                    time.sleep(0.2)
            finally:
                # Cancelled, or the worker goes: it ends at a frame.
                if child.poll() is None:
                    child.terminate()
                    child.wait()
            output.seek(max(began, output.seek(0, os.SEEK_END) - _KEPT_BYTES))
            said = output.read().decode(errors="replace")
    except OSError as fault:
        return USAGE, f"error: {fault}", host, 0.0
    return child.returncode, said, host, time.monotonic() - start


class Cluster:
    """A Ray that runs calls."""

    def __init__(self, ray: Any, *, cpus: int, memory_gib: int | None, logs: str | None) -> None:
        self.ray, self.logs = ray, logs
        ray.cloudpickle.register_pickle_by_value(sys.modules[__name__])
        # Ray's own retries would not be counted together with those after 75.
        self.remote = ray.remote(num_cpus=cpus, max_retries=0, scheduling_strategy="SPREAD")(_called)
        self.memory = {"memory": memory_gib << 30} if memory_gib else {}
        self.running: dict[Any, Call] = {}

    def clock(self) -> float:
        return time.monotonic()

    def start(self, call: Call) -> None:
        wants: dict[str, Any] = dict(self.memory)
        if call.resource == "GPU":
            wants["num_gpus"] = 1
        elif call.resource:
            wants["resources"] = {call.resource: 1}
        log = os.path.join(self.logs, f"{call.name}.log") if self.logs else None
        self.running[self.remote.options(name=f"convoy {call.name}", **wants).remote(call.words, log)] = call

    def ended(self, within_s: float) -> list[tuple[Call, Ended]]:
        if not self.running:
            time.sleep(within_s)
            return []
        done, _ = self.ray.wait(list(self.running), num_returns=1, timeout=within_s)
        return [(self.running.pop(ref), self._end(ref)) for ref in done]

    def _end(self, ref: Any) -> Ended:
        faults = self.ray.exceptions
        try:
            returned, said, node, seconds = self.ray.get(ref)
            return Ended(exit_code(returned), told(said), f" in {seconds:.0f} s on {node}")
        except faults.OutOfMemoryError:
            return Ended(KILLED, ("Ray ended it: the node's memory was full (--memory keeps some for each task)",))
        except (faults.RayTaskError, faults.RuntimeEnvSetupError, faults.TaskUnschedulableError) as fault:
            return Ended(SOME_FAILED, told(str(fault))[-1:])
        except faults.RayError as fault:
            return Ended(TRY_AGAIN, (f"its node or worker was lost ({type(fault).__name__})",))

    def stop(self, within_s: float = 120.0) -> None:
        """Ends all calls: each at its next frame."""
        for ref in self.running:
            self.ray.cancel(ref)
        if self.running:
            self.ray.wait(list(self.running), num_returns=len(self.running), timeout=within_s)

    def faults(self, program: str, cpus: int) -> list[str]:
        """Of nodes that would get tasks, why the program is not there; or that they have different ones."""
        versions: dict[str, list[str]] = {}
        asked = []
        for node in alive(self.ray):
            if node["Resources"]["CPU"] >= cpus:
                on = self.ray.util.scheduling_strategies.NodeAffinitySchedulingStrategy(node["NodeID"], soft=False)
                here = self.remote.options(num_cpus=0, scheduling_strategy=on)
                asked.append((node["NodeManagerAddress"], here.remote((program, "--version"), None)))
        faults = []
        for address, ref in asked:
            try:
                code, said, _, _ = self.ray.get(ref, timeout=60)
            except self.ray.exceptions.RayError as fault:
                # Whatever it is, it may be gone when a task comes there.
                code, said = TRY_AGAIN, str(fault)
            if code in (DONE, TRY_AGAIN):
                versions.setdefault(said.strip() if code == DONE else "", []).append(address)
            else:
                faults.append(f"node {address}: {(told(said) or ('it does not start',))[-1].removeprefix('error: ')}")
        versions.pop("", None)
        if len(versions) > 1:
            each = "; ".join(f"{version} on {', '.join(nodes[:3])}" for version, nodes in sorted(versions.items()))
            faults.append(f"nodes have different programs: {each}")
        return faults


# The command.


def alive(ray: Any) -> list[dict[str, Any]]:
    """The nodes that have cores."""
    return [node for node in ray.nodes() if node["Alive"] and node["Resources"].get("CPU", 0) >= 1]


def parser() -> argparse.ArgumentParser:
    it = argparse.ArgumentParser(
        prog="python -m convoy.ray",
        description="Makes a dataset with Ray: plans, makes shares of the scenes as tasks, joins. Started again, it goes on. "
        "Files are named as all nodes see them.",
        epilog="Exit codes: 0 all is done; 1 some scenes failed; 2 wrong arguments, configuration or programs; 75 stopped, or "
        "something did not end: run it again.",
    )
    it.add_argument("--store", required=True, metavar="DIR", help="the store, in a place that all nodes see")
    it.add_argument("--config", metavar="FILE", help="configuration; not needed where the store is planned")
    it.add_argument("--maps", metavar="DIR", help="folder with OpenDRIVE files, for the planner")
    it.add_argument("--tasks", type=_count, metavar="N", help="shares (default: four for each that fits at once)")
    it.add_argument("--cpus", type=_count, metavar="N", help="cores of a task (default: 16, or the smallest node's)")
    it.add_argument("--memory", type=_count, metavar="GIB", help="memory of a task (default: not counted)")
    it.add_argument(
        "--split", type=split, action="append", default=[], metavar="STAGES=RESOURCE",
        help="stages that are tasks of their own on nodes with a GPU (render-sensors=GPU) or another resource of Ray",
    )  # fmt: skip
    it.add_argument(
        "--address", metavar="HOST:PORT",
        help="Ray's, or `local` for this machine alone (default: RAY_ADDRESS, else the Ray that runs here)",
    )  # fmt: skip
    it.add_argument(
        "--program", metavar="PATH", default=os.environ.get("CONVOY_PROGRAM", "convoy"),
        help="convoy on the nodes (default: CONVOY_PROGRAM here, else that on the PATH of each node)",
    )  # fmt: skip
    it.add_argument("--logs", metavar="DIR", help="folder where nodes write all output, a file a task (default: none)")
    return it


def _count(text: str) -> int:
    if not text.isdigit() or not int(text):
        raise argparse.ArgumentTypeError(f"{text!r} is no number from 1 on")
    return int(text)


def absolute(asked: argparse.Namespace) -> None:
    """Names files as other working directories see them. Stores may be URLs, programs words."""
    if "://" not in asked.store:
        asked.store = os.path.abspath(asked.store)
    if os.sep in asked.program:
        asked.program = os.path.abspath(asked.program)
    for name in ("config", "maps", "logs"):
        if getattr(asked, name) is not None:
            setattr(asked, name, os.path.abspath(getattr(asked, name)))


def sizes(asked: argparse.Namespace, nodes: Sequence[Mapping[str, float]]) -> list[str]:
    """Chooses cores and number of tasks where nobody says, by what nodes have; what they lack."""
    cores = [int(node.get("CPU", 0)) for node in nodes]
    asked.cpus = asked.cpus or min([16, *cores])
    slots = sum(of_node // asked.cpus for of_node in cores)
    asked.tasks = asked.tasks or 4 * max(slots, 1)
    notes = [] if slots else [f"no node has {asked.cpus} cores (--cpus), the largest {max(cores, default=0)}"]
    for resource in sorted({resource for _, resource in asked.split}):
        if not any(node.get(resource, 0) >= 1 for node in nodes):
            notes.append(f"no node has {resource} (--split)")
    return [f"note: {note}: tasks wait for one that has" for note in notes]


def answers(address: str, within_s: float = 5.0) -> bool:
    """Whether somebody listens there: Ray itself asks for minutes."""
    host, _, port = address.removeprefix("ray://").rpartition(":")
    if not host or not port.isdigit():
        return True
    try:
        socket.create_connection((host, int(port)), within_s).close()
    except OSError:
        return False
    return True


def show_token(environment: MutableMapping[str, str], home: pathlib.Path) -> None:
    """Lets Ray show its token, if there is one: nodes of 2.60 ask for it then, and a driver shows it only when told to."""
    named = any(environment.get(name) for name in ("RAY_AUTH_TOKEN", "RAY_AUTH_TOKEN_PATH"))
    if named or (home / ".ray" / "auth_token").is_file():
        environment.setdefault("RAY_AUTH_MODE", "token")


def connect(ray: Any, address: str | None) -> str | None:
    """Joins a Ray; why not, in a line."""
    address = address or os.environ.get("RAY_ADDRESS") or "auto"
    if not answers(address):
        return f"no Ray answers at {address}"
    # Nothing goes through Ray's store.
    alone = {"include_dashboard": False, "object_store_memory": 100 << 20} if address == "local" else {}
    try:
        ray.init(address=address, log_to_driver=False, logging_level="ERROR", **alone)
    except ConnectionError:
        if address == "auto":
            return "no Ray runs here: ray start --head starts one, --address names another or `local`"
        return f"no Ray answers at {address}"
    except (RuntimeError, ValueError, OSError) as fault:
        return f"Ray at {address}: {(told(str(fault)) or (type(fault).__name__,))[0]}"
    return None


def _interrupt(*_: object) -> None:
    raise KeyboardInterrupt


def main(words: Sequence[str] | None = None) -> int:
    """`python -m convoy.ray`."""
    asked = parser().parse_args(words)

    def fail(why: str) -> int:
        print(f"convoy.ray: {why}", file=sys.stderr)
        return USAGE

    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    show_token(os.environ, pathlib.Path.home())
    try:
        import ray
        import ray.util.scheduling_strategies
    except ImportError:
        return fail("Ray is not installed: pip install ray")
    absolute(asked)
    why_not = connect(ray, asked.address)
    if why_not:
        return fail(why_not)
    # After Ray's own, which would leave at once.
    signal.signal(signal.SIGTERM, _interrupt)
    nodes = [node["Resources"] for node in alive(ray)]
    notes = sizes(asked, nodes)
    cluster = Cluster(ray, cpus=asked.cpus, memory_gib=asked.memory, logs=asked.logs)
    try:
        faults = cluster.faults(asked.program, asked.cpus)
        if faults:
            return fail("; ".join(faults[:3]) + (f"; and {len(faults) - 3} more" if len(faults) > 3 else ""))

        def tell(line: str) -> None:
            print(line, flush=True)

        for note in notes:
            tell(note)
        cpus = sum(node["CPU"] for node in nodes)
        tell(f"{len(nodes)} nodes of {cpus:.0f} cores; {asked.tasks} shares of the scenes, {asked.cpus} cores each")
        return make(asked, cluster, tell)
    except KeyboardInterrupt:
        print("stopping: tasks end at their next frame (once more to leave at once)", file=sys.stderr, flush=True)
        try:
            cluster.stop()
        except KeyboardInterrupt:
            pass
        return TRY_AGAIN
    finally:
        ray.shutdown()


if __name__ == "__main__":
    sys.exit(main())
