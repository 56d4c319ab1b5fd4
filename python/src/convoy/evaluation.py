"""Scores of predictions, by Convoy's own program."""

from __future__ import annotations

import os
import pathlib
import shutil
import subprocess
import sysconfig
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import pyarrow.parquet as pq

from convoy.places import place_of


class ProgramError(RuntimeError):
    """The program is not there, or ended with an error; the message has what it said."""


@dataclass(frozen=True)
class Evaluation:
    """What `convoy evaluate` found."""

    rows: list[dict[str, Any]]
    """One a number: metrics, mode, class, level, measure, threshold, value (docs/evaluation.md)."""
    program: str
    """By which program."""
    version: str

    def value(
        self, measure: str, *, metrics: str = "simbev2x", mode: str = "-", threshold: float | None = None,
        level: str = "all", of_class: str = "all",
    ) -> float | None:  # fmt: skip
        """One of the numbers; None where nothing can be said, as of a class without targets."""
        wanted = {"metrics": metrics, "mode": mode, "class": of_class, "level": level, "measure": measure}
        for row in self.rows:
            if row["threshold"] == threshold and all(row[name] == value for name, value in wanted.items()):
                found: float | None = row["value"]
                return found
        raise KeyError(f"there is no {wanted | {'threshold': threshold}}")


def evaluate(
    predictions: str | os.PathLike[str],
    store: str | os.PathLike[str],
    *,
    split: str | None = None,
    every: int | None = None,
    metrics: Sequence[str] = (),
    program: str | os.PathLike[str] | None = None,
    options: Sequence[str] = (),
) -> Evaluation:
    """Scores a Parquet file of predictions against a store, a folder or a URL, with `convoy evaluate`.

    The program is `program`, or what the variable CONVOY_PROGRAM names, or this environment's own (the wheel `convoy-v2x` brings
    one), or `convoy` on the path, or target/release/convoy here; `options` are further ones of its command line. Raises `ProgramError`.
    """
    convoy = found(program)
    place_of(store)  # Faults repeat the command, which must have no secrets in it.
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder, "scores.parquet")
        command = [convoy, "evaluate", "--predictions", str(predictions), "--store", str(store), "--out", str(out)]
        command += ["--split", split] if split is not None else []
        command += ["--every", str(every)] if every is not None else []
        command += ["--metrics", ",".join(metrics)] if metrics else []
        run(command + list(options))
        rows = pq.read_table(out).to_pylist()
    return Evaluation(rows, convoy, run([convoy, "--version"]).strip())


def found(program: str | os.PathLike[str] | None = None) -> str:
    """Where the program `convoy` is."""
    named = program or os.environ.get("CONVOY_PROGRAM")
    if named:
        where = shutil.which(named)
    else:
        # The environment's programs lie beside its Python, which may be started without them on the path.
        places = [sysconfig.get_path("scripts"), None, str(pathlib.Path("target/release").absolute())]
        where = next(filter(None, (shutil.which("convoy", path=place) for place in places)), None)
    if where is None:
        raise ProgramError(
            f"there is no program {named}"
            if named
            else "there is no program convoy in this environment, on the path or in target/release: "
            "the wheel convoy-v2x or `make build` brings it, the variable CONVOY_PROGRAM may name it"
        )
    return where


def run(command: Sequence[str]) -> str:
    """What a command says on its standard output."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as fault:
        raise ProgramError(f"{command[0]} does not start: {fault}") from fault
    if done.returncode:
        raise ProgramError(f"{' '.join(command)} ended with {done.returncode}: {done.stderr.strip()}")
    return done.stdout
