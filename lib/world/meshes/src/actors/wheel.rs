//! Wheels: tyre, rim with spokes, turning about y; the outer face looks to +y.

use std::sync::Arc;

use catalogue::Rim;
use glam::Vec3;
use schema::Tag;
use schema::geometry::{MeshPart, Surface, TriMesh};

use crate::actors::pieces::{Joint, Piece};
use crate::solids::{Detail, MeshBuilder, circle};

const TYRE: [f32; 3] = [0.022, 0.022, 0.023];

fn ring(radius: f32, y: f32, sides: usize) -> Vec<Vec3> {
    circle(sides).map(|(c, s)| Vec3::new(radius * s, y, radius * c)).collect()
}

/// A car's or lorry's wheel: closed, `width` wide about y = 0.
pub(crate) fn disc(tag: Tag, radius: f32, width: f32, rim: Rim, detail: Detail) -> TriMesh {
    let tyre = MeshPart::new(tag, Surface::Rubber, TYRE);
    let bright = match rim {
        Rim::Dark(_) => MeshPart::new(tag, Surface::Metal, [0.09, 0.09, 0.095]),
        Rim::Heavy => MeshPart::new(tag, Surface::Metal, [0.42, 0.42, 0.43]),
        _ => MeshPart::new(tag, Surface::Metal, [0.62, 0.63, 0.65]),
    };
    let gap = MeshPart::new(tag, Surface::Metal, [0.035, 0.035, 0.037]);
    let half = 0.5 * width;
    // Heavy wheels have a high tyre.
    let edge = if rim == Rim::Heavy { 0.58 } else { 0.69 } * radius;
    let mut b = MeshBuilder::new();
    if detail != Detail::Full {
        let sides = if detail == Detail::Half { 12 } else { 8 };
        let rings = [(radius, -half), (radius, half), (edge, half)].map(|(r, y)| ring(r, y, sides));
        b.loft(&rings, |_, _| tyre, [tyre, gap]);
        if detail == Detail::Half {
            // Every other piece shows that it turns.
            for pair in ring(0.94 * edge, 0.0, 12).chunks(2) {
                spoke(&mut b, bright, half, pair);
            }
        }
        return b.finish();
    }
    // A lorry has more of them.
    let sides = if rim == Rim::Heavy { 18 } else { 24 };
    let profile = [
        (0.60 * radius, -0.9 * half),
        (0.94 * radius, -half),
        (radius, -0.76 * half),
        (radius, 0.76 * half),
        (0.94 * radius, half),
        (edge, 0.90 * half),
        (0.92 * edge, 0.84 * half),
        (0.88 * edge, 0.1 * half),
    ];
    let rings: Vec<Vec<Vec3>> = profile.iter().map(|(r, y)| ring(*r, *y, sides)).collect();
    let shell = |k: usize, _: usize| match k {
        0..5 => tyre,
        5 => bright,
        _ => gap,
    };
    b.loft(&rings, shell, [gap; 2]);
    match rim {
        Rim::Spokes(n) | Rim::Dark(n) => spokes(&mut b, bright, edge, half, n),
        Rim::Steel => cover(&mut b, bright, gap, edge, half),
        Rim::Heavy => hub(&mut b, bright, gap, edge, half),
    }
    b.finish()
}

/// A wedge from the hub to the rim that stands out of the face a little.
fn spoke(b: &mut MeshBuilder, part: MeshPart, half: f32, rim: &[Vec3]) {
    let index = b.part_index(part);
    let out = Vec3::Y * (half + 0.004);
    let [hub, from, to, back] =
        [out, rim[0] + out, rim[1] + out, 0.5 * (rim[0] + rim[1]) * 0.6 + Vec3::Y * 0.5 * half]
            .map(|p| b.vertex(p));
    for corners in [[hub, from, to], [from, hub, back], [to, from, back], [hub, to, back]] {
        b.triangle(index, corners);
    }
}

/// Spokes between hub and rim, dished a little.
fn spokes(b: &mut MeshBuilder, part: MeshPart, edge: f32, half: f32, count: usize) {
    let wide = (0.62 * edge / count as f32).min(0.15 * edge);
    for (c, s) in circle(count) {
        let (out, across) = (Vec3::new(s, 0.0, c), Vec3::new(c, 0.0, -s));
        let section = |r: f32, w: f32, y: [f32; 2]| -> Vec<Vec3> {
            [(w, y[0]), (0.7 * w, y[1]), (-0.7 * w, y[1]), (-w, y[0])]
                .map(|(a, y)| out * r + across * a + Vec3::Y * y)
                .to_vec()
        };
        let rings = [
            section(0.10 * edge, 0.9 * wide, [0.3 * half, 0.70 * half]),
            section(0.94 * edge, 1.1 * wide, [0.45 * half, 0.86 * half]),
        ];
        b.loft(&rings, |_, _| part, [part; 2]);
    }
    let rings = [
        ring(0.24 * edge, 0.2 * half, 12),
        ring(0.23 * edge, 0.72 * half, 12),
        ring(0.15 * edge, 0.79 * half, 12),
    ];
    b.loft(&rings, |_, _| part, [part; 2]);
}

/// A disc of steel with slots near its edge, and a cap.
fn cover(b: &mut MeshBuilder, part: MeshPart, gap: MeshPart, edge: f32, half: f32) {
    let rings: Vec<Vec<Vec3>> =
        [(0.93, 0.3), (0.92, 0.78), (0.66, 0.84), (0.30, 0.70), (0.26, 0.82), (0.10, 0.86)]
            .map(|(r, y)| ring(r * edge, y * half, 16))
            .to_vec();
    b.loft(&rings, |k, j| if k == 1 && j % 3 == 0 { gap } else { part }, [part; 2]);
}

/// A dished disc with a ring of bolts about a hub that stands out.
fn hub(b: &mut MeshBuilder, part: MeshPart, gap: MeshPart, edge: f32, half: f32) {
    let rings: Vec<Vec<Vec3>> = [(0.90, 0.1), (0.89, 0.35), (0.70, 0.30), (0.36, 0.5), (0.30, 0.92)]
        .map(|(r, y)| ring(r * edge, y * half, 12))
        .to_vec();
    b.loft(&rings, |k, j| if k == 1 && j % 4 < 2 { gap } else { part }, [part; 2]);
    for (c, s) in circle(5) {
        let at = Vec3::new(0.5 * edge * s, 0.42 * half, 0.5 * edge * c);
        b.bar(gap, at, at + Vec3::Y * 0.04, [0.017, 0.014], 3);
    }
}

/// A bicycle's or motorcycle's wheel: a tyre ring with spokes one can see through, wide ones of a motorcycle.
pub(crate) fn spoked(tag: Tag, radius: f32, width: f32, spokes: usize, detail: Detail) -> TriMesh {
    let sides = match detail {
        Detail::Full => 28,
        Detail::Half => 16,
        Detail::Coarse => 8,
    };
    let tyre = MeshPart::new(tag, Surface::Rubber, TYRE);
    let metal = MeshPart::new(tag, Surface::Metal, [0.5, 0.5, 0.52]);
    let mut b = MeshBuilder::new();
    let (half, inner) = (0.5 * width, radius - 1.4 * width.min(0.3 * radius));
    let wide = width > 0.06;
    let bead = inner + 0.3 * (radius - inner);
    // Around the tyre's section, then the rim's.
    let section: &[(f32, f32, MeshPart)] = if detail == Detail::Full {
        &[
            (bead, -0.8 * half, tyre),
            (0.5 * (bead + radius), -half, tyre),
            (radius - 0.2 * half, -0.72 * half, tyre),
            (radius, 0.0, tyre),
            (radius - 0.2 * half, 0.72 * half, tyre),
            (0.5 * (bead + radius), half, tyre),
            (bead, 0.8 * half, metal),
            (inner, 0.6 * half, metal),
            (inner, -0.6 * half, metal),
        ]
    } else {
        &[(bead, -half, tyre), (radius, 0.0, tyre), (bead, half, metal), (inner, 0.0, metal)]
    };
    let rings: Vec<Vec<u32>> = section
        .iter()
        .map(|(r, y, _)| ring(*r, *y, sides).into_iter().map(|p| b.vertex(p)).collect())
        .collect();
    for (k, from) in rings.iter().enumerate() {
        let (to, part) = (&rings[(k + 1) % rings.len()], b.part_index(section[k].2));
        for j in 0..sides {
            let n = (j + 1) % sides;
            b.quad(part, [from[j], from[n], to[n], to[j]]);
        }
    }
    let shown = if detail == Detail::Coarse { spokes.min(4) } else { spokes };
    for (k, (c, s)) in circle(shown).enumerate() {
        let (out, aside) = (Vec3::new(c, 0.0, s), if k % 2 == 0 { 0.6 } else { -0.6 });
        if wide {
            b.bar(metal, Vec3::ZERO, out * (inner + 0.005), [0.030, 0.018], 5);
        } else {
            b.bar(metal, Vec3::Y * aside * half, out * (inner + 0.003), [0.0035; 2], 3);
        }
    }
    let hub = if wide { 0.045 } else { 0.022 };
    let end = Vec3::Y * if wide { 0.7 * half } else { half };
    b.bar(metal, -end, end, [hub; 2], 8);
    if wide && detail == Detail::Full {
        // The disc of the brake.
        let disc = Vec3::Y * 0.75 * half;
        b.bar(metal, disc, disc + Vec3::Y * 0.005, [0.34 * radius; 2], 20);
    }
    b.finish()
}

/// Where the wheels of a vehicle are, and how they look.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wheels<'a> {
    pub(crate) tag: Tag,
    /// x of the axles; the first one is steered.
    pub(crate) axles: &'a [f32],
    pub(crate) radius: f32,
    pub(crate) width: f32,
    /// y of the outer faces.
    pub(crate) outer_y: f32,
    pub(crate) rim: Rim,
}

impl Wheels<'_> {
    /// The largest angle that wheels are steered by, radians.
    pub(crate) const STEER_RAD: f32 = 0.9;

    /// The pieces, two to an axle.
    fn pieces(&self, detail: Detail) -> Vec<Piece> {
        let mesh = Arc::new(disc(self.tag, self.radius, self.width, self.rim, detail));
        let y = self.outer_y - 0.5 * self.width;
        let axles = self.axles.iter().enumerate();
        axles
            .flat_map(|(i, x)| {
                [(y, false), (-y, true)].map(|(y, right)| Piece {
                    mesh: Arc::clone(&mesh),
                    joint: Joint::Wheel { at: Vec3::new(*x, y, self.radius), steered: i == 0, right },
                })
            })
            .collect()
    }

    /// A body and its wheels. Far away these are one piece and neither turn nor steer.
    pub(crate) fn under(&self, body: MeshBuilder, detail: Detail) -> Vec<Piece> {
        let mut pieces = vec![Piece { mesh: Arc::new(body.finish()), joint: Joint::Fixed }];
        if detail == Detail::Coarse {
            let mut wheels = MeshBuilder::at(detail);
            self.stand(&mut wheels);
            pieces.push(Piece { mesh: Arc::new(wheels.finish()), joint: Joint::Standing });
        } else {
            pieces.extend(self.pieces(detail));
        }
        pieces
    }

    fn stand(&self, b: &mut MeshBuilder) {
        let tyre = MeshPart::new(self.tag, Surface::Rubber, TYRE);
        let rim = MeshPart::new(self.tag, Surface::Rubber, [0.07, 0.07, 0.072]);
        // Where there are six of them each has fewer corners.
        let sides = if self.axles.len() > 2 { 6 } else { 8 };
        for x in self.axles {
            for side in [1.0, -1.0] {
                let place = |y: f32| {
                    ring(self.radius, side * y, sides)
                        .into_iter()
                        .map(|p| p + Vec3::new(*x, 0.0, self.radius))
                        .collect()
                };
                let faces: [Vec<Vec3>; 2] = [place(self.outer_y - self.width), place(self.outer_y)];
                let rings = if side > 0.0 {
                    faces
                } else {
                    let [inner, outer] = faces;
                    [outer, inner]
                };
                let caps = if side > 0.0 { [tyre, rim] } else { [rim, tyre] };
                b.loft(&rings, |_, _| tyre, caps);
            }
        }
    }

    /// How near the middle the wheels of each axle come however they are steered: y, metres.
    pub(crate) fn inner_y(&self) -> Vec<f32> {
        let (s, c) = frames::math::f32::sin_cos(Self::STEER_RAD);
        let steered = 0.5 * self.width * (1.0 + c) + self.radius * s;
        (0..self.axles.len())
            .map(|i| if i == 0 { steered } else { self.width })
            .map(|reach| self.outer_y - reach - 0.02)
            .collect()
    }
}
