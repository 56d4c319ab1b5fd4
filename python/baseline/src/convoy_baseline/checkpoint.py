"""Checkpoints: replaced as a whole, so that a run that is killed goes on where it was."""

from __future__ import annotations

import dataclasses
import hashlib
import os
import pathlib
from dataclasses import dataclass
from typing import Any

import torch
from torch.optim.swa_utils import AveragedModel, get_ema_multi_avg_fn

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
    began_from: str
    """SHA-256 of the checkpoint whose weights it began with; nothing if it began anew."""
    masks: tuple[str, ...]
    """Names of the masks."""
    step: int
    """Steps that are done."""
    seconds: float
    """Time that they took."""
    share: float = 1.0
    """Which part of the scenes it learns from."""

    @property
    def done(self) -> bool:
        """Whether all steps are."""
        return self.step >= self.settings.steps

    def identity(self) -> dict[str, Any]:
        """What may not differ where a run goes on."""
        known = dataclasses.asdict(self)
        return {name: known[name] for name in ("settings", "mode", "seed", "spoil", "began_from", "masks", "share")}


class WrongVersion(ValueError):
    """A checkpoint of another build."""


def averaged(model: Model, settings: Settings) -> AveragedModel | None:
    """The mean of a model's weights over its last steps, if settings want one."""
    if not settings.average:
        return None
    rule = get_ema_multi_avg_fn(settings.average)  # type: ignore[no-untyped-call]
    return AveragedModel(model, multi_avg_fn=rule, use_buffers=True)


def digest(path: pathlib.Path) -> str:
    """SHA-256 of a file."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def begin(model: Model, start: pathlib.Path, device: torch.device) -> tuple[int, int]:
    """Gives a model weights of a checkpoint where names and shapes are the same: how many tensors, and how many of the model not."""
    _, state = load(start, device)
    theirs, own = weights_of(state), model.state_dict()
    fitting = {name: theirs[name] for name in own if name in theirs and theirs[name].shape == own[name].shape}
    if not fitting:
        raise ValueError(f"{start}: no weights fit this model: choose a checkpoint of the same parts")
    model.load_state_dict(fitting, strict=False)
    return len(fitting), len(own) - len(fitting)


def weights_of(state: dict[str, Any]) -> dict[str, torch.Tensor]:
    """Those that predict: the averaged ones, if there are any."""
    if state["average"] is None:
        plain: dict[str, torch.Tensor] = state["model"]
        return plain
    return {
        name.removeprefix("module."): value for name, value in state["average"].items() if name.startswith("module.")
    }


def save(
    path: pathlib.Path, run: Run, model: Model, optimiser: torch.optim.Optimizer, average: AveragedModel | None
) -> None:
    """Writes it beside, then puts it in place."""
    state = {
        "version": VERSION,
        "run": dataclasses.asdict(run),
        "model": model.state_dict(),
        "optimiser": optimiser.state_dict(),
        "average": None if average is None else average.state_dict(),
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
    model.load_state_dict(weights_of(state))
    return run, model.eval()
