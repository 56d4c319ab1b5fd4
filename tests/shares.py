"""Voxels by class beside the published means (figure 3c of the SimBEV2X paper): shares.py FOLDER_OF_PROGRAMS [MAPS [STORE]].

A scene of each of our towns but the demo, and of CARLA's maps that MAPS has, with the default agents, traffic and scenery; whole
grids of 0.1 m, not filled, each two seconds. Prints a table in Markdown and ends with 1 where a class of the street is farther off
than a factor of two. With STORE the store is kept there, and what it has is not made again.

Then what sensors see of each tag, in a short scene of three towns: of lidar returns, of pixels, of BEV cells. That needs numpy,
pyarrow and Pillow.
"""

import csv
import pathlib
import subprocess
import sys
import tempfile

# Cells of all published grids, not filled (588,520 of 1280 x 1280 x 80 cells).
GRIDS = 588_520
CELLS = {
    "building": 900_817_475_055, "wall": 23_378_189_499, "fence": 18_363_831_129, "guard_rail": 5_591_909_462,
    "bridge": 6_893_309_672, "pole": 8_579_662_196, "traffic_light": 498_884_251, "traffic_sign": 400_975_040,
    "vegetation": 1_198_452_609_539, "terrain": 436_551_954_377, "sidewalk": 189_922_307_774, "static": 7_171_988_904,
    "bus": 6_826_241_522, "road": 187_936_233_179, "road_line": 10_380_085_422, "ground": 20_361_839_035,
    "rail_track": 11_447_168_465, "water": 379_943_469, "dynamic": 3_235_741_524, "other": 2_150_601_495,
    "car": 42_413_913_362, "truck": 13_310_215_313, "motorcycle": 397_784_633, "bicycle": 75_835_868,
    "pedestrian": 2_094_463_408, "rider": 443_130_500, "traffic_cone": 62_982_599, "barrier": 187_344_182,
}
# Those that are to be within a factor of two.
WANTED = ["building", "wall", "fence", "guard_rail", "bridge", "pole", "traffic_light", "traffic_sign", "vegetation", "terrain",
          "sidewalk", "static", "bus"]
TOWNS = [f"convoy/{k:02}" for k in range(1, 12)]
MAPS = ["Town03", "Town04", "Town10HD"]

CONFIG = """name = "shares"
seed = 351
[timing]
min_duration_s = 8
max_duration_s = 8
[scenes.train]
{scenes}
"""
OF_AGENTS = """[{agent}]
occupancy = {{ sparse = true, every_n_frames = 40 }}
camera = {{ enabled = false }}
lidar = {{ enabled = false }}
radar = {{ enabled = false }}
"""


SEEN = """name = "seen"
seed = 352
[agents]
min_vehicles = 2
max_vehicles = 2
min_rsus = 1
max_rsus = 1
[timing]
min_duration_s = 2
max_duration_s = 2
[scenes.train]
{scenes}
"""
SEEN_BY = """[{agent}]
camera = {{ width = 480, height = 270, every_n_frames = 20 }}
lidar = {{ semantic = true, every_n_frames = 20 }}
radar = {{ enabled = false }}
occupancy = {{ enabled = false }}
"""
# The numbers of tags, from CARLA 0.9.15 on.
TAGS = ["unlabeled", "road", "sidewalk", "building", "wall", "fence", "pole", "traffic light", "traffic sign", "vegetation",
        "terrain", "sky", "pedestrian", "rider", "car", "truck", "bus", "train", "motorcycle", "bicycle", "static", "dynamic",
        "other", "water", "road line", "ground", "bridge", "rail track", "guard rail", "rock", "traffic cone", "barrier"]


def make(programs, maps, folder, names, config, stages):
    known = [name for name in names if name.startswith("convoy/") or maps and (maps / f"{name}.xodr").exists()]
    file = folder / f"{stages.split(',')[-1]}.toml"
    whole, of_agents = config
    scenes = "\n".join(f'"{name}" = 1' for name in known)
    file.write_text(whole.format(scenes=scenes) + "".join(of_agents.format(agent=a) for a in ["vehicle", "rsu"]))
    store = folder / ("store" if stages.endswith("stats") else "seen")
    words = ["run", "--config", file, "--store", store, "--stages", stages, "--progress", "none"]
    done = subprocess.run([programs / "convoy", *words, *(["--maps", maps] if maps else [])], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"error: convoy run ended with {done.returncode}:\n{done.stderr}")
    return len(known), store


def seen(store):
    """Prints how much of lidar returns, pixels and BEV cells has which tag."""
    try:
        import numpy as np
        import PIL.Image  # noqa: F401, the reader decodes pictures with it
        sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "python" / "src"))
        import convoy
    except ImportError as missing:
        print(f"\nnote: what sensors see is not counted: {missing}")
        return
    dataset = convoy.Dataset(store)
    returns, pixels = (np.zeros(len(TAGS), dtype=np.int64) for _ in range(2))
    cells, masks = {}, 0
    for scene in dataset.scenes():
        for frame in (scene.frame(0), scene.frame(20)):
            for agent in (frame.agent(name) for name in frame.agents):
                returns += np.bincount(agent.semantic_lidar()["tag"], minlength=len(TAGS))
                for name in (name for name in agent.sensors if name.startswith("IST-")):
                    tags, _ = agent.camera(name.removeprefix("IST-"), "IST").instances()
                    pixels += np.bincount(tags.ravel(), minlength=len(TAGS))
                bev = agent.bev()
                masks += bev.masks[0].size
                for name, mask in zip(bev.classes, bev.masks):
                    cells[name] = cells.get(name, 0) + int(mask.sum())
    print("\n| tag | % of lidar returns | % of pixels |\n|---|---|---|")
    for tag, points, seen_of in zip(TAGS, 100 * returns / returns.sum(), 100 * pixels / pixels.sum()):
        if points > 0 or seen_of > 0:
            print(f"| {tag} | {points:.2f} | {seen_of:.2f} |")
    print("\n| class | % of BEV cells |\n|---|---|")
    for name, count in cells.items():
        print(f"| {name.replace('_', ' ')} | {100 * count / masks:.2f} |")


def table(store, name):
    with open(store / "stats" / f"{name}.csv", newline="") as file:
        return list(csv.DictReader(file))


def main():
    programs = pathlib.Path(sys.argv[1])
    maps = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 and sys.argv[2] else None
    with tempfile.TemporaryDirectory() as aside:
        folder = pathlib.Path(sys.argv[3] if len(sys.argv) > 3 else aside)
        folder.mkdir(parents=True, exist_ok=True)
        stages = "spawn-planner,simulate-and-log,occupancy-gt,stats"
        scenes, store = make(programs, maps, folder, TOWNS + MAPS, (CONFIG, OF_AGENTS), stages)
        ours = {row["label"]: int(row["unfilled"]) for row in table(store, "voxel_cells")}
        stages = "spawn-planner,simulate-and-log,bev-gt,render-sensors"
        _, pictures = make(programs, maps, folder, ["convoy/03", "convoy/07", "Town03"], (SEEN, SEEN_BY), stages)
        grids = next(int(row["value"]) for row in table(store, "overview") if row["quantity"] == "voxel_grids")
        print(f"{scenes} scenes, {grids} grids\n\n| class | cells a grid | published | ratio | |\n|---|---|---|---|---|")
        outside = 0
        for name, cells in [*CELLS.items(), ("total", 3_098_326_620_874)]:
            own, theirs = ours.get(name, 0) / grids, cells / GRIDS
            ratio = own / theirs
            is_wanted = name in WANTED or name == "total"
            is_outside = is_wanted and not 0.5 <= ratio <= 2
            outside += is_outside
            mark = "outside" if is_outside else "" if is_wanted else "not asked for"
            print(f"| {name.replace('_', ' ')} | {own:,.0f} | {theirs:,.0f} | {ratio:.2f} | {mark} |")
        share = 100 * ours["total"] / grids / (1280 * 1280 * 80)
        print(f"\nOccupied: {share:.2f} % of the cells; 4.02 % are published.")
        seen(pictures)
    return outside


sys.exit(main() > 0)
