"""Checkpoints: replaced as a whole, so that a run that is killed goes on where it was."""

from __future__ import annotations

import dataclasses
import os
import pathlib
from dataclasses import dataclass
from typing import Any

import torch

from convoy_baseline.model import Model
from convoy_baseline.settings import Settings, parse

VERSION = 2
"""Of what a checkpoint holds: another one is of another build, whose models have other parts."""


@dataclass
class Run:
    """What training is and how far it came."""

    settings: Settings
    mode: str
    """With whom it learns to work together."""
    seed: int
    spoil: str
    """What was done to its labels, for tests: nothing if empty."""
    masks: tuple[str, ...]
    """Names of the masks."""
    step: int
    """Steps that are done."""
    seconds: float
    """Time that they took."""

    @property
    def done(self) -> bool:
        """Whether all steps are."""
        return self.step >= self.settings.steps

    def identity(self) -> dict[str, Any]:
        """What may not differ where a run goes on."""
        known = dataclasses.asdict(self)
        return {name: known[name] for name in ("settings", "mode", "seed", "spoil", "masks")}


class WrongVersion(ValueError):
    """A checkpoint of another build."""


def save(path: pathlib.Path, run: Run, model: Model, optimiser: torch.optim.Optimizer) -> None:
    """Writes it beside, then puts it in place."""
    state = {
        "version": VERSION,
        "run": dataclasses.asdict(run),
        "model": model.state_dict(),
        "optimiser": optimiser.state_dict(),
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(path.name + ".new")
    with open(beside, "wb") as file:
        torch.save(state, file)
        file.flush()
        os.fsync(file.fileno())
    os.replace(beside, path)


def load(path: pathlib.Path, device: torch.device) -> tuple[Run, dict[str, Any]]:
    """The run, and states of model and optimiser."""
    try:
        state = torch.load(path, map_location=device, weights_only=True)
        if state.get("version", 1) != VERSION:
            raise WrongVersion(
                f"{path} is a checkpoint of version {state.get('version', 1)}, this build reads {VERSION}: train anew into another file, "
                "or predict with the build that made it"
            )
        run = dict(state["run"])
        settings = parse(run.pop("settings"), str(path))
        return Run(settings, masks=tuple(run.pop("masks")), **run), state
    except (KeyError, TypeError, AttributeError, EOFError, RuntimeError) as fault:
        raise ValueError(f"{path} is no checkpoint ({fault}): remove it to begin again") from fault


def model_of(path: pathlib.Path, device: torch.device) -> tuple[Run, Model]:
    """A model that was trained, ready to predict."""
    run, state = load(path, device)
    model = Model(run.settings, len(run.masks)).to(device)
    model.load_state_dict(state["model"])
    return run, model.eval()
