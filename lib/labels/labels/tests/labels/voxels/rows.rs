//! Occupied cells one by one.

use glam::{Affine3A, Vec3};
use labels::voxels::{CellRows, Wanted};
use schema::Tag;
use schema::geometry::Snapshot;
use settings::OccupancySettings;
use testkit::{WorldBuilder, box_mesh, sheet, small_town};

use crate::voxels::{at, ready, small, whole};

const ALL: Wanted = Wanted { places: true, ids: true, flow: true };

fn u16s(bytes: &[u8]) -> Vec<u16> {
    bytes.as_chunks().0.iter().map(|&b| u16::from_le_bytes(b)).collect()
}

fn flows(rows: &CellRows) -> Vec<[f32; 3]> {
    let values: Vec<f32> = rows.flow.as_chunks().0.iter().map(|&b| f32::from_le_bytes(b)).collect();
    values.as_chunks().0.to_vec()
}

/// Overlapping things of the same and of other labels.
fn crowd() -> Snapshot {
    let mut b = WorldBuilder::default();
    b.add(sheet(Tag::Road, [-5.0, 5.0], [-5.0, 5.0], 1.0, |x, y| 0.1 * x - 0.03 * y), 40, [0.0; 3], [0.0; 3]);
    b.add(box_mesh(Tag::Car, [1.5, 0.7, 0.8], 3), 9, [0.3, 0.2, 0.1], [0.0, 0.0, 0.4]);
    b.add(box_mesh(Tag::Car, [1.3, 0.9, 0.9], 3), 7, [0.6, 0.4, 0.1], [0.1, 0.0, 1.4]);
    b.add(box_mesh(Tag::Wall, [0.2, 2.5, 1.5], 2), 3, [-0.8, 0.0, -0.3], [0.0; 3]);
    b.add(box_mesh(Tag::Building, [0.9, 2.0, 1.1], 2), 5, [-1.0, 0.1, -0.2], [0.0, 0.1, 0.2]);
    b.snapshot([0.0; 3])
}

#[test]
fn a_list_is_the_grid() {
    let town = small_town();
    let settings = OccupancySettings { voxel_m: 0.4, ..OccupancySettings::default() };
    let scenes = [
        (&crowd(), small(), at([0.1, 0.0, 0.05], [0.05, -0.02, 0.7])),
        (&town, settings, at([-20.0, -2.0, 0.0], [0.01, 0.02, 0.3])),
    ];
    for (snapshot, settings, pose) in &scenes {
        let (cpu, block) = ready(snapshot, settings, pose);
        let grid = whole(&cpu, snapshot, &block);
        let rows = cpu.cell_rows(snapshot, &block, ALL).expect("is prepared");
        let [_, ny, nz] = block.shape;
        let want: Vec<u16> = (0..grid.len())
            .filter(|&cell| grid[cell] != 0)
            .flat_map(|cell| {
                [cell / nz / ny, cell / nz % ny, cell % nz, usize::from(grid[cell])].map(|n| n as u16)
            })
            .collect();
        assert_eq!(u16s(&rows.places), want);
        let n = want.len() / 4;
        assert!(n > 500 && rows.ids.len() == 2 * n && rows.flow.len() == 12 * n);
        assert_eq!(rows.counts.iter().sum::<u64>(), n as u64);
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            assert_eq!(pool.install(|| cpu.cell_rows(snapshot, &block, ALL)).expect("is prepared"), rows);
        }
    }
}

#[test]
fn a_cell_belongs_to_who_gives_it_its_label() {
    let snapshot = crowd();
    let pose = at([0.1, 0.0, 0.05], [0.05, -0.02, 0.7]);
    let (cpu, block) = ready(&snapshot, &small(), &pose);
    // Each object alone.
    let alone: Vec<(u16, Vec<u8>)> = snapshot
        .instances
        .iter()
        .map(|instance| {
            let only = Snapshot { instances: vec![*instance], ..snapshot.clone() };
            (instance.object, whole(&cpu, &only, &block))
        })
        .collect();
    let rows = cpu.cell_rows(&snapshot, &block, ALL).expect("is prepared");
    let (ids, places) = (u16s(&rows.ids), u16s(&rows.places));
    let mut shared = 0;
    for (id, place) in ids.iter().zip(places.as_chunks::<4>().0) {
        let [i, j, k] = [0, 1, 2].map(|axis| usize::from(place[axis]));
        let cell = (i * 16 + j) * 12 + k;
        let there = alone.iter().filter(|(_, grid)| grid[cell] != 0);
        let rank =
            |label: u8| Tag::from_u8(label).map(|tag| (tag.voxel_priority(), std::cmp::Reverse(label)));
        let best = there.clone().max_by_key(|(id, grid)| (rank(grid[cell]), std::cmp::Reverse(*id)));
        assert_eq!(best.map(|(id, _)| *id), Some(*id));
        shared += usize::from(there.count() > 1);
    }
    assert!(shared > 20, "{shared}");
}

#[test]
fn flow_is_the_way_of_the_surface_along_the_grids_axes() {
    let mut b = WorldBuilder::default();
    b.add(box_mesh(Tag::Wall, [0.4, 0.4, 0.8], 1), 3, [-1.4, 0.0, 0.0], [0.0; 3]);
    b.add(box_mesh(Tag::Car, [0.8, 0.6, 0.6], 2), 9, [0.8, 0.0, 0.1], [0.0; 3]);
    let mut snapshot = b.snapshot([0.0; 3]);
    // Half a metre east a frame: 10 m/s. The agent faces north: east is to its right.
    let car = &mut snapshot.instances[1];
    car.previous_local_from_object =
        Affine3A::from_translation(Vec3::new(-0.5, 0.0, 0.0)) * car.local_from_object;
    let north = at([0.0; 3], [0.0, 0.0, frames::deg(90.0)]);
    let (cpu, block) = ready(&snapshot, &small(), &north);
    let rows = cpu.cell_rows(&snapshot, &block, ALL).expect("is prepared");
    for (id, flow) in u16s(&rows.ids).into_iter().zip(flows(&rows)) {
        let want = if id == 9 { [0.0, -10.0, 0.0] } else { [0.0; 3] };
        assert!(flow.iter().zip(want).all(|(got, want)| (got - want).abs() < 1e-3), "{id} {flow:?}");
    }
    // A turn about the world's z axis by 0.05 rad a frame, 1 rad/s: speed is the distance from the axis.
    let car = &mut snapshot.instances[1];
    car.previous_local_from_object = Affine3A::from_rotation_z(-0.05) * car.local_from_object;
    let (cpu, block) = ready(&snapshot, &small(), &at([0.0; 3], [0.0; 3]));
    let rows = cpu.cell_rows(&snapshot, &block, ALL).expect("is prepared");
    let (ids, places) = (u16s(&rows.ids), u16s(&rows.places));
    let mut turning = 0;
    for ((id, place), flow) in ids.iter().zip(places.as_chunks::<4>().0).zip(flows(&rows)) {
        if *id == 9 {
            let [x, y] = [0, 1].map(|axis| -2.0 + 0.25 * (f32::from(place[axis]) + 0.5));
            // To first order: a chord of 0.05 rad is off by a fortieth.
            let (want, off) = ([-y, x, 0.0], 0.03 * (x.abs() + y.abs()));
            assert!(flow.iter().zip(want).all(|(got, want)| (got - want).abs() < off), "{flow:?} {want:?}");
            turning += 1;
        }
    }
    assert!(turning > 20);
}
