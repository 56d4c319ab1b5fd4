"""Trains a checkout of somebody else's trainer on a small export: train_check.py TRAINER PROGRAMS [--checkout FOLDER] [--steps 200].

Makes a store, exports it, runs the trainer for some steps and expects that the loss falls and, where the trainer says it, that AP on
the frames it was trained on is above 0.5. Run it with the Python of the trainer. Exit code 77: what it needs is not there.
docs/trainers.md tells what is done for each.
"""

import argparse
import importlib.util
import os
import pathlib
import re
import shlex
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time

REPO = pathlib.Path(__file__).resolve().parents[1]
# The mean of the last tenth of all losses is below this share of that of the first tenth.
FALL = 0.7
LEAST_AP = 0.5

CONFIG = """name = "train-check"
seed = 5
[scenes.train]
"convoy/demo" = 1
[agents]
min_vehicles = 2
max_vehicles = 2
min_rsus = 1
max_rsus = 1
spawn_mode = "clustered"
clustered_spawn_distance_m = 120
[timing]
min_duration_s = {seconds}
max_duration_s = {seconds}
[traffic]
vehicles = 45
[walkers]
count = 15
[weather.initial]
precipitation = 0
fog_density = 0
[weather.final]
precipitation = 0
fog_density = 0
[world]
radius_m = 150
[annotation]
every_n_frames = 2
[vehicle]
{cameras}
lidar = {{ channels = {beams}, columns = 1024, every_n_frames = 2 }}
radar = {{ enabled = false }}
occupancy = {{ enabled = false }}
[rsu]
camera = {{ enabled = false }}
lidar = {{ channels = {beams}, columns = 1024, every_n_frames = 2 }}
radar = {{ enabled = false }}
occupancy = {{ enabled = false }}
"""
NO_CAMERAS = "camera = { enabled = false }"
LOSS = re.compile(r"\bloss\b\W{1,4}([-+]?(?:[0-9.]+(?:e[-+]?[0-9]+)?|nan|inf))", re.IGNORECASE)
AP = re.compile(r"(?:average precision|\bAP)[^\n]*?0\.50?\b\D+([01]?\.[0-9]+|1\.0+|[01]\b)", re.IGNORECASE)


class Skipped(Exception):
    """What the check needs is not there."""


def say(text):
    print(f"train-check: {text}", flush=True)


def make(command, **how):
    say(shlex.join(map(str, command)))
    return subprocess.run([str(word) for word in command], check=True, **how)


def export(args, layout, *options, cameras=NO_CAMERAS, beams=64, seconds=4):
    """A store, and an export of it; what is there already stays."""
    config, store, dest = args.work / "config.toml", args.work / "store", args.work / "export"
    config.write_text(CONFIG.format(cameras=cameras, beams=beams, seconds=seconds))
    convoy = args.programs / "convoy"
    make([convoy, "run", "--config", config, "--store", store, "--progress", "none"])
    make([convoy, "export", layout, "--store", store, "--dest", dest, *options])
    return store, dest


def run_until(args, command, cwd, environment, wants=None):
    """Runs a trainer to its end, or until it has told `steps` losses and `wants` finds what it leaves; returns the losses."""
    say(f"in {cwd}: {shlex.join(map(str, command))}")
    environment = {**os.environ, "PYTHONUNBUFFERED": "1", **environment}
    process = subprocess.Popen(
        [str(word) for word in command], cwd=cwd, env=environment, text=True, bufsize=1, errors="replace",
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True,
    )  # fmt: skip
    watch = threading.Timer(60 * args.minutes, os.killpg, (process.pid, signal.SIGTERM))
    watch.start()
    losses, tail = [], []
    with (args.work / "train.log").open("w", buffering=1) as log:
        # Progress bars end their lines by a carriage return, which is a line here, too.
        for line in process.stdout:
            log.write(line)
            tail = [*tail[-30:], line]
            losses += [float(found) for found in LOSS.findall(line)[:1]]
            if wants and len(losses) >= args.steps and wants():
                os.killpg(process.pid, signal.SIGTERM)
                break
    code = process.wait()
    watch.cancel()
    if len(losses) < args.steps or (code and not wants):
        sys.exit(f"{''.join(tail)}\nthe trainer ended with {code} and told {len(losses)} losses of {args.steps} steps")
    return losses[: args.steps]


def expect_fall(losses):
    tenth = max(1, len(losses) // 10)
    first, last = (statistics.fmean(part) for part in (losses[:tenth], losses[-tenth:]))
    say(f"loss: {first:.4g} in the first {tenth} of {len(losses)} steps, {last:.4g} in the last")
    if not last < FALL * first:
        sys.exit(f"the loss did not fall below {FALL} of what it was")


def expect_ap(found, what):
    say(f"{what}: {found:.3f}")
    if not found > LEAST_AP:
        sys.exit(f"{what} is not above {LEAST_AP}")


def checkout(args, *names):
    """The user's checkout, which has these files."""
    if args.checkout is None:
        raise Skipped("CHECKOUT names no folder")
    for name in names:
        if not (args.checkout / name).exists():
            raise Skipped(f"{args.checkout} has no {name}")
    return args.checkout


def needs(*packages):
    missing = [package for package in packages if importlib.util.find_spec(package) is None]
    if missing:
        raise Skipped(f"{sys.executable} has no {', '.join(missing)}")


def opencood(args, layout="opv2v"):
    """OpenCOOD and those that are made of it: hypes of the checkout, adapted by the export's own tool."""
    folder = checkout(args, args.hypes, "opencood/tools/train.py")
    needs("torch", "yaml")
    _, dest = export(args, layout)
    split = dest / {"opv2v": "OPV2V", "v2x-real": "V2X-Real"}[layout]
    for name in ("validate", "test"):
        # AP is that of the frames of training.
        if not (split / name).exists():
            (split / name).symlink_to("train")
    hypes = args.work / "hypes.yaml"
    sets = [word for value in args.set for word in ("--set", value)]
    make([sys.executable, dest / "hypes/adapt_hypes.py", folder / args.hypes, hypes, *sets])
    start = time.time()

    def checkpoints():
        return [path for path in folder.rglob("*.pth") if path.stat().st_mtime >= start]

    environment = {"PYTHONPATH": str(folder)}
    command = [sys.executable, "opencood/tools/train.py", "--hypes_yaml", hypes]
    expect_fall(run_until(args, command, folder, environment, wants=checkpoints))
    model = max(checkpoints(), key=lambda path: path.stat().st_mtime).parent
    fusion = next((name for name in ("late", "early") if name in args.hypes), "intermediate")
    infer = args.infer or "opencood/tools/inference.py --model_dir {model} --fusion_method {fusion}"
    command = [sys.executable, *shlex.split(infer.format(model=model, fusion=fusion))]
    done = make(command, cwd=folder, env={**os.environ, **environment}, capture_output=True, text=True)
    found = AP.findall(done.stdout + done.stderr)
    if found:
        expect_ap(float(found[-1]), "AP at an overlap of 0.5")
    else:
        say(f"note: no AP was found in what inference said:\n{done.stdout[-2000:]}")


SMALL = """
import sys
from mmengine import Config
base, out, steps, infos = sys.argv[1:]
steps = int(steps)
cfg = Config.fromfile(base)
# The same frames again and again, as they are.
cfg.train_dataloader.update(batch_size=2, num_workers=0, persistent_workers=False)
cfg.train_dataloader.dataset.pipeline = [
    step for step in cfg.train_dataloader.dataset.pipeline if step.type not in ("GlobalRotScaleTrans", "RandomFlip3D")]
for loader in (cfg.val_dataloader, cfg.test_dataloader):
    loader.update(num_workers=0, persistent_workers=False)
    loader.dataset.ann_file = infos
for evaluator in (cfg.val_evaluator, cfg.test_evaluator):
    evaluator.ann_file = cfg.data_root + infos
cfg.optim_wrapper.optimizer.lr = 2e-3
cfg.param_scheduler = [dict(type="OneCycleLR", eta_max=2e-3, total_steps=steps, by_epoch=False)]
cfg.train_cfg = dict(type="IterBasedTrainLoop", max_iters=steps, val_interval=steps)
cfg.default_hooks.logger.interval = 1
cfg.default_hooks.checkpoint = dict(type="CheckpointHook", by_epoch=False, interval=steps)
cfg.log_processor = dict(type="LogProcessor", window_size=1, by_epoch=False)
cfg.auto_scale_lr = None
cfg.randomness = dict(seed=0)
cfg.dump(out)
"""


def mmdet3d(args):
    """mmdet3d as it is installed, or a checkout of it, by our CenterPoint; scores by `convoy evaluate`."""
    needs("mmdet3d", "mmengine")
    package = pathlib.Path(importlib.util.find_spec("mmdet3d").origin).parent
    train = (args.checkout or package / ".mim") / "tools/train.py"
    if not train.exists():
        raise Skipped(f"there is no {train}")
    store, dest = export(args, "nuscenes", "--infos", "mmdet3d", "--agents", "vehicle_*", "--sample-every", "4", beams=32)
    results, config = args.work / "results", args.work / "small.py"
    environment = {
        "CONVOY_EXPORT": str(dest), "CONVOY_RESULTS": str(results), "CONVOY_REACH_M": "25.6", "CONVOY_CELL_M": "0.4",
    }  # fmt: skip
    base = REPO / f"configs/trainers/mmdet3d/{args.hypes or 'centerpoint'}.py"
    infos = "infos/mmdet3d_train.pkl"
    maker = args.work / "make_small.py"
    maker.write_text(SMALL)
    make([sys.executable, maker, base, config, args.steps, infos], env={**os.environ, **environment})
    command = [sys.executable, train, config, "--work-dir", args.work / "mmdet3d"]
    expect_fall(run_until(args, command, args.work, environment))
    found = make(
        [args.programs / "convoy", "evaluate", "--store", store, "--nuscenes", dest, "--metrics", "nuscenes",
         "--predictions", results / "pred_instances_3d/results_nusc.json", "--range-m=-25.6,-25.6,25.6,25.6"],
        capture_output=True, text=True,
    ).stdout  # fmt: skip
    print(found)
    # Class, targets, AP, and AP at 0.5, 1, 2 and 4 m, in per cent.
    row = next(line for line in found.splitlines() if line.split()[:1] == ["car"])
    expect_ap(float(row.split()[5]) / 100, "AP of cars at 2 m")


def openpcdet(args):
    """OpenPCDet on one agent; it trains on a GPU alone."""
    folder = checkout(args, "tools/train.py")
    needs("torch", "pcdet")
    import torch

    if not torch.cuda.is_available():
        raise Skipped("OpenPCDet trains on a GPU alone, and there is none")
    cameras = "camera = { width = 960, height = 320, boxes_2d = true, every_n_frames = 2 }"
    _, dest = export(args, "kitti", "--agents", "vehicle_*", cameras=cameras)
    configs, root = REPO / "configs/trainers/openpcdet", dest / "vehicle_0/object"
    make([sys.executable, configs / "make_infos.py", root])
    frames = len((root / "ImageSets/train.txt").read_text().split())
    epochs = max(1, -(-args.steps // max(1, frames // 4)))
    command = [sys.executable, "train.py", "--cfg_file", configs / "pointpillar.yaml", "--epochs", epochs, "--batch_size", 4,
               "--extra_tag", f"train-check-{int(time.time())}", "--logger_iter_interval", 1, "--num_epochs_to_eval", 1,
               "--set", "DATA_CONFIG.DATA_PATH", root, "DATA_CONFIG.INFO_PATH.test", "['kitti_infos_train.pkl']"]  # fmt: skip
    expect_fall(run_until(args, command, folder / "tools", {}))
    text = (args.work / "train.log").read_text()
    found = re.findall(r"^3d +AP: *([0-9.]+)", text[text.rfind("Car AP") :], re.MULTILINE)
    expect_ap(float(found[0]) / 100, "3D AP of cars")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("trainer", choices=["opencood", "heal", "v2x-real", "mmdet3d", "openpcdet"])
    parser.add_argument("programs", type=pathlib.Path, help="the folder of the program `convoy`")
    parser.add_argument("--checkout", type=pathlib.Path, help="the trainer's")
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--minutes", type=float, default=120, help="at most so long (120)")
    parser.add_argument("--hypes", help="the checkout's file that is adapted; of mmdet3d centerpoint or pointpillars")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="another value for a key of the hypes")
    parser.add_argument("--infer", help="the command of inference with {model} and {fusion}, without the Python")
    parser.add_argument("--work", type=pathlib.Path, help="keep everything in this folder")
    args = parser.parse_args()
    args.programs, args.checkout = args.programs.resolve(), args.checkout and args.checkout.resolve()
    if args.trainer in ("opencood", "heal", "v2x-real"):
        args.hypes = args.hypes or "opencood/hypes_yaml/point_pillar_intermediate_fusion.yaml"
    # HEAL replaces words in whole paths: none of these is in one that we name.
    with tempfile.TemporaryDirectory(prefix="convoy-check-") as folder:
        args.work = (args.work or pathlib.Path(folder)).resolve()
        args.work.mkdir(parents=True, exist_ok=True)
        try:
            if args.trainer == "mmdet3d":
                mmdet3d(args)
            elif args.trainer == "openpcdet":
                openpcdet(args)
            else:
                opencood(args, "v2x-real" if args.trainer == "v2x-real" else "opv2v")
        except Skipped as why:
            say(f"note: {args.trainer} is skipped: {why}")
            return 77
    say(f"{args.trainer} trains on it")
    return 0


if __name__ == "__main__":
    sys.exit(main())
