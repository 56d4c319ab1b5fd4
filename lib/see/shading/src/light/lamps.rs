//! Light of lamps: street lamps, headlights, and the glow of other lamps.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::Vec3;
use render::{RenderError, Scene};
use schema::geometry::{Snapshot, Surface, TriMesh};
use schema::{ObjectId, lights};
use simd::{F32x8, LANES, U32x8, Vec3x8, floor_words};

use super::lamp_depths::{LampDepths, LampEye, LampView};
use super::math::luminance;
use super::{headlight, street};
use crate::retro;

/// Areas around an agent in which lamps give light, by the width of their cells, metres: a fine one near by,
/// a coarse one around it.
const CELLS_M: [f32; 2] = [8.0, 32.0];
/// Cells a side of each.
const CELLS: usize = 24;
/// Half width of the fine area, and of the coarse one.
const NEAR_M: f32 = 0.5 * CELLS as f32 * CELLS_M[0];
const AREA_M: f32 = 0.5 * CELLS as f32 * CELLS_M[1];
/// From a cell's middle to its corners, and a little, in widths.
const TO_CORNERS: f32 = 0.71;
/// Most lamps that light a cell: the strongest there.
const PER_CELL: usize = 16;

/// No lamp is followed farther, metres.
const REACH_M: f32 = if headlight::REACH_M > street::REACH_M { headlight::REACH_M } else { street::REACH_M };

/// Film is not made for brighter spots than this, kilolux.
const SPOT_KLX: f32 = 0.05;

/// A floodlight's flux over its shape, the cosine squared: candela ahead by lumen. It looks ahead and
/// somewhat down.
const FLOOD_CD_PER_LM: f32 = 3.0 / std::f32::consts::TAU;
const FLOOD_AIM: [f32; 2] = [0.955, 0.297];
/// So many vehicles around an agent have headlights that things stand in the way of, and so many street lamps
/// are like that.
const MOST_SHADED: usize = 8;

/// How a lamp spreads its light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Beam {
    /// Downwards, widely.
    Street,
    /// Ahead, widely: a floodlight.
    Flood,
    /// Ahead and on the road: dipped.
    Low,
    /// Far ahead.
    High,
    /// Everywhere.
    Glow,
}

impl Beam {
    fn is_headlight(self) -> bool {
        matches!(self, Self::Low | Self::High)
    }
}

/// One lamp that burns.
#[derive(Clone, Debug)]
pub(super) struct Lamp {
    object: ObjectId,
    pub(super) position: Vec3,
    /// Where it points, and what is up for it.
    pub(super) direction: Vec3,
    up: Vec3,
    pub(super) beam: Beam,
    /// Of headlights their colour, the greatest component 1; of others kilocandela (kilolux at a metre) where
    /// their beam's shape is 1.
    pub(super) rgb: Vec3,
    radius_m: f32,
    /// Which of an object's lamps it is.
    pub(super) bits: u32,
    /// The obstacles that block its light.
    seen: Option<Arc<LampDepths>>,
}

/// The lamps around an agent, by the place they light.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lamps {
    pub(super) lamps: Vec<Lamp>,
    areas: [Area; 2],
}

/// An area around an agent, in cells.
#[derive(Clone, Debug, Default)]
struct Area {
    corner: Vec3,
    cell_m: f32,
    /// Indices into `lamps` cell by cell; cell `i` has `starts[i]..starts[i + 1]`.
    entries: Vec<u16>,
    starts: Vec<u32>,
}

/// A lamp part of a mesh: where its triangles are, in the middle.
struct Fitting {
    centre: Vec3,
    bits: u32,
    rgb: Vec3,
}

impl Lamps {
    /// The lamps of a scene around a place.
    ///
    /// # Errors
    /// The renderer failed.
    pub(crate) fn new(scene: &dyn Scene, wanted: bool, centre: Vec3) -> Result<Self, RenderError> {
        if !wanted {
            return Ok(Self::default());
        }
        let mut lamps = burning(scene.snapshot(), centre);
        lamps.truncate(usize::from(u16::MAX) - 1);
        shade(scene, &mut lamps, centre)?;
        Ok(Self::by_cells(lamps, centre))
    }

    /// Tells which lamps light which cells around a place.
    fn by_cells(lamps: Vec<Lamp>, centre: Vec3) -> Self {
        let areas = CELLS_M.map(|cell_m| Area::new(&lamps, centre, cell_m));
        Self { lamps, areas }
    }

    /// What they give the ground around a place in the mean, kilolux; a bright spot counts for little.
    pub(crate) fn on_the_ground(&self, centre: Vec3) -> Vec3 {
        if self.is_empty() {
            return Vec3::ZERO;
        }
        const SIDE: usize = LANES;
        const APART_M: f32 = 8.0;
        let along = |i: usize| (i as f32 - 0.5 * (SIDE - 1) as f32) * APART_M;
        let mut sum = Vec3::ZERO;
        for row in 0..SIDE {
            let places = Vec3x8::from_fn(|i| centre + Vec3::new(along(i), along(row), 0.0));
            let klx = self.illuminance(&places, &Vec3x8::splat(Vec3::Z));
            for i in 0..SIDE {
                let here = klx.lane(i);
                sum += here * (SPOT_KLX / luminance(here).max(SPOT_KLX));
            }
        }
        sum / (SIDE * SIDE) as f32
    }

    /// Whether none burns near by.
    pub(crate) fn is_empty(&self) -> bool {
        self.areas.iter().all(|area| area.entries.is_empty())
    }

    /// Illuminance of places of surfaces that look along the normals by the lamps around, kilolux.
    pub(crate) fn illuminance(&self, positions: &Vec3x8, normals: &Vec3x8) -> Vec3x8 {
        self.sum(positions, normals, None)
    }

    /// The same of retro-reflecting sheeting: what a white surface would have to get to be as bright for an
    /// eye.
    pub(crate) fn returned(&self, positions: &Vec3x8, normals: &Vec3x8, eye: Vec3) -> Vec3x8 {
        self.sum(positions, normals, Some(eye))
    }

    fn sum(&self, positions: &Vec3x8, normals: &Vec3x8, eye: Option<Vec3>) -> Vec3x8 {
        let mut left = F32x8::ZERO.simd_eq(0.0).to_bitmask();
        let mut sum = Vec3x8::default();
        for area in &self.areas {
            if left == 0 {
                break;
            }
            let cell = |v: F32x8, corner: f32| (v - corner) * (1.0 / area.cell_m);
            let (x, y) = (cell(positions.x, area.corner.x), cell(positions.y, area.corner.y));
            let limit = CELLS as f32;
            let inside = x.simd_ge(0.0) & y.simd_ge(0.0) & x.simd_lt(limit) & y.simd_lt(limit);
            let none = F32x8::ZERO;
            let cells =
                floor_words(inside.select(y, none)) * CELLS as u32 + floor_words(inside.select(x, none));
            let mut here = inside.to_bitmask() & left;
            left &= !here;
            // Mostly all places are in one cell.
            while here != 0 {
                let cell = cells.as_array()[here.trailing_zeros() as usize];
                let alike = cells.simd_eq(U32x8::splat(cell));
                let bits = here & alike.to_bitmask();
                here &= !bits;
                let mut of_cell = Vec3x8::default();
                for &index in area.of(cell) {
                    self.lamps[usize::from(index)].add_to(&mut of_cell, positions, normals, eye);
                }
                let chosen = F32x8::from(std::array::from_fn(|i| if bits >> i & 1 != 0 { 1.0 } else { 0.0 }));
                sum += of_cell.or(chosen.simd_gt(0.0), Vec3x8::default());
            }
        }
        sum
    }
}

impl Area {
    /// Finds the lamps of each cell.
    fn new(lamps: &[Lamp], centre: Vec3, cell_m: f32) -> Self {
        let half_m = 0.5 * CELLS as f32 * cell_m;
        let corner = centre - Vec3::new(half_m, half_m, 0.0);
        let reach_m = TO_CORNERS * cell_m;
        let mut starts = vec![0u32];
        let mut entries = Vec::new();
        let place = |i: usize| (i as f32 + 0.5) * cell_m;
        for cell in 0..CELLS * CELLS {
            let middle = corner + Vec3::new(place(cell % CELLS), place(cell / CELLS), 0.0);
            let mut here: Vec<(f32, u16)> = (0..)
                .zip(lamps)
                .filter_map(|(i, lamp)| {
                    let off = (lamp.position - middle).truncate().length() - reach_m;
                    let most = lamp.most_kcd(middle, reach_m);
                    (off < lamp.radius_m && most > 0.0).then(|| {
                        let nearest = off.max(3.0);
                        (most / (nearest * nearest), i)
                    })
                })
                .collect();
            here.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            entries.extend(here.iter().take(PER_CELL).map(|&(_, i)| i));
            starts.push(entries.len() as u32);
        }
        Self { corner, cell_m, entries, starts }
    }

    /// The lamps of a cell.
    fn of(&self, cell: u32) -> &[u16] {
        let [first, end] = [cell, cell + 1].map(|i| self.starts[i as usize] as usize);
        &self.entries[first..end]
    }
}

impl Lamp {
    /// No place within a distance of a cell's middle gets more than so much of its light, kilocandela.
    fn most_kcd(&self, middle: Vec3, reach_m: f32) -> f32 {
        let rgb = self.rgb.max_element();
        if !self.beam.is_headlight() {
            return rgb;
        }
        let to = (middle - self.position).truncate();
        let away = to.length();
        // Half the angle that the cell fills, which what is in it is nearer to the axis than its middle at
        // most.
        let sin = reach_m / away;
        let ahead = self.direction.truncate();
        let cos_middle = to.dot(ahead.normalize_or_zero()) / away;
        let cos_half = (1.0 - sin * sin).max(0.0).sqrt();
        let nearest = if sin < 1.0 && cos_middle < cos_half {
            cos_middle * cos_half + (1.0 - cos_middle * cos_middle).max(0.0).sqrt() * sin
        } else {
            1.0
        };
        // A beam that is tilted looks at what is straight above or below, too.
        let cos = (nearest * ahead.length()).max(0.0) + self.direction.z.abs();
        rgb * headlight::most_kcd(self.beam == Beam::High, cos)
    }

    /// The shape of its beam in directions (unit).
    #[inline]
    pub(super) fn spread(&self, towards: &Vec3x8) -> F32x8 {
        let along = |axis: Vec3| towards.dot(Vec3x8::splat(axis));
        match self.beam {
            Beam::Street => street::intensity(along(self.direction)),
            Beam::Flood => {
                let ahead = along(self.direction).fast_max(F32x8::ZERO);
                ahead * ahead
            }
            Beam::Low | Beam::High => {
                let left = self.up.cross(self.direction);
                headlight::intensity(self.beam == Beam::High, [self.direction, left, self.up].map(along))
            }
            Beam::Glow => F32x8::ONE,
        }
    }

    /// Adds its light on places of surfaces; on sheeting that sends it back, as it looks to an eye.
    #[inline]
    fn add_to(&self, sum: &mut Vec3x8, positions: &Vec3x8, normals: &Vec3x8, eye: Option<Vec3>) {
        let to = Vec3x8::splat(self.position) - *positions;
        let r2 = to.length_squared();
        let facing = to.dot(*normals);
        let reach2 = self.radius_m * self.radius_m;
        let reached = facing.simd_gt(0.0) & r2.simd_lt(reach2);
        if reached.none() {
            return;
        }
        let r2 = r2.fast_max(F32x8::splat(0.04));
        let r = r2.sqrt();
        let spread = self.spread(&(to * (-1.0 / r)));
        let spread = match &self.seen {
            Some(seen) => spread * seen.reaches(positions, normals),
            None => spread,
        };
        // Ends smoothly at the radius.
        let window = 1.0 - r2 * (1.0 / reach2);
        let mut strength = spread * facing / (r * r2) * (window * window);
        if let Some(eye) = eye {
            let to_eye = Vec3x8::splat(eye) - *positions;
            let to_eye = to_eye * (1.0 / to_eye.length_squared().sqrt().fast_max(F32x8::splat(1e-3)));
            strength *= retro::gain(&(to * (1.0 / r)), &to_eye, facing / r);
        }
        *sum += Vec3x8::splat(self.rgb) * reached.select(strength, F32x8::ZERO);
    }
}

/// The lamps that burn and whose light reaches the area.
fn burning(snapshot: &Snapshot, centre: Vec3) -> Vec<Lamp> {
    let mut fittings: BTreeMap<u32, Vec<Fitting>> = BTreeMap::new();
    let mut lamps = Vec::new();
    for instance in &snapshot.instances {
        if instance.lights & !lights::BUILDING == 0 {
            continue;
        }
        let pose = instance.local_from_object;
        let off = Vec3::from(pose.translation) - centre;
        let off_m = off.truncate().abs().max_element();
        if off_m > AREA_M + REACH_M {
            continue;
        }
        let found = fittings.entry(instance.mesh).or_insert_with(|| fittings_of(snapshot.mesh(instance)));
        for fitting in found.iter() {
            let on = fitting.bits & instance.lights;
            if on == 0 {
                continue;
            }
            // Small lamps look ahead or back, whichever end they are at.
            let looks = pose.transform_vector3(Vec3::new(1.0f32.copysign(fitting.centre.x), 0.0, 0.0));
            let (beam, rgb, radius_m, direction) = if on & lights::STREET_LAMP != 0 {
                // Kilocandela at the nominal flux.
                let rgb = Vec3::from_array(instance.glow)
                    * (street::CD_PER_LM * 1e-3 * lights::STREET_LAMP_LM as f32);
                (Beam::Street, rgb, street::REACH_M, -Vec3::Z)
            } else if on & lights::WORK_LAMP != 0 {
                let rgb =
                    Vec3::from_array(instance.glow) * (FLOOD_CD_PER_LM * 1e-3 * lights::WORK_LAMP_LM as f32);
                let [level, down] = FLOOD_AIM;
                let aim = pose.transform_vector3(Vec3::new(level, 0.0, -down));
                (Beam::Flood, rgb, street::REACH_M, aim)
            } else if on & (lights::LOW_BEAM | lights::HIGH_BEAM) != 0 {
                let beam = if on & lights::HIGH_BEAM != 0 { Beam::High } else { Beam::Low };
                (beam, warm(fitting.rgb), headlight::REACH_M, pose.transform_vector3(Vec3::X))
            } else if off_m > NEAR_M + REACH_M {
                // Glows are faint.
                continue;
            } else if on & lights::EMERGENCY != 0 {
                (Beam::Glow, fitting.rgb * 0.12, 16.0, looks)
            } else {
                (Beam::Glow, fitting.rgb * 0.008, 6.0, looks)
            };
            let position = pose.transform_point3(fitting.centre);
            let up = pose.transform_vector3(Vec3::Z);
            let object = instance.object;
            lamps.push(Lamp { object, position, direction, up, beam, rgb, radius_m, bits: on, seen: None });
        }
    }
    lamps
}

/// Finds what blocks the light of the street lamps, of the floodlights, and of the headlights
/// of the vehicles, nearest to a place; those farther away shine through things.
fn shade(scene: &dyn Scene, lamps: &mut [Lamp], centre: Vec3) -> Result<(), RenderError> {
    let kinds = [
        (&[Beam::Low, Beam::High][..], LampView::HEADLIGHT),
        (&[Beam::Street], LampView::WIDE),
        (&[Beam::Flood], LampView::WIDE),
    ];
    // All are asked for at once. An object may have lamps of several kinds: each looks for itself.
    let kind_of = |lamp: &Lamp| kinds.iter().position(|(beams, _)| beams.contains(&lamp.beam));
    let (mut eyes, mut owned) = (Vec::new(), Vec::new());
    for (kind, (_, view)) in kinds.into_iter().enumerate() {
        let is_of = |lamp: &Lamp| kind_of(lamp) == Some(kind);
        // Middle, number of lamps, where they point and what is up.
        let mut owners: BTreeMap<ObjectId, (Vec3, f32, [Vec3; 2])> = BTreeMap::new();
        for lamp in lamps.iter().filter(|lamp| is_of(lamp)) {
            // Square to where it points, whatever that is.
            let up = if lamp.beam == Beam::Street { Vec3::X } else { lamp.up };
            let up = (up - lamp.direction * up.dot(lamp.direction)).normalize_or(Vec3::X);
            let axes = [lamp.direction, up];
            let (sum, count, _) = owners.entry(lamp.object).or_insert((Vec3::ZERO, 0.0, axes));
            (*sum, *count) = (*sum + lamp.position, *count + 1.0);
        }
        let mut nearest: Vec<_> =
            owners.into_iter().map(|(object, (sum, count, axes))| (object, sum / count, axes)).collect();
        let away = |place: Vec3| (place - centre).length_squared();
        nearest.sort_by(|a, b| away(a.1).total_cmp(&away(b.1)).then(a.0.cmp(&b.0)));
        nearest.truncate(MOST_SHADED);
        let eye =
            |(own, place, [ahead, up]): (ObjectId, Vec3, [Vec3; 2])| LampEye { own, place, ahead, up, view };
        owned.extend(nearest.iter().map(|(object, ..)| (kind, *object)));
        eyes.extend(nearest.into_iter().map(eye));
    }
    let seen = LampDepths::of(scene, &eyes)?.into_iter().map(Arc::new);
    let seen: BTreeMap<(usize, ObjectId), Arc<LampDepths>> = owned.into_iter().zip(seen).collect();
    for lamp in lamps {
        lamp.seen = kind_of(lamp).and_then(|kind| seen.get(&(kind, lamp.object)).cloned());
    }
    Ok(())
}

/// A lamp's colour at full brightness: its greatest component is 1.
fn warm(rgb: Vec3) -> Vec3 {
    rgb / rgb.max_element().max(1e-3)
}

/// Lamps that have no left and right.
const FIXED: u32 = lights::STREET_LAMP
    | lights::WORK_LAMP
    | lights::BUILDING
    | lights::SIGNAL_RED
    | lights::SIGNAL_YELLOW
    | lights::SIGNAL_GREEN;

/// The lamp parts of a mesh. Separate lamps of one part count as one between them; a vehicle's left and right
/// are two.
fn fittings_of(mesh: &TriMesh) -> Vec<Fitting> {
    let mut sums: BTreeMap<(u8, bool), (Vec3, f32)> = BTreeMap::new();
    for (triangle, &part) in mesh.triangle_part.iter().enumerate() {
        if let Some(Surface::Lamp(bits)) = mesh.parts.get(usize::from(part)).map(|p| p.surface) {
            let [a, b, c] = mesh.corners(triangle);
            let area = (b - a).cross(c - a).length();
            let middle = (a + b + c) / 3.0;
            let on_right = bits & !FIXED != 0 && middle.y < -0.1;
            let sum = sums.entry((part, on_right)).or_insert((Vec3::ZERO, 0.0));
            sum.0 += middle * area;
            sum.1 += area;
        }
    }
    let fitting = |((part, _), (sum, area)): ((u8, bool), (Vec3, f32))| {
        let part = &mesh.parts[usize::from(part)];
        let Surface::Lamp(bits) = part.surface else { return None };
        let rgb = Vec3::from_array(part.rgb);
        (area > 0.0).then(|| Fitting { centre: sum / area, bits, rgb })
    };
    sums.into_iter().filter_map(fitting).collect()
}

#[cfg(test)]
mod tests {
    use schema::Tag;
    use schema::geometry::MeshPart;

    use super::*;

    fn one(beam: Beam) -> Lamps {
        let lamp = Lamp {
            position: Vec3::new(0.0, 0.0, 6.0),
            direction: -Vec3::Z,
            up: Vec3::X,
            beam,
            rgb: Vec3::ONE,
            radius_m: 30.0,
            object: 1,
            bits: 0,
            seen: None,
        };
        Lamps::by_cells(vec![lamp], Vec3::ZERO)
    }

    /// The light on one place, asked for among others.
    fn at(lamps: &Lamps, position: Vec3, normal: Vec3) -> Vec3 {
        let places = Vec3x8::from_fn(|i| position + Vec3::X * (i as f32 - 3.0) * 20.0);
        lamps.illuminance(&places, &Vec3x8::splat(normal)).lane(3)
    }

    #[test]
    fn light_falls_with_the_square_of_the_distance() {
        let lamps = one(Beam::Glow);
        for z in [0.0f32, 3.0, 5.0] {
            let d = 6.0 - z;
            let window = 1.0 - d * d / 900.0;
            let want = window * window / (d * d);
            let got = at(&lamps, Vec3::new(0.0, 0.0, z), Vec3::Z).x;
            assert!((got - want).abs() < 1e-4 * want, "{got} {want}");
        }
        assert_eq!(at(&lamps, Vec3::ZERO, -Vec3::Z), Vec3::ZERO);
        assert_eq!(at(&lamps, Vec3::new(40.0, 0.0, 0.0), Vec3::Z), Vec3::ZERO);
    }

    #[test]
    fn cells_leave_no_lamp_out() {
        // As many as a cell keeps, all about the fine area and near its rim; places in both areas.
        let mut stream = random::Stream::new(3, 0, "lamps", 0);
        let centre = Vec3::new(11.0, -7.0, 0.5);
        for round in 0..20 {
            let mut uniform = |low: f64, high: f64| stream.uniform(low, high) as f32;
            let beams = [Beam::Street, Beam::Low, Beam::High, Beam::Flood, Beam::Glow];
            let lamps: Vec<Lamp> = (0..PER_CELL)
                .map(|i| Lamp {
                    position: centre
                        + Vec3::new(uniform(-110.0, 110.0), uniform(-110.0, 110.0), uniform(0.5, 9.0)),
                    direction: Vec3::new(uniform(-1.0, 1.0), uniform(-1.0, 1.0), -0.3).normalize(),
                    up: Vec3::Z,
                    beam: beams[(i + round) % 5],
                    rgb: Vec3::new(uniform(0.1, 9.0), uniform(0.1, 9.0), uniform(0.1, 9.0)),
                    radius_m: uniform(5.0, 60.0),
                    object: 1,
                    bits: 0,
                    seen: None,
                })
                .collect();
            let by_cells = Lamps::by_cells(lamps.clone(), centre);
            let mut lit = 0;
            for k in 0..500 {
                let half_m = if k % 2 == 0 { 96.0 } else { 150.0 };
                let places = Vec3x8::from_fn(|_| {
                    centre
                        + Vec3::new(uniform(-half_m, half_m), uniform(-half_m, half_m), uniform(-1.0, 12.0))
                });
                let normal =
                    Vec3::new(uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-1.0, 1.0)).normalize();
                let normals = Vec3x8::splat(normal);
                let mut every = Vec3x8::default();
                lamps.iter().for_each(|lamp| lamp.add_to(&mut every, &places, &normals, None));
                let ours = by_cells.illuminance(&places, &normals);
                for lane in 0..simd::LANES {
                    let (a, b) = (ours.lane(lane), every.lane(lane));
                    // Other orders of adding round otherwise.
                    assert!((a - b).abs().max_element() <= 1e-5 * b.max_element(), "{a} {b}");
                    lit += usize::from(b != Vec3::ZERO);
                }
            }
            assert!(lit > 100, "{lit}");
        }
    }

    #[test]
    fn headlights_that_look_away_leave_a_street_lamp_its_cell() {
        let lamp = |beam, position, direction| Lamp { position, direction, ..one(beam).lamps[0].clone() };
        let mut lamps: Vec<Lamp> =
            (0..30).map(|k| lamp(Beam::Low, Vec3::new(-6.0 - 0.1 * k as f32, 1.0, 0.7), -Vec3::X)).collect();
        lamps.push(lamp(Beam::Street, Vec3::new(4.0, 4.0, 6.0), -Vec3::Z));
        let lamps = Lamps::by_cells(lamps, Vec3::ZERO);
        assert!(at(&lamps, Vec3::new(4.0, 4.0, 0.0), Vec3::Z).x > 0.01);
    }

    #[test]
    fn a_car_has_two_headlights_that_look_where_it_does() {
        // Lenses to either side of a car at (10, 5) that looks along y.
        let mut mesh = TriMesh::default();
        let part = mesh.part_index(MeshPart::new(Tag::Car, Surface::Lamp(lights::LOW_BEAM), [0.9, 0.9, 0.8]));
        for y in [-0.7f32, 0.7] {
            let corners = [[2.0, y - 0.1, 0.6], [2.0, y + 0.1, 0.6], [2.0, y, 0.8]];
            let corners = corners.map(|corner| mesh.add_vertex(Vec3::from_array(corner)));
            mesh.add_triangle(part, corners);
        }
        let turn = std::f32::consts::FRAC_PI_2;
        let pose = glam::Affine3A::from_translation(Vec3::new(10.0, 5.0, 0.0))
            * glam::Affine3A::from_rotation_z(turn);
        let mut car = testkit::instance(0, 3, pose);
        car.lights = lights::LOW_BEAM;
        let lamps = burning(&testkit::snapshot(vec![Arc::new(mesh)], vec![car]), Vec3::ZERO);
        assert_eq!(lamps.len(), 2);
        for (lamp, x) in lamps.iter().zip([9.3f32, 10.7]) {
            assert!((lamp.position.x - x).abs() < 0.02 && (lamp.position.y - 7.0).abs() < 0.02);
            assert!(
                (lamp.direction - Vec3::Y).length() < 1e-5 && lamp.up == Vec3::Z && lamp.beam == Beam::Low
            );
        }
        let lamps = Lamps::by_cells(lamps, Vec3::ZERO);
        let ahead = at(&lamps, Vec3::new(10.0, 20.0, 0.0), Vec3::Z).x;
        assert!(ahead > 0.001 && at(&lamps, Vec3::new(10.0, -5.0, 0.0), Vec3::Z).x == 0.0, "{ahead}");
    }

    #[test]
    fn sheeting_is_bright_for_who_sits_beside_the_lamp() {
        let street = one(Beam::Street);
        let (place, lamp) = (Vec3::new(2.0, 0.0, 0.0), street.lamps[0].position);
        let normal = (lamp - place).normalize();
        let returned = |eye: Vec3| {
            street.returned(&Vec3x8::splat(place), &Vec3x8::splat(normal), eye).lane(0).x
                / at(&street, place, normal).x
        };
        // 280 cd/(lx m2) where white paint has 1 / pi; 90 degrees off the lamp nothing is left.
        assert!((returned(lamp) - 1.0 - 280.0 * std::f32::consts::PI).abs() < 0.5, "{}", returned(lamp));
        assert!(returned(place + Vec3::Y * 9.0) < 1.01);
    }

    #[test]
    fn beams_point() {
        let street = one(Beam::Street);
        assert_eq!(at(&street, Vec3::new(2.0, 0.0, 7.0), -Vec3::X), Vec3::ZERO);
        // A floodlight gives a wall ahead of it light, and nothing what is beside or behind.
        let aside = Lamp { direction: Vec3::X, up: Vec3::Z, ..one(Beam::Flood).lamps[0].clone() };
        let flood = Lamps::by_cells(vec![aside], Vec3::ZERO);
        let wall = at(&flood, Vec3::new(10.0, 0.0, 6.0), -Vec3::X).x;
        let window = 1.0 - 100.0 / 900.0;
        assert!((wall - window * window / 100.0).abs() < 1e-5, "{wall}");
        assert_eq!(at(&flood, Vec3::new(-5.0, 0.0, 6.0), Vec3::X), Vec3::ZERO);
    }

    #[test]
    fn dipped_beams_end_at_a_line_that_rises_on_the_right() {
        // A lamp 0.65 m up that looks along x at a wall 10 m away.
        let lamp = |beam| Lamp {
            position: Vec3::new(0.0, 0.0, 0.65),
            direction: Vec3::X,
            up: Vec3::Z,
            beam,
            rgb: Vec3::ONE,
            radius_m: 1000.0,
            object: 1,
            bits: 0,
            seen: None,
        };
        let wall = |beam, y: f32, z: f32| {
            let mut sum = Vec3x8::default();
            lamp(beam).add_to(
                &mut sum,
                &Vec3x8::splat(Vec3::new(10.0, y, z)),
                &Vec3x8::splat(-Vec3::X),
                None,
            );
            sum.lane(0).x
        };
        let low = |y, z| wall(Beam::Low, y, z);
        // The line is 10 cm below the lamp; within 10 cm the light falls to a twentieth.
        let (below, above) = (low(0.0, 0.40), low(0.0, 0.66));
        assert!(below > 20.0 * above, "{below} {above}");
        // On the left it is level, on the right it rises by 0.27 m a metre.
        assert!(low(1.5, 0.66) < 1.2 * above);
        assert!(low(-1.5, 0.66) > 5.0 * above && low(-1.5, 1.15) < 1.5 * above);
        // Kilolux at 10 m are kilocandela over a hundred: 5 to 20 of a passing beam's brightest spot.
        let brightest = (0..65).map(|k| low(0.0, 0.01 * k as f32)).fold(0.0f32, f32::max);
        assert!((0.05..0.20).contains(&brightest), "{brightest}");
        // Driving beams light what is straight ahead, and nothing lights what is behind.
        assert!(wall(Beam::High, 0.0, 0.65) > 10.0 * low(0.0, 0.66));
        let mut behind = Vec3x8::default();
        lamp(Beam::Low).add_to(
            &mut behind,
            &Vec3x8::splat(Vec3::new(-5.0, 0.0, 0.3)),
            &Vec3x8::splat(Vec3::X),
            None,
        );
        assert_eq!(behind.lane(0), Vec3::ZERO);
    }
}
