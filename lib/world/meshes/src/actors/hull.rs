//! Where the skin of a cabin is: cars, vans, buses and the cabs of lorries, by a few curves along them.
//!
//! A place along the side is a share `f`, 0 at the nose's corner and 1 at the tail's. Up the side goes `row`:
//! 0 is the lower edge, 1 the belt below the windows, 2 the edge of the roof (of bonnet and boot where there
//! is no roof). Across the top goes `s`, from 1 on the left to -1 on the right.

use crate::solids::{chain_at, curve_at};
use catalogue::Shape;
use glam::Vec3;

/// A cabin's skin.
#[derive(Clone, Debug)]
pub(crate) struct Hull {
    pub(crate) style: Shape,
    /// Tail and nose, metres.
    pub(crate) x: [f32; 2],
    pub(crate) half_width: f32,
    pub(crate) height: f32,
    /// Wheels that stand in it.
    pub(crate) axles: Vec<f32>,
    pub(crate) radius: f32,
    /// Radius of the arches above them.
    pub(crate) arch: f32,
    top: [(f32, f32); 11],
    belt: [(f32, f32); 5],
    crown: [(f32, f32); 6],
    edge_width: [(f32, f32); 6],
    bow: [(f32, f32); 6],
}

/// The outline across at one place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Section {
    pub(crate) f: f32,
    /// Half width.
    pub(crate) wide: f32,
    pub(crate) low: f32,
    pub(crate) belt_z: f32,
    /// The edge of the roof.
    pub(crate) edge: (f32, f32),
    pub(crate) top_z: f32,
    bow_m: f32,
}

/// How wide the side is at shares of the belt's height.
const SIDE: [(f32, f32); 6] =
    [(0.15, 0.925), (0.26, 0.972), (0.46, 1.0), (0.62, 0.998), (0.80, 0.988), (1.0, 0.0)];

impl Hull {
    /// A cabin from tail to nose, with wheels of a radius under it.
    pub(crate) fn new(
        mut style: Shape,
        x: [f32; 2],
        [half_width, height]: [f32; 2],
        axles: &[f32],
        radius: f32,
    ) -> Self {
        let arch = 1.12 * radius + 0.012;
        // Nose and tail are no rounder than the arches beside them let them be.
        let ahead = axles.first().map_or(f32::MAX, |axle| x[1] - axle - arch - 0.02);
        let behind = axles.last().map_or(f32::MAX, |axle| axle - x[0] - arch - 0.02);
        style.bow_m = [style.bow_m[0].min(ahead).max(0.02), style.bow_m[1].min(behind).max(0.02)];
        let roof_z = style.roof_z;
        let ((roof0, roof1), cowl, deck) = (style.roof, style.cowl, style.deck);
        let between = |a: (f32, f32), b: (f32, f32), t: f32, rise: f32| {
            (a.0 + (b.0 - a.0) * t, a.1 + (b.1 - a.1) * t + rise)
        };
        let [front, rear] = style.falls.map(|fall| roof_z - fall);
        let (front, rear) = ((roof0, front), (roof1, rear));
        let (nose, tail) = ((0.0, style.nose_z), (1.0, style.tail_z));
        Self {
            style,
            x,
            half_width,
            height,
            axles: axles.to_vec(),
            radius,
            arch,
            top: [
                nose,
                between(nose, cowl, 0.5, 0.10 * (cowl.1 - nose.1)),
                between(nose, cowl, 0.94, 0.0),
                cowl,
                between(cowl, front, 0.5, 0.012),
                front,
                (0.55 * roof0 + 0.45 * roof1, roof_z),
                rear,
                between(rear, deck, 0.5, 0.012),
                deck,
                tail,
            ],
            belt: [
                (0.0, style.belt[0] * style.nose_z),
                (0.6 * cowl.0, style.belt[0] * (0.4 * style.nose_z + 0.6 * cowl.1)),
                (cowl.0, 0.955 * cowl.1),
                (deck.0, 0.965 * deck.1),
                (1.0, style.belt[1] * style.tail_z),
            ],
            crown: [
                (0.0, 0.035),
                (0.9 * cowl.0, 0.035),
                (roof0, style.crown_m),
                (roof1, style.crown_m),
                (deck.0, 0.03),
                (1.0, 0.03),
            ],
            edge_width: [
                (0.0, 0.80),
                (cowl.0, 0.825_f32.max(style.roof_width)),
                (roof0, style.roof_width + 0.015),
                (roof1, style.roof_width),
                (deck.0, 0.82_f32.max(style.roof_width - 0.02)),
                (1.0, 0.80_f32.max(style.roof_width - 0.06)),
            ],
            bow: [
                (0.0, style.bow_m[0]),
                (cowl.0, style.glass_bow_m[0]),
                (roof0, 0.6 * style.glass_bow_m[0]),
                (roof1, -0.5 * style.glass_bow_m[1]),
                (deck.0, -style.glass_bow_m[1]),
                (1.0, -style.bow_m[1]),
            ],
        }
    }

    /// x of the nose's and the tail's corner.
    fn corners(&self) -> [f32; 2] {
        [self.x[1] - self.style.bow_m[0], self.x[0] + self.style.bow_m[1]]
    }

    /// x of a place along the side.
    pub(crate) fn x_of(&self, f: f32) -> f32 {
        let [nose, tail] = self.corners();
        nose + (tail - nose) * f
    }

    /// The place along the side at some x.
    pub(crate) fn f_of(&self, x: f32) -> f32 {
        let [nose, tail] = self.corners();
        (x - nose) / (tail - nose)
    }

    /// A length along the side as a share.
    pub(crate) fn share(&self, length_m: f32) -> f32 {
        let [nose, tail] = self.corners();
        length_m / (nose - tail)
    }

    /// Height of the lower edge, of arches that of their upper half's edge.
    fn low(&self, f: f32) -> f32 {
        let x = self.x_of(f);
        // Nose and tail are cut away below.
        let rise = 0.05 * (1.0 - f / 0.07).max(0.0) + 0.08 * (1.0 - (1.0 - f) / 0.10).max(0.0);
        let mut low = self.style.clearance * self.height + rise.min(0.5 * self.style.clearance * self.height);
        for axle in &self.axles {
            let d = (x - axle).abs();
            if d <= 1.002 * self.arch {
                low = low.max(self.radius + (self.arch * self.arch - d * d).max(0.0).sqrt());
            }
        }
        low
    }

    /// The outline across at a place.
    pub(crate) fn section(&self, f: f32) -> Section {
        let [nose_wide, tail_wide] = self.style.ends_width;
        let plan = [
            (0.0, nose_wide),
            (0.05, 0.45 * nose_wide + 0.55),
            (0.14, 0.996),
            (0.22, 1.0),
            (0.84, 1.0),
            (0.91, 0.996),
            (0.965, 0.4 * tail_wide + 0.6),
            (1.0, tail_wide),
        ];
        let low = self.low(f);
        let top_z = curve_at(&self.top, f) * self.height;
        let crown = chain_at(&self.crown, f);
        let belt_z = (curve_at(&self.belt, f) * self.height).min(top_z - crown - 0.02).max(low + 0.035);
        let edge_z = (top_z - crown).max(belt_z + 0.015);
        let wide = self.half_width * curve_at(&plan, f);
        Section {
            f,
            wide,
            low,
            belt_z,
            edge: (wide * curve_at(&self.edge_width, f), edge_z),
            top_z: top_z.max(edge_z + 0.005),
            bow_m: curve_at(&self.bow, f),
        }
    }

    /// How far the skin is moved along x at an end's height.
    pub(crate) fn lean(&self, f: f32, z: f32) -> f32 {
        let share = |end: f32| {
            let near = (1.0 - end / 0.085).max(0.0);
            near * near
        };
        let Shape { nose_z, tail_z, nose_lean, tail_lean, .. } = self.style;
        curve_at(tail_lean, z / (tail_z * self.height)) * share(1.0 - f)
            - curve_at(nose_lean, z / (nose_z * self.height)) * share(f)
    }

    /// Half width of the side at a height below the belt.
    pub(crate) fn aside(&self, at: &Section, z: f32) -> f32 {
        let mut side = SIDE;
        side[5].1 = 1.0 - self.style.tuck;
        at.wide * curve_at(&side, (z / at.belt_z).min(1.0))
    }

    /// `(y, z)` of a row on the left.
    fn across(&self, at: &Section, row: f32) -> (f32, f32) {
        if row < 0.0 {
            let (y, _) = self.across(at, 0.0);
            return (y - 0.06_f32.min(0.1 * at.wide), at.low);
        }
        if row <= 1.0 {
            let base = self.style.clearance * self.height;
            let up = at.low + (0.012 + 0.3 * row * (at.belt_z - at.low)).min(at.belt_z - at.low);
            let z = (base + row * (at.belt_z - base)).max(up).min(at.belt_z);
            return (self.aside(at, z), z);
        }
        // From the belt to the roof's edge, bent outwards a little.
        let (t, belt) = (row - 1.0, (self.aside(at, at.belt_z), at.belt_z));
        let (dy, dz) = (at.edge.0 - belt.0, at.edge.1 - belt.1);
        let bulge = 0.045 * dy.abs().min(dz.abs()) + 0.05 * dz.abs().min(0.2) + 0.02 * dy.abs();
        let long = (dy * dy + dz * dz).sqrt().max(1e-4);
        let out = bulge * 4.0 * t * (1.0 - t) / long;
        (belt.0 + t * dy + out * dz, belt.1 + t * dz - out * dy)
    }

    /// A place on the side.
    pub(crate) fn side(&self, at: &Section, row: f32, left: bool) -> Vec3 {
        let (y, z) = self.across(at, row);
        Vec3::new(self.x_of(at.f) + self.lean(at.f, z), if left { y } else { -y }, z)
    }

    /// A place on the side by its height, below the belt; `f` along the side.
    pub(crate) fn side_at(&self, f: f32, z: f32, left: bool) -> Vec3 {
        let at = self.section(f);
        let y = self.aside(&at, z);
        Vec3::new(self.x_of(f) + self.lean(f, z), if left { y } else { -y }, z)
    }

    /// A place on bonnet, windscreen, roof or boot.
    pub(crate) fn top(&self, at: &Section, s: f32) -> Vec3 {
        let (edge, s2) = (at.edge, s * s);
        let z = edge.1 + (at.top_z - edge.1) * (1.0 - s2 * s.abs().sqrt());
        let x = self.x_of(at.f) + self.lean(at.f, z) + at.bow_m * (1.0 - s2 * s.abs());
        Vec3::new(x, s * edge.0, z)
    }

    /// A place on the nose or the tail, `s` from 1 at the left corner to -1.
    pub(crate) fn end(&self, nose: bool, s: f32, z: f32) -> Vec3 {
        let at = self.section(if nose { 0.0 } else { 1.0 });
        let y = s * self.aside(&at, z.min(at.belt_z));
        let s = s.abs().min(1.0);
        let x = self.x_of(at.f) + at.bow_m * (1.0 - s * s * s) + self.lean(at.f, z);
        Vec3::new(x, y, z)
    }
}
