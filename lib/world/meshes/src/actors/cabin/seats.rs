//! Seats, dashboard, steering wheel, poles: closed solids.

use crate::solids::{MeshBuilder, circle};
use catalogue::Seats;
use frames::math::f32::sin_cos;
use glam::Vec3;
use schema::geometry::{MeshPart, Surface};

use super::plan::{Plan, Row};
use crate::actors::hull::Hull;

/// What things in a cabin are made of.
pub(crate) struct Stuffs {
    pub(crate) cloth: MeshPart,
    pub(crate) plastic: MeshPart,
    pub(crate) metal: MeshPart,
}

/// A slab from below to above with bevelled edges: places of its middle with half depth and half width.
fn cushion(b: &mut MeshBuilder, part: MeshPart, line: &[(Vec3, f32, f32)], forward: Vec3) {
    let rings: Vec<Vec<Vec3>> = line
        .iter()
        .map(|(at, deep, wide)| {
            [(1.0, -0.75), (1.0, 0.75), (0.0, 1.0), (-1.0, 0.75), (-1.0, -0.75), (0.0, -1.0)]
                .map(|(d, w)| *at + forward * (d * deep) + Vec3::Y * (w * wide))
                .to_vec()
        })
        .collect();
    b.loft(&rings, |_, _| part, [part; 2]);
}

/// A seat for hips at a place, leaning back, so wide; with head rests at places across.
pub(crate) fn seat(b: &mut MeshBuilder, s: &Stuffs, hips: Vec3, half_y: f32, lean_rad: f32, heads: &[f32]) {
    let low = hips - Vec3::Z * 0.20;
    // The cushion lies: its rings go from behind to the front.
    let along = |x: f32, z: f32, high: f32, wide: f32| (low + Vec3::new(x, 0.0, z), high, wide * half_y);
    cushion(
        b,
        s.cloth,
        &[along(-0.14, 0.02, 0.05, 0.92), along(0.10, 0.05, 0.075, 1.0), along(0.36, 0.08, 0.05, 0.94)],
        -Vec3::Z,
    );
    let (sin, cos) = sin_cos(lean_rad + 0.10);
    let (up, forward) = (Vec3::new(-sin, 0.0, cos), Vec3::new(cos, 0.0, sin));
    let foot = hips + Vec3::new(-0.13, 0.0, -0.12);
    cushion(
        b,
        s.cloth,
        &[
            (foot, 0.05, 0.95 * half_y),
            (foot + up * 0.30, 0.075, half_y),
            (foot + up * 0.64, 0.04, 0.86 * half_y),
        ],
        forward,
    );
    for y in heads {
        let at = foot + up * 0.66 + Vec3::Y * *y;
        cushion(b, s.cloth, &[(at, 0.045, 0.12), (at + up * 0.17, 0.035, 0.11)], forward);
    }
}

/// What a seat stands on.
fn base(b: &mut MeshBuilder, s: &Stuffs, hips: Vec3, half_y: f32, floor_z: f32) {
    let (min, max) = (Vec3::new(-0.12, -0.8 * half_y, 0.0), Vec3::new(0.30, 0.8 * half_y, 0.0));
    let top = hips.z - 0.20;
    if top > floor_z + 0.03 {
        b.cuboid(s.plastic, (hips + min).with_z(floor_z), (hips + max).with_z(top));
    }
}

/// A simple double seat of a bus, towards the front.
/// It hangs on the wall.
fn bus_seat(b: &mut MeshBuilder, s: &Stuffs, hips: Vec3) {
    let half_y = 0.43;
    let low = hips.z - 0.16;
    b.cuboid(
        s.cloth,
        Vec3::new(hips.x - 0.16, hips.y - half_y, low),
        Vec3::new(hips.x + 0.28, hips.y + half_y, low + 0.09),
    );
    let slab = |back_m: f32, z: f32, half_y: f32| -> Vec<Vec3> {
        [(-0.03, -1.0), (0.03, -1.0), (0.03, 1.0), (-0.03, 1.0)]
            .map(|(x, side)| hips + Vec3::new(x - back_m, side * half_y, z))
            .to_vec()
    };
    b.loft(&[slab(0.16, -0.10, half_y), slab(0.29, 0.60, 0.92 * half_y)], |_, _| s.cloth, [s.cloth; 2]);
}

/// All seats of a plan.
pub(crate) fn rows(b: &mut MeshBuilder, s: &Stuffs, plan: &Plan, hull: &Hull) {
    let bus = plan.rows.iter().any(|row| matches!(row.seats, Seats::Aisle { .. }));
    if bus {
        let [x, y, z] = plan.driver;
        let hips = Vec3::new(x, y, z);
        seat(b, s, hips, 0.24, plan.lean_rad, &[0.0]);
        base(b, s, hips, 0.24, plan.floor_z);
    }
    for (k, Row { x, z, seats }) in plan.rows.iter().copied().enumerate() {
        let hips = |y: f32| Vec3::new(x, y, z);
        match seats {
            Seats::Two(aside) => {
                for y in [aside, -aside] {
                    seat(b, s, hips(y), 0.25, plan.lean_rad, &[0.0]);
                    base(b, s, hips(y), 0.25, plan.floor_z);
                }
            }
            Seats::Bench(half_y) => {
                seat(b, s, hips(0.0), half_y, plan.lean_rad, &[0.62 * half_y, 0.0, -0.62 * half_y]);
                base(b, s, hips(0.0), half_y, plan.floor_z);
            }
            Seats::Aisle { right } => {
                let aside = hull.half_width - 0.52;
                for y in [Some(aside), right.then_some(-aside)].into_iter().flatten() {
                    bus_seat(b, s, hips(y));
                }
                if k % 2 == 0 || !right {
                    let foot = Vec3::new(x - 0.2, if k % 4 == 0 { 0.32 } else { -0.32 }, plan.floor_z);
                    b.bar(s.metal, foot, foot.with_z(hull.style.roof_z * hull.height - 0.12), [0.018; 2], 5);
                }
            }
        }
    }
}

/// The dashboard from side to side, bent as the windscreen is.
pub(crate) fn dashboard(b: &mut MeshBuilder, part: MeshPart, plan: &Plan, hull: &Hull) {
    let (x, z, deep) = (plan.cowl_x, plan.cowl_z, plan.dash_m);
    let bow = 0.85 * hull.style.glass_bow_m[0];
    // Against the way across, counter-clockwise.
    let ring = |share: f32| -> Vec<Vec3> {
        let ahead = bow * (1.0 - share.abs() * share * share);
        let y = share * hull.half_width;
        [
            (x + ahead, plan.floor_z),
            (x - 0.62 * deep, plan.floor_z + 0.10),
            (x - 0.92 * deep, z - 0.30),
            (x - deep, z - 0.08),
            (x - 0.80 * deep, z - 0.005),
            (x + ahead, z - 0.02),
        ]
        .map(|(x, z)| Vec3::new(x, y, z))
        .to_vec()
    };
    let rings: Vec<Vec<Vec3>> = [-1.0, -0.6, 0.0, 0.6, 1.0].map(ring).to_vec();
    b.loft(&rings, |_, _| part, [part; 2]);
}

/// The middle of the steering wheel, and the way from its hub to the driver.
pub(crate) fn wheel_at(plan: &Plan) -> (Vec3, Vec3) {
    let [x, y, z] = plan.driver;
    let (s, c) = sin_cos(plan.wheel[1]);
    let ahead = (plan.cowl_x - plan.dash_m - 0.06 - x).min(0.44);
    (Vec3::new(x + ahead, y, z + 0.26 + 0.04 * s), Vec3::new(-c, 0.0, s))
}

/// The steering wheel with its column.
pub(crate) fn steering_wheel(b: &mut MeshBuilder, s: &Stuffs, plan: &Plan) {
    let (at, towards) = wheel_at(plan);
    let (across, up) = (Vec3::Y, towards.cross(Vec3::Y) * -1.0);
    let part = b.part_index(s.plastic);
    let (radius, thick) = (plan.wheel[0], 0.017);
    let rings: Vec<Vec<u32>> = circle(12)
        .map(|(c, n)| {
            let out = across * c + up * n;
            circle(4).map(|(d, t)| b.vertex(at + out * (radius + thick * d) + towards * thick * t)).collect()
        })
        .collect();
    for (k, from) in rings.iter().enumerate() {
        let to = &rings[(k + 1) % rings.len()];
        for j in 0..4 {
            let n = (j + 1) % 4;
            b.quad(part, [from[j], from[n], to[n], to[j]]);
        }
    }
    b.bar(s.plastic, at - towards * 0.20, at - towards * 0.01, [0.05, 0.06], 6);
    b.bar(s.plastic, at - across * radius, at + across * radius, [0.014; 2], 4);
    b.bar(s.plastic, at, at - up * radius, [0.016; 2], 4);
}

/// The mirror below the roof's front edge.
pub(crate) fn inner_mirror(b: &mut MeshBuilder, part: MeshPart, hull: &Hull) {
    let (cowl, roof) = (hull.style.cowl.0, hull.style.roof.0);
    let at = hull.top(&hull.section(roof - 0.16 * (roof - cowl)), 0.0) - Vec3::new(0.10, 0.0, 0.09);
    b.cuboid(part, at - Vec3::new(0.012, 0.12, 0.03), at + Vec3::new(0.012, 0.12, 0.03));
}

/// The stuffs of a tag and a colour of the seats.
impl Stuffs {
    pub(crate) fn new(stuff: impl Fn(Surface, [f32; 3]) -> MeshPart, seats: [f32; 3]) -> Self {
        Self {
            cloth: stuff(Surface::Cloth, seats),
            plastic: stuff(Surface::Rubber, [0.03, 0.03, 0.031]),
            metal: stuff(Surface::Metal, [0.5, 0.42, 0.1]),
        }
    }
}
