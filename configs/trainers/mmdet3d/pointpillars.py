# PointPillars (anchors on three levels) on data.py; its parts are those of mmdet3d's own model, which comes with the package.
_base_ = [
    './data.py', 'mmdet3d::_base_/models/pointpillars_hv_fpn_nus.py', 'mmdet3d::_base_/schedules/schedule-2x.py',
    'mmdet3d::_base_/default_runtime.py'
]
reach_m = float('{{$CONVOY_REACH_M:51.2}}')
cell_m = float('{{$CONVOY_CELL_M:0.2}}')
point_cloud_range = [-reach_m, -reach_m, -5.0, reach_m, reach_m, 3.0]
voxel_size = [cell_m, cell_m, 8]
# The backbone halves it three times: it must be divisible by 8.
cells = round(2 * reach_m / cell_m)
model = dict(
    data_preprocessor=dict(voxel_layer=dict(voxel_size=voxel_size, point_cloud_range=point_cloud_range)),
    # x, y, z, intensity, time.
    pts_voxel_encoder=dict(in_channels=5, voxel_size=voxel_size, point_cloud_range=point_cloud_range),
    pts_middle_encoder=dict(output_shape=[cells, cells]),
    pts_bbox_head=dict(
        num_classes=9,
        # Anchors stand on the ground, 1.8 m below the lidar.
        anchor_generator=dict(ranges=[[-reach_m, -reach_m, -1.8, reach_m, reach_m, -1.8]])))
