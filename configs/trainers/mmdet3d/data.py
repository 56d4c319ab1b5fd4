# The data of `convoy export nuscenes --infos mmdet3d` for mmdet3d 1.4: docs/trainers.md. Models of this folder take it as their base.
#
# CONVOY_EXPORT   the export's folder
# CONVOY_SWEEPS   earlier sweeps that are joined to a sample's: 9 for exports with `--sweeps lidar`; without, they would be half a
#                 second apart, so none are taken
# CONVOY_REACH_M  how far to each side

data_root = '{{$CONVOY_EXPORT:export}}/'
reach_m = float('{{$CONVOY_REACH_M:51.2}}')
sweeps_num = int('{{$CONVOY_SWEEPS:0}}')
# About the lidar, which is 1.8 m above the ground.
point_cloud_range = [-reach_m, -reach_m, -5.0, reach_m, reach_m, 3.0]
# nuScenes' classes without construction_vehicle, which no store has, in the order of CenterPoint's tasks.
class_names = ['car', 'truck', 'bus', 'trailer', 'barrier', 'motorcycle', 'bicycle', 'pedestrian', 'traffic_cone']
modality = dict(use_lidar=True, use_camera=False)

load = [
    dict(type='LoadPointsFromFile', coord_type='LIDAR', load_dim=5, use_dim=5),
    # Its fifth number is the time; where no sweep is joined it is 0 everywhere.
    dict(
        type='LoadPointsFromMultiSweeps',
        sweeps_num=sweeps_num,
        use_dim=[0, 1, 2, 3, 4],
        pad_empty_sweeps=False,
        remove_close=True),
]
train_pipeline = load + [
    dict(type='LoadAnnotations3D', with_bbox_3d=True, with_label_3d=True),
    dict(
        type='GlobalRotScaleTrans',
        rot_range=[-0.3925, 0.3925],
        scale_ratio_range=[0.95, 1.05],
        translation_std=[0, 0, 0]),
    dict(type='RandomFlip3D', sync_2d=False, flip_ratio_bev_horizontal=0.5, flip_ratio_bev_vertical=0.5),
    dict(type='PointsRangeFilter', point_cloud_range=point_cloud_range),
    dict(type='ObjectRangeFilter', point_cloud_range=point_cloud_range),
    dict(type='ObjectNameFilter', classes=class_names),
    dict(type='PointShuffle'),
    dict(type='Pack3DDetInputs', keys=['points', 'gt_bboxes_3d', 'gt_labels_3d']),
]
test_pipeline = load + [
    dict(type='PointsRangeFilter', point_cloud_range=point_cloud_range),
    dict(type='Pack3DDetInputs', keys=['points']),
]

dataset = dict(
    type='NuScenesDataset',
    data_root=data_root,
    data_prefix=dict(pts='samples/LIDAR_TOP', img='', sweeps='sweeps/LIDAR_TOP'),
    metainfo=dict(classes=class_names),
    modality=modality,
    # Boxes with a point of a lidar or a radar.
    use_valid_flag=True,
    box_type_3d='LiDAR')
train_dataloader = dict(
    batch_size=4,
    num_workers=4,
    persistent_workers=True,
    sampler=dict(type='DefaultSampler', shuffle=True),
    dataset=dict(ann_file='infos/mmdet3d_train.pkl', pipeline=train_pipeline, test_mode=False, **dataset))
val_dataloader = dict(
    batch_size=1,
    num_workers=1,
    persistent_workers=True,
    drop_last=False,
    sampler=dict(type='DefaultSampler', shuffle=False),
    dataset=dict(ann_file='infos/mmdet3d_val.pkl', pipeline=test_pipeline, test_mode=True, **dataset))
test_dataloader = val_dataloader

# nuScenes' own lists of scenes have none of ours, so scores are not worked out here: `convoy evaluate` reads the file
# RESULTS/pred_instances_3d/results_nusc.json.
val_evaluator = dict(
    type='NuScenesMetric',
    data_root=data_root,
    ann_file=data_root + 'infos/mmdet3d_val.pkl',
    metric='bbox',
    format_only=True,
    jsonfile_prefix='{{$CONVOY_RESULTS:results}}')
test_evaluator = val_evaluator
