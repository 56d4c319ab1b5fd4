//! The ground that is taken when a scene begins.

use std::collections::BTreeMap;

use frames::math::sin_cos;
use frames::{Object, Pose, World};
use nalgebra::Point3;
use schema::ActorKind;
use schema::tables::ActorRow;

/// Free space around a vehicle at the start, metres.
const CLEARANCE_M: f64 = 0.8;
/// Free space to parked vehicles, metres: their lanes are beside.
const PARKED_CLEARANCE_M: f64 = 0.1;
/// Vehicles farther above each other than this are on different decks, metres.
const DECK_M: f64 = 3.0;

/// Rectangles that are taken, in square cells, each with the space that is to be left around it, metres.
#[derive(Default)]
pub(crate) struct Taken(BTreeMap<(i32, i32), Vec<(Footprint, f64)>>);

/// Middle, yaw and size.
pub(crate) type Footprint = (Point3<f64>, f64, [f64; 3]);

impl Taken {
    const CELL_M: f64 = 16.0;

    fn cell(point: &Point3<f64>) -> (i32, i32) {
        ((point.x / Self::CELL_M).floor() as i32, (point.y / Self::CELL_M).floor() as i32)
    }

    /// Whether a body has the space around it that it needs.
    pub(crate) fn is_free(&self, at: &Point3<f64>, yaw: f64, size: [f64; 3]) -> bool {
        let (x, y) = Self::cell(at);
        let near = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (x + dx, y + dy)));
        near.filter_map(|c| self.0.get(&c))
            .flatten()
            .all(|(other, clearance_m)| apart(&(*at, yaw, size), other, *clearance_m))
    }

    /// The parked vehicles of a scene.
    pub(crate) fn parked(fixed: &[ActorRow]) -> Self {
        let mut taken = Self::default();
        for actor in fixed.iter().filter(|a| a.kind == ActorKind::Parked) {
            let pose = Pose::<World, Object>::from_xyz_wxyz(actor.xyz_m, actor.quaternion);
            let size = [actor.length_m, actor.width_m, actor.height_m];
            taken.add((Point3::from(actor.xyz_m), pose.yaw(), size), PARKED_CLEARANCE_M);
        }
        taken
    }

    pub(crate) fn insert(&mut self, at: Point3<f64>, yaw: f64, size: [f64; 3]) {
        self.add((at, yaw, size), CLEARANCE_M);
    }

    fn add(&mut self, print: Footprint, clearance_m: f64) {
        self.0.entry(Self::cell(&print.0)).or_default().push((print, clearance_m));
    }
}

/// Whether two footprints are at least so far apart along or across the first one, or on different decks.
pub(crate) fn apart(one: &Footprint, other: &Footprint, clearance_m: f64) -> bool {
    let ((at, yaw, size), (other, other_yaw, other_size)) = (one, other);
    let away = other - at;
    let (sin, cos) = sin_cos(*yaw);
    let (ahead, left) = (away.x * cos + away.y * sin, away.y * cos - away.x * sin);
    let (sin_d, cos_d) = sin_cos(other_yaw - yaw);
    let half = |own: f64, along: f64, across: f64| 0.5 * (own + along + across) + clearance_m;
    away.z.abs() > DECK_M
        || ahead.abs() > half(size[0], other_size[0] * cos_d.abs(), other_size[1] * sin_d.abs())
        || left.abs() > half(size[1], other_size[0] * sin_d.abs(), other_size[1] * cos_d.abs())
}
