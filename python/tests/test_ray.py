"""The driver for Ray, without Ray: what is tried again, command lines, the order of calls."""

import argparse
import contextlib
import errno
import io
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
import unittest
from unittest import mock

from convoy import ray as driver
from convoy.ray import Ended

GRAPH = pathlib.Path(__file__).parents[2] / "pipeline.toml"


def asked(*words):
    options = driver.parser().parse_args(["--store", "/scratch/rain", *words])
    driver.absolute(options)
    return options


class Fake:
    """Runs calls in no time; says of each, by its name, how it ends, the last of a list again and again."""

    def __init__(self, **ends):
        self.ends = {name.replace("_", "-"): list(codes) for name, codes in ends.items()}
        self.running, self.started, self.now_s = [], [], 0.0

    def clock(self):
        return self.now_s

    def start(self, call):
        self.running.append(call)
        self.started.append(call.name)

    def ended(self, within_s):
        if not self.running:
            self.now_s += within_s
            return []
        call = self.running.pop(0)
        codes = self.ends.get(call.name, [0])
        code = codes.pop(0) if len(codes) > 1 else codes[0]
        return [(call, Ended(code, (f"said {code}",)))]


def make(engine, *words):
    """The exit code, and what was told."""
    lines = []
    return driver.make(asked(*words), engine, lines.append), lines


class Policy(unittest.TestCase):
    def test_what_was_stopped_or_killed_is_tried_again_five_times(self):
        for code in (75, 137):
            pauses = [driver.pause_s(code, retries) for retries in range(7)]
            self.assertEqual(pauses, [15, 30, 60, 120, 240, None, None])
        for code in (0, 1, 2):
            self.assertIsNone(driver.pause_s(code, 0))

    def test_the_worst_is_the_exit_code_of_all(self):
        for codes, all_of_them in [
            ([], 0),
            ([0, 0], 0),
            ([0, 1], 1),
            ([1, 75, 0], 75),
            ([137, 1], 75),
            ([75, 2, 1], 2),
        ]:
            self.assertEqual(driver.verdict(codes), all_of_them)

    def test_signals_are_what_convoy_run_takes_them_for(self):
        for code, returned in [(0, [0]), (1, [1]), (2, [2]), (75, [75, -15, 143, 130]), (137, [137, -9])]:
            self.assertEqual({driver.exit_code(one) for one in returned}, {code})
        # What crashes is not tried again.
        for returned in (101, -11, 139, 127):
            self.assertEqual(driver.exit_code(returned), 1)

    def test_errors_are_told_before_what_comes_last(self):
        text = "\n INFO share 0 of 4\nERROR render-sensors: scene 3: no\n\nstage   seconds\ntotal  1.0\n"
        self.assertEqual(driver.told(text), ("ERROR render-sensors: scene 3: no",))
        self.assertEqual(driver.told("a\n" * 9 + "b\n"), ("a", "a", "a", "a", "b"))
        self.assertEqual(driver.told(""), ())


class Words(unittest.TestCase):
    def test_calls_are_those_of_the_manual(self):
        options = asked(
            "--config", "/home/rain.toml", "--maps", "/maps", "--tasks", "40", "--cpus", "16", "--program", "convoy"
        )  # fmt: skip
        calls = [driver.plan_call(options), *driver.share_calls(options, 3), driver.join_call(options)]
        self.assertEqual(
            [" ".join(call.words) for call in calls],
            [
                "convoy run --stages plan --config /home/rain.toml --store /scratch/rain --maps /maps --progress plain",
                "convoy run --stages scenes --shard 3/40 --store /scratch/rain --threads 16 --progress plain",
                "convoy run --stages stats --store /scratch/rain --progress plain",
            ],
        )
        self.assertEqual([call.name for call in calls], ["plan", "scenes-3", "join"])

    def test_a_stage_with_a_resource_is_a_call_of_its_own(self):
        options = asked("--tasks", "4", "--cpus", "2", "--split", "render-sensors=GPU")
        calls = driver.share_calls(options, 0)
        self.assertEqual([call.resource for call in calls], [None, "GPU", None])
        self.assertEqual(
            [call.words[3] for call in calls],
            ["simulate-and-log", "render-sensors", "bev-gt,occupancy-gt,postprocess-valid,merge-tracks"],
        )
        self.assertEqual(len({call.name for call in calls}), 3)
        both = [driver.split("render-sensors,bev-gt=big"), driver.split("merge-tracks=GPU")]
        self.assertEqual([resource for _, resource in driver.groups(both)], [None, "big", None, "GPU"])
        self.assertEqual(driver.groups([driver.split(",".join(driver.STAGES) + "=big")]), [("scenes", "big")])
        for wrong in ("render-sensors", "render-sensors=", "stats=GPU", "paint=GPU", "=GPU"):
            with self.assertRaises(argparse.ArgumentTypeError):
                driver.split(wrong)

    @unittest.skipUnless(GRAPH.exists(), "the graph of stages, which is in the repository")
    def test_stages_are_those_of_the_graph(self):
        stages = tomllib.loads(GRAPH.read_text())["stage"]
        self.assertEqual(driver.STAGES, tuple(stage["name"] for stage in stages if stage["unit"] == "scene"))

    def test_files_have_whole_names_and_programs_may_be_words(self):
        options = driver.parser().parse_args(["--store", "rain", "--config", "rain.toml", "--program", "bin/convoy"])
        driver.absolute(options)
        here = os.getcwd()
        self.assertEqual([options.store, options.config], [f"{here}/rain", f"{here}/rain.toml"])
        self.assertEqual(options.program, f"{here}/bin/convoy")
        self.assertEqual(asked("--store", "s3://rain/a").store, "s3://rain/a")
        with mock.patch.dict(os.environ):
            os.environ.pop("CONVOY_PROGRAM", None)
            self.assertEqual(asked().program, "convoy")

    def test_tasks_fit_the_nodes(self):
        for words, nodes, found in [
            ([], [64.0, 64.0, 32.0], (16, 40)),
            ([], [8.0, 4.0], (4, 12)),
            (["--cpus", "2"], [2.0, 1.0], (2, 4)),
            (["--tasks", "7"], [16.0], (16, 7)),
        ]:
            options = asked(*words)
            self.assertEqual(driver.sizes(options, [{"CPU": cpus} for cpus in nodes]), [])
            self.assertEqual((options.cpus, options.tasks), found)
        options = asked("--cpus", "8", "--split", "bev-gt=GPU")
        self.assertEqual(
            driver.sizes(options, [{"CPU": 4.0}]),
            [
                "note: no node has 8 cores (--cpus), the largest 4: tasks wait for one that has",
                "note: no node has GPU (--split): tasks wait for one that has",
            ],
        )
        self.assertEqual(options.tasks, 4)
        self.assertEqual(len(driver.sizes(asked(), [])), 1)
        self.assertEqual(driver.sizes(options, [{"CPU": 8.0}, {"GPU": 1.0}]), [])

    def test_wrong_words_end_with_2(self):
        for words in (["--tasks", "0"], ["--cpus", "-1"], ["--tasks", "a"], ["--split", "stats=GPU"]):
            said = io.StringIO()
            with contextlib.redirect_stderr(said), self.assertRaises(SystemExit) as ended:
                asked(*words)
            self.assertEqual(ended.exception.code, 2)
            self.assertIn(words[0], said.getvalue())

    def test_without_ray_it_says_what_to_install(self):
        said = io.StringIO()
        with mock.patch.dict(sys.modules, ray=None), contextlib.redirect_stderr(said):
            self.assertEqual(driver.main(["--store", "/scratch/rain"]), 2)
        self.assertEqual(said.getvalue(), "convoy.ray: Ray is not installed: pip install ray\n")

    def test_a_token_is_shown_where_there_is_one(self):
        def shown(file, **variables):
            with tempfile.TemporaryDirectory() as home:
                if file:
                    pathlib.Path(home, ".ray").mkdir()
                    pathlib.Path(home, ".ray", "auth_token").write_text("secret", "utf-8")
                driver.show_token(variables, pathlib.Path(home))
                return variables.get("RAY_AUTH_MODE")

        self.assertIsNone(shown(False))
        self.assertEqual(shown(True), "token")
        self.assertEqual(shown(False, RAY_AUTH_TOKEN="secret"), "token")
        self.assertEqual(shown(False, RAY_AUTH_TOKEN_PATH="/run/token"), "token")
        # Whoever says how it is to be knows better.
        self.assertEqual(shown(True, RAY_AUTH_MODE="disabled"), "disabled")

    def test_an_address_where_nobody_listens_is_told_at_once(self):
        self.assertFalse(driver.answers("127.0.0.1:9"))
        self.assertFalse(driver.answers("ray://127.0.0.1:9"))
        self.assertTrue(driver.answers("auto"))
        self.assertEqual(driver.connect(None, "127.0.0.1:9"), "no Ray answers at 127.0.0.1:9")


class Order(unittest.TestCase):
    def test_a_plan_then_shares_then_the_join(self):
        engine = Fake()
        code, lines = make(engine, "--config", "rain.toml", "--tasks", "3", "--cpus", "1")
        self.assertEqual(code, 0)
        self.assertEqual(engine.started, ["plan", "scenes-0", "scenes-1", "scenes-2", "join"])
        self.assertIn("3 of 3: scenes-2 done", lines)
        self.assertIn("all is done", lines[-1])
        planned = Fake()
        make(planned, "--tasks", "1", "--cpus", "1")
        self.assertEqual(planned.started, ["scenes-0", "join"])

    def test_without_a_plan_nothing_is_made(self):
        for code in (1, 2):
            engine = Fake(plan=[code])
            self.assertEqual(make(engine, "--config", "rain.toml", "--tasks", "2", "--cpus", "1")[0], code)
            self.assertEqual(engine.started, ["plan"])

    def test_what_stopped_is_tried_again_and_the_join_runs_whatever_happened(self):
        engine = Fake(scenes_0=[75, 137, 0], scenes_1=[75], scenes_2=[1], scenes_3=[2])
        code, lines = make(engine, "--tasks", "4", "--cpus", "1")
        self.assertEqual(code, 2)
        counts = {name: engine.started.count(name) for name in engine.started}
        self.assertEqual(counts, {"scenes-0": 3, "scenes-1": 6, "scenes-2": 1, "scenes-3": 1, "join": 1})
        self.assertEqual(engine.started[-1], "join")
        self.assertEqual(engine.now_s, 15 + 30 + 60 + 120 + 240)
        self.assertIn("scenes-1: again in 240 s (5 of 5): said 75", lines)
        self.assertIn("4 of 4: scenes-1 did not end", lines)
        self.assertEqual(
            lines[-7:-1],
            [
                "exit code 1: scenes-2",
                "    said 1",
                "exit code 2: scenes-3",
                "    said 2",
                "exit code 75: scenes-1",
                "    said 75",
            ],
        )
        self.assertIn("not all is done (2)", lines[-1])

    def test_the_calls_of_a_share_follow_one_another(self):
        engine = Fake(render_sensors_0=[75, 1], render_sensors_1=[2])
        code, lines = make(engine, "--tasks", "2", "--cpus", "1", "--split", "render-sensors=GPU")
        self.assertEqual(code, 2)
        last = "bev-gt,occupancy-gt,postprocess-valid,merge-tracks"
        # Of a share whose scenes failed in part the others are made; one with wrong arguments ends.
        self.assertEqual(
            engine.started,
            ["simulate-and-log-0", "simulate-and-log-1", "render-sensors-0", "render-sensors-1"]
            + ["render-sensors-0", f"{last}-0", "join"],
        )
        self.assertIn(f"5 of 5: {last}-0 done", lines)

    def test_who_said_the_same_is_told_once(self):
        said = Ended(2, ("ERROR there is no plan",))
        found = [(driver.Call(f"scenes-{index}", ()), said) for index in range(5)]
        self.assertEqual(
            driver.summary(found),
            ["exit code 2: scenes-0, scenes-1, scenes-2 and 2 more", "    ERROR there is no plan"],
        )


@unittest.skipUnless(sys.platform == "linux", "Linux, for calls on a node")
class Node(unittest.TestCase):
    def script(self, folder, text):
        path = pathlib.Path(folder, "convoy")
        path.write_text(f"#!/bin/sh\n{text}\n")
        path.chmod(0o755)
        return str(path)

    def test_a_call_gives_its_code_and_what_it_said(self):
        with tempfile.TemporaryDirectory() as folder:
            program = self.script(folder, 'echo "$1 $NO_COLOR"; echo no >&2; exit 75')
            log = f"{folder}/logs/scenes-0.log"
            for _ in range(2):
                code, said, _, seconds = driver._called([program, "run"], log)
                self.assertEqual((code, said), (75, "run 1\nno\n"))
                self.assertLess(seconds, 60)
            # A second try is added to the log, and alone is told.
            self.assertEqual(pathlib.Path(log).read_text(), "run 1\nno\n" * 2)
            self.assertEqual(driver._called([program, "run"], None)[1], "run 1\nno\n")

    def test_what_does_not_start_is_told_in_a_line(self):
        with tempfile.TemporaryDirectory() as folder:
            code, said, _, _ = driver._called([f"{folder}/convoy", "run"], None)
            self.assertEqual((code, said), (2, f"error: {folder}/convoy is not there"))
            self.assertIn("is not on the PATH of Ray", driver._called(["convoy-that-is-not", "run"], None)[1])
            program = self.script(folder, "exit 0")
            code, said, _, _ = driver._called([program], f"{program}/logs/a.log")
            self.assertEqual((code, said.count("\n")), (2, 0))
            pathlib.Path(program).write_bytes(b"\x7fELF, but no program")
            code, said, _, _ = driver._called([program], None)
            reason = os.strerror(errno.ENOEXEC)
            self.assertEqual(
                (driver.exit_code(code), driver.told(said)), (2, (f"error: {program} does not start: {reason}",))
            )

    def test_a_task_can_be_cancelled_where_ray_was_started_in_the_background(self):
        with tempfile.TemporaryDirectory() as folder:
            mark = pathlib.Path(folder, "mark")
            wait = f"trap 'echo ended >{mark}; exit 75' TERM; echo on >{mark}; while :; do sleep 0.1; done"
            program = self.script(folder, wait)
            source = str(pathlib.Path(driver.__file__).parents[1])
            # As Ray cancels a task: from another thread of its worker.
            code = f"""
import _thread, pathlib, signal, sys, threading, time
sys.path.insert(0, {source!r})
from convoy import ray
signal.signal(signal.SIGINT, signal.SIG_IGN)
def cancel():
    while not pathlib.Path({str(mark)!r}).exists():
        time.sleep(0.05)
    _thread.interrupt_main()
threading.Thread(target=cancel, daemon=True).start()
try:
    ray._called([{program!r}], None)
except KeyboardInterrupt:
    sys.exit(7)
"""
            worker = subprocess.Popen([sys.executable, "-c", code])
            self.addCleanup(worker.kill)
            self.assertEqual(worker.wait(20), 7)
            self.assertEqual(mark.read_text(), "ended\n")

    def test_whoever_starts_a_program_and_goes_ends_it_first(self):
        # Whether the worker is killed or the keeper: the program is told by SIGTERM.
        for killed in ("worker", "keeper"):
            with tempfile.TemporaryDirectory() as folder:
                mark = pathlib.Path(folder, "mark")
                wait = f"trap 'echo ended >{mark}; exit 75' TERM; echo $PPID >{mark}; while :; do sleep 0.1; done"
                program = self.script(folder, wait)
                source = str(pathlib.Path(driver.__file__).parents[1])
                code = f"import sys; sys.path.insert(0, {source!r}); from convoy import ray; ray._called([{program!r}], None)"
                worker = subprocess.Popen([sys.executable, "-c", code])
                until(lambda mark=mark: mark.exists() and mark.read_text().strip())
                os.kill(worker.pid if killed == "worker" else int(mark.read_text()), signal.SIGKILL)
                until(lambda mark=mark: mark.read_text() == "ended\n")
                worker.wait(10)


def until(holds, within_s=20):
    end = time.monotonic() + within_s
    while not holds():
        if time.monotonic() > end:
            raise AssertionError("it does not come")
        time.sleep(0.05)


if __name__ == "__main__":
    unittest.main()
