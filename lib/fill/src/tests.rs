//! Against marching rays cell by cell, and the rule's own consequences.

use std::collections::BTreeSet;

use proptest::prelude::*;
use schema::Tag;

use super::*;

/// The rule, word by word.
fn brute_force(grid: &VoxelGrid, voxel_m: f64) -> VoxelGrid {
    let mut out = grid.clone();
    for (tag, chunk) in ORDER {
        let chunk = chunk_cells(chunk, voxel_m, grid.shape);
        let before = out.clone();
        let [nx, ny, nz] = grid.shape;
        let cell = |i: usize, j: usize, k: usize| before.data[before.index(i, j, k)];
        let chunk_of = |i: usize, j: usize, k: usize| [i / chunk[0], j / chunk[1], k / chunk[2]];
        let mut active = BTreeSet::new();
        for i in 0..nx {
            for j in 0..ny {
                active.extend((0..nz).filter(|&k| cell(i, j, k) == tag as u8).map(|k| chunk_of(i, j, k)));
            }
        }
        if active.is_empty() {
            continue;
        }
        for i in 0..nx {
            for j in 0..ny {
                for k in 0..nz {
                    if cell(i, j, k) != 0 {
                        continue;
                    }
                    let hits =
                        |mut way: Box<dyn Iterator<Item = u8> + '_>| way.find(|c| *c != 0) == Some(tag as u8);
                    let enclosed = hits(Box::new((i + 1..nx).map(|a| cell(a, j, k))))
                        && hits(Box::new((0..i).rev().map(|a| cell(a, j, k))))
                        && hits(Box::new((j + 1..ny).map(|b| cell(i, b, k))))
                        && hits(Box::new((0..j).rev().map(|b| cell(i, b, k))))
                        && hits(Box::new((k + 1..nz).map(|c| cell(i, j, c))))
                        && hits(Box::new((0..k).rev().map(|c| cell(i, j, c))));
                    if enclosed && active.contains(&chunk_of(i, j, k)) {
                        let at = out.index(i, j, k);
                        out.data[at] = tag as u8;
                    }
                }
            }
        }
    }
    out
}

/// Paints the shell of the cube `from..to` in all axes.
fn shell(grid: &mut VoxelGrid, tag: Tag, from: usize, to: usize) {
    for i in from..to {
        for j in from..to {
            for k in from..to {
                if [i, j, k].iter().any(|&n| n == from || n == to - 1) {
                    let at = grid.index(i, j, k);
                    grid.data[at] = tag as u8;
                }
            }
        }
    }
}

fn filled(grid: &VoxelGrid) -> VoxelGrid {
    let mut out = grid.clone();
    fill(&mut out, 0.1).expect("a usual grid");
    out
}

#[test]
fn a_small_shell_keeps_the_hole_that_no_chunk_reaches() {
    let mut grid = VoxelGrid::free([40, 40, 40]);
    shell(&mut grid, Tag::Pedestrian, 0, 20);
    let out = filled(&grid);
    let hole = |i: usize, j: usize, k: usize| [i, j, k].iter().all(|n| (8..16).contains(n));
    for i in 1..19 {
        for j in 1..19 {
            for k in 1..19 {
                assert_eq!(out.data[out.index(i, j, k)] == 0, hole(i, j, k), "{i} {j} {k}");
            }
        }
    }
    assert_eq!(out.count()[Tag::Pedestrian as usize], 20 * 20 * 20 - 512);
}

#[test]
fn a_car_shell_is_filled_and_an_open_one_is_not() {
    let mut grid = VoxelGrid::free([48, 40, 80]);
    shell(&mut grid, Tag::Car, 0, 32);
    assert_eq!(filled(&grid).count()[Tag::Car as usize], 32 * 32 * 32);
    for i in 0..32 {
        for j in 0..32 {
            let top = grid.index(i, j, 31);
            grid.data[top] = 0;
        }
    }
    assert_eq!(filled(&grid), grid);
}

#[test]
fn a_house_leaves_the_inside_of_a_car_to_the_car() {
    let mut grid = VoxelGrid::free([64, 64, 80]);
    shell(&mut grid, Tag::Building, 0, 60);
    shell(&mut grid, Tag::Car, 20, 40);
    let out = filled(&grid);
    for (inner, tag) in [
        ([30, 30, 30], Tag::Car),
        ([10, 30, 30], Tag::Unlabeled),
        ([10, 10, 10], Tag::Building),
        ([45, 50, 8], Tag::Building),
    ] {
        assert_eq!(out.data[out.index(inner[0], inner[1], inner[2])], tag as u8, "{inner:?}");
    }
    assert_eq!(out, brute_force(&grid, 0.1));
}

#[test]
fn roads_and_walls_are_never_filled() {
    for tag in
        [Tag::Road, Tag::Sidewalk, Tag::Wall, Tag::Fence, Tag::Terrain, Tag::Other, Tag::Water, Tag::Ground]
    {
        let mut grid = VoxelGrid::free([16, 16, 16]);
        shell(&mut grid, tag, 1, 12);
        assert_eq!(filled(&grid), grid, "{tag:?}");
    }
}

#[test]
fn chunks_grow_as_cells_shrink() {
    assert_eq!(chunk_cells([8, 8, 8], 0.1, [1280, 1280, 80]), [8, 8, 8]);
    assert_eq!(chunk_cells([320, 320, 80], 0.1, [64, 400, 80]), [64, 320, 80]);
    assert_eq!(chunk_cells([16, 16, 16], 0.04, [1280, 1280, 80]), [40, 40, 40]);
    assert_eq!(chunk_cells([16, 16, 16], 0.2, [1280, 1280, 40]), [16, 16, 16]);
    assert_eq!(chunk_cells([8, 8, 8], 0.06, [1280, 1280, 80]), [13, 13, 13]);
}

#[test]
fn unfit_grids_are_refused() {
    let mut tall = VoxelGrid::free([1, 1, 513]);
    assert_eq!(fill(&mut tall, 0.1), Err(FillError::Layers { layers: 513 }));
    let mut torn = VoxelGrid { shape: [2, 2, 2], data: vec![0; 7] };
    assert!(matches!(fill(&mut torn, 0.1), Err(FillError::Shape { cells: 7, .. })));
    assert_eq!(fill(&mut VoxelGrid::default(), 0.1), Ok(()));
}

#[test]
fn a_filler_forgets_the_last_grid() {
    let mut first = VoxelGrid::free([40, 40, 40]);
    shell(&mut first, Tag::Car, 2, 30);
    let mut second = VoxelGrid::free([40, 40, 40]);
    shell(&mut second, Tag::Bus, 5, 25);
    let mut filler = Filler::default();
    let mut third = VoxelGrid::free([30, 50, 40]);
    shell(&mut third, Tag::Pole, 5, 14);
    for grid in [first, second, third] {
        let mut got = grid.clone();
        filler.fill(&mut got, 0.1).expect("a usual grid");
        assert_eq!(got, filled(&grid));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    /// Boxes of several classes in each other's way, and noise, over layers that need one, two and four words.
    #[test]
    fn equals_marching_rays(
        boxes in proptest::collection::vec((0..20_usize, 0..14_usize, 0..14_usize, 0..60_usize, 3..20_usize, 3..16_usize), 1..7),
        noise in proptest::collection::vec((0..20_usize, 0..20_usize, 0..70_usize, 0..32_u8), 0..30),
        layers in prop::sample::select(vec![24_usize, 64, 70, 130]),
        threads in 1..3_usize,
    ) {
        let shape = [20, 20, layers];
        let mut grid = VoxelGrid::free(shape);
        for (class, x, y, z, long, high) in boxes {
            let (top, far) = ((z + high).min(layers - 1), [(x + long).min(19), (y + 7).min(19)]);
            for i in x..=far[0] {
                for j in y..=far[1] {
                    for k in z.min(top)..=top {
                        if i == x || i == far[0] || j == y || j == far[1] || k == z || k == top {
                            let at = grid.index(i, j, k);
                            grid.data[at] = ORDER[class].0 as u8;
                        }
                    }
                }
            }
        }
        for (i, j, k, label) in noise {
            let at = grid.index(i, j, k.min(layers - 1));
            grid.data[at] = label;
        }
        let mut got = grid.clone();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| fill(&mut got, 0.1)).expect("a usual grid");
        prop_assert!(got == brute_force(&grid, 0.1));
    }
}
