//! The skin of a [`Hull`] as a mesh: a loft from tail to nose whose ends are grids, with wheel houses cut out
//! below.

use crate::solids::{Detail, MeshBuilder};
use frames::math::f32::sin_cos;
use glam::Vec3;
use schema::geometry::MeshPart;

use crate::actors::hull::{Hull, Section};

/// Where a patch of the skin is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Place {
    /// Below, in the wheel houses too.
    Under,
    /// On a side, at a row.
    Side(f32),
    /// On bonnet, windscreen, roof, rear window or boot, so far aside.
    Top(f32),
    /// On the nose, at a row.
    Nose(f32),
    /// On the tail.
    Tail(f32),
}

/// How finely a skin is cut.
pub(crate) struct Grid {
    /// Places along it, from the tail to the nose.
    stations: Vec<f32>,
    rows: &'static [f32],
    /// Places across the top from left to right, the edges too.
    columns: &'static [f32],
}

impl Grid {
    /// Stations at the given places, at arches and where the hull bends; `cuts` have thin lines around them.
    pub(crate) fn new(hull: &Hull, detail: Detail, places: &[f32], cuts: &[f32]) -> Self {
        let style = &hull.style;
        let ((roof0, roof1), (cowl, _), (deck, _)) = (style.roof, style.cowl, style.deck);
        let mut f = vec![0.0, cowl, roof0, roof1, deck, 1.0];
        f.extend_from_slice(places);
        let even = |f: &mut Vec<f32>, a: f32, b: f32, n: usize| {
            f.extend((1..n).map(|i| a + (b - a) * i as f32 / n as f32));
        };
        let (arch, rows, columns): (&[f32], &'static [f32], &'static [f32]) = match detail {
            Detail::Full => {
                f.extend([0.01, 0.03, 0.06, 0.09, 0.91, 0.94, 0.97, 0.99]);
                even(&mut f, 0.09, cowl, 3);
                even(&mut f, cowl, roof0, 3);
                even(&mut f, roof0, roof1, 5);
                even(&mut f, roof1, deck, 3);
                for cut in cuts {
                    f.extend([cut - hull.share(LINE_M), cut + hull.share(LINE_M)]);
                }
                (
                    &[-1.006, -1.0, -0.93, -0.73, -0.42, 0.0, 0.42, 0.73, 0.93, 1.0, 1.006],
                    &[-0.01, 0.0, 0.13, 0.32, 0.58, 0.82, 1.0, 1.06, 1.5, 1.9, 2.0],
                    &[1.0, 0.93, 0.75, 0.42, 0.0, -0.42, -0.75, -0.93, -1.0],
                )
            }
            Detail::Half => {
                f.extend([0.05, 0.95]);
                even(&mut f, roof0, roof1, 2);
                (
                    &[-1.006, -1.0, -0.6, 0.6, 1.0, 1.006],
                    &[-0.01, 0.13, 0.62, 1.0, 1.9, 2.0],
                    &[1.0, 0.9, 0.0, -0.9, -1.0],
                )
            }
            Detail::Coarse => {
                (&[-1.006, -1.0, -0.55, 0.55, 1.0, 1.006], &[-0.01, 0.62, 1.0, 2.0], &[1.0, -1.0])
            }
        };
        for axle in &hull.axles {
            f.extend(arch.iter().map(|share| hull.f_of(axle - share * hull.arch)));
        }
        f.retain(|f| (0.0..=1.0).contains(f));
        f.sort_by(f32::total_cmp);
        let least = hull.share(0.001);
        f.dedup_by(|a, b| *a - *b < least);
        f.reverse();
        Self { stations: f, rows, columns }
    }
}

/// Half the width of the gap between two panels, metres.
pub(crate) const LINE_M: f32 = 0.005;

/// Adds a skin; `part` says what is where, at a place along it.
pub(crate) fn skin(b: &mut MeshBuilder, hull: &Hull, grid: &Grid, part: &dyn Fn(f32, Place) -> MeshPart) {
    let (rows, columns) = (grid.rows, grid.columns);
    let (r, c) = (rows.len() - 1, columns.len() - 1);
    let sections: Vec<Section> = grid.stations.iter().map(|f| hull.section(*f)).collect();
    // Each ring goes up the left side, across the top, and down the right side.
    let rings: Vec<Vec<u32>> = sections
        .iter()
        .map(|at| {
            let left = rows.iter().map(|row| hull.side(at, *row, true));
            let top = columns[1..c].iter().map(|s| hull.top(at, *s));
            let right = rows.iter().rev().map(|row| hull.side(at, *row, false));
            left.chain(top).chain(right).map(|p| b.vertex(p)).collect()
        })
        .collect();
    let n = 2 * (r + 1) + c - 1;
    let middle = |values: &[f32], i: usize| 0.5 * (values[i] + values[i + 1]);
    for (k, pair) in rings.windows(2).enumerate() {
        let f = middle(&grid.stations, k);
        for j in 0..n {
            let place = match j {
                _ if j < r => Place::Side(middle(rows, j)),
                _ if j < r + c => Place::Top(middle(columns, j - r)),
                _ if j < 2 * r + c => Place::Side(middle(rows, 2 * r + c - 1 - j)),
                _ => Place::Under,
            };
            let part = b.part_index(part(f, place));
            let next = (j + 1) % n;
            b.quad(part, [pair[0][j], pair[0][next], pair[1][next], pair[1][j]]);
        }
    }
    for (ring, nose) in [(rings.last(), true), (rings.first(), false)] {
        let (Some(ring), f) = (ring, if nose { 0.0 } else { 1.0 }) else { continue };
        let place = |row: f32| part(f, if nose { Place::Nose(row) } else { Place::Tail(row) });
        end(b, hull, grid, ring, nose, &place);
    }
}

/// Closes an end with a grid of the ring's rows and columns.
fn end(
    b: &mut MeshBuilder,
    hull: &Hull,
    grid: &Grid,
    ring: &[u32],
    nose: bool,
    part: &dyn Fn(f32) -> MeshPart,
) {
    let (rows, columns) = (grid.rows, grid.columns);
    let (r, c) = (rows.len() - 1, columns.len() - 1);
    let at = hull.section(if nose { 0.0 } else { 1.0 });
    let crown = hull.top(&at, 0.0).z - hull.top(&at, 1.0).z;
    let line = |b: &mut MeshBuilder, i: usize| -> Vec<u32> {
        if i == r {
            return ring[r..=r + c].to_vec();
        }
        let edge = hull.side(&at, rows[i], true);
        let mut ids = vec![ring[i]];
        ids.extend(columns[1..c].iter().map(|s| {
            let z = edge.z + crown * (rows[i] - 1.0).max(0.0) * (1.0 - s * s);
            let point = hull.end(nose, *s, z);
            b.vertex(Vec3::new(point.x, s * edge.y, z))
        }));
        ids.push(ring[2 * r + c - i]);
        ids
    };
    let triangle = |b: &mut MeshBuilder, part: u8, [x, y, z]: [u32; 3]| {
        b.triangle(part, if nose { [x, y, z] } else { [x, z, y] });
    };
    let mut lower = line(b, 1);
    // Below the first row lies the straight edge of the underside.
    let (left, right) = (ring[0], ring[2 * r + c]);
    let below = b.part_index(part(0.5 * (rows[0] + rows[1])));
    for j in 0..c {
        let foot = if 2 * j < c { left } else { right };
        triangle(b, below, [foot, lower[j], lower[j + 1]]);
    }
    triangle(b, below, [left, lower[c.div_ceil(2)], right]);
    for i in 1..r {
        let upper = line(b, i + 1);
        let part = b.part_index(part(0.5 * (rows[i] + rows[i + 1])));
        for j in 0..c {
            triangle(b, part, [lower[j], upper[j], upper[j + 1]]);
            triangle(b, part, [lower[j], upper[j + 1], lower[j + 1]]);
        }
        lower = upper;
    }
}

/// The wall between the left and the right wheel house of each axle: at `inner_y`, metres aside.
pub(crate) fn wheel_houses(b: &mut MeshBuilder, hull: &Hull, under: MeshPart, inner_y: &[f32]) {
    let low = hull.style.clearance * hull.height;
    for (axle, half_y) in hull.axles.iter().zip(inner_y) {
        let reach = 1.02 * hull.arch;
        let mut outline = vec![(-reach, low + 0.01), (reach, low + 0.01)];
        outline.extend((0..=6).map(|i| {
            let (s, c) = sin_cos(std::f32::consts::PI * i as f32 / 6.0);
            (reach * c, hull.radius + reach * s)
        }));
        // Seen from the left x runs to the left: backwards it is counter-clockwise.
        let ring = |y: f32| outline.iter().rev().map(|(x, z)| Vec3::new(axle + x, y, *z)).collect();
        b.loft(&[ring(-half_y), ring(*half_y)], |_, _| under, [under; 2]);
    }
}
