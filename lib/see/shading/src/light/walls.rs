//! What houses around a place leave of the sky: streets and courtyards are darker at their feet, ground along
//! walls, facades where others face them.
//!
//! Houses are taken as columns: a map from above has their heights. On a grid of cells, at some heights over
//! the ground, the horizon that they make is followed all around; what is left of an even sky, for surfaces
//! that face up, north, west, south and east, is added up from it in closed form and kept. Places between
//! cells and heights are interpolated.

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use render::{RenderError, Scene, Stipple};
use schema::Tag;
use schema::geometry::TriMesh;
use simd::F32x8;

use super::lens::{Lens, depths};

/// Texels of the map a side of a cell.
const CELL: usize = 2;
/// Heights over the ground: the squares of whole numbers, metres, and a little more.
const LEVELS: usize = 8;
const LOWEST_M: f32 = 0.2;
/// In so many directions horizons are followed.
const AZIMUTHS: usize = 16;
/// Where the heights of houses are looked up, metres from a place.
const STEPS_M: [f32; 15] =
    [1.0, 2.0, 3.0, 4.2, 5.7, 7.5, 9.8, 12.7, 16.3, 20.8, 26.5, 34.0, 44.0, 58.0, 76.0];
/// Places are looked at from so far off their surface, metres: from before the wall.
const OFF_M: f32 = 1.0;
/// Towards the map's edge houses fade away over this distance, metres.
const FADE_M: f32 = 16.0;
/// Tags of the ground.
const GROUND: [Tag; 6] = [Tag::Road, Tag::RoadLine, Tag::Sidewalk, Tag::Ground, Tag::Terrain, Tag::Water];

/// Light of an even sky: the mean of what surfaces get that face sideways, how much more those to the east
/// and to the north, and what one gets that faces up. Without houses a half, nothing, nothing and one.
type Left = wide::f32x4;

/// How a surface is turned to what is left of the sky.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facing {
    weights: Left,
    /// Off the surface, metres.
    off_m: Vec3,
    is_roof: bool,
}

impl Facing {
    pub(crate) fn new(normal: Vec3) -> Self {
        let rise = normal.z * normal.z;
        // What faces down is lit by the ground, which has what faces up there.
        let (side, up) = (1.0 - rise, if normal.z > 0.0 { rise } else { 0.5 * rise });
        let all = 0.5 * side + up;
        let weights = Left::new([side / all, normal.x / all, normal.y / all, up / all]);
        Self { weights, off_m: normal * OFF_M, is_roof: normal.z > 0.3 }
    }
}

/// What houses leave of the sky, cell by cell.
#[derive(Clone, Debug)]
pub(super) struct Walls {
    /// Where its middle is in the world.
    pub(super) centre_m: DVec3,
    /// Cells a side, from the south-west; none without houses.
    pub(super) side: usize,
    pub(super) cell_m: f32,
    /// Height of the ground over the middle, by cell.
    ground_m: Vec<f32>,
    /// By cell and height.
    left: Vec<Left>,
}

/// Whether some of a mesh is ground.
pub(super) fn is_ground(mesh: &TriMesh) -> bool {
    mesh.parts.iter().any(|part| GROUND.contains(&part.tag))
}

impl Walls {
    /// Of the houses that a lens sees from above, whole.
    ///
    /// # Errors
    /// The renderer failed.
    pub(super) fn new(scene: &dyn Scene, lens: &Lens) -> Result<Self, RenderError> {
        let snapshot = scene.snapshot();
        let is_house = |mesh: &TriMesh| mesh.parts.iter().any(|part| part.tag == Tag::Building);
        let of = |wanted: &dyn Fn(&TriMesh) -> bool| -> Vec<u32> {
            let instances = (0..).zip(&snapshot.instances);
            instances.filter(|(_, i)| wanted(snapshot.mesh(i))).map(|(number, _)| number).collect()
        };
        let houses = of(&is_house);
        if houses.is_empty() {
            let nothing = (Vec::new(), Vec::new());
            let (ground_m, left) = nothing;
            return Ok(Self { centre_m: lens.centre_m, side: 0, cell_m: 1.0, ground_m, left });
        }
        let camera = lens.camera(&snapshot.origin, lens.whole());
        let up_m = camera.local_from_optical.translation.z
            - snapshot.origin.local_from_world(lens.centre_m.to_array()).z;
        // From the south-west, row by row.
        let side = lens.side as usize;
        let ground = of(&|mesh| is_ground(mesh) && !is_house(mesh));
        let asked = [&houses, &ground].map(|among| (&camera, Some(&among[..]), Stipple::OPAQUE));
        let heights = |depth_m: &Vec<f32>| -> Vec<f32> {
            let rows = depth_m.chunks_exact(side).rev();
            rows.flatten().map(|depth_m| up_m - depth_m).collect()
        };
        let mut heights_m = depths(scene, asked)?.iter().map(heights).collect::<Vec<_>>().into_iter();
        let [houses_m, ground_m] = std::array::from_fn(|_| heights_m.next().unwrap_or_default());
        Ok(Self::over(lens.centre_m, lens.texel_m, side, &houses_m, &ground_m))
    }

    /// The share of the sky's light that reaches a place of a surface, of what would without houses: from the
    /// south-west corner, and over the middle.
    #[inline]
    pub(super) fn open(&self, from_corner: Vec3, facing: &Facing) -> f32 {
        if self.side == 0 {
            return 1.0;
        }
        let p = from_corner + facing.off_m;
        let (x, y) = (p.x / self.cell_m - 0.5, p.y / self.cell_m - 0.5);
        let last = (self.side - 1) as f32;
        let edge = x.min(y).min(last - x).min(last - y) * self.cell_m;
        if edge.is_nan() || edge <= 0.0 {
            return 1.0;
        }
        let (x0, y0) = (x as usize, y as usize);
        let first = (y0.min(self.side - 2)) * self.side + x0.min(self.side - 2);
        let over_m = (from_corner.z - self.ground_m[first] - LOWEST_M).max(0.0);
        let level = over_m.sqrt().min((LEVELS - 1) as f32);
        // From a roof one looks from above it.
        let level = if facing.is_roof && over_m > 2.0 { level.ceil() } else { level };
        let below = (level as usize).min(LEVELS - 2);
        let (fx, fy, fz) = (x - x0 as f32, y - y0 as f32, level - below as f32);
        let at = |cell: usize| {
            let column = &self.left[cell * LEVELS + below..];
            column[0] + (column[1] - column[0]) * fz
        };
        let south = at(first) + (at(first + 1) - at(first)) * fx;
        let north = at(first + self.side) + (at(first + self.side + 1) - at(first + self.side)) * fx;
        let left = (south + (north - south) * fy) * facing.weights;
        let open = left.reduce_add().clamp(0.0, 1.0);
        1.0 - (1.0 - open) * (edge / FADE_M).min(1.0)
    }

    /// Of heights of houses and ground over the middle, by texel from the south-west; negative endless where
    /// there is none.
    fn over(centre_m: DVec3, texel_m: f32, texels: usize, houses_m: &[f32], ground_m: &[f32]) -> Self {
        let side = texels / CELL;
        // Where no ground is known it is as high as the middle.
        let ground_at = |cell: usize| {
            let (x, y) = (cell % side * CELL + CELL / 2, cell / side * CELL + CELL / 2);
            let height = ground_m[y * texels + x];
            if height.is_finite() { height } else { 0.0 }
        };
        let ground: Vec<f32> = (0..side * side).map(ground_at).collect();
        let around = Around::new();
        let cells: Vec<([Left; LEVELS], u32)> = (0..side * side)
            .into_par_iter()
            .with_min_len(side)
            .map(|cell| {
                let middle = |at: usize| (at * CELL) as f32 + 0.5 * CELL as f32;
                let place = [middle(cell % side), middle(cell / side)];
                let levels = F32x8::from(std::array::from_fn(|l| (l * l) as f32 + LOWEST_M + ground[cell]));
                around.left(
                    place,
                    levels,
                    |x, y| {
                        let inside = x >= 0.0 && y >= 0.0 && x < texels as f32 && y < texels as f32;
                        if inside { houses_m[y as usize * texels + x as usize] } else { f32::NEG_INFINITY }
                    },
                    texel_m,
                )
            })
            .collect();
        let left = outside(side, &cells);
        Self { centre_m, side, cell_m: texel_m * CELL as f32, ground_m: ground, left }
    }
}

/// Cells with those heights that are within houses filled from what is beside them, as seen from their
/// walls; deep inside from above.
fn outside(side: usize, cells: &[([Left; LEVELS], u32)]) -> Vec<Left> {
    let mut left: Vec<Left> = cells.iter().flat_map(|(left, _)| *left).collect();
    let mut within: Vec<u32> = cells.iter().map(|(_, within)| *within).collect();
    for _ in 0..2 {
        let before = (left.clone(), within.clone());
        for (cell, bits) in before.1.iter().enumerate().filter(|(_, bits)| **bits != 0) {
            let (x, y) = (cell % side, cell / side);
            for level in (0..LEVELS).filter(|level| bits >> level & 1 != 0) {
                let (mut sum, mut count) = (Left::ZERO, 0.0);
                for row in y.saturating_sub(1)..(y + 2).min(side) {
                    for column in x.saturating_sub(1)..(x + 2).min(side) {
                        let other = row * side + column;
                        if before.1[other] >> level & 1 == 0 {
                            sum += before.0[other * LEVELS + level];
                            count += 1.0;
                        }
                    }
                }
                if count > 0.0 {
                    left[cell * LEVELS + level] = sum * (1.0 / count);
                    within[cell] &= !(1 << level);
                }
            }
        }
    }
    for (cell, bits) in within.iter().enumerate().filter(|(_, bits)| **bits != 0) {
        for level in (0..LEVELS - 1).rev().filter(|level| bits >> level & 1 != 0) {
            left[cell * LEVELS + level] = left[cell * LEVELS + level + 1];
        }
    }
    left
}

/// Directions all around, none along an axis: there a wall would count whole or not at all.
struct Around {
    /// Cosine and sine.
    ways: [[f32; 2]; AZIMUTHS],
    /// Makes the sums over directions those over all.
    per_side: f32,
}

impl Around {
    fn new() -> Self {
        let step = std::f32::consts::TAU / AZIMUTHS as f32;
        let ways = std::array::from_fn(|i| {
            let (sin, cos) = frames::math::f32::sin_cos(step * (i as f32 + 0.5));
            [cos, sin]
        });
        let ahead: f32 = ways.iter().map(|[cos, _]| cos.max(0.0)).sum();
        // A surface that faces sideways gets a half; see `side`.
        Self { ways, per_side: 0.5 / (ahead * std::f32::consts::FRAC_PI_4) }
    }

    /// What columns whose heights are looked up by column and row (texels) leave of the sky at a place at
    /// some heights, and which of these are within a column: bits by height.
    fn left(
        &self,
        [x, y]: [f32; 2],
        levels: F32x8,
        column_m: impl Fn(f32, f32) -> f32,
        texel_m: f32,
    ) -> ([Left; LEVELS], u32) {
        let within = (levels + 0.5).simd_lt(column_m(x, y)).to_bitmask();
        let [mut east, mut north, mut west, mut south, mut up] = [F32x8::ZERO; 5];
        for [cos, sin] in self.ways {
            let mut slope = F32x8::ZERO;
            for away_m in STEPS_M {
                let away = away_m / texel_m;
                let height = column_m(x + cos * away, y + sin * away);
                if height > f32::NEG_INFINITY {
                    slope = slope.fast_max((F32x8::splat(height) - levels) * (1.0 / away_m));
                }
            }
            let horizon = slope / (slope * slope + 1.0).sqrt();
            up += 1.0 - horizon * horizon;
            let side = side(horizon) * self.per_side;
            east += side * cos.max(0.0);
            west += side * (-cos).max(0.0);
            north += side * sin.max(0.0);
            south += side * (-sin).max(0.0);
        }
        let mean = (east + north + west + south) * 0.25;
        let (more_east, more_north) = ((east - west) * 0.5, (north - south) * 0.5);
        let up = up * (1.0 / AZIMUTHS as f32);
        let [a, b, c, d] = [mean, more_east, more_north, up].map(F32x8::to_array);
        (std::array::from_fn(|l| Left::new([a[l], b[l], c[l], d[l]])), within)
    }
}

/// What a surface that faces a direction gets of the sky over a horizon there, by the horizon's sine: half of
/// `pi / 2 - h - sin h cos h`.
#[inline]
fn side(horizon: F32x8) -> F32x8 {
    // Arc cosine: Abramowitz and Stegun, 4.4.45, within 7e-5.
    let x = horizon;
    let series = ((x * -0.018_729_3 + 0.074_261) * x - 0.212_114_4) * x + 1.570_728_8;
    let acos = (1.0 - x).fast_max(F32x8::ZERO).sqrt() * series;
    let cos = (1.0 - x * x).fast_max(F32x8::ZERO).sqrt();
    ((acos - x * cos) * 0.5).fast_max(F32x8::ZERO)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXELS: usize = 200;

    /// Walls over a height field of metres, the place that is asked for at its middle.
    fn sky_visibility(houses_m: impl Fn(f32, f32) -> f32) -> Walls {
        let middle = |at: usize| at as f32 + 0.5 - 0.5 * TEXELS as f32;
        let houses: Vec<f32> =
            (0..TEXELS * TEXELS).map(|i| houses_m(middle(i % TEXELS), middle(i / TEXELS))).collect();
        Walls::over(DVec3::ZERO, 1.0, TEXELS, &houses, &[0.0; TEXELS * TEXELS])
    }

    /// The same by many rays through the height field, over what is left without houses.
    fn by_rays(houses_m: impl Fn(f32, f32) -> f32, place: Vec3, normal: Vec3) -> f32 {
        let (mut got, mut most) = (0.0, 0.0);
        for i in 0..4000 {
            let z = (i as f32 + 0.5) / 4000.0;
            let (sin, cos) = frames::math::f32::sin_cos(2.399_963 * i as f32);
            let level = (1.0 - z * z).sqrt();
            let to = Vec3::new(level * cos, level * sin, z);
            let weight = normal.dot(to).max(0.0);
            most += weight;
            let free = (1..900).all(|step| {
                let p = place + normal * 0.05 + to * (0.1 * step as f32 / level.max(0.05));
                houses_m(p.x, p.y) < p.z
            });
            got += if free { weight } else { 0.0 };
        }
        got / most
    }

    #[test]
    fn it_is_closed_forms_and_rays() {
        let none = sky_visibility(|_, _| f32::NEG_INFINITY);
        let open = |walls: &Walls, place: Vec3, normal: Vec3| {
            let half_m = 0.5 * TEXELS as f32;
            walls.open(place + Vec3::new(half_m, half_m, 0.0), &Facing::new(normal))
        };
        for normal in [Vec3::Z, Vec3::X, -Vec3::Y, Vec3::new(0.6, 0.0, 0.8), -Vec3::Z] {
            assert!((open(&none, Vec3::new(3.0, 7.0, 0.0), normal) - 1.0).abs() < 1e-4, "{normal}");
        }
        // Beside a wall without end half of the sky is left.
        let endless = sky_visibility(|x, _| if x < 0.0 { 1e4 } else { f32::NEG_INFINITY });
        for x in [3.0, 12.0] {
            let half = open(&endless, Vec3::new(x, 0.0, 0.0), Vec3::Z);
            assert!((half - 0.5).abs() < 0.05, "{x}: {half}");
        }
        let before = open(&endless, Vec3::ZERO, Vec3::X);
        assert!(before > 0.9, "{before}");
        // A street and a courtyard, on the ground and up the walls.
        let street = |x: f32, _: f32| if x.abs() > 6.0 { 12.0 } else { f32::NEG_INFINITY };
        let court = |x: f32, y: f32| {
            let is_house = x.abs().max(y.abs()) > 8.0 && x.abs().max(y.abs()) < 20.0;
            if is_house { 15.0 } else { f32::NEG_INFINITY }
        };
        let corner = |x: f32, y: f32| if x > 4.0 && y > 4.0 { 9.0 } else { f32::NEG_INFINITY };
        let fields: [&dyn Fn(f32, f32) -> f32; 3] = [&street, &court, &corner];
        for (number, field) in fields.into_iter().enumerate() {
            let walls = sky_visibility(field);
            let mut places: Vec<(Vec3, Vec3)> =
                [-3.0, 0.0, 3.0].map(|x| (Vec3::new(x, 0.5, 0.0), Vec3::Z)).to_vec();
            let wall = [6.0, 8.0, 4.0][number];
            places.extend(
                [0.5, 3.0, 7.0].map(|z| (Vec3::new(wall, if number == 2 { 9.0 } else { 0.0 }, z), -Vec3::X)),
            );
            for (place, normal) in places {
                let (got, want) = (open(&walls, place, normal), by_rays(field, place, normal));
                assert!((got - want).abs() < 0.1, "{number} {place} {normal}: {got} {want}");
            }
        }
        // On a roof nothing is in the way.
        let roof = open(&sky_visibility(street), Vec3::new(12.0, 0.0, 12.0), Vec3::Z);
        assert!(roof > 0.97, "{roof}");
    }
}
