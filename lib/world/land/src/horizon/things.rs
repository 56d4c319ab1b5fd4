//! What lies and stands on the plots of the horizon.

use glam::Vec3;
use random::Stream;
use schema::Tag;
use schema::geometry::{MeshPart, Surface, Wall};

use super::plot::{PLOT_M, STREET_M, Use};
use super::shape::Shape;
use crate::surfaces::GRASS;

/// Colours of fields, linear RGB, and how common each is: grass, corn, stubble, soil, rape, beet.
const FIELDS: [([f32; 3], f64); 6] = [
    ([0.11, 0.18, 0.05], 0.30),
    ([0.24, 0.21, 0.08], 0.24),
    ([0.27, 0.23, 0.12], 0.12),
    ([0.15, 0.105, 0.07], 0.14),
    ([0.33, 0.31, 0.05], 0.06),
    ([0.07, 0.14, 0.04], 0.14),
];
/// The same in winter: soil, winter corn, dull grass.
const WINTER_FIELDS: [([f32; 3], f64); 3] =
    [([0.14, 0.10, 0.07], 0.5), ([0.10, 0.15, 0.05], 0.2), ([0.15, 0.15, 0.07], 0.3)];
const MEADOW: [f32; 3] = [0.12, 0.18, 0.055];
/// Between houses.
const YARD: [f32; 3] = [0.13, 0.15, 0.09];
const LEAVES: [[f32; 3]; 3] = [[0.045, 0.085, 0.025], [0.06, 0.105, 0.03], [0.04, 0.07, 0.03]];
const TWIGS: [[f32; 3]; 3] = [[0.11, 0.09, 0.075], [0.13, 0.105, 0.085], [0.05, 0.07, 0.035]];
const WALLS: [[f32; 3]; 5] =
    [[0.62, 0.58, 0.50], [0.55, 0.45, 0.34], [0.34, 0.16, 0.11], [0.66, 0.65, 0.62], [0.48, 0.46, 0.44]];
const TILES: [[f32; 3]; 3] = [[0.28, 0.09, 0.05], [0.20, 0.08, 0.06], [0.12, 0.12, 0.125]];
/// Crowns of a wood stand about so far apart, metres.
const CROWN_M: f64 = 8.0;
const CROWNS: usize = (PLOT_M / CROWN_M) as usize;

fn grass(rgb: [f32; 3]) -> MeshPart {
    MeshPart { rgb, ..GRASS }
}

/// The ground of a plot: two by two squares, whose corners `at` has.
pub(super) fn add_ground(
    shape: &mut Shape,
    used_for: Use,
    is_winter: bool,
    draw: &mut Stream,
    at: impl Fn(f64, f64) -> Vec3,
) {
    let fields: &[_] = if is_winter { &WINTER_FIELDS } else { &FIELDS };
    let mut field = || grass(draw.choose_common(fields).unwrap_or(MEADOW));
    // Fields are as wide as a plot or half of it.
    let (first, second) = (field(), field());
    let (is_one, is_across) = (draw.chance(0.45), draw.chance(0.5));
    let part = |i: usize, j: usize| match used_for {
        Use::Field => {
            if is_one || (if is_across { i } else { j }) == 0 {
                first
            } else {
                second
            }
        }
        Use::Meadow => grass(MEADOW),
        Use::Wood => grass(LEAVES[2]),
        Use::Town | Use::Village => grass(YARD),
    };
    for (i, j) in [(0, 0), (1, 0), (1, 1), (0, 1)] {
        let (x, y) = (i as f64, j as f64);
        shape.face(part(i, j), &[at(x, y), at(x + 1.0, y), at(x + 1.0, y + 1.0), at(x, y + 1.0)]);
    }
}

/// What stands on a plot. `at` has the ground at a place of it, and how far off roads that is.
pub(super) fn add(
    shape: &mut Shape,
    used_for: Use,
    is_winter: bool,
    draw: &mut Stream,
    at: impl Fn(f64, f64) -> (Vec3, f64),
) {
    let crowns = if is_winter { TWIGS } else { LEAVES };
    let leaves = crowns.map(|rgb| MeshPart::new(Tag::Vegetation, Surface::Foliage, rgb));
    match used_for {
        Use::Wood => add_wood(shape, &leaves, draw, &at),
        Use::Field => add_trees(shape, &leaves, draw, &at, 3),
        Use::Meadow => add_trees(shape, &leaves, draw, &at, 5),
        Use::Village => {
            add_village(shape, draw, &at);
            add_trees(shape, &leaves, draw, &at, 6);
        }
        Use::Town => {
            add_blocks(shape, draw, &at);
            add_trees(shape, &leaves, draw, &at, 6);
        }
    }
}

/// Some trees, few of them by chance.
fn add_trees(
    shape: &mut Shape,
    leaves: &[MeshPart; 3],
    draw: &mut Stream,
    at: &impl Fn(f64, f64) -> (Vec3, f64),
    most: i64,
) {
    for _ in 0..draw.int_inclusive(0, most) {
        let (foot, away_m) = at(draw.uniform(0.0, PLOT_M), draw.uniform(0.0, PLOT_M));
        let (radius_m, height_m) = (draw.uniform(2.5, 5.0) as f32, draw.uniform(6.0, 14.0) as f32);
        let part = leaves[draw.int_inclusive(0, 2) as usize];
        if away_m > STREET_M {
            shape.tree(part, foot, radius_m, height_m);
        }
    }
}

/// A canopy: crowns up and down, and its sides.
fn add_wood(
    shape: &mut Shape,
    leaves: &[MeshPart; 3],
    draw: &mut Stream,
    at: &impl Fn(f64, f64) -> (Vec3, f64),
) {
    const SIDE: usize = CROWNS + 1;
    let mut feet = [[Vec3::ZERO; SIDE]; SIDE];
    let mut tops = feet;
    for j in 0..SIDE {
        for i in 0..SIDE {
            let is_edge = [i, j].iter().any(|k| *k == 0 || *k == CROWNS);
            let aside = |draw: &mut Stream| if is_edge { 0.0 } else { draw.uniform(-2.5, 2.5) };
            let (x, y) = (i as f64 * CROWN_M + aside(draw), j as f64 * CROWN_M + aside(draw));
            feet[j][i] = at(x, y).0;
            // Crowns and what is between them.
            let high_m = if (i + j) % 2 == 0 { draw.uniform(11.0, 17.0) } else { draw.uniform(8.0, 13.0) };
            tops[j][i] = feet[j][i] + Vec3::Z * high_m as f32;
        }
    }
    for j in 0..CROWNS {
        for i in 0..CROWNS {
            let [a, b, c, d] = [tops[j][i], tops[j][i + 1], tops[j + 1][i + 1], tops[j + 1][i]];
            let part = leaves[draw.int_inclusive(0, 2) as usize];
            shape.face(part, &[a, b, c]);
            shape.face(part, &[a, c, d]);
        }
    }
    for k in 0..CROWNS {
        let sides = [
            [(k, 0), (k + 1, 0)],
            [(CROWNS, k), (CROWNS, k + 1)],
            [(k + 1, CROWNS), (k, CROWNS)],
            [(0, k + 1), (0, k)],
        ];
        for [(i, j), (m, n)] in sides {
            let part = leaves[draw.int_inclusive(0, 2) as usize];
            shape.face(part, &[feet[j][i], feet[n][m], tops[n][m], tops[j][i]]);
        }
    }
}

/// A way along a house, by chance.
fn along(draw: &mut Stream) -> Vec3 {
    let (s, c) = frames::math::sin_cos(draw.uniform(0.0, std::f64::consts::PI));
    Vec3::new(c as f32, s as f32, 0.0)
}

/// Houses with roofs of tiles; in one of four villages a church.
fn add_village(shape: &mut Shape, draw: &mut Stream, at: &impl Fn(f64, f64) -> (Vec3, f64)) {
    let along = along(draw);
    for i in 0..3 {
        for j in 0..3 {
            let place =
                |k: i32, draw: &mut Stream| (f64::from(k) + 0.5) * PLOT_M / 3.0 + draw.uniform(-4.0, 4.0);
            let (foot, away_m) = at(place(i, draw), place(j, draw));
            let half_m = [draw.uniform(4.5, 8.0) as f32, draw.uniform(3.5, 5.0) as f32];
            let parts = house_parts(draw);
            let eaves_m = draw.uniform(3.0, 6.0) as f32;
            if away_m > STREET_M && draw.chance(0.75) {
                shape.house(parts, foot, (half_m, along), [eaves_m, 0.8 * half_m[1]]);
            }
        }
    }
    if draw.chance(0.25) {
        let (foot, _) = at(0.5 * PLOT_M, 0.5 * PLOT_M);
        let [wall, roof] = house_parts(draw);
        shape.house([wall, roof], foot, ([12.0, 5.5], along), [9.0, 7.0]);
        let tower = foot + along * 13.0;
        shape.house([wall, roof], tower, ([2.8, 2.8], along), [22.0, 0.0]);
        shape.spire(roof, tower + Vec3::Z * 22.0, 3.1, 10.0);
    }
}

fn house_parts(draw: &mut Stream) -> [MeshPart; 2] {
    let [wall, roof] =
        [(&WALLS[..], 4), (&TILES[..], 2)].map(|(all, last)| all[draw.int_inclusive(0, last) as usize]);
    [
        MeshPart::new(Tag::Building, Surface::Facade(Wall::Plaster), wall),
        MeshPart::new(Tag::Building, Surface::RoofTiles, roof),
    ]
}

/// Blocks of a town between its streets.
fn add_blocks(shape: &mut Shape, draw: &mut Stream, at: &impl Fn(f64, f64) -> (Vec3, f64)) {
    let roof = MeshPart::new(Tag::Building, Surface::Gravel, [0.16; 3]);
    for i in 0..2 {
        for j in 0..2 {
            let middle = |k: i32| (f64::from(k) + 0.5) * 0.5 * PLOT_M;
            let (foot, away_m) = at(middle(i), middle(j));
            let half_m = [draw.uniform(8.0, 14.0) as f32, draw.uniform(6.0, 10.0) as f32];
            let storeys = if draw.chance(0.12) { draw.uniform(8.0, 16.0) } else { draw.uniform(2.0, 6.0) };
            let ([wall, tiles], is_pitched) = (house_parts(draw), draw.chance(0.4));
            let along = if draw.chance(0.5) { Vec3::X } else { Vec3::Y };
            if away_m < STREET_M {
                continue;
            }
            let high_m = 3.1 * storeys as f32;
            if is_pitched && storeys < 6.0 {
                shape.house([wall, tiles], foot, (half_m, along), [high_m, 0.6 * half_m[1]]);
            } else {
                shape.house([wall, roof], foot, (half_m, along), [high_m, 0.0]);
            }
        }
    }
}
