//! Against a test of every cell by separating axes, and closed forms.

use std::sync::Arc;

use crate::voxel_grid::VoxelGrid;
use frames::{Agent, Pose, World};
use glam::DVec3;
use proptest::prelude::*;
use render::{RenderError, VoxelBlock, VoxelRenderer};
use schema::Tag;
use schema::geometry::{Snapshot, TriMesh};
use settings::OccupancySettings;
use testkit::{WorldBuilder, box_mesh, sheet, small_town};

use crate::voxels::{CpuVoxelRenderer, GridPlacement, voxelize};

fn small() -> OccupancySettings {
    OccupancySettings {
        range_m: 2.0,
        voxel_m: 0.25,
        lower_m: -1.0,
        upper_m: 2.0,
        mount_z_m: 0.1,
        ..OccupancySettings::default()
    }
}

fn at(xyz_m: [f64; 3], rpy_rad: [f64; 3]) -> Pose<World, Agent> {
    Pose::from_xyz_rpy(xyz_m, rpy_rad)
}

/// Whether a triangle meets the cube of half side `half` about `centre`: no axis of the thirteen separates
/// them.
fn overlaps(corners: [DVec3; 3], centre: DVec3, half: f64) -> bool {
    let p = corners.map(|c| c - centre);
    let edges = [p[1] - p[0], p[2] - p[1], p[0] - p[2]];
    let units = [DVec3::X, DVec3::Y, DVec3::Z];
    let crosses = units.iter().flat_map(|u| edges.iter().map(move |e| u.cross(*e)));
    units.into_iter().chain([edges[0].cross(edges[1])]).chain(crosses).all(|axis| {
        let reach = half * (axis.x.abs() + axis.y.abs() + axis.z.abs());
        let along = p.map(|c| c.dot(axis));
        let (low, high) = along.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
        low <= reach && high >= -reach
    })
}

/// Every cell against every triangle, in f64, with cubes of the given relative size.
fn brute_force(
    snapshot: &Snapshot,
    pose: &Pose<World, Agent>,
    settings: &OccupancySettings,
    size: f64,
) -> VoxelGrid {
    let mut grid = VoxelGrid::free(settings.shape());
    let s = settings.voxel_m;
    let grid_from_world =
        (*pose * Pose::<Agent, Agent>::from_xyz_rpy([0.0, 0.0, settings.mount_z_m], [0.0; 3])).inverse();
    for instance in &snapshot.instances {
        let mesh = snapshot.mesh(instance);
        for t in 0..mesh.triangles.len() {
            let tag = mesh.part(t).tag;
            let corners = mesh.corners(t).map(|c| {
                let world = snapshot.origin.world_from_local(instance.local_from_object.transform_point3(c));
                let p = grid_from_world * nalgebra::Point3::from(world);
                DVec3::new(p.x, p.y, p.z)
            });
            for i in 0..grid.shape[0] {
                for j in 0..grid.shape[1] {
                    for k in 0..grid.shape[2] {
                        let middle = |n: usize, low: f64| low + (n as f64 + 0.5) * s;
                        let centre = DVec3::new(
                            middle(i, -settings.range_m),
                            middle(j, -settings.range_m),
                            middle(k, settings.lower_m),
                        );
                        if overlaps(corners, centre, 0.5 * s * size) {
                            let at = grid.index(i, j, k);
                            let old = Tag::from_u8(grid.data[at]).expect("a tag");
                            let wins = tag.voxel_priority() > old.voxel_priority()
                                || (tag.voxel_priority() == old.voxel_priority() && tag < old);
                            if wins {
                                grid.data[at] = tag as u8;
                            }
                        }
                    }
                }
            }
        }
    }
    grid
}

/// A mesh of loose triangles of one tag.
fn loose(tag: Tag, corners: &[[f32; 3]]) -> TriMesh {
    let mut mesh = box_mesh(tag, [1.0; 3], 1);
    mesh.positions = corners.iter().map(|&c| c.into()).collect();
    mesh.triangles = (0..corners.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    mesh.triangle_part = vec![0; mesh.triangles.len()];
    mesh
}

fn corner() -> impl Strategy<Value = [f32; 3]> {
    (-3.0..3.0f32, -3.0..3.0f32, -1.5..2.5f32).prop_map(|(x, y, z)| [x, y, z])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// One label: the set of cells lies between those of slightly smaller and slightly larger cubes.
    #[test]
    fn cells_are_those_of_separating_axes(
        corners in proptest::collection::vec(corner(), 9),
        tiny in proptest::collection::vec((corner(), corner(), corner()), 6),
        rpy in (-0.3..0.3f64, -0.3..0.3f64, -3.0..3.0f64),
    ) {
        let mut b = WorldBuilder::default();
        b.add(loose(Tag::Wall, &corners), 1, [1000.0, -500.0, 30.0], [0.1, 0.2, 0.3]);
        // Triangles smaller than a cell too.
        let tiny: Vec<[f32; 3]> = tiny
            .iter()
            .flat_map(|(p, a, c)| [*p, std::array::from_fn(|n| p[n] + 0.05 * a[n]), std::array::from_fn(|n| p[n] + 0.05 * c[n])])
            .collect();
        b.add(loose(Tag::Wall, &tiny), 2, [1000.0, -500.0, 30.0], [0.0; 3]);
        let snapshot = b.snapshot([1000.0, -500.0, 30.0]);
        let pose = at([1000.0, -500.0, 30.0], [rpy.0, rpy.1, rpy.2]);
        let got = voxelize(&snapshot, &pose, &small(), None).expect("settings");
        let (inner, outer) = (brute_force(&snapshot, &pose, &small(), 1.0 - 1e-4), brute_force(&snapshot, &pose, &small(), 1.0 + 1e-4));
        for (at, cell) in got.data.iter().enumerate() {
            prop_assert!(inner.data[at] <= *cell && *cell <= outer.data[at], "cell {at}: {} {} {}", inner.data[at], cell, outer.data[at]);
        }
        prop_assert!(got.data.iter().any(|c| *c != 0) || outer.data.iter().all(|c| *c == 0));
    }

    /// Labels: whatever the order of the triangles, the greatest priority wins, then the smallest label.
    #[test]
    fn labels_do_not_depend_on_order(corners in proptest::collection::vec(corner(), 18), turn in 0..6_usize) {
        use Tag::*;
        let tags = [Car, Truck, Bus, RoadLine, Wall, Building];
        let build = |order: &mut dyn Iterator<Item = usize>| {
            let mut b = WorldBuilder::default();
            order.for_each(|t| b.add(loose(tags[t], &corners[3 * t..3 * t + 3]), 1, [0.0; 3], [0.0; 3]));
            b.snapshot([0.0; 3])
        };
        let pose = at([0.0; 3], [0.0; 3]);
        let (first, second) = (build(&mut (0..6)), build(&mut (0..6).map(|t| (t + turn) % 6).rev()));
        let got = voxelize(&first, &pose, &small(), None).expect("settings");
        prop_assert_eq!(&got, &voxelize(&second, &pose, &small(), None).expect("settings"));
        // Cells whose own decision is clear of rounding agree with the full test.
        let (inner, outer) = (brute_force(&first, &pose, &small(), 1.0 - 1e-4), brute_force(&first, &pose, &small(), 1.0 + 1e-4));
        for (at, cell) in got.data.iter().enumerate().filter(|(at, _)| inner.data[*at] == outer.data[*at]) {
            prop_assert_eq!(*cell, inner.data[at]);
        }
    }
}

#[test]
fn flat_ground_is_one_layer_and_a_box_is_its_shell() {
    let mut b = WorldBuilder::default();
    b.add(sheet(Tag::Road, [-5.0, 5.0], [-5.0, 5.0], 10.0, |_, _| 0.0), 1, [0.0; 3], [0.0; 3]);
    // From 0.12 to 0.87 in all horizontal directions: 6 cells across; 0.2 to 0.9 above the ground: 4 cells
    // high.
    b.add(box_mesh(Tag::Car, [0.75, 0.75, 0.7], 3), 2, [0.495, 0.495, 0.2], [0.0; 3]);
    let settings = OccupancySettings { voxel_m: 0.125, ..small() };
    let grid = voxelize(&b.snapshot([0.0; 3]), &at([0.0; 3], [0.0; 3]), &settings, None).expect("settings");
    assert_eq!(grid.shape, [32, 32, 24]);
    let counts = grid.count();
    assert_eq!(counts[Tag::Road as usize], 32 * 32);
    // The ground is at -0.1 in the grid: layer 7 of those from -1 up.
    assert_eq!(grid.data[grid.index(3, 4, 7)], Tag::Road as u8);
    // Across 0.12..0.87: cells 16 (0 to 0.125) to 22; up 0.1..0.8: cells 8 to 14.
    assert_eq!(counts[Tag::Car as usize], 7 * 7 * 7 - 5 * 5 * 5);
    assert_eq!(grid.data[grid.index(16, 22, 14)], Tag::Car as u8);
    assert_eq!(grid.data[grid.index(19, 19, 11)], 0, "hollow");
    assert_eq!(counts.iter().sum::<u64>(), grid.data.len() as u64);
}

#[test]
fn the_grid_turns_with_its_agent_and_can_leave_it_out() {
    let mut b = WorldBuilder::default();
    b.add(box_mesh(Tag::Car, [0.1; 3], 1), 7, [10.0, 1.0, 0.0], [0.0; 3]);
    let snapshot = b.snapshot([10.0, 0.0, 0.0]);
    // Facing north, an object one metre north is ahead: large i, middle j.
    let pose = at([10.0, 0.0, 0.0], [0.0, 0.0, frames::deg(90.0)]);
    let grid = voxelize(&snapshot, &pose, &small(), None).expect("settings");
    let i = ((2.0 + 1.0) / 0.25) as usize;
    assert_ne!(grid.data[grid.index(i, 8, 3)], 0);
    assert_eq!(
        voxelize(&snapshot, &pose, &small(), Some(7)).expect("settings").count()[0],
        grid.data.len() as u64
    );
}

#[test]
fn bytes_do_not_depend_on_threads_nor_on_what_the_memory_held() {
    let town = small_town();
    let settings = OccupancySettings { voxel_m: 0.4, ..OccupancySettings::default() };
    let pose = at([-20.0, -2.0, 0.0], [0.01, 0.02, 0.3]);
    let mut cpu = CpuVoxelRenderer::default();
    cpu.prepare(&town.meshes).expect("has no device");
    let with = |threads: usize, grid: &mut VoxelGrid| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let placement = GridPlacement::new(&settings).expect("settings");
        pool.install(|| placement.voxelize(&cpu, &town, &pose, None, grid).expect("has no device"));
    };
    let mut one = VoxelGrid::default();
    with(1, &mut one);
    let mut two = VoxelGrid { shape: [1, 1, 9], data: vec![7; 1_000_000] };
    with(2, &mut two);
    assert_eq!(one, two);
    assert!(one.count()[Tag::Car as usize] > 100);
}

#[test]
fn senseless_grids_are_refused() {
    for settings in [
        OccupancySettings { voxel_m: 0.0, ..small() },
        OccupancySettings { voxel_m: f64::NAN, ..small() },
        OccupancySettings { range_m: 0.0, ..small() },
        OccupancySettings { range_m: 1e9, ..small() },
        OccupancySettings { upper_m: -2.0, ..small() },
        OccupancySettings { upper_m: 999.0, ..small() },
    ] {
        assert!(GridPlacement::new(&settings).is_err(), "{settings:?}");
    }
}

/// Tries every cell of a block against every triangle: a second renderer behind the seam.
struct EveryCell;

impl VoxelRenderer for EveryCell {
    fn prepare(&mut self, _: &[Arc<TriMesh>]) -> Result<(), RenderError> {
        Ok(())
    }

    fn voxelize(
        &self,
        snapshot: &Snapshot,
        blocks: &[VoxelBlock],
        cells: &mut [Vec<u8>],
    ) -> Result<(), RenderError> {
        for (block, cells) in blocks.iter().zip(cells) {
            let [nx, ny, nz] = block.shape;
            cells.clear();
            cells.resize(nx * ny * nz, 0);
            let others = snapshot.instances.iter().filter(|i| Some(i.object) != block.without);
            for instance in others {
                let mesh = snapshot.mesh(instance);
                let to_cells = block.cells_from_local * instance.local_from_object;
                for t in 0..mesh.triangles.len() {
                    let tag = mesh.part(t).tag;
                    let corners = mesh.corners(t).map(|c| to_cells.transform_point3(c).as_dvec3());
                    for (at, cell) in cells.iter_mut().enumerate() {
                        let place = [at / nz / ny, at / nz % ny, at % nz].map(|n| n as f64 + 0.5);
                        let old = Tag::from_u8(*cell).expect("a tag");
                        let wins = (tag.voxel_priority(), old) > (old.voxel_priority(), tag);
                        if wins && overlaps(corners, DVec3::from_array(place), 0.5) {
                            *cell = tag as u8;
                        }
                    }
                }
            }
        }
        Ok(())
    }
}

#[test]
fn another_renderer_fills_the_same_cells() {
    // Nothing lies on the face of a cell, so rounding decides nothing.
    let mut b = WorldBuilder::default();
    b.add(
        sheet(Tag::Road, [-5.03, 5.07], [-5.01, 5.02], 2.0, |x, y| 0.013 + 0.07 * x - 0.05 * y),
        1,
        [0.0; 3],
        [0.0; 3],
    );
    b.add(box_mesh(Tag::Car, [0.751, 0.433, 0.7], 2), 2, [0.4951, 0.311, 0.2017], [0.1, 0.2, 0.3]);
    b.add(box_mesh(Tag::Wall, [0.131, 0.833, 0.9], 1), 3, [-0.913, 0.211, 0.107], [0.0, 0.1, 1.0]);
    let snapshot = b.snapshot([0.0; 3]);
    let placement = GridPlacement::new(&small()).expect("settings");
    let block = |x: f64, yaw: f64, without| {
        placement.block(&snapshot.origin, &at([x, 0.017, 0.031], [0.02, -0.01, yaw]), without)
    };
    // A batch: two places, and one without the car.
    let blocks = [block(0.011, 0.3, None), block(0.713, 2.0, None), block(0.011, 0.3, Some(2))];
    let filled = |renderer: &mut dyn VoxelRenderer| {
        renderer.prepare(&snapshot.meshes).expect("has no device");
        let mut cells = vec![Vec::new(), vec![9; 40_000], vec![3; 7]];
        renderer.voxelize(&snapshot, &blocks, &mut cells).expect("has no device");
        cells
    };
    let cpu = filled(&mut CpuVoxelRenderer::default());
    assert_eq!(cpu, filled(&mut EveryCell));
    let cells_of = |cells: &[u8], tag: Tag| cells.iter().filter(|&&c| c == tag as u8).count();
    assert!(cells_of(&cpu[0], Tag::Car) > 30 && cells_of(&cpu[1], Tag::Wall) > 30);
    assert_eq!(cells_of(&cpu[2], Tag::Car), 0);
}

#[test]
fn meshes_that_were_not_prepared_are_an_error() {
    let town = small_town();
    let placement = GridPlacement::new(&small()).expect("settings");
    let made = placement.voxelize(
        &CpuVoxelRenderer::default(),
        &town,
        &at([0.0; 3], [0.0; 3]),
        None,
        &mut VoxelGrid::default(),
    );
    assert!(matches!(made, Err(RenderError::Unprepared { prepared: 0, .. })));
}
