//! What motorcycles and scooters are made of.

use crate::solids::{Detail, MeshBuilder};
use catalogue::Frame;
use glam::Vec3;
use schema::geometry::{MeshPart, Surface};
use schema::{Tag, lights};

use crate::actors::decal::disc;
use crate::actors::plates::SHEETING;
use crate::actors::pod::{mudguard, pod, rounded, tube};

/// Where things are on a motorcycle, metres.
pub(crate) struct Places {
    /// x of the axles.
    pub(crate) front: f32,
    pub(crate) rear: f32,
    pub(crate) radius: f32,
    /// Height of the saddle.
    pub(crate) seat: f32,
    /// The left grip's end.
    pub(crate) grip: Vec3,
    /// Rear end and highest place.
    pub(crate) back: f32,
    pub(crate) top: f32,
    /// Whole width.
    pub(crate) wide: f32,
}

struct Parts {
    paint: MeshPart,
    metal: MeshPart,
    chrome: MeshPart,
    dark: MeshPart,
    plastic: MeshPart,
    glass: MeshPart,
}

/// Adds everything but the wheels.
pub(crate) fn body(b: &mut MeshBuilder, frame: Frame, places: &Places, detail: Detail) {
    let tag = Tag::Motorcycle;
    let parts = Parts {
        paint: MeshPart::new(tag, Surface::Paint, [0.5; 3]),
        metal: MeshPart::new(tag, Surface::Metal, [0.16, 0.16, 0.17]),
        chrome: MeshPart::new(tag, Surface::Metal, [0.6, 0.6, 0.62]),
        dark: MeshPart::new(tag, Surface::Rubber, [0.03; 3]),
        plastic: MeshPart::new(tag, Surface::Rubber, [0.05, 0.05, 0.052]),
        glass: MeshPart::new(tag, Surface::Glass, [0.04, 0.05, 0.06]),
    };
    let machine = Machine { b, p: places, parts, detail };
    match frame {
        Frame::Scooter => machine.scooter(false),
        Frame::Moped => machine.scooter(true),
        Frame::Police => machine.police(),
        Frame::Sport => machine.sport(),
        Frame::Cruiser => machine.cruiser(),
        // `two_wheeler` builds those.
        Frame::Bicycle | Frame::CargoBicycle | Frame::KickScooter => {}
    }
}

struct Machine<'a> {
    b: &'a mut MeshBuilder,
    p: &'a Places,
    parts: Parts,
    detail: Detail,
}

impl Machine<'_> {
    /// A place by its share of the wheelbase from the rear axle, and its height.
    fn at(&self, share: f32, z: f32) -> Vec3 {
        Vec3::new(self.p.rear + share * (self.p.front - self.p.rear), 0.0, z)
    }

    fn sides(&self, full: usize) -> usize {
        match self.detail {
            Detail::Full => full,
            Detail::Half => (full / 2).max(4),
            Detail::Coarse => 4,
        }
    }

    fn pod(&mut self, part: MeshPart, line: &[(f32, f32, f32, f32)]) {
        let line: Vec<(Vec3, f32, f32)> = line.iter().map(|(f, z, y, h)| (self.at(*f, *z), *y, *h)).collect();
        let sides = self.sides(14);
        pod(self.b, part, &line, sides);
    }

    fn tube(&mut self, part: MeshPart, line: &[(Vec3, f32)]) {
        let sides = self.sides(8);
        tube(self.b, part, line, sides);
    }

    fn cruiser(mut self) {
        let (seat, radius) = (self.p.seat, self.p.radius);
        let (paint, metal, chrome, dark) =
            (self.parts.paint, self.parts.metal, self.parts.chrome, self.parts.dark);
        self.pod(
            paint,
            &[
                (0.40, seat + 0.01, 0.05, 0.03),
                (0.46, seat + 0.04, 0.11, 0.08),
                (0.58, seat + 0.07, 0.15, 0.11),
                (0.70, seat + 0.09, 0.14, 0.10),
                (0.78, seat + 0.09, 0.07, 0.06),
            ],
        );
        self.pod(
            dark,
            &[
                (-0.06, seat + 0.01, 0.08, 0.03),
                (0.04, seat - 0.02, 0.12, 0.05),
                (0.17, seat - 0.05, 0.16, 0.06),
                (0.33, seat - 0.06, 0.16, 0.06),
                (0.43, seat - 0.02, 0.09, 0.05),
            ],
        );
        self.frame();
        self.engine(metal, chrome);
        self.exhaust(chrome, -0.10, 0.95 * radius);
        self.running_gear(0.09);
        self.lamps(0.085, Vec3::new(self.p.grip.x + 0.17, 0.0, self.p.grip.z - 0.10));
        self.mirrors();
    }

    fn sport(mut self) {
        let (seat, radius, grip) = (self.p.seat, self.p.radius, self.p.grip);
        let (paint, metal, dark, glass) =
            (self.parts.paint, self.parts.metal, self.parts.dark, self.parts.glass);
        // Tank, seat and a tail that rises.
        self.pod(
            paint,
            &[
                (0.40, seat - 0.02, 0.07, 0.04),
                (0.48, seat + 0.02, 0.14, 0.09),
                (0.62, seat + 0.05, 0.16, 0.11),
                (0.76, seat + 0.05, 0.10, 0.07),
            ],
        );
        self.pod(
            dark,
            &[
                (0.10, seat + 0.0, 0.11, 0.03),
                (0.22, seat - 0.03, 0.14, 0.05),
                (0.43, seat - 0.05, 0.09, 0.05),
            ],
        );
        self.pod(
            paint,
            &[
                (-0.20, seat + 0.06, 0.03, 0.02),
                (-0.06, seat + 0.03, 0.09, 0.05),
                (0.14, seat - 0.04, 0.12, 0.06),
                (0.36, seat - 0.12, 0.11, 0.07),
            ],
        );
        // Fairing: around the engine, and the nose with its screen.
        self.pod(
            paint,
            &[
                (0.42, 1.05 * radius, 0.10, 0.13),
                (0.54, 1.12 * radius + 0.02, 0.19, 0.20),
                (0.74, 1.35 * radius + 0.06, 0.20, 0.24),
                (0.86, 1.7 * radius + 0.10, 0.15, 0.16),
            ],
        );
        let nose = (self.p.front + 0.14 - self.p.rear) / (self.p.front - self.p.rear);
        self.pod(
            paint,
            &[
                (0.74, grip.z - 0.14, 0.15, 0.14),
                (0.86, grip.z - 0.08, 0.19, 0.13),
                (0.96, grip.z - 0.11, 0.14, 0.11),
                (nose, grip.z - 0.17, 0.04, 0.03),
            ],
        );
        self.pod(
            glass,
            &[
                (0.80, grip.z + 0.05, 0.10, self.p.top - grip.z - 0.05),
                (0.90, grip.z + 0.00, 0.12, 0.07),
                (0.99, grip.z - 0.07, 0.06, 0.03),
            ],
        );
        self.frame();
        self.engine(metal, metal);
        self.exhaust(self.parts.chrome, 0.02, 1.35 * radius);
        self.running_gear(0.08);
        self.lamps(0.05, Vec3::new(self.p.front + 0.10, 0.0, grip.z - 0.155));
        self.mirrors();
    }

    /// One of the police: a tourer behind a screen, with cases and blue lamps.
    fn police(mut self) {
        let (seat, radius, grip) = (self.p.seat, self.p.radius, self.p.grip);
        let (paint, metal, dark, glass) =
            (self.parts.paint, self.parts.metal, self.parts.dark, self.parts.glass);
        let (plain, back) =
            (|rgb: [f32; 3]| MeshPart::new(Tag::Motorcycle, Surface::Plain, rgb), self.p.back);
        self.pod(
            paint,
            &[
                (0.40, seat + 0.0, 0.06, 0.04),
                (0.48, seat + 0.05, 0.14, 0.10),
                (0.62, seat + 0.08, 0.17, 0.13),
                (0.76, seat + 0.08, 0.11, 0.09),
            ],
        );
        self.pod(
            dark,
            &[
                (-0.04, seat + 0.02, 0.10, 0.03),
                (0.10, seat + 0.0, 0.15, 0.05),
                (0.26, seat - 0.04, 0.16, 0.06),
                (0.43, seat - 0.03, 0.09, 0.05),
            ],
        );
        // The fairing beside the engine and around the lamp, a blue band on it, the screen.
        self.pod(
            paint,
            &[
                (0.44, 1.05 * radius, 0.10, 0.12),
                (0.56, 1.15 * radius, 0.19, 0.20),
                (0.74, 1.45 * radius, 0.22, 0.26),
                (0.85, 1.85 * radius, 0.17, 0.18),
            ],
        );
        self.pod(
            paint,
            &[
                (0.68, grip.z - 0.22, 0.15, 0.14),
                (0.80, grip.z - 0.15, 0.24, 0.18),
                (0.92, grip.z - 0.18, 0.20, 0.16),
                (1.03, grip.z - 0.25, 0.09, 0.08),
            ],
        );
        self.pod(
            plain([0.03, 0.10, 0.34]),
            &[
                (0.58, 1.2 * radius, 0.205, 0.05),
                (0.74, 1.45 * radius, 0.228, 0.06),
                (0.82, 1.7 * radius, 0.192, 0.05),
            ],
        );
        let screen = |b: f32, z: f32, wide: f32| Vec3::new(grip.x + b, wide, z);
        let ring = |b: f32, z: f32, wide: f32| -> Vec<Vec3> {
            [
                screen(b + 0.05, z, 0.0),
                screen(b, z, wide),
                screen(b - 0.02, z, wide),
                screen(b + 0.03, z, 0.0),
                screen(b - 0.02, z, -wide),
                screen(b, z, -wide),
            ]
            .to_vec()
        };
        self.b.loft(
            &[ring(0.15, grip.z - 0.06, 0.19), ring(0.03, grip.z + 0.25, 0.15)],
            |_, _| glass,
            [glass; 2],
        );
        self.frame();
        self.engine(metal, metal);
        self.exhaust(self.parts.chrome, -0.02, 0.85 * radius);
        // Cases beside and behind the seat.
        let x = [back + 0.06, back + 0.56];
        for side in [1.0, -1.0] {
            let (a, c) = (side * 0.17, side * (0.5 * self.p.wide - 0.01));
            let (min, max) =
                (Vec3::new(x[0] + 0.04, a.min(c), seat - 0.36), Vec3::new(x[1], a.max(c), seat + 0.02));
            rounded(self.b, paint, min, max, 0.04);
            let band = [c - 0.004, c + 0.004].map(|y| y - side * 0.0035);
            self.b.cuboid(
                plain([0.03, 0.10, 0.34]),
                Vec3::new(min.x + 0.06, band[0], seat - 0.22),
                Vec3::new(max.x - 0.06, band[1], seat - 0.10),
            );
        }
        rounded(
            self.b,
            paint,
            Vec3::new(x[0] - 0.02, -0.20, seat + 0.07),
            Vec3::new(x[0] + 0.34, 0.20, seat + 0.33),
            0.04,
        );
        // Lamps on a pole and beside the screen.
        let pole = Vec3::new(x[0] + 0.02, 0.0, seat + 0.30);
        self.tube(dark, &[(pole, 0.014), (pole.with_z(self.p.top - 0.06), 0.012)]);
        let lamp = |bits: u32| MeshPart::new(Tag::Motorcycle, Surface::Lamp(bits), [0.05, 0.1, 0.8]);
        let head = pole.with_z(self.p.top - 0.08);
        self.b.stack(
            lamp(lights::EMERGENCY),
            &[(head, 0.045, 0.045), (head.with_z(self.p.top), 0.035, 0.035)],
            8,
        );
        for (side, bits) in [(1.0, lights::EMERGENCY), (-1.0, lights::EMERGENCY_OTHER)] {
            let at = Vec3::new(grip.x + 0.14, side * 0.20, grip.z - 0.08);
            self.b.cuboid(lamp(bits), at - Vec3::new(0.02, 0.045, 0.025), at + Vec3::new(0.03, 0.045, 0.025));
        }
        self.running_gear(0.09);
        self.lamps(0.07, Vec3::new(self.p.front + 0.06, 0.0, grip.z - 0.25));
        self.mirrors();
    }

    /// With a box for what it delivers, or without.
    fn scooter(mut self, delivers: bool) {
        let (seat, radius, grip) = (self.p.seat, self.p.radius, self.p.grip);
        let (paint, dark, plastic) = (self.parts.paint, self.parts.dark, self.parts.plastic);
        self.pod(
            paint,
            &[
                (-0.22, seat - 0.12, 0.05, 0.03),
                (-0.08, seat - 0.14, 0.14, 0.10),
                (0.12, seat - 0.20, 0.18, 0.17),
                (0.34, seat - 0.25, 0.17, 0.21),
                (0.41, seat - 0.27, 0.15, 0.20),
            ],
        );
        self.pod(
            dark,
            &[
                (-0.10, seat + 0.0, 0.10, 0.03),
                (0.04, seat - 0.02, 0.15, 0.05),
                (0.22, seat - 0.05, 0.15, 0.06),
                (0.42, seat - 0.06, 0.10, 0.05),
            ],
        );
        let board = radius + 0.03;
        self.pod(
            plastic,
            &[
                (0.30, board, 0.14, 0.06),
                (0.38, board, 0.19, 0.05),
                (0.70, board, 0.19, 0.05),
                (0.80, board + 0.06, 0.14, 0.07),
            ],
        );
        // The shield leans back as it rises.
        let sides = self.sides(14);
        let lean = |z: f32, back: f32| Vec3::new(self.p.front - back, 0.0, z);
        self.b.stack(
            paint,
            &[
                (lean(board + 0.02, 0.24), 0.06, 0.16),
                (lean(0.42 * (board + grip.z), 0.22), 0.07, 0.21),
                (lean(0.75 * grip.z, 0.21), 0.07, 0.19),
                (lean(0.90 * grip.z, 0.23), 0.07, 0.11),
                (lean(grip.z - 0.02, grip.x.mul_add(-1.0, self.p.front)), 0.08, 0.10),
                (lean(grip.z + 0.01, grip.x.mul_add(-1.0, self.p.front)), 0.03, 0.04),
            ],
            sides,
        );
        self.running_gear(0.06);
        self.lamps(0.065, Vec3::new(grip.x + 0.12, 0.0, grip.z - 0.07));
        self.mirrors();
        if delivers {
            let back = self.p.back + 0.05;
            let (min, max) = (Vec3::new(back, -0.19, seat - 0.02), Vec3::new(back + 0.36, 0.19, seat + 0.34));
            rounded(self.b, paint, min, max, 0.02);
            let lid = Vec3::Z * (seat + 0.26);
            rounded(
                self.b,
                dark,
                min.with_z(lid.z) - Vec3::splat(0.006).with_z(0.0),
                max.with_z(lid.z + 0.03) + Vec3::splat(0.006).with_z(0.0),
                0.01,
            );
        }
    }

    /// Crankcase, two cylinders with fins, and a cover on each side.
    fn engine(&mut self, case: MeshPart, bright: MeshPart) {
        let (seat, radius) = (self.p.seat, self.p.radius);
        self.pod(
            case,
            &[
                (0.34, 0.85 * radius, 0.09, 0.09),
                (0.42, 0.82 * radius, 0.14, 0.13),
                (0.58, 0.82 * radius, 0.14, 0.13),
                (0.66, 0.85 * radius, 0.08, 0.08),
            ],
        );
        let foot = self.at(0.50, 0.95 * radius);
        for head in [self.at(0.42, seat - 0.12), self.at(0.62, seat - 0.08)] {
            self.tube(case, &[(foot, 0.075), (head, 0.075)]);
            if self.detail == Detail::Full {
                for fin in 0..4 {
                    let t = 0.45 + 0.14 * fin as f32;
                    let middle = foot + (head - foot) * t;
                    let thick = (head - foot).normalize_or(Vec3::Z) * 0.007;
                    self.tube(bright, &[(middle - thick, 0.098), (middle + thick, 0.098)]);
                }
            }
        }
        if self.detail == Detail::Full {
            for side in [1.0, -1.0] {
                let cover = self.at(0.50, 0.82 * radius) + Vec3::Y * side * 0.12;
                self.tube(bright, &[(cover, 0.085), (cover + Vec3::Y * side * 0.04, 0.065)]);
            }
        }
    }

    /// A pipe from the cylinder down and back along the right side.
    fn exhaust(&mut self, part: MeshPart, end: f32, end_z: f32) {
        let low = 0.62 * self.p.radius;
        let right = Vec3::Y * -0.17;
        let bend = [
            (self.at(0.66, self.p.seat - 0.18) + right * 0.4, 0.022),
            (self.at(0.70, low + 0.12) + right * 0.7, 0.022),
            (self.at(0.60, low) + right, 0.025),
            (self.at(0.34, low) + right, 0.03),
            (self.at(0.26, low + 0.2 * (end_z - low)) + right, 0.05),
            (self.at(end, end_z) + right, 0.055),
        ];
        self.tube(part, &bend);
    }

    /// Tubes from the steering head under the engine to the saddle.
    fn frame(&mut self) {
        let (seat, radius, grip) = (self.p.seat, self.p.radius, self.p.grip);
        let (head, metal) = (Vec3::new(grip.x, 0.0, grip.z - 0.05), self.parts.metal);
        let frame = [
            (head - Vec3::Z * 0.06, 0.03),
            (self.at(0.70, 0.75 * radius), 0.025),
            (self.at(0.36, 0.62 * radius), 0.025),
            (self.at(0.30, seat - 0.10), 0.025),
        ];
        self.tube(metal, &frame);
    }

    /// Fork, swingarm, handlebar, pegs and mudguards.
    fn running_gear(&mut self, apart: f32) {
        let (seat, radius, grip) = (self.p.seat, self.p.radius, self.p.grip);
        let (metal, chrome, dark, paint) =
            (self.parts.metal, self.parts.chrome, self.parts.dark, self.parts.paint);
        let head = Vec3::new(grip.x, 0.0, grip.z - 0.05);
        let axle = Vec3::new(self.p.front, 0.0, radius);
        for side in [1.0, -1.0] {
            let aside = Vec3::Y * side * apart;
            let middle = axle + 0.45 * (head - axle);
            self.tube(metal, &[(axle + aside, 0.028), (middle + aside, 0.028)]);
            self.tube(chrome, &[(middle + aside, 0.020), (head + aside * 0.9, 0.020)]);
            let pivot = self.at(0.36, radius + 0.05) + aside;
            self.tube(metal, &[(self.at(0.0, radius) + aside, 0.022), (pivot, 0.03)]);
            self.tube(
                chrome,
                &[
                    (self.at(0.04, radius + 0.02) + aside * 1.1, 0.022),
                    (self.at(0.16, seat - 0.10) + aside, 0.028),
                ],
            );
            // The bar sweeps back to its grips.
            let end = Vec3::new(grip.x - 0.08, side * (grip.y + 0.012), grip.z - 0.008);
            let bend = Vec3::new(grip.x, side * 0.5 * grip.y, grip.z);
            self.tube(metal, &[(head, 0.014), (bend, 0.013), (bend + 0.45 * (end - bend), 0.012)]);
            self.tube(dark, &[(bend + 0.4 * (end - bend), 0.018), (end, 0.018)]);
            let peg = self.at(0.48, 0.48 * radius);
            self.tube(dark, &[(peg + Vec3::Y * side * 0.12, 0.012), (peg + Vec3::Y * side * 0.24, 0.016)]);
        }
        let steps = if self.detail == Detail::Full { 8 } else { 3 };
        mudguard(self.b, paint, axle, radius + 0.018, 0.075, [0.15, 0.40], steps);
        let rear = self.at(0.0, radius);
        mudguard(self.b, paint, rear, radius + 0.02, 0.09, [0.16, 0.47], steps);
    }

    /// The head lamp with its lens at a place, tail lamp, plate and blinkers.
    fn lamps(&mut self, lens_m: f32, face: Vec3) {
        let lamp = |bits: u32, rgb: [f32; 3]| MeshPart::new(Tag::Motorcycle, Surface::Lamp(bits), rgb);
        let head = lamp(lights::LOW_BEAM | lights::HIGH_BEAM | lights::POSITION, [0.85; 3]);
        let housing = self.parts.metal;
        let sides = self.sides(12);
        self.tube(
            housing,
            &[(face - Vec3::X * 0.14, 0.4 * lens_m), (face - Vec3::X * 0.08, lens_m), (face, 1.08 * lens_m)],
        );
        let lens =
            |c: f32, s: f32| face + Vec3::new(0.006 + 0.02 * (1.0 - c * c - s * s), lens_m * c, lens_m * s);
        disc(self.b, head, sides, Vec3::X * -0.05, &lens);
        // The tail lamp, and the plate at the very end.
        let tail_z = self.p.seat - 0.05;
        let tail = Vec3::new(self.p.back + 0.07, 0.0, tail_z);
        let red = lamp(lights::POSITION | lights::BRAKE, [0.55, 0.03, 0.03]);
        self.b.tapered(
            red,
            tail - Vec3::new(0.035, 0.06, 0.025),
            tail + Vec3::new(0.05, 0.06, 0.03),
            0.8,
            0.8,
        );
        let plate = MeshPart::new(Tag::Motorcycle, Surface::Reflector, SHEETING);
        let dark = self.parts.plastic;
        let back = Vec3::new(self.p.back, 0.0, tail_z - 0.19);
        self.b.cuboid(plate, back - Vec3::new(0.0, 0.09, 0.07), back + Vec3::new(0.012, 0.09, 0.07));
        let hanger =
            [(back + Vec3::new(0.02, 0.0, 0.02), 0.012), (tail + Vec3::new(0.04, 0.0, -0.02), 0.018)];
        self.tube(dark, &hanger);
        for (bits, side) in [(lights::BLINK_LEFT, 1.0), (lights::BLINK_RIGHT, -1.0)] {
            let amber = lamp(bits, [0.75, 0.35, 0.05]);
            for at in [tail + Vec3::new(0.02, side * 0.15, 0.0), face + Vec3::new(-0.09, side * 0.17, -0.02)]
            {
                let (rings, around) = if self.detail == Detail::Full { (5, 8) } else { (2, 4) };
                self.b.ellipsoid(amber, at, Vec3::new(0.028, 0.035, 0.024), rings, around);
                if self.detail == Detail::Full {
                    let root = Vec3::new(at.x, side * 0.03, at.z);
                    self.tube(dark, &[(root, 0.009), (at - Vec3::Y * side * 0.02, 0.009)]);
                }
            }
        }
    }

    /// Two, and what makes the machine as high as it is.
    fn mirrors(&mut self) {
        let (grip, dark) = (self.p.grip, self.parts.dark);
        for side in [1.0, -1.0] {
            let at = Vec3::new(grip.x + 0.01, side * 0.72 * grip.y, (grip.z + 0.09).min(self.p.top - 0.045));
            let (rings, around) = if self.detail == Detail::Full { (5, 8) } else { (2, 4) };
            self.b.ellipsoid(dark, at, Vec3::new(0.02, 0.065, 0.045), rings, around);
            self.tube(dark, &[(Vec3::new(grip.x, side * 0.55 * grip.y, grip.z - 0.02), 0.008), (at, 0.008)]);
        }
    }
}
