#!/usr/bin/env python3
"""Makes hypes for this export from a trainer's own: python adapt_hypes.py STOCK.yaml OURS.yaml

Stock hypes of OpenCOOD, HEAL, CoBEVT and V2X-Real lose objects of this export without a word, or stop: boxes above 1 m over the
lidar (trucks, buses, cars uphill), beyond 40 m to the sides, and samples of more than 100 objects. This puts the folders of the
export and room for all of them wherever a file says such a thing, and tells what it changed. It needs PyYAML, which the trainers
need, too.

  --keep-range       leave ranges alone, height included
  --keep-width       leave ranges to the sides alone
  --set KEY=VALUE    another value for a key that the file has, as --set train_params.batch_size=1
"""
import argparse
import pathlib
import re
import sys

import yaml

HERE = pathlib.Path(__file__).resolve().parent
RANGES = ("cav_lidar_range", "lidar_range", "gt_range", "pc_range", "point_cloud_range")
FOLDERS = ("root_dir", "validate_dir", "test_dir")
# Where a file has none of them, it says otherwise what this puts there.
LOOKED_FOR = ("root_dir", "validate_dir", "cav_lidar_range", "max_num", "max_cav")


class Loader(yaml.SafeLoader):
    """Reads 1e-10 as the number that it is meant to be."""


Loader.yaml_implicit_resolvers = dict(yaml.SafeLoader.yaml_implicit_resolvers)
Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"^[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)[eE][-+]?[0-9]+$"),
    list("-+0123456789."),
)


def heights(node):
    """Heights of all ranges that a file names."""
    if isinstance(node, dict):
        for key, value in node.items():
            if key in RANGES and isinstance(value, list) and len(value) == 6:
                yield value[5] - value[2]
            yield from heights(value)
    elif isinstance(node, list):
        for item in node:
            yield from heights(item)


def adapted(key, node, values, pillars):
    """A node with what the export needs."""
    root = HERE.parent
    is_list = isinstance(node, list) and all(isinstance(v, (int, float)) for v in node)
    if key in FOLDERS:
        return str(root / values[key])
    if key == "assignment_path" and key in values:
        return str(root / values[key])
    if key in RANGES and is_list and len(node) == 6:
        x0, y0, z0, x1, y1, z1 = node
        if values["y_range"] and max(abs(y0), abs(y1)) < min(abs(x0), abs(x1)):
            y0, y1 = values["y_range"]
        if values["z_range"]:
            z0, z1 = values["z_range"]
        return [x0, y0, z0, x1, y1, z1]
    # Pillars stay one voxel high; the number of layers of other grids grows with the range.
    if key == "voxel_size" and is_list and len(node) == 3 and values["z_range"] and node[2] in pillars:
        return node[:2] + [values["z_range"][1] - values["z_range"][0]]
    if key == "max_num" and isinstance(node, int):
        return max(node, values["max_num"])
    if key == "max_cav" and isinstance(node, int):
        return max(node, values["max_cav"])
    if isinstance(node, dict):
        made = {k: adapted(k, v, values, pillars) for k, v in node.items()}
        # Augmentation of pictures starts from their size.
        if "final_dim" in made and "camera_width" in values and {"H", "W"} <= made.keys():
            made.update(H=values["camera_height"], W=values["camera_width"])
        return made
    if isinstance(node, list):
        return [adapted(None, item, values, pillars) for item in node]
    return node


def leaves(node, path=()):
    """Each value of a file that is no mapping, with the keys that lead to it."""
    if isinstance(node, dict):
        for key, value in node.items():
            yield from leaves(value, (*path, key))
    else:
        yield path, node


def put(node, assignment):
    """Another value for a key that is there."""
    keys, equals, value = assignment.partition("=")
    *folders, last = keys.split(".")
    try:
        for key in folders:
            node = node[key]
        if not equals or last not in node:
            raise KeyError(last)
    except (KeyError, TypeError):
        sys.exit(f"--set {assignment}: the file has no such key")
    node[last] = yaml.load(value, Loader)


def uneven(stock, made):
    """Grids that were even enough for the strides of their model and are no more: cells along each axis that are no whole number,
    or can be halved less often than those of the stock."""

    def cells(node):
        found = {}
        for path, size in leaves(node):
            if path[-1:] != ("voxel_size",) or not isinstance(size, list) or len(size) != 3:
                continue
            beside = {other: value for other, value in leaves(node) if other[:1] == path[:1]}
            for other, extent in beside.items():
                if other[-1] in RANGES and isinstance(extent, list) and len(extent) == 6:
                    found[path, other] = [(extent[k + 3] - extent[k]) / size[k] for k in range(2)]
        return found

    def halvings(count):
        whole = round(count)
        return -1 if abs(whole - count) > 1e-6 or whole < 1 else (whole & -whole).bit_length() - 1

    before = cells(stock)
    for places, counts in cells(made).items():
        for axis, count, was in zip("xy", counts, before[places]):
            if halvings(count) < min(halvings(was), 5):
                yield f"{'.'.join(map(str, places[1]))}: {count:g} cells along {axis}, where {was:g} were"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("stock", type=pathlib.Path)
    parser.add_argument("ours", type=pathlib.Path)
    parser.add_argument("--keep-range", action="store_true")
    parser.add_argument("--keep-width", action="store_true")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    args = parser.parse_args()
    values = yaml.load((HERE / "values.yaml").read_text(), Loader)
    if args.keep_range or args.keep_width:
        values["y_range"] = None
    if args.keep_range:
        values["z_range"] = None
    stock = yaml.load(args.stock.read_text(), Loader)
    made = adapted(None, stock, values, set(heights(stock)))
    faults = list(uneven(stock, made))
    if faults:
        sys.exit("\n".join([*faults, "the model's strides may not fit: take --keep-width"]))
    for assignment in args.set:
        put(made, assignment)
    after = dict(leaves(made))
    for path, value in leaves(stock):
        if after.get(path, value) != value:
            print(f"{'.'.join(map(str, path))}: {value} -> {after[path]}")
    missing = [key for key in LOOKED_FOR if not any(key in path for path in after)]
    if missing:
        print(f"note: {args.stock} has no {', '.join(missing)}", file=sys.stderr)
    args.ours.write_text(yaml.safe_dump(made, sort_keys=False))


if __name__ == "__main__":
    main()
