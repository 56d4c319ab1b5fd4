//! Sweeps along the axes.

use schema::Tag;
use schema::geometry::Snapshot;
use settings::{SweepSettings, ZFill};
use testkit::{WorldBuilder, box_mesh, sheet};

use crate::voxels::{at, ready, small, whole};

const NONE: SweepSettings = SweepSettings {
    z_top: false,
    z_bottom: false,
    x_front: false,
    x_back: false,
    y_left: false,
    y_right: false,
    z_fill: ZFill::None,
};

/// Cells (i, j, k) with their tags.
fn swept(snapshot: &Snapshot, settings: &SweepSettings) -> Vec<([usize; 3], u8)> {
    let (cpu, block) = ready(snapshot, &small(), &at([0.0; 3], [0.0; 3]));
    let mut cells = vec![9; 7];
    cpu.sweep(snapshot, &block, settings, &mut cells).expect("is prepared");
    assert_eq!(cells.len(), 16 * 16 * 12);
    let place = |cell: usize| [cell / 12 / 16, cell / 12 % 16, cell % 12];
    (0..cells.len()).filter(|&cell| cells[cell] != 0).map(|cell| (place(cell), cells[cell])).collect()
}

fn box_cells(
    i: std::ops::Range<usize>,
    j: std::ops::Range<usize>,
    k: std::ops::Range<usize>,
    tag: Tag,
) -> Vec<([usize; 3], u8)> {
    let mut all = Vec::new();
    for i in i {
        for j in j.clone() {
            all.extend(k.clone().map(|k| ([i, j, k], tag as u8)));
        }
    }
    all
}

fn sorted(parts: &[Vec<([usize; 3], u8)>]) -> Vec<([usize; 3], u8)> {
    let mut all = parts.concat();
    all.sort_unstable();
    all
}

/// A car from 0.1 to 0.9 along x, -0.4 to 0.4 along y, 0.1 to 0.9 along z: cells 8 to 11, 6 to 9, 4 to 7.
fn car() -> WorldBuilder {
    let mut b = WorldBuilder::default();
    b.add(box_mesh(Tag::Car, [0.8, 0.8, 0.8], 2), 4, [0.5, 0.0, 0.1], [0.0; 3]);
    b
}

#[test]
fn each_direction_meets_its_side() {
    let world = car().snapshot([0.0; 3]);
    let side = |settings: SweepSettings| swept(&world, &settings);
    let (i, j, k) = (8..12, 6..10, 4..8);
    let tag = Tag::Car;
    assert_eq!(side(SweepSettings { z_top: true, ..NONE }), box_cells(i.clone(), j.clone(), 7..8, tag));
    assert_eq!(side(SweepSettings { z_bottom: true, ..NONE }), box_cells(i.clone(), j.clone(), 4..5, tag));
    assert_eq!(side(SweepSettings { x_front: true, ..NONE }), box_cells(11..12, j.clone(), k.clone(), tag));
    assert_eq!(side(SweepSettings { x_back: true, ..NONE }), box_cells(8..9, j.clone(), k.clone(), tag));
    assert_eq!(side(SweepSettings { y_left: true, ..NONE }), box_cells(i.clone(), 9..10, k.clone(), tag));
    assert_eq!(side(SweepSettings { y_right: true, ..NONE }), box_cells(i.clone(), 6..7, k.clone(), tag));
    // All six: the shell of 4 x 4 x 4 cells.
    let all = SweepSettings {
        z_top: true,
        z_bottom: true,
        x_front: true,
        x_back: true,
        y_left: true,
        y_right: true,
        ..NONE
    };
    let shell: Vec<_> = box_cells(i, j, k, tag)
        .into_iter()
        .filter(|([i, j, k], _)| [8, 11].contains(i) || [6, 9].contains(j) || [4, 7].contains(k))
        .collect();
    assert_eq!(side(all), shell);
}

#[test]
fn every_object_on_the_way_is_met_once() {
    let mut b = car();
    // Behind the car for rays from the front; two of one label and object count once, at the first.
    b.add(box_mesh(Tag::Wall, [0.2, 0.2, 0.2], 1), 5, [-0.9, 0.12, 0.4], [0.0; 3]);
    b.add(box_mesh(Tag::Car, [0.2, 0.2, 0.2], 1), 4, [-1.6, 0.1, 0.4], [0.0; 3]);
    let front = swept(&b.snapshot([0.0; 3]), &SweepSettings { x_front: true, ..NONE });
    // The wall from -1.0 to -0.8: met at -0.8, cell 4; across 0.02 to 0.22 and up 0.4 to 0.6: cells 8 and 5,
    // 6.
    let wall = vec![([4, 8, 5], Tag::Wall as u8), ([4, 8, 6], Tag::Wall as u8)];
    assert_eq!(front, sorted(&[box_cells(11..12, 6..10, 4..8, Tag::Car), wall]));
}

#[test]
fn what_is_met_half_a_cell_beyond_counts_for_the_last_cell() {
    let roof = |z: f64| {
        let mut b = WorldBuilder::default();
        b.add(sheet(Tag::Building, [0.1, 0.2], [0.1, 0.2], 1.0, |_, _| 0.0), 5, [0.0, 0.0, z], [0.0; 3]);
        swept(&b.snapshot([0.0; 3]), &SweepSettings { z_top: true, ..NONE })
    };
    // The grid ends at 2 m, a sweep begins at 2.125 m.
    assert_eq!(roof(2.1), [([8, 8, 11], Tag::Building as u8)]);
    assert_eq!(roof(2.15), []);
    assert_eq!(roof(-1.1), [([8, 8, 0], Tag::Building as u8)]);
}

/// A ramp of road under everything, and the car above some of it.
fn street() -> Snapshot {
    let mut b = car();
    // Within each column it climbs by two cells: from below it would be met lower than from above.
    b.add(sheet(Tag::Road, [-2.0, -1.0], [-2.0, 2.0], 4.0, |x, _| 2.0 * x + 2.99), 1, [0.0; 3], [0.0; 3]);
    b.add(sheet(Tag::Road, [-1.0, 2.0], [-2.0, 2.0], 4.0, |_, _| -0.1), 2, [0.0; 3], [0.0; 3]);
    b.snapshot([0.0; 3])
}

#[test]
fn bare_ground_is_not_met_from_below() {
    let world = street();
    let both = swept(&world, &SweepSettings { z_top: true, z_bottom: true, ..NONE });
    let of = |cells: &[([usize; 3], u8)], i: usize, j: usize| -> Vec<(usize, u8)> {
        cells.iter().filter(|(at, _)| at[0] == i && at[1] == j).map(|(at, tag)| (at[2], *tag)).collect()
    };
    let (road, car) = (Tag::Road as u8, Tag::Car as u8);
    // At x = -1.5 to -1.25 the road climbs from -0.01 to 0.49: cells 3 and 5. Bare: met from the top alone.
    assert_eq!(of(&both, 2, 8), [(5, road)]);
    assert_eq!(of(&swept(&world, &SweepSettings { z_bottom: true, ..NONE }), 2, 8), [(3, road)]);
    // Under the car the first thing met is no ground.
    assert_eq!(of(&both, 9, 8), [(3, road), (4, car), (7, car)]);
}

#[test]
fn between_top_and_bottom() {
    let world = street();
    let with = |z_fill| swept(&world, &SweepSettings { z_top: true, z_bottom: true, z_fill, ..NONE });
    let (road, car) = (Tag::Road as u8, Tag::Car as u8);
    let column = |cells: &[([usize; 3], u8)], i: usize| -> Vec<(usize, u8)> {
        cells.iter().filter(|(at, _)| at[0] == i && at[1] == 8).map(|(at, tag)| (at[2], *tag)).collect()
    };
    // Going up: road from below and from the top in cell 3, the car from cell 4 to 7, all of it car.
    let lines = with(ZFill::Scanline);
    assert_eq!(column(&lines, 9), [(3, road), (4, car), (5, car), (6, car), (7, car)]);
    assert_eq!(column(&lines, 2), [(5, road)], "bare ground opens nothing");
    // What touches cells between the ends: the middle of the car is hollow, its sides are not; the road's
    // slope is whole.
    let boxes = with(ZFill::BoxSweep);
    assert_eq!(column(&boxes, 9), [(3, road), (4, car), (7, car)]);
    assert_eq!(column(&boxes, 8), [(3, road), (4, car), (5, car), (6, car), (7, car)]);
    assert_eq!(column(&boxes, 2), [(3, road), (4, road), (5, road)]);
    // With sweeps from both ends this is every cell that anything touches.
    let (cpu, block) = ready(&world, &small(), &at([0.0; 3], [0.0; 3]));
    let full = whole(&cpu, &world, &block);
    assert_eq!(boxes.len(), full.iter().filter(|cell| **cell != 0).count());
}

#[test]
fn a_lid_of_another_label_closes_nothing() {
    let mut b = WorldBuilder::default();
    b.add(sheet(Tag::Wall, [0.1, 0.2], [0.1, 0.2], 1.0, |_, _| 0.0), 5, [0.0, 0.0, 0.1], [0.0; 3]);
    b.add(sheet(Tag::Fence, [0.1, 0.2], [0.1, 0.2], 1.0, |_, _| 0.0), 6, [0.0, 0.0, 1.1], [0.0; 3]);
    let settings = SweepSettings { z_top: true, z_bottom: true, z_fill: ZFill::Scanline, ..NONE };
    let cells = swept(&b.snapshot([0.0; 3]), &settings);
    assert_eq!(cells, [([8, 8, 4], Tag::Wall as u8), ([8, 8, 8], Tag::Fence as u8)]);
}
