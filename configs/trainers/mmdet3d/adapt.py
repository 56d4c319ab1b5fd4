#!/usr/bin/env python3
"""Makes a configuration for an export of any of mmdet3d's for nuScenes: python adapt.py BASE.py OURS.py --export EXPORT

For models that this folder has none of, as BEVFusion of mmdet3d's projects. Run it in the checkout, with the Python that has
mmdet3d. Wherever the configuration has a dataset or a metric of nuScenes it puts the export's info files, and leaves out what an
export has not: copies of objects of other samples, and the balancing of classes, which divides by zero where one has no object.
The ten classes stay as they are.
"""

import argparse
import pathlib

from mmengine import Config


def adapted(node, export, split, results):
    """A node with what the export needs; split is that of the dataloader it is in."""
    if isinstance(node, (list, tuple)):
        kept = [item for item in node if not (isinstance(item, dict) and 'db_sampler' in item)]
        return type(node)(adapted(item, export, split, results) for item in kept)
    if not isinstance(node, dict):
        return node
    if node.get('type') == 'CBGSDataset':
        return adapted(node['dataset'], export, split, results)
    made = {
        key: adapted(value, export, 'train' if key == 'train_dataloader' else split, results)
        for key, value in node.items()
    }
    if node.get('type') == 'NuScenesDataset':
        made.update(data_root=f'{export}/', ann_file=f'infos/mmdet3d_{split}.pkl')
    if node.get('type') == 'NuScenesMetric':
        made.update(
            data_root=f'{export}/',
            ann_file=f'{export}/infos/mmdet3d_val.pkl',
            format_only=True,
            jsonfile_prefix=results)
    return made


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('base', type=pathlib.Path)
    parser.add_argument('ours', type=pathlib.Path)
    parser.add_argument('--export', required=True, type=pathlib.Path, help='the folder of `convoy export nuscenes`')
    parser.add_argument('--results', default='results', help='where results_nusc.json is written')
    args = parser.parse_args()
    base = Config.fromfile(args.base).to_dict()
    # Pipelines of the file's own stand in the dataloaders already.
    Config(adapted(base, args.export.resolve(), 'val', args.results)).dump(args.ours)


if __name__ == '__main__':
    main()
