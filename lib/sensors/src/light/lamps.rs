//! Light of lamps: street lamps, headlights, and the glow of other lamps.

use std::collections::BTreeMap;

use glam::Vec3;
use schema::geometry::{Snapshot, Surface, TriMesh};
use schema::lights;

/// Half width of the area around an agent in which lamps give light, metres.
const AREA_M: f32 = 96.0;
/// Cells of the grid over it.
const CELL_M: f32 = 8.0;
const CELLS: usize = (2.0 * AREA_M / CELL_M) as usize;
/// Most lamps that light a cell: the strongest there.
const PER_CELL: usize = 10;

/// How a lamp spreads its light.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Beam {
    /// Downwards, widely.
    Street,
    /// Along the direction, narrowly.
    Head,
    /// Everywhere.
    Glow,
}

/// One lamp that burns.
#[derive(Clone, Copy, Debug)]
struct Lamp {
    position: Vec3,
    direction: Vec3,
    beam: Beam,
    /// Intensity along the direction, kilocandela (kilolux at a metre).
    rgb: Vec3,
    radius_m: f32,
}

/// The lamps around an agent, by the place they light.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lamps {
    lamps: Vec<Lamp>,
    corner: Vec3,
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
    pub(crate) fn new(snapshot: &Snapshot, wanted: bool, centre: Vec3) -> Self {
        if !wanted {
            return Self::default();
        }
        let mut lamps = burning(snapshot, centre);
        lamps.truncate(usize::from(u16::MAX));
        let corner = centre - Vec3::new(AREA_M, AREA_M, 0.0);
        let mut starts = vec![0u32];
        let mut entries = Vec::new();
        for cell in 0..CELLS * CELLS {
            let middle = corner
                + Vec3::new(
                    (cell % CELLS) as f32 * CELL_M + 0.5 * CELL_M,
                    (cell / CELLS) as f32 * CELL_M + 0.5 * CELL_M,
                    0.0,
                );
            let mut here: Vec<(f32, u16)> = lamps
                .iter()
                .enumerate()
                .filter_map(|(i, lamp)| {
                    let off = (lamp.position - middle).truncate().length() - 0.71 * CELL_M;
                    (off < lamp.radius_m).then(|| {
                        let nearest = off.max(3.0);
                        (lamp.rgb.max_element() / (nearest * nearest), i as u16)
                    })
                })
                .collect();
            here.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            entries.extend(here.iter().take(PER_CELL).map(|&(_, i)| i));
            starts.push(entries.len() as u32);
        }
        Self { lamps, corner, entries, starts }
    }

    /// Whether none burns near by.
    pub(crate) fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Illuminance of a surface by the lamps around, kilolux.
    #[inline]
    pub(crate) fn illuminance(&self, position: Vec3, normal: Vec3) -> Vec3 {
        let cell = (position - self.corner) / CELL_M;
        if !(cell.x >= 0.0 && cell.y >= 0.0 && cell.x < CELLS as f32 && cell.y < CELLS as f32) {
            return Vec3::ZERO;
        }
        let cell = cell.y as usize * CELLS + cell.x as usize;
        let here = self.starts[cell] as usize..self.starts[cell + 1] as usize;
        let mut sum = Vec3::ZERO;
        for &index in &self.entries[here] {
            let lamp = &self.lamps[usize::from(index)];
            let to = lamp.position - position;
            let r2 = to.length_squared();
            let facing = to.dot(normal);
            let reach2 = lamp.radius_m * lamp.radius_m;
            if facing <= 0.0 || r2 >= reach2 {
                continue;
            }
            let r2 = r2.max(0.04);
            let r = r2.sqrt();
            let cos = -to.dot(lamp.direction) / r;
            let spread = match lamp.beam {
                Beam::Street => cos.max(0.0) * (0.6 + 0.8 * (1.0 - cos)),
                Beam::Head => {
                    // Half the intensity at 12 degrees, a faint wide skirt.
                    let c = cos.max(0.0);
                    let (c2, narrow) = (c * c, 0.9 + 0.1 * cos);
                    let narrow = narrow.max(0.0) * narrow.max(0.0);
                    let lobe = if c > 0.85 { (c - 0.85) / 0.15 } else { 0.0 };
                    lobe * lobe * lobe * narrow + 0.02 * c2
                }
                Beam::Glow => 1.0,
            };
            // Ends smoothly at the radius.
            let window = 1.0 - r2 / reach2;
            sum += lamp.rgb * (spread * facing / (r * r2) * window * window);
        }
        sum
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
        if off.truncate().abs().max_element() > 2.0 * AREA_M {
            continue;
        }
        let found = fittings.entry(instance.mesh).or_insert_with(|| fittings_of(snapshot.mesh(instance)));
        for fitting in found.iter() {
            let on = fitting.bits & instance.lights;
            if on == 0 {
                continue;
            }
            let (beam, rgb, radius_m, direction) = if on & lights::STREET_LAMP != 0 {
                // 0.75 kcd downwards at the nominal flux.
                let glow = Vec3::from_array(instance.glow);
                (Beam::Street, glow * 0.75, reach_m(glow.max_element()), -Vec3::Z)
            } else if on & (lights::LOW_BEAM | lights::HIGH_BEAM) != 0 {
                // Dipped by two degrees.
                let ahead = pose.transform_vector3(Vec3::new(0.999, 0.0, -0.035));
                let strength = if on & lights::HIGH_BEAM != 0 { 14.0 } else { 7.0 };
                (Beam::Head, warm(fitting.rgb) * strength, 48.0, ahead)
            } else if on & lights::EMERGENCY != 0 {
                (Beam::Glow, fitting.rgb * 0.12, 16.0, Vec3::Z)
            } else {
                (Beam::Glow, fitting.rgb * 0.012, 6.0, Vec3::Z)
            };
            let position = pose.transform_point3(fitting.centre);
            lamps.push(Lamp { position, direction, beam, rgb, radius_m });
        }
    }
    lamps
}

/// How far a street lamp's light is followed, metres: 30 at the nominal flux, and to the same illuminance at others.
fn reach_m(strength: f32) -> f32 {
    (30.0 * strength.max(0.0).sqrt()).clamp(5.0, 60.0)
}

/// A lamp's colour at full brightness: its greatest component is 1.
fn warm(rgb: Vec3) -> Vec3 {
    rgb / rgb.max_element().max(1e-3)
}

/// The lamp parts of a mesh. Separate lamps of one part (a pair of headlights) count as one between them.
fn fittings_of(mesh: &TriMesh) -> Vec<Fitting> {
    let mut sums: BTreeMap<u8, (Vec3, f32)> = BTreeMap::new();
    for (triangle, &part) in mesh.triangle_part.iter().enumerate() {
        if let Some(Surface::Lamp(_)) = mesh.parts.get(usize::from(part)).map(|p| p.surface) {
            let [a, b, c] = mesh.corners(triangle);
            let area = (b - a).cross(c - a).length();
            let sum = sums.entry(part).or_insert((Vec3::ZERO, 0.0));
            sum.0 += (a + b + c) * (area / 3.0);
            sum.1 += area;
        }
    }
    let fitting = |(part, (sum, area)): (u8, (Vec3, f32))| {
        let part = &mesh.parts[usize::from(part)];
        let Surface::Lamp(bits) = part.surface else { return None };
        (area > 0.0).then(|| Fitting { centre: sum / area, bits, rgb: Vec3::from_array(part.rgb) })
    };
    sums.into_iter().filter_map(fitting).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(beam: Beam) -> Lamps {
        let lamp = Lamp {
            position: Vec3::new(0.0, 0.0, 6.0),
            direction: -Vec3::Z,
            beam,
            rgb: Vec3::ONE,
            radius_m: 30.0,
        };
        Lamps {
            lamps: vec![lamp],
            corner: Vec3::new(-AREA_M, -AREA_M, 0.0),
            entries: vec![0; CELLS * CELLS],
            starts: (0..=(CELLS * CELLS) as u32).collect(),
        }
    }

    #[test]
    fn light_falls_with_the_square_of_the_distance() {
        let lamps = one(Beam::Glow);
        for z in [0.0f32, 3.0, 5.0] {
            let d = 6.0 - z;
            let window = 1.0 - d * d / 900.0;
            let want = window * window / (d * d);
            let got = lamps.illuminance(Vec3::new(0.0, 0.0, z), Vec3::Z).x;
            assert!((got - want).abs() < 1e-4 * want, "{got} {want}");
        }
        assert_eq!(lamps.illuminance(Vec3::ZERO, -Vec3::Z), Vec3::ZERO);
        assert_eq!(lamps.illuminance(Vec3::new(40.0, 0.0, 0.0), Vec3::Z), Vec3::ZERO);
    }

    #[test]
    fn beams_point() {
        let street = one(Beam::Street);
        assert_eq!(street.illuminance(Vec3::new(2.0, 0.0, 7.0), -Vec3::X), Vec3::ZERO);
        let head = one(Beam::Head);
        let on_axis = head.illuminance(Vec3::ZERO, Vec3::Z).x;
        let aside = head.illuminance(Vec3::new(5.0, 0.0, 0.0), Vec3::Z).x;
        assert!(on_axis > 8.0 * aside);
    }
}
