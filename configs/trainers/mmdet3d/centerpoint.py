# CenterPoint with pillars on data.py; its parts are those of mmdet3d's own model, which comes with the package.
_base_ = [
    './data.py', 'mmdet3d::_base_/models/centerpoint_pillar02_second_secfpn_nus.py',
    'mmdet3d::_base_/schedules/cyclic-20e.py', 'mmdet3d::_base_/default_runtime.py'
]
reach_m = float('{{$CONVOY_REACH_M:51.2}}')
cell_m = float('{{$CONVOY_CELL_M:0.2}}')
point_cloud_range = [-reach_m, -reach_m, -5.0, reach_m, reach_m, 3.0]
voxel_size = [cell_m, cell_m, 8]
# The backbone halves it three times, and the head works on a quarter: it must be divisible by 8.
cells = round(2 * reach_m / cell_m)
reach_of_boxes = [-1.2 * reach_m, -1.2 * reach_m, -10.0, 1.2 * reach_m, 1.2 * reach_m, 10.0]
tasks = [
    dict(num_class=1, class_names=['car']),
    dict(num_class=1, class_names=['truck']),
    dict(num_class=2, class_names=['bus', 'trailer']),
    dict(num_class=1, class_names=['barrier']),
    dict(num_class=2, class_names=['motorcycle', 'bicycle']),
    dict(num_class=2, class_names=['pedestrian', 'traffic_cone']),
]
model = dict(
    data_preprocessor=dict(voxel_layer=dict(voxel_size=voxel_size, point_cloud_range=point_cloud_range)),
    pts_voxel_encoder=dict(voxel_size=voxel_size, point_cloud_range=point_cloud_range),
    pts_middle_encoder=dict(output_shape=(cells, cells)),
    pts_bbox_head=dict(
        tasks=tasks,
        bbox_coder=dict(
            voxel_size=voxel_size[:2], pc_range=point_cloud_range[:2], post_center_range=reach_of_boxes)),
    train_cfg=dict(
        pts=dict(grid_size=[cells, cells, 1], voxel_size=voxel_size, point_cloud_range=point_cloud_range)),
    test_cfg=dict(
        pts=dict(
            voxel_size=voxel_size[:2],
            pc_range=point_cloud_range[:2],
            post_center_limit_range=reach_of_boxes)))
