//! What is under and behind the cab of every lorry: a frame on axles, lamps.

use crate::solids::{Detail, MeshBuilder};
use catalogue::{Load, Shape};
use glam::Vec3;
use schema::geometry::{MeshPart, Surface};
use schema::{Tag, lights};

use crate::actors::car::Car;
use crate::actors::plates::SHEETING;
use crate::actors::pod::rounded;

/// A cab above its engine.
pub(crate) const CAB: Shape = Shape {
    nose_z: 0.47,
    cowl: (0.012, 0.485),
    roof: (0.17, 0.985),
    deck: (0.995, 0.50),
    tail_z: 0.49,
    windows: (0.13, 0.60),
    pillars: &[],
    roof_width: 0.90,
    clearance: 0.12,
    rear_glass: false,
    roof_z: 1.0,
    bow_m: [0.13, 0.01],
    glass_bow_m: [0.10, 0.01],
    tuck: 0.012,
    ends_width: [0.94, 0.985],
    nose_lean: &[(0.2, 0.04), (0.36, 0.0), (0.8, 0.008), (1.0, 0.03)],
    tail_lean: &[(0.0, 0.0), (1.0, 0.0)],
    belt: [0.97, 0.97],
    crown_m: 0.05,
    falls: [0.05, 0.01],
};

/// Width of tyres.
pub(crate) const TYRE_M: f32 = 0.34;

/// Height of the cab under a lorry's whole height, metres.
pub(crate) fn cab_top_m(load: Load, high_m: f32) -> f32 {
    match load {
        Load::Goods { .. } | Load::Curtain => 0.87 * high_m,
        Load::Flatbed | Load::Tipper => high_m - 0.08,
        Load::Dropside | Load::Sweeper | Load::Tow => high_m - 0.16,
        Load::Mixer => 0.78 * high_m,
        Load::Tank => 0.88 * high_m,
        Load::Refuse => 0.85 * high_m,
        Load::Fire => high_m - 0.25,
        Load::Ladder => high_m - 0.62,
        Load::Coupling => 0.80 * high_m,
        // Nothing drives it.
        Load::Container => high_m,
    }
}

/// Whether the fire brigade drives it.
pub(crate) fn is_fire(load: Load) -> bool {
    matches!(load, Load::Fire | Load::Ladder)
}

/// What is behind and under a cab.
pub(crate) struct Lorry<'a> {
    pub(crate) size: Vec3,
    pub(crate) cab: &'a Car<'a>,
    pub(crate) axles: &'a [f32],
    pub(crate) cab_back: f32,
    pub(crate) cab_top: f32,
    pub(crate) load: Load,
    /// Lower edge of the body.
    pub(crate) floor_m: f32,
}

impl Lorry<'_> {
    pub(crate) fn half(&self) -> Vec3 {
        0.5 * self.size
    }

    pub(crate) fn radius(&self) -> f32 {
        self.cab.wheels.radius
    }

    /// Lower edge and front of the body.
    pub(crate) fn body_floor(&self) -> f32 {
        self.floor_m
    }

    pub(crate) fn body_front(&self) -> f32 {
        self.cab_back - 0.12
    }

    /// Beams, axles, tanks, mudguards and bars against driving under it.
    pub(crate) fn frame(&self, b: &mut MeshBuilder, detail: Detail) {
        let (half, radius, looks) = (self.half(), self.radius(), &self.cab.looks);
        let metal = MeshPart::new(Tag::Truck, Surface::Metal, [0.07, 0.07, 0.075]);
        let (floor, front) = (self.body_floor() - 0.1, self.cab_back + 0.4);
        for y in [-0.4, 0.4] {
            b.cuboid(
                metal,
                Vec3::new(-half.x + 0.12, y - 0.06, floor - 0.28),
                Vec3::new(front, y + 0.06, floor),
            );
        }
        // The bar at the rear carries the lamps.
        b.cuboid(
            metal,
            Vec3::new(-half.x + 0.03, -half.y + 0.06, 0.46),
            Vec3::new(-half.x + 0.14, half.y - 0.06, 0.72),
        );
        if detail == Detail::Coarse {
            return;
        }
        for axle in &self.axles[1..] {
            let end = Vec3::new(*axle, half.y - 0.35, radius);
            b.bar(metal, end * Vec3::new(1.0, -1.0, 1.0), end, [0.09; 2], 6);
        }
        let (first, last) = (self.axles[1], self.axles[self.axles.len() - 1]);
        let room = [first + radius + 0.18, self.axles[0] - 1.15 * radius - 0.25];
        let tank = MeshPart::new(Tag::Truck, Surface::Metal, [0.45, 0.46, 0.47]);
        let long = 0.42 * (room[1] - room[0]);
        for (y, x, part) in [(1.0, room[1] - long, tank), (-1.0, room[1] - 0.7 * long, looks.trim)] {
            let (a, c) = (0.52 * y, (half.y - 0.16) * y);
            let x1 = if y > 0.0 { x + long } else { x + 0.7 * long };
            rounded(b, part, Vec3::new(x, a.min(c), 0.42), Vec3::new(x1, a.max(c), floor - 0.02), 0.06);
        }
        for side in [1.0, -1.0] {
            let y = side * (half.y - 0.07);
            for z in [0.52, 0.82] {
                let rail = Vec3::new(0.0, 0.02, 0.05);
                b.cuboid(metal, Vec3::new(room[0], y, z) - rail, Vec3::new(room[1], y, z) + rail);
            }
            if detail == Detail::Full {
                for share in [0.1, 0.5, 0.9] {
                    let x = room[0] + share * (room[1] - room[0]);
                    b.cuboid(
                        metal,
                        Vec3::new(x - 0.03, y - 0.03, 0.47),
                        Vec3::new(x + 0.03, y + 0.01, floor),
                    );
                }
                // Mudflaps behind the wheels.
                let flap = Vec3::new(last - radius - 0.10, y - side * 0.20, 0.0);
                b.cuboid(
                    looks.trim,
                    flap + Vec3::new(-0.01, -0.17, 0.22),
                    flap + Vec3::new(0.01, 0.17, floor),
                );
            }
        }
    }

    pub(crate) fn rear_lamps(&self, b: &mut MeshBuilder, detail: Detail) {
        let (half, looks) = (self.half(), &self.cab.looks);
        let amber = [0.75, 0.35, 0.05];
        let red = looks.lamp(lights::POSITION | lights::FOG, [0.55, 0.03, 0.03]);
        let brake = looks.lamp(lights::BRAKE, [0.6, 0.02, 0.02]);
        let white = looks.lamp(lights::REVERSE, [0.8; 3]);
        let (left, right) = (looks.lamp(lights::BLINK_LEFT, amber), looks.lamp(lights::BLINK_RIGHT, amber));
        let [z0, z1] = [0.52, 0.66];
        for (parts, y) in [
            ([red; 2], [0.80, 0.93]),
            ([brake; 2], [0.67, 0.79]),
            ([left, right], [0.57, 0.66]),
            ([white; 2], [0.49, 0.56]),
        ] {
            for (part, side) in parts.into_iter().zip([1.0, -1.0]) {
                let (a, c) = (y[0] * half.y * side, y[1] * half.y * side);
                let (min, max) = (Vec3::new(-half.x, a.min(c), z0), Vec3::new(-half.x + 0.08, a.max(c), z1));
                if detail == Detail::Full {
                    rounded(b, part, min, max, 0.012)
                } else {
                    b.cuboid(part, min, max)
                }
            }
        }
        if detail != Detail::Coarse {
            let back = Self::stuff(Surface::Reflector, [0.45, 0.02, 0.02]);
            let (x, y) = ([-half.x + 0.02, -half.x + 0.08], [0.49 * half.y, 0.93 * half.y]);
            Self::both(b, back, x, y, [0.47, 0.51]);
        }
        let plate = Self::stuff(Surface::Reflector, SHEETING);
        b.cuboid(plate, Vec3::new(-half.x + 0.01, -0.26, 0.54), Vec3::new(-half.x + 0.08, 0.26, 0.65));
    }

    /// A part of what is carried.
    pub(crate) fn stuff(surface: Surface, rgb: [f32; 3]) -> MeshPart {
        MeshPart::new(Tag::Truck, surface, rgb)
    }

    /// A box on each side: y counts outward from the middle.
    pub(crate) fn both(b: &mut MeshBuilder, part: MeshPart, x: [f32; 2], y: [f32; 2], z: [f32; 2]) {
        for side in [1.0, -1.0] {
            let (a, c) = (side * y[0], side * y[1]);
            b.cuboid(part, Vec3::new(x[0], a.min(c), z[0]), Vec3::new(x[1], a.max(c), z[1]));
        }
    }

    /// A box across the middle.
    pub(crate) fn across(b: &mut MeshBuilder, part: MeshPart, x: [f32; 2], half_y: f32, z: [f32; 2]) {
        b.cuboid(part, Vec3::new(x[0], -half_y, z[0]), Vec3::new(x[1], half_y, z[1]));
    }

    /// The floor that a load stands on, with a line along its sides that shows how long the lorry is (UN
    /// Regulation 104).
    pub(crate) fn deck(&self, b: &mut MeshBuilder) {
        let (half, floor) = (self.half(), self.body_floor());
        let metal = Self::stuff(Surface::Metal, [0.22, 0.22, 0.23]);
        Self::across(b, metal, [-half.x, self.body_front()], half.y - 0.004, [floor - 0.12, floor]);
        if self.load == Load::Sweeper {
            // Its sides are all machine.
            return;
        }
        let line = Self::stuff(Surface::Reflector, [0.72, 0.62, 0.04]);
        let along = [-half.x + 0.06, self.body_front() - 0.06];
        Self::both(b, line, along, [half.y - 0.06, half.y - 0.001], [floor - 0.088, floor - 0.032]);
    }

    /// The same between the wheels only, where what is carried is a machine.
    pub(crate) fn spine(&self, b: &mut MeshBuilder) {
        let (half, floor) = (self.half(), self.body_floor());
        let metal = Self::stuff(Surface::Metal, [0.12, 0.12, 0.125]);
        Self::across(b, metal, [-half.x + 0.05, self.body_front()], 0.62, [floor - 0.12, floor]);
    }

    /// Guards over the rear wheels.
    pub(crate) fn guards(&self, b: &mut MeshBuilder, detail: Detail) {
        let (half, radius, dark) = (self.half(), self.radius(), self.cab.looks.trim);
        let [behind, ahead] =
            [self.axles[self.axles.len() - 1] - 1.35 * radius, self.axles[1] + 1.35 * radius];
        let (y, z) = ([half.y - 0.46, half.y - 0.012], 2.0 * radius + 0.05);
        if detail == Detail::Coarse {
            return;
        }
        Self::both(b, dark, [behind, ahead], y, [z, z + 0.04]);
        if detail == Detail::Full {
            for x in [behind, ahead - 0.04] {
                Self::both(b, dark, [x, x + 0.04], y, [1.25 * radius, z + 0.02]);
            }
        }
    }

    /// Amber lamps on the roof of the cab.
    pub(crate) fn beacons(&self, b: &mut MeshBuilder, detail: Detail) {
        let amber = Self::stuff(Surface::Plain, [0.80, 0.32, 0.02]);
        let (x, low) = (self.half().x - 1.0, self.cab_top - 0.05);
        if detail == Detail::Coarse {
            Self::both(b, amber, [x - 0.07, x + 0.07], [0.33, 0.47], [low, self.size.z]);
            return;
        }
        Self::across(b, self.cab.looks.trim, [x - 0.08, x + 0.08], 0.52, [low, low + 0.05]);
        for y in [-0.40, 0.40] {
            let foot = Vec3::new(x, y, low + 0.04);
            b.stack(amber, &[(foot, 0.075, 0.075), (foot.with_z(self.size.z), 0.06, 0.06)], 8);
        }
    }
}
