#!/usr/bin/env python3
"""Writes OpenPCDet's info files for an agent of `convoy export kitti`: python make_infos.py EXPORT/vehicle_0/object

Run it with the Python that has pcdet. Its own `create_kitti_infos` reads data/kitti of the checkout alone, wants all three lists and
the test frames in a folder of their own, and stops at the first frame without a label. Here frames without labels are left out.
"""

import argparse
import pathlib
import pickle

import yaml
from easydict import EasyDict
from pcdet.datasets.kitti.kitti_dataset import KittiDataset

CONFIG = pathlib.Path(__file__).resolve().with_name("pointpillar.yaml")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", type=pathlib.Path, help="the folder `object` of an agent")
    root = parser.parse_args().root.resolve()
    config = EasyDict(yaml.safe_load(CONFIG.read_text()))
    dataset = KittiDataset(config.DATA_CONFIG, config.CLASS_NAMES, training=False, root_path=root)
    for split in ("train", "val", "test"):
        listed = root / f"ImageSets/{split}.txt"
        if not listed.exists():
            continue
        # Frames of all splits lie in `training`, with labels.
        dataset.set_split("train")
        names = [name for name in listed.read_text().split() if (root / f"training/label_2/{name}.txt").stat().st_size]
        infos = dataset.get_infos(num_workers=4, has_label=True, count_inside_pts=True, sample_id_list=names)
        (root / f"kitti_infos_{split}.pkl").write_bytes(pickle.dumps(infos))
        print(f"{split}: {len(infos)} frames")


if __name__ == "__main__":
    main()
