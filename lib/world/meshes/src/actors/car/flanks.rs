//! What is on the sides and on the roof: mirrors, handles, wipers, rails, lights.

use crate::solids::{Detail, MeshBuilder};
use catalogue::Special;
use frames::math::f32::sin_cos;
use glam::Vec3;
use schema::Tag;
use schema::geometry::MeshPart;
use schema::lights;

use super::Car;
use crate::actors::decal::{disc, patch};

/// By how much a ball's radius grows towards the corners of a cube, at shares of the way up and around.
fn squarish(up: f32, around: f32) -> f32 {
    let (s, c) = sin_cos(std::f32::consts::PI * up);
    let (y, x) = sin_cos(std::f32::consts::TAU * around);
    let fourth = |v: f32| v * v * v * v;
    1.0 / (fourth(s * x) + fourth(s * y) + fourth(c)).sqrt().sqrt()
}

impl Car<'_> {
    pub(super) fn flanks(&self, b: &mut MeshBuilder, detail: Detail) {
        let (hull, looks) = (self.hull, &self.looks);
        let front = hull.section(hull.style.windows.0 + hull.share(0.12));
        let belt = hull.side(&front, 1.0, true);
        // Mirrors fill the room that the belt leaves inside the widest place.
        let half = Vec3::new(0.07, 0.115, 0.075);
        let centre = Vec3::new(belt.x, hull.half_width - half.y - 0.002, belt.z + 0.075);
        for side in [1.0, -1.0] {
            let at = centre * Vec3::new(1.0, side, 1.0);
            match detail {
                Detail::Full => {
                    b.blob(looks.paint, at, half, 6, 10, |ring, side| {
                        squarish(ring as f32 / 6.0, side as f32 / 10.0)
                    });
                    let glass = |c: f32, s: f32| at + Vec3::new(-0.062, 0.085 * c, 0.052 * s);
                    disc(b, looks.chrome, 10, Vec3::X * 0.05, &glass);
                    b.bar(
                        looks.trim,
                        at - Vec3::Z * 0.07,
                        at - Vec3::new(0.0, 0.08 * side, 0.10),
                        [0.03; 2],
                        5,
                    );
                }
                Detail::Half => b.ellipsoid(looks.paint, at, half, 3, 5),
                Detail::Coarse => {}
            }
        }
        if detail != Detail::Full {
            return;
        }
        for [_, behind] in self.doorways() {
            for left in [true, false] {
                let grip = |back_m: f32, out_m: f32| {
                    let f = behind - hull.share(back_m);
                    let p = hull.side(&hull.section(f), 0.90, left);
                    p + Vec3::Y * if left { out_m } else { -out_m }
                };
                b.bar(looks.paint, grip(0.10, 0.016), grip(0.29, 0.016), [0.014; 2], 6);
                for back_m in [0.105, 0.285] {
                    b.bar(looks.trim, grip(back_m, -0.01), grip(back_m, 0.016), [0.010; 2], 5);
                }
            }
        }
        self.wipers(b);
        if self.model.car_body().is_some_and(|body| body.has_rub_strips) {
            self.rub_strips(b);
        }
    }

    /// Strips of plastic along the sides between the wheels.
    fn rub_strips(&self, b: &mut MeshBuilder) {
        let hull = self.hull;
        let [front, rear] =
            [hull.axles[0] - hull.arch - 0.05, hull.axles[1] + hull.arch + 0.05].map(|x| hull.f_of(x));
        for left in [true, false] {
            let out = Vec3::Y * if left { 0.012 } else { -0.012 };
            let at = |u: f32, v: f32| {
                hull.side_at(front + (rear - front) * u, hull.radius * (1.22 + 0.30 * v), left) + out
            };
            patch(b, self.looks.trim, [6, 1], -5.0 * out, &at);
        }
    }

    fn wipers(&self, b: &mut MeshBuilder) {
        let (hull, looks) = (self.hull, &self.looks);
        let (cowl, roof) = (hull.style.cowl.0, hull.style.roof.0);
        let on = |f: f32, s: f32| hull.top(&hull.section(f), s) + Vec3::new(0.01, 0.0, 0.012);
        for (from, to) in [(0.12, 0.80), (-0.62, 0.05)] {
            let foot = cowl + 0.02 * (roof - cowl);
            let rings: Vec<Vec3> = (0..=4)
                .map(|i| i as f32 / 4.0)
                .map(|t| on(foot + 0.10 * t * (roof - cowl), from + (to - from) * t))
                .collect();
            for pair in rings.windows(2) {
                b.bar(looks.trim, pair[0], pair[1], [0.008; 2], 4);
            }
        }
    }

    /// Beacons and signs on the roof, and the third brake lamp.
    pub(super) fn on_the_roof(&self, b: &mut MeshBuilder, detail: Detail) {
        let (hull, looks) = (self.hull, &self.looks);
        let style = &hull.style;
        let (half_w, height) = (hull.half_width, hull.height);
        let middle = hull.x_of(0.5 * (style.roof.0 + style.roof.1));
        let low = (style.roof_z - 0.03) * height;
        match self.model.special {
            Special::Emergency => {
                let x = if looks.tag == Tag::Truck { hull.x_of(style.roof.0 + 0.05) } else { middle };
                for (y, bits, rgb) in [
                    ([0.02, 0.55], lights::EMERGENCY, [0.05, 0.1, 0.8]),
                    ([-0.55, -0.02], lights::EMERGENCY_OTHER, [0.8, 0.05, 0.05]),
                ] {
                    let [min, max] =
                        [Vec3::new(x - 0.14, y[0] * half_w, low), Vec3::new(x + 0.14, y[1] * half_w, height)];
                    b.tapered(looks.lamp(bits, rgb), min, max, 0.7, 0.97);
                }
            }
            Special::Taxi => {
                let sign = looks.lamp(lights::POSITION, [0.9, 0.75, 0.2]);
                b.tapered(
                    sign,
                    Vec3::new(middle - 0.09, -0.22, low),
                    Vec3::new(middle + 0.09, 0.22, height),
                    0.6,
                    0.9,
                );
            }
            _ => {}
        }
        self.third_brake_lamp(b);
        let has_rails = self.model.car_body().is_some_and(|body| body.has_roof_rails);
        if has_rails && detail != Detail::Coarse {
            self.rails(b, looks.trim);
        }
    }

    fn third_brake_lamp(&self, b: &mut MeshBuilder) {
        let hull = self.hull;
        let third = self.looks.lamp(lights::BRAKE, [0.5, 0.02, 0.02]);
        // At the upper edge of the rear window, or of the rear doors.
        let f = hull.style.roof.1 + 0.06 * (hull.style.deck.0 - hull.style.roof.1);
        let p = hull.top(&hull.section(f), 0.0);
        b.tapered(third, p - Vec3::new(0.02, 0.14, 0.03), p + Vec3::new(0.03, 0.14, 0.004), 0.8, 0.95);
    }

    fn rails(&self, b: &mut MeshBuilder, part: MeshPart) {
        let hull = self.hull;
        let (from, to) = (hull.style.roof.0 + 0.04, hull.style.roof.1 - 0.02);
        for s in [0.9, -0.9] {
            let on = |t: f32, up: f32| hull.top(&hull.section(from + (to - from) * t), s) + Vec3::Z * up;
            let line: Vec<Vec3> =
                [(0.0, -0.01), (0.04, 0.028), (0.35, 0.034), (0.68, 0.034), (0.96, 0.028), (1.0, -0.01)]
                    .map(|(t, up)| on(t, up))
                    .to_vec();
            for pair in line.windows(2) {
                b.bar(part, pair[0], pair[1], [0.016; 2], 5);
            }
        }
    }
}
