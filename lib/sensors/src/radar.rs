//! Radars: a random cone of rays with range and range rate.

use glam::{Affine3A, Vec3};
use schema::settings::RadarSpec;
use schema::tables::RadarRow;
use schema::{FRAME_PERIOD_S, ObjectId};
use visibility::{Hit, Ray, Scene};

use crate::lidar::Struck;

/// Rays may start within the agent's own body; each surface of it that is passed costs one more trace.
const OWN_SURFACES: usize = 8;
/// Distance behind a surface of the agent's own body from which a ray goes on, metres.
const STEP_M: f32 = 1e-3;

/// Where a radar is, and was one frame before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadarMotion {
    /// Sensor frame to the snapshot's local frame, now.
    pub local_from_sensor: Affine3A,
    /// The same one frame period ago (in the same local frame); equal to the other when there was none.
    pub previous_local_from_sensor: Affine3A,
    /// The agent's own object: its surfaces are looked through.
    pub own: Option<ObjectId>,
}

/// The returns of one radar at one frame, in the order of the rays. All lists are equally long.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RadarReturns {
    /// Distance, metres.
    pub depth_m: Vec<f32>,
    /// Angle above the sensor's x-y plane, radians.
    pub altitude_rad: Vec<f32>,
    /// Angle to the left of the sensor's axis, radians.
    pub azimuth_rad: Vec<f32>,
    /// Velocity of the target relative to the sensor along the ray, m/s, positive receding.
    pub velocity_mps: Vec<f32>,
    /// Whose surface was hit.
    pub id: Vec<ObjectId>,
    /// What was hit.
    pub tag: Vec<u8>,
}

/// One reading of a radar.
///
/// Each ray ends at `(range, range tan(h / 2) r cos phi, range tan(v / 2) r sin phi)` in the sensor frame, with `r`
/// and `phi` drawn evenly: an elliptic cone, denser at its axis. Ray `i` of frame `f` reads the random words at
/// `f << 32 | i`. Velocities are those of the surface points and of the sensor over the last frame period.
#[must_use]
pub fn radar(
    scene: &Scene<'_>,
    spec: &RadarSpec,
    motion: &RadarMotion,
    stream: &random::Stream,
    frame: u32,
) -> RadarReturns {
    let range_m = spec.range_m as f32;
    let half_width = range_m * frames::math::tan(0.5 * spec.horizontal_fov_rad) as f32;
    let half_height = range_m * frames::math::tan(0.5 * spec.vertical_fov_rad) as f32;
    // Neighbours in angle are followed together; the order of the returns stays that of the draws.
    let mut rays: Vec<(u32, Vec3)> = (0..spec.rays)
        .map(|ray| {
            let words = stream.at(u64::from(frame) << 32 | u64::from(ray));
            let radius = random::unit_f32(words[0]);
            let (sin, cos) = frames::math::f32::sin_cos(std::f32::consts::TAU * random::unit_f32(words[1]));
            (ray, Vec3::new(range_m, half_width * radius * cos, half_height * radius * sin))
        })
        .collect();
    rays.sort_by_key(|(ray, end)| {
        let column = (16.0 * (end.y / half_width)) as i32;
        let row = (8.0 * (end.z / half_height)) as i32;
        (column, row, *ray)
    });
    let origin = Vec3::from(motion.local_from_sensor.translation);
    let directions: Vec<Vec3> = rays
        .iter()
        .map(|(_, end)| motion.local_from_sensor.transform_vector3(*end).normalize_or_zero())
        .collect();
    let farthest_m = rays.iter().map(|(_, end)| end.length()).fold(0.0, f32::max);
    let mut hits = vec![None; directions.len()];
    scene.trace_packet_shared_origin(origin, &directions, 0.0, farthest_m, &mut hits);

    let before = Vec3::from(motion.previous_local_from_sensor.translation);
    let velocity = (origin - before) / FRAME_PERIOD_S as f32;
    let mut found: Vec<(u32, Vec3, f32, f32, ObjectId, u8)> = Vec::with_capacity(rays.len());
    for (((ray, end), direction), hit) in rays.iter().zip(&directions).zip(hits) {
        let limit_m = end.length();
        let Some((hit, struck)) = hit.and_then(|h| beyond_own(scene, motion, *direction, h, limit_m)) else {
            continue;
        };
        if hit.t > limit_m {
            continue;
        }
        let Some(instance) = scene.snapshot().instances.get(hit.instance as usize) else { continue };
        // The difference of the transforms first: it is exactly zero for what stands still.
        let moved = (instance.local_from_object.matrix3 - instance.previous_local_from_object.matrix3)
            * struck.position_object
            + Vec3::from(
                instance.local_from_object.translation - instance.previous_local_from_object.translation,
            );
        let radial = (moved / FRAME_PERIOD_S as f32 - velocity).dot(*direction);
        found.push((*ray, *end / limit_m, hit.t, radial, struck.object, struck.part.tag as u8));
    }
    found.sort_by_key(|f| f.0);
    let mut out = RadarReturns::default();
    for (_, direction, depth_m, velocity_mps, id, tag) in found {
        out.depth_m.push(depth_m);
        out.altitude_rad.push(frames::math::f32::asin(direction.z.clamp(-1.0, 1.0)));
        out.azimuth_rad.push(frames::math::f32::atan2(direction.y, direction.x));
        out.velocity_mps.push(velocity_mps);
        out.id.push(id);
        out.tag.push(tag);
    }
    out
}

/// The hit, or the first one behind it that is not on the agent's own body.
fn beyond_own<'a>(
    scene: &Scene<'a>,
    motion: &RadarMotion,
    direction: Vec3,
    first: Hit,
    limit_m: f32,
) -> Option<(Hit, Struck<'a>)> {
    let mut hit = first;
    for _ in 0..=OWN_SURFACES {
        let struck = Struck::new(scene, &hit)?;
        if Some(struck.object) != motion.own {
            return Some((hit, struck));
        }
        hit = scene.trace(&Ray {
            origin: Vec3::from(motion.local_from_sensor.translation),
            direction,
            t_min: hit.t + STEP_M,
            t_max: limit_m,
        })?;
    }
    None
}

impl RadarReturns {
    /// Number of returns.
    #[must_use]
    pub fn len(&self) -> usize {
        self.depth_m.len()
    }

    /// Whether nothing came back.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.depth_m.is_empty()
    }

    /// The returns as a table row.
    #[must_use]
    pub fn into_row(self, frame: u32) -> RadarRow {
        RadarRow {
            frame,
            time_s: crate::frame_time_s(frame),
            depth: self.depth_m,
            altitude: self.altitude_rad,
            azimuth: self.azimuth_rad,
            velocity: self.velocity_mps,
            id: self.id,
            tag: self.tag,
        }
    }
}
