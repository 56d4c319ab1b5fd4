"""Voxels by class beside the published means (figure 3c of the SimBEV2X paper): shares.py FOLDER_OF_PROGRAMS [MAPS [STORE]].

A scene of each of our towns but the demo, and of CARLA's maps that MAPS has, with the default agents, traffic and scenery; whole
grids of 0.1 m, not filled, each two seconds. Prints a table in Markdown and ends with 1 where a class of the street is farther off
than a factor of two. With STORE the store is kept there, and what it has is not made again.
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


def make(programs, maps, folder):
    names = TOWNS + [name for name in MAPS if maps and (maps / f"{name}.xodr").exists()]
    config = folder / "shares.toml"
    scenes = "\n".join(f'"{name}" = 1' for name in names)
    config.write_text(CONFIG.format(scenes=scenes) + "".join(OF_AGENTS.format(agent=a) for a in ["vehicle", "rsu"]))
    stages = "spawn-planner,simulate-and-log,occupancy-gt,stats"
    words = ["run", "--config", config, "--store", folder / "store", "--stages", stages, "--progress", "none"]
    subprocess.run([programs / "convoy", *words, *(["--maps", maps] if maps else [])], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return len(names)


def table(folder, name):
    with open(folder / "store" / "stats" / f"{name}.csv", newline="") as file:
        return list(csv.DictReader(file))


def main():
    programs = pathlib.Path(sys.argv[1])
    maps = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 and sys.argv[2] else None
    with tempfile.TemporaryDirectory() as aside:
        folder = pathlib.Path(sys.argv[3] if len(sys.argv) > 3 else aside)
        folder.mkdir(parents=True, exist_ok=True)
        scenes = make(programs, maps, folder)
        ours = {row["label"]: int(row["unfilled"]) for row in table(folder, "voxel_cells")}
        grids = next(int(row["value"]) for row in table(folder, "overview") if row["quantity"] == "voxel_grids")
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
    sys.exit(outside > 0)


main()
