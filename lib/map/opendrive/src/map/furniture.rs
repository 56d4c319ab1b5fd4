//! Objects and crosswalks in the world.

use frames::{Object as ObjectFrame, Pose, World};
use nalgebra::{Isometry3, Point3, Vector3};

use super::{Crosswalk, Map, ObjectInfo, OutlineInfo};
use crate::geometry::Surface;
use crate::model::{Corner, Object, Outline, Repeat};

/// Most copies, corners of copies and points of stretched objects that the rows of a map are written out to;
/// what goes beyond is left out.
const MAX_PARTS: usize = 2_000_000;
/// Sampling step of a continuous row, metres.
const ROW_STEP_M: f64 = 2.0;
/// Painted corners take the height of lane surfaces that end nearer than this, metres.
const NEAR_M: f64 = 2.0;
/// Corners nearer than this are one.
const SAME_CORNER_M: f64 = 1e-3;

impl Map {
    /// Gives a point the height of the lane surface at or beside it, if there is one near.
    pub(super) fn lay_down(&self, point: &mut Point3<f64>) {
        let Some(hit) = self.nearest_lane(*point, |_| true) else { return };
        if hit.t_m.abs() > 0.5 * hit.width_m + NEAR_M || hit.distance_m > hit.width_m + NEAR_M {
            return;
        }
        if let Some(place) = self.lane_point(hit.lane, hit.s, hit.t_m) {
            point.z = place.position.z;
        }
    }

    /// Places all objects, and picks out the crosswalks.
    pub(super) fn build_objects(&mut self) {
        let mut room = MAX_PARTS;
        for (r, road) in self.network.roads.iter().enumerate() {
            let surface = &self.surfaces[r];
            for (index, object) in road.objects.iter().enumerate() {
                let first = self.objects.len();
                if object.repeats.is_empty() {
                    self.objects.push(placed(
                        surface,
                        r as u32,
                        index,
                        object,
                        object.s,
                        object.t,
                        object.z_offset_m,
                    ));
                }
                for repeat in &object.repeats {
                    row(surface, r as u32, index, object, repeat, &mut room, &mut self.objects);
                }
                for (i, info) in self.objects.iter().enumerate().skip(first) {
                    if let Some(mut crosswalk) = crosswalk(i, info, object) {
                        crosswalk.polygon.iter_mut().for_each(|corner| self.lay_down(corner));
                        self.crosswalks.push(crosswalk);
                    }
                }
            }
        }
    }
}

/// An object as a crosswalk, if it is one: by its type, or by its name where the type says nothing. A ring of
/// at least three corners is asked for, as stop lines beside crosswalks carry the word in their name, too.
///
/// The corners are those of the level object: exporters disagree about the sign of a painted area's tilt, and
/// the surface under it is known.
fn crosswalk(index: usize, info: &ObjectInfo, object: &Object) -> Option<Crosswalk> {
    let typed = info.kind.eq_ignore_ascii_case("crosswalk");
    if !typed && !info.name.to_ascii_lowercase().contains("crosswalk") {
        return None;
    }
    let level =
        Pose::<ObjectFrame, ObjectFrame>::from_xyz_rpy([0.0; 3], [object.roll_rad, object.pitch_rad, 0.0]);
    let pose = info.pose * level.inverse();
    let local = object.outlines.iter().zip(&info.outlines).find(|(_, o)| o.closed && o.base.len() >= 3);
    let ring = local.map(|(corners, placed)| {
        let level = corners.corners.iter().zip(&placed.base).map(|(corner, placed)| match *corner {
            Corner::Local { u_m, v_m, z_m, .. } => pose * Point3::new(u_m, v_m, z_m),
            Corner::Road { .. } => *placed,
        });
        level.collect()
    });
    let polygon = ring.or_else(|| {
        let (half_length, half_width) = (0.5 * info.size_m.x, 0.5 * info.size_m.y);
        let sized = typed && half_length > 0.0 && half_width > 0.0;
        sized.then(|| {
            [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]
                .map(|(x, y)| pose * Point3::new(x * half_length, y * half_width, 0.0))
                .to_vec()
        })
    })?;
    Some(Crosswalk { object: index, id: info.id.clone(), road: info.road, s: info.s, polygon })
}

/// A pose at another place.
fn moved(pose: &Pose<World, ObjectFrame>, to: Point3<f64>) -> Pose<World, ObjectFrame> {
    Pose::from_isometry(Isometry3::from_parts(to.coords.into(), pose.isometry().rotation))
}

fn placed(
    surface: &Surface,
    road: u32,
    index: usize,
    object: &Object,
    s: f64,
    t: f64,
    up_m: f64,
) -> ObjectInfo {
    let mut at = surface.point(s, t);
    at.z += up_m;
    let pose = if object.perpendicular {
        let turned = Pose::<ObjectFrame, ObjectFrame>::from_xyz_rpy([0.0; 3], [0.0, 0.0, object.hdg_rad]);
        moved(&surface.pose(s, t, 0.0), at) * turned
    } else {
        let tangent = surface.frame(s).tangent;
        let heading = frames::math::atan2(tangent.y, tangent.x) + object.hdg_rad;
        Pose::from_xyz_rpy(at.coords.into(), [object.roll_rad, object.pitch_rad, heading])
    };
    let round = object.radius_m.map(|r| 2.0 * r);
    let or_zero = |value: Option<f64>| value.unwrap_or(0.0).max(0.0);
    ObjectInfo {
        id: object.id.clone(),
        name: object.name.clone(),
        kind: object.kind.clone(),
        road,
        index,
        s,
        t,
        pose,
        size_m: Vector3::new(
            or_zero(object.length_m.or(round)),
            or_zero(object.width_m.or(round)),
            or_zero(object.height_m),
        ),
        orientation: object.orientation,
        outlines: object.outlines.iter().map(|o| outline(surface, &pose, o)).collect(),
    }
}

/// Corners in the world. Road coordinates count from the reference line, without lane offset.
fn outline(surface: &Surface, pose: &Pose<World, ObjectFrame>, outline: &Outline) -> OutlineInfo {
    let mut info = OutlineInfo { closed: outline.closed, ..OutlineInfo::default() };
    for corner in &outline.corners {
        let (point, height) = match *corner {
            Corner::Local { u_m, v_m, z_m, height_m } => (*pose * Point3::new(u_m, v_m, z_m), height_m),
            Corner::Road { s, t, dz_m, height_m } => {
                let mut point = surface.point(s, t);
                point.z += dz_m;
                (point, height_m)
            }
        };
        info.base.push(point);
        info.height_m.push(height);
    }
    if let [first, .., last] = info.base[..]
        && info.base.len() > 2
        && (first - last).norm() < SAME_CORNER_M
    {
        info.base.pop();
        info.height_m.pop();
        info.closed = true;
    }
    info
}

/// A row of copies; one without spacing becomes a single object whose outline follows the row.
fn row(
    surface: &Surface,
    road: u32,
    index: usize,
    object: &Object,
    repeat: &Repeat,
    room: &mut usize,
    found: &mut Vec<ObjectInfo>,
) {
    let most = |parts_each: usize, room: &mut usize, wanted: f64| {
        let count = (wanted.min(Repeat::MAX_COPIES as f64) as usize).min(*room / parts_each);
        *room -= count * parts_each;
        count
    };
    let length = repeat.length_m.max(0.0);
    // A detached row runs straight between its two ends.
    let straight =
        repeat.detached.then(|| [0.0, length].map(|d| surface.point(repeat.s + d, repeat.t_at(d))));
    let place = |d: f64| {
        let mut at = match straight {
            Some([from, to]) if length > 0.0 => from + (to - from) * (d / length),
            _ => surface.point(repeat.s + d, repeat.t_at(d)),
        };
        at.z += repeat.z_offset_at(d);
        at
    };
    let size = |d: f64, info: &mut ObjectInfo| {
        let round = repeat.size_at(repeat.radius_m, d).map(|r| 2.0 * r);
        let sizes = [
            round.or(repeat.size_at(repeat.object_length_m, d)),
            round.or(repeat.size_at(repeat.width_m, d)),
            repeat.size_at(repeat.height_m, d),
        ];
        for (size, own) in sizes.into_iter().zip(info.size_m.iter_mut()) {
            *own = size.unwrap_or(*own).max(0.0);
        }
    };
    if repeat.distance_m > 0.0 {
        let corners: usize = object.outlines.iter().map(|o| o.corners.len()).sum();
        let count = most(1 + corners, room, repeat.room());
        for d in (0..count).map(|i| i as f64 * repeat.distance_m) {
            let mut copy =
                placed(surface, road, index, object, repeat.s + d, repeat.t_at(d), repeat.z_offset_at(d));
            if straight.is_some() {
                copy.pose = moved(&copy.pose, place(d));
            }
            size(d, &mut copy);
            found.push(copy);
        }
        return;
    }
    let points = most(1, room, (length / ROW_STEP_M).ceil().max(1.0) + 1.0);
    let Some(steps) = points.checked_sub(1).filter(|steps| *steps > 0) else { return };
    let mut chain = OutlineInfo::default();
    for i in 0..points {
        let d = length * (i as f64 / steps as f64);
        chain.base.push(place(d));
        let height = repeat.size_at(repeat.height_m, d).or(object.height_m);
        chain.height_m.push(height.unwrap_or(0.0).max(0.0));
    }
    let mut whole = placed(surface, road, index, object, repeat.s, repeat.t_m[0], repeat.z_offset_m[0]);
    let largest = |pair: Option<[f64; 2]>, own: f64| pair.map_or(own, |[a, b]| a.max(b));
    whole.size_m.z = largest(repeat.height_m, whole.size_m.z);
    whole.size_m.y = largest(repeat.width_m, whole.size_m.y);
    whole.size_m.x = length;
    whole.outlines = vec![chain];
    found.push(whole);
}
