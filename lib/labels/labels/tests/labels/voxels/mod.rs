//! Sweeps against hand-made columns, and lists of cells against whole grids.

mod rows;
mod sweeps;

use frames::{Agent, Pose, World};
use labels::voxels::{CpuVoxelRenderer, GridPlacement};
use render::{VoxelBlock, VoxelRenderer};
use schema::geometry::Snapshot;
use settings::OccupancySettings;

/// 16 x 16 x 12 cells of 0.25 m: from -2 m to 2 m and from -1 m to 2 m.
fn small() -> OccupancySettings {
    OccupancySettings {
        range_m: 2.0,
        voxel_m: 0.25,
        lower_m: -1.0,
        upper_m: 2.0,
        mount_z_m: 0.0,
        ..OccupancySettings::default()
    }
}

fn at(xyz_m: [f64; 3], rpy_rad: [f64; 3]) -> Pose<World, Agent> {
    Pose::from_xyz_rpy(xyz_m, rpy_rad)
}

/// A renderer for a snapshot and the block of an agent's grid.
fn ready(
    snapshot: &Snapshot,
    settings: &OccupancySettings,
    pose: &Pose<World, Agent>,
) -> (CpuVoxelRenderer, VoxelBlock) {
    let mut cpu = CpuVoxelRenderer::default();
    cpu.prepare(&snapshot.meshes).expect("has no device");
    let placement = GridPlacement::new(settings).expect("settings");
    (cpu, placement.block(&snapshot.origin, pose, None))
}

/// The whole grid.
fn whole(cpu: &CpuVoxelRenderer, snapshot: &Snapshot, block: &VoxelBlock) -> Vec<u8> {
    let mut cells = vec![Vec::new()];
    cpu.voxelize(snapshot, &[*block], &mut cells).expect("is prepared");
    cells.remove(0)
}
