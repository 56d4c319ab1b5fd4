//! Against marching rays cell by cell, and the rule's own consequences.

use std::collections::{BTreeMap, BTreeSet};

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

/// The paper's rule: march from every free cell in six directions, reading the grid as it was.
fn paper(grid: &VoxelGrid) -> VoxelGrid {
    let mut out = grid.clone();
    for cell in cells(grid).filter(|cell| grid.data[grid.index(cell[0], cell[1], cell[2])] == 0) {
        let march = |axis: usize, step: isize| {
            let mut at = cell;
            loop {
                at[axis] = at[axis].checked_add_signed(step).filter(|n| *n < grid.shape[axis])?;
                let label = grid.data[grid.index(at[0], at[1], at[2])];
                if label != 0 {
                    return Some(label);
                }
            }
        };
        let met: BTreeSet<Option<u8>> = (0..3).flat_map(|axis| [march(axis, -1), march(axis, 1)]).collect();
        if let (1, Some(Some(label))) = (met.len(), met.first()) {
            let at = out.index(cell[0], cell[1], cell[2]);
            out.data[at] = *label;
        }
    }
    out
}

/// Whatever is closed is full: from every free cell a walk that ends at the border, or a room.
fn solid(grid: &VoxelGrid) -> VoxelGrid {
    let mut out = grid.clone();
    let mut seen = BTreeSet::new();
    for start in cells(grid) {
        if grid.data[grid.index(start[0], start[1], start[2])] != 0 || seen.contains(&start) {
            continue;
        }
        let (mut room, mut todo, mut open) = (Vec::new(), vec![start], false);
        let mut faces: BTreeMap<u8, usize> = BTreeMap::new();
        seen.insert(start);
        while let Some(cell) = todo.pop() {
            room.push(cell);
            for axis in 0..3 {
                for step in [-1, 1] {
                    let mut next = cell;
                    let Some(n) = cell[axis].checked_add_signed(step).filter(|n| *n < grid.shape[axis])
                    else {
                        open = true;
                        continue;
                    };
                    next[axis] = n;
                    match grid.data[grid.index(next[0], next[1], next[2])] {
                        0 => todo.extend(seen.insert(next).then_some(next)),
                        label => *faces.entry(label).or_default() += 1,
                    }
                }
            }
        }
        let most = faces.iter().max_by(|a, b| a.1.cmp(b.1).then(b.0.cmp(a.0))).map(|(label, _)| *label);
        let label = most.filter(|most| !open && ORDER.iter().any(|(tag, _)| *tag as u8 == *most));
        for cell in label.iter().flat_map(|_| &room) {
            let at = out.index(cell[0], cell[1], cell[2]);
            out.data[at] = label.unwrap_or(0);
        }
    }
    out
}

fn cells(grid: &VoxelGrid) -> impl Iterator<Item = [usize; 3]> {
    let [nx, ny, nz] = grid.shape;
    (0..nx).flat_map(move |i| (0..ny).flat_map(move |j| (0..nz).map(move |k| [i, j, k])))
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
    fill(&mut out, 0.1, FillingRule::Chunk).expect("a usual grid");
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
fn each_rule_fills_what_it_says() {
    let counts = |grid: &VoxelGrid, rule| {
        let mut out = grid.clone();
        fill(&mut out, 0.1, rule).expect("a usual grid");
        let of = out.count();
        [Tag::Pedestrian, Tag::Wall].map(|tag| of[tag as usize])
    };
    // A shell of 20 cells: chunks of 8 leave a hole of 512 in the middle, the others none.
    let mut grid = VoxelGrid::free([40, 40, 40]);
    shell(&mut grid, Tag::Pedestrian, 3, 23);
    assert_eq!(counts(&grid, FillingRule::Paper), [8000, 0]);
    assert_eq!(counts(&grid, FillingRule::Solid), [8000, 0]);
    // A dent: a free cell whose way up leads out. For the paper it stays, and so does what lies below it
    // within the hole; open is open.
    let top = grid.index(10, 10, 22);
    grid.data[top] = 0;
    assert_eq!(counts(&grid, FillingRule::Paper), [8000 - 19, 0], "the column below the hole");
    assert_eq!(counts(&grid, FillingRule::Solid), [20 * 20 * 20 - 18 * 18 * 18 - 1, 0]);
    // Walls are filled by the paper alone.
    let mut walls = VoxelGrid::free([40, 40, 40]);
    shell(&mut walls, Tag::Wall, 0, 10);
    assert_eq!(counts(&walls, FillingRule::Paper), [0, 1000]);
    assert_eq!(counts(&walls, FillingRule::Solid), [0, 1000 - 512]);
    // An L-shaped room, round the corner of which no ray sees the same class all around.
    let mut nested = VoxelGrid::free([40, 40, 40]);
    shell(&mut nested, Tag::Pedestrian, 0, 20);
    shell(&mut nested, Tag::Wall, 5, 12);
    let [people, _] = counts(&nested, FillingRule::Solid);
    assert_eq!(people, 8000 - 343, "the room around the wall; the wall's own room has walls");
    assert!(counts(&nested, FillingRule::Paper)[0] < people);
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
    assert_eq!(fill(&mut tall, 0.1, FillingRule::Chunk), Err(FillError::Layers { layers: 513 }));
    let mut torn = VoxelGrid { shape: [2, 2, 2], data: vec![0; 7] };
    assert!(matches!(fill(&mut torn, 0.1, FillingRule::Chunk), Err(FillError::Shape { cells: 7, .. })));
    assert_eq!(fill(&mut VoxelGrid::default(), 0.1, FillingRule::Chunk), Ok(()));
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
        filler.fill(&mut got, 0.1, FillingRule::Chunk).expect("a usual grid");
        assert_eq!(got, filled(&grid));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    /// Boxes of several classes in each other's way, and noise, over layers that need one, two and four
    /// words.
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
        pool.install(|| fill(&mut got, 0.1, FillingRule::Chunk)).expect("a usual grid");
        prop_assert!(got == brute_force(&grid, 0.1));
        let with = |rule| {
            let mut got = grid.clone();
            pool.install(|| fill(&mut got, 0.1, rule)).expect("a usual grid");
            got
        };
        prop_assert!(with(FillingRule::Paper) == paper(&grid));
        prop_assert!(with(FillingRule::Solid) == solid(&grid));
    }
}
