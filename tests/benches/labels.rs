//! One benchmark per row of the speed budget.

use std::collections::BTreeMap;

use divan::{Bencher, counter::ItemsCount};
use frames::{Agent, Pose, World};
use labels::bev::{Areas, BevRasterizer, LaneAreas, LaneRasterizer, LaneView};
use labels::fill::Filler;
use labels::validity::{Evidence, PointCloud, validate};
use labels::voxel_grid::VoxelGrid;
use labels::voxels::{CpuVoxelRenderer, GridPlacement, Wanted};
use render::VoxelRenderer;
use schema::tables::BoxRow;
use settings::{BevSettings, FillingRule, OccupancySettings, SweepSettings};
use testkit::small_town;

fn main() {
    divan::main();
}

fn agent() -> Pose<World, Agent> {
    Pose::from_xyz_rpy([-20.0, -2.0, -0.1], [0.002, -0.006, 0.05])
}

#[divan::bench]
fn bev_400x400(bencher: Bencher<'_, '_>) {
    let town = small_town();
    let mut rasterizer = BevRasterizer::new(&BevSettings::default()).expect("default settings");
    bencher.bench_local(|| {
        rasterizer.rasterize(&town, &agent(), Areas::default()).to_bytes(&schema::BevClass::ALL)
    });
}

/// By the rule `simbev2x`: looks from above and below, closing; no lanes.
#[divan::bench]
fn bev_400x400_simbev2x(bencher: Bencher<'_, '_>) {
    let town = small_town();
    let mut rasterizer = LaneRasterizer::new(&BevSettings::default()).expect("default settings");
    let lanes = LaneAreas::default();
    let chosen_at = agent().xyz().into();
    let view = LaneView { lanes: &lanes, hazards: &[], footprints: &[], chosen_at };
    bencher.bench_local(|| rasterizer.rasterize(&town, &agent(), view).to_bytes(&schema::BevClass::ALL));
}

#[divan::bench]
fn voxels_1280x1280x80(bencher: Bencher<'_, '_>) {
    let town = small_town();
    let triangles: usize = town.instances.iter().map(|i| town.mesh(i).triangles.len()).sum();
    let placement = GridPlacement::new(&OccupancySettings::default()).expect("default settings");
    let mut cpu = CpuVoxelRenderer::default();
    cpu.prepare(&town.meshes).expect("has no device");
    let mut grid = VoxelGrid::default();
    let mut voxelize = || placement.voxelize(&cpu, &town, &agent(), None, &mut grid).is_ok();
    assert!(voxelize());
    bencher.counter(ItemsCount::new(triangles)).bench_local(voxelize);
}

/// The same with whose each cell is and how it moves.
#[divan::bench]
fn voxel_rows_1280x1280x80(bencher: Bencher<'_, '_>) {
    let town = small_town();
    let placement = GridPlacement::new(&OccupancySettings::default()).expect("default settings");
    let mut cpu = CpuVoxelRenderer::default();
    cpu.prepare(&town.meshes).expect("has no device");
    let block = placement.block(&town.origin, &agent(), None);
    let wanted = Wanted { places: true, ids: true, flow: true };
    bencher.bench_local(|| cpu.cell_rows(&town, &block, wanted).expect("is prepared"));
}

#[divan::bench]
fn voxel_sweeps_1280x1280x80(bencher: Bencher<'_, '_>) {
    let town = small_town();
    let placement = GridPlacement::new(&OccupancySettings::default()).expect("default settings");
    let mut cpu = CpuVoxelRenderer::default();
    cpu.prepare(&town.meshes).expect("has no device");
    let block = placement.block(&town.origin, &agent(), None);
    let mut cells = Vec::new();
    bencher.bench_local(|| cpu.sweep(&town, &block, &SweepSettings::default(), &mut cells).is_ok());
}

#[divan::bench(args = FillingRule::ALL.map(FillingRule::name))]
fn fill_1280x1280x80(bencher: Bencher<'_, '_>, rule: &str) {
    let rule = FillingRule::ALL.into_iter().find(|of| of.name() == rule).expect("is one of them");
    let town = small_town();
    let hollow = labels::voxels::voxelize(&town, &agent(), &OccupancySettings::default(), None)
        .expect("default settings");
    let mut filler = Filler::default();
    bencher
        .with_inputs(|| hollow.clone())
        .bench_local_refs(|grid| filler.fill(grid, 0.1, rule).expect("a usual grid"));
}

#[divan::bench]
fn count_voxels(bencher: Bencher<'_, '_>) {
    let grid = labels::voxels::voxelize(&small_town(), &agent(), &OccupancySettings::default(), None)
        .expect("default settings");
    bencher.bench_local(|| grid.count());
}

/// 200 000 points (from a spiral over the ground), 300 boxes.
#[divan::bench]
fn validity_200k_points_300_boxes(bencher: Bencher<'_, '_>) {
    let boxes: Vec<BoxRow> = (0..300_u16)
        .map(|k| {
            let (x, y) = (f64::from(k % 20) * 9.0 - 90.0, f64::from(k / 20) * 9.0 - 70.0);
            let bounds = frames::OrientedBox::standing(
                Pose::from_xyz_rpy([x, y, 0.0], [0.0, 0.0, 0.1 * f64::from(k)]),
                4.6,
                1.9,
                1.5,
            );
            let mut corners_m = [0.0; 24];
            for (to, corner) in corners_m.chunks_exact_mut(3).zip(bounds.corners()) {
                to.copy_from_slice(corner.coords.as_slice());
            }
            BoxRow { id: k + 1, class: "car".into(), corners_m, ..BoxRow::default() }
        })
        .collect();
    let [x, y, z] = points();
    let cloud = PointCloud {
        world_from_sensor: Pose::from_xyz_rpy([0.0, 0.0, 1.8], [0.0, 0.0, 0.3]),
        x: &x,
        y: &y,
        z: &z,
    };
    let pixels = BTreeMap::new();
    let evidence = Evidence { lidars: &[cloud], radars: &[], num_pixels: &pixels, valid_by_image: true };
    bencher.bench_local(|| validate(&boxes, &evidence));
}

/// 200,000 returns up to 120 m away, in the sensor's frame, metres.
fn points() -> [Vec<f32>; 3] {
    let (mut x, mut y, mut z) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..200_000 {
        let (sin, cos) = frames::math::f32::sin_cos(k as f32 * 0.003_07);
        let reach_m = 2.0 + 118.0 * (k % 128) as f32 / 128.0 * ((k * 7 % 13) as f32 / 13.0);
        x.push(cos * reach_m);
        y.push(sin * reach_m);
        z.push(-1.8 + (k % 17) as f32 * 0.1);
    }
    [x, y, z]
}

#[divan::bench]
fn observed_1280x1280x80_200k_rays(bencher: Bencher<'_, '_>) {
    let [x, y, z] = points();
    let lattice =
        labels::carve::Lattice { shape: [1280, 1280, 80], corner_m: [-64.0, -64.0, -0.98], cell_m: 0.1 };
    let agent_from_sensor = Pose::from_xyz_rpy([0.0, 0.0, 1.8], [0.0; 3]);
    let sweep = labels::carve::Sweep { agent_from_sensor, x: &x, y: &y, z: &z };
    let mut cells = Vec::new();
    bencher.bench_local(|| labels::carve::carve(&lattice, &[sweep], &mut cells));
}
