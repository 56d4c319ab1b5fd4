//! Liveries: stripes, checkers and panels on the sides, and the windows of what people live in.

use crate::solids::{Detail, MeshBuilder};
use catalogue::Livery;
use glam::Vec3;
use schema::geometry::{MeshPart, Surface};

use super::Car;
use crate::actors::decal::patch;

const BLUE: [f32; 3] = [0.03, 0.10, 0.34];
const RED: [f32; 3] = [0.62, 0.05, 0.03];
const YELLOW: [f32; 3] = [0.66, 0.62, 0.03];
const BLACK: [f32; 3] = [0.018; 3];

/// A piece of a livery on both sides.
struct Strip {
    rgb: [f32; 3],
    /// From where to where along the side, as shares.
    along: [f32; 2],
    /// From where to where up the side, as rows of the hull.
    up: [f32; 2],
    /// How much farther back its upper edge is, as a share.
    slant: f32,
}

impl Car<'_> {
    /// What a model has on its sides.
    fn strips(&self, detail: Detail) -> Vec<Strip> {
        let hull = self.hull;
        // Between the wheels, clear of arches and doors' gaps.
        let [front, rear] =
            [hull.axles[0] - hull.arch - 0.06, hull.axles[1] + hull.arch + 0.06].map(|x| hull.f_of(x));
        let strip = |rgb, along, up, slant| Strip { rgb, along, up, slant };
        let fine = detail == Detail::Full;
        let livery = self.model.car_body().map_or(Livery::None, |body| body.livery);
        match livery {
            Livery::Taxi if fine => {
                // A checker of two rows.
                let n = 22;
                let at = |k: usize| front + (rear - front) * k as f32 / n as f32;
                (0..n)
                    .map(|k| {
                        let low = if k % 2 == 0 { 0.74 } else { 0.80 };
                        strip(BLACK, [at(k), at(k + 1)], [low, low + 0.06], 0.0)
                    })
                    .collect()
            }
            // Farther off the checker is a band.
            Livery::Taxi => vec![strip([0.12; 3], [front, rear], [0.76, 0.84], 0.0)],
            Livery::Police => vec![strip(YELLOW, [front, rear], [0.70, 0.77], 0.0)],
            Livery::Ambulance => {
                let mut strips = vec![strip(YELLOW, [0.36, 0.97], [1.16, 1.30], 0.0)];
                // The cross of what brings help: two bars.
                strips.push(strip(RED, [0.60, 0.70], [1.50, 1.60], 0.0));
                strips.push(strip(RED, [0.633, 0.667], [1.40, 1.70], 0.0));
                if detail != Detail::Coarse {
                    strips.push(strip(RED, [0.36, 0.97], [0.74, 0.80], 0.0));
                }
                strips
            }
            Livery::Delivery => vec![
                strip(BLUE, [0.46, 0.72], [1.20, 1.45], 0.06),
                strip([0.70, 0.26, 0.02], [0.74, 0.84], [1.20, 1.45], 0.06),
            ],
            Livery::Parcel => vec![
                strip([0.60, 0.42, 0.05], [0.30, 0.97], [1.05, 1.13], 0.0),
                strip([0.60, 0.42, 0.05], [0.48, 0.58], [1.35, 1.65], 0.05),
                strip([0.60, 0.42, 0.05], [0.62, 0.66], [1.35, 1.65], 0.05),
            ],
            // What leisure is sold with, and a shuttle's swoosh.
            Livery::Camper => vec![
                strip([0.60, 0.24, 0.04], [front, rear], [0.80, 0.86], 0.0),
                strip([0.30, 0.10, 0.03], [front, rear], [0.88, 0.91], 0.0),
            ],
            Livery::Shuttle => vec![
                strip([0.04, 0.22, 0.30], [0.52, 0.60], [0.36, 0.94], 0.08),
                strip([0.05, 0.36, 0.40], [0.62, 0.65], [0.36, 0.94], 0.08),
            ],
            Livery::Craftsman => vec![strip([0.10, 0.34, 0.12], [0.52, 0.74], [1.15, 1.55], 0.05)],
            Livery::Motorhome => vec![
                strip([0.10, 0.16, 0.26], [front, 0.97], [0.82, 0.90], 0.0),
                strip([0.30, 0.33, 0.36], [0.34, 0.97], [0.94, 0.97], 0.0),
            ],
            Livery::None => Vec::new(),
        }
    }

    pub(super) fn livery(&self, b: &mut MeshBuilder, detail: Detail) {
        let hull = self.hull;
        let cells = |along: [f32; 2], up: [f32; 2]| match detail {
            Detail::Full => [
                ((along[1] - along[0]) * 14.0).ceil().max(1.0) as usize,
                if up[1] - up[0] < 0.1 { 1 } else { 2 },
            ],
            Detail::Half => [((along[1] - along[0]) * 7.0).ceil().max(1.0) as usize, 1],
            Detail::Coarse => [1, 1],
        };
        let mut on_both = |part: MeshPart, Strip { along, up, slant, .. }: Strip, out_m: f32| {
            for left in [true, false] {
                let out = Vec3::Y * if left { out_m } else { -out_m };
                patch(b, part, cells(along, up), -12.0 * out, &|u, v| {
                    let f = along[0] + (along[1] - along[0]) * u - slant * v;
                    hull.side(&hull.section(f), up[0] + (up[1] - up[0]) * v, left) + out
                });
            }
        };
        for strip in self.strips(detail) {
            // Warning yellow of police and ambulances is sheeting.
            let surface = if strip.rgb == YELLOW { Surface::Reflector } else { Surface::Plain };
            let part = MeshPart::new(self.looks.tag, surface, strip.rgb);
            on_both(part, strip, 0.006);
        }
        if self.model.car_body().is_some_and(|body| body.livery == Livery::Motorhome)
            && detail != Detail::Coarse
        {
            let window = |along: [f32; 2], up: [f32; 2]| Strip { rgb: BLACK, along, up, slant: 0.0 };
            let dark = MeshPart::new(self.looks.tag, Surface::Glass, [0.03, 0.035, 0.04]);
            on_both(self.looks.trim, window([0.40, 0.56], [1.22, 1.62]), 0.008);
            on_both(dark, window([0.407, 0.553], [1.24, 1.60]), 0.014);
            on_both(self.looks.trim, window([0.74, 0.86], [1.22, 1.62]), 0.008);
            on_both(dark, window([0.747, 0.853], [1.24, 1.60]), 0.014);
            // The door of the living room and the awning over it, on the right; hatches on the roof.
            let roof = hull.style.roof_z * hull.height;
            let side = hull.side(&hull.section(0.6), 1.93, false);
            let (from, to) = (hull.x_of(0.42), hull.x_of(0.92));
            b.bar(self.white(), Vec3::new(from, side.y, side.z), Vec3::new(to, side.y, side.z), [0.05; 2], 6);
            for f in [0.5, 0.8] {
                let at = Vec3::new(hull.x_of(f), 0.0, roof - 0.03);
                b.tapered(
                    self.white(),
                    at - Vec3::new(0.3, 0.25, 0.0),
                    (at + Vec3::new(0.3, 0.25, 0.0)).with_z(hull.height - if f < 0.6 { 0.0 } else { 0.03 }),
                    0.85,
                    0.85,
                );
            }
        }
    }
}
