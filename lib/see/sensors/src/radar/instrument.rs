//! Radars: a random cone of rays with range and range rate.

use glam::{Affine3A, Vec3};
use random::Stream;
use rayon::prelude::*;
use render::{Hit, Hits, RayBatch, RayQuery, RenderError, Scene};
use schema::geometry::{Instance, Snapshot};
use schema::tables::RadarRow;
use schema::{FRAME_PERIOD_S, ObjectId};
use settings::RadarSpec;

use crate::echo;
use crate::surface_hit::SurfaceHit;

/// Rays may start within the agent's own body; each surface of it that is passed costs one more trace of
/// those that did.
const OWN_SURFACES: usize = 8;
/// Distance behind a surface of the agent's own body from which a ray goes on, metres.
const STEP_M: f32 = 1e-3;
/// Rays of a parallel task, at least.
const RAYS_PER_TASK: usize = 256;

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
    /// Cross-section of the patch that the ray stands for, dB of a square metre.
    pub rcs_dbsm: Vec<f32>,
    /// Signal to noise, dB.
    pub snr_db: Vec<f32>,
    /// Whose surface was hit.
    pub id: Vec<ObjectId>,
    /// What was hit.
    pub tag: Vec<u8>,
}

/// A reading of a radar that is asked for.
#[derive(Clone, Copy, Debug)]
pub struct RadarQuery<'a> {
    /// The radar.
    pub spec: &'a RadarSpec,
    /// Where it is.
    pub motion: RadarMotion,
    /// Its random numbers.
    pub stream: &'a Stream,
}

/// One reading each of some radars at a frame, in their order; all rays are followed together.
///
/// Each ray ends at `(range, range tan(h / 2) r cos phi, range tan(v / 2) r sin phi)` in the sensor frame,
/// with `r` and `phi` drawn evenly: an elliptic cone, denser at its axis. Ray `i` of frame `f` reads the
/// random words at `f << 32 | i`. Velocities are those of the bodies hit and of the sensor over the last
/// frame period; with [`RadarSpec::micro_motion`] those of the very surfaces, wheels and limbs too.
///
/// # Errors
/// The renderer failed.
pub fn radars(
    scene: &dyn Scene,
    radars: &[RadarQuery<'_>],
    frame: u32,
) -> Result<Vec<RadarReturns>, RenderError> {
    let drawn: Vec<Vec<Drawn>> = radars
        .par_iter()
        .map(|radar| draw(radar.spec, &radar.motion.local_from_sensor, radar.stream, frame))
        .collect();
    let hits = beyond_own(scene, radars, &drawn)?;
    let each = radars.par_iter().zip(&drawn).zip(&hits);
    Ok(each.map(|((radar, rays), hits)| radar.receive(scene.snapshot(), rays, hits)).collect())
}

impl RadarQuery<'_> {
    /// What comes back of rays that were followed.
    fn receive(&self, snapshot: &Snapshot, rays: &[Drawn], hits: &[Option<Hit>]) -> RadarReturns {
        let Self { spec, motion, .. } = *self;
        let origin = Vec3::from(motion.local_from_sensor.translation);
        let before = Vec3::from(motion.previous_local_from_sensor.translation);
        let velocity = (origin - before) / FRAME_PERIOD_S as f32;
        let echo = |(ray, hit): (&Drawn, &Option<Hit>)| {
            let hit = (*hit).filter(|hit| hit.t <= ray.limit_m)?;
            let surface_hit = SurfaceHit::new(snapshot, &hit)?;
            let part = &snapshot.instances[hit.instance as usize];
            let moved = if spec.micro_motion {
                way_of(
                    [&part.local_from_object, &part.previous_local_from_object],
                    part,
                    surface_hit.position_object(&hit),
                )
            } else {
                let motion = snapshot.motion(part.object);
                motion.map_or(Vec3::ZERO, |m| {
                    way_of(
                        [&m.local_from_object, &m.previous_local_from_object],
                        part,
                        surface_hit.position_object(&hit),
                    )
                })
            };
            let cos_angle = f64::from(surface_hit.normal_local.dot(ray.direction).abs().min(1.0));
            let range_m = f64::from(hit.t);
            let patch_m2 = echo::cross_section_m2(surface_hit.part, ray.solid_angle_sr, range_m, cos_angle);
            let rcs_dbsm = echo::dbsm(patch_m2);
            let direction = ray.end / ray.limit_m;
            Some(Return {
                number: ray.number,
                depth_m: hit.t,
                altitude_rad: frames::math::f32::asin(direction.z.clamp(-1.0, 1.0)),
                azimuth_rad: frames::math::f32::atan2(direction.y, direction.x),
                velocity_mps: (moved / FRAME_PERIOD_S as f32 - velocity).dot(ray.direction),
                rcs_dbsm: rcs_dbsm as f32,
                snr_db: echo::snr_db(spec.snr_db, rcs_dbsm, range_m) as f32,
                id: surface_hit.object,
                tag: surface_hit.part.tag as u8,
            })
        };
        let mut found: Vec<Return> =
            rays.par_iter().zip(hits).with_min_len(RAYS_PER_TASK).filter_map(echo).collect();
        found.sort_unstable_by_key(|r| r.number);
        found.into_iter().collect()
    }
}

/// One return.
struct Return {
    number: u32,
    depth_m: f32,
    altitude_rad: f32,
    azimuth_rad: f32,
    velocity_mps: f32,
    rcs_dbsm: f32,
    snr_db: f32,
    id: ObjectId,
    tag: u8,
}

impl FromIterator<Return> for RadarReturns {
    fn from_iter<I: IntoIterator<Item = Return>>(returns: I) -> Self {
        let mut out = Self::default();
        for r in returns {
            out.depth_m.push(r.depth_m);
            out.altitude_rad.push(r.altitude_rad);
            out.azimuth_rad.push(r.azimuth_rad);
            out.velocity_mps.push(r.velocity_mps);
            out.rcs_dbsm.push(r.rcs_dbsm);
            out.snr_db.push(r.snr_db);
            out.id.push(r.id);
            out.tag.push(r.tag);
        }
        out
    }
}

/// How far a point of a part has moved in the last frame period, as a point of what is now at the one and was
/// before at the other of two poses, local frame, metres.
fn way_of([now, before]: [&Affine3A; 2], part: &Instance, position_part: Vec3) -> Vec3 {
    let place = if part.local_from_object == *now {
        position_part
    } else {
        now.inverse().transform_point3(part.local_from_object.transform_point3(position_part))
    };
    // The difference of the transforms first: it is exactly zero for static objects.
    (now.matrix3 - before.matrix3) * place + Vec3::from(now.translation - before.translation)
}

/// A ray of a reading.
struct Drawn {
    /// Place among the draws, which is the order of the returns.
    number: u32,
    /// Its end in the sensor frame, and how far away that is, metres.
    end: Vec3,
    limit_m: f32,
    /// Where it goes in the snapshot's local frame.
    direction: Vec3,
    /// What of the cone it stands for.
    solid_angle_sr: f64,
}

/// Draws the rays of a reading; neighbours in angle stand together, because they are followed together.
fn draw(spec: &RadarSpec, local_from_sensor: &Affine3A, stream: &Stream, frame: u32) -> Vec<Drawn> {
    let range_m = spec.range_m as f32;
    let half_angles =
        [spec.horizontal_fov_rad, spec.vertical_fov_rad].map(|fov_rad| frames::math::tan(0.5 * fov_rad));
    let [half_width, half_height] = half_angles.map(|half| range_m * half as f32);
    let mut rays: Vec<Drawn> = (0..spec.rays)
        .into_par_iter()
        .with_min_len(RAYS_PER_TASK)
        .map(|number| {
            let words = stream.at(u64::from(frame) << 32 | u64::from(number));
            let radius = random::unit_f32(words[0]);
            let (sin, cos) = frames::math::f32::sin_cos(std::f32::consts::TAU * random::unit_f32(words[1]));
            let end = Vec3::new(range_m, half_width * radius * cos, half_height * radius * sin);
            let direction = local_from_sensor.transform_vector3(end).normalize_or_zero();
            let limit_m = end.length();
            let along = f64::from(range_m / limit_m);
            let solid_angle_sr =
                echo::solid_angle_sr(half_angles[0], half_angles[1], f64::from(radius), spec.rays, along);
            Drawn { number, end, limit_m, direction, solid_angle_sr }
        })
        .collect();
    rays.sort_by_cached_key(|ray| {
        let column = (16.0 * (ray.end.y / half_width)) as i32;
        let row = (8.0 * (ray.end.z / half_height)) as i32;
        (column, row, ray.number)
    });
    rays
}

/// Of each radar, what each ray hits first that is not the agent's own body.
fn beyond_own(
    scene: &dyn Scene,
    radars: &[RadarQuery<'_>],
    drawn: &[Vec<Drawn>],
) -> Result<Vec<Vec<Option<Hit>>>, RenderError> {
    let all = radars.iter().zip(drawn).map(|(radar, rays)| Onward {
        origin: radar.motion.local_from_sensor.translation.into(),
        farthest_m: rays.iter().map(|ray| ray.limit_m).fold(0.0, f32::max),
        directions: rays.iter().map(|ray| ray.direction).collect(),
        nearest_m: Vec::new(),
    });
    let all: Vec<Onward> = all.collect();
    let queries: Vec<RayQuery<'_>> = all.iter().map(Onward::query).collect();
    let mut hits: Vec<Vec<Option<Hit>>> =
        scene.trace(&queries)?.iter().map(|hits| hits.iter().collect()).collect();

    let instances = &scene.snapshot().instances;
    let is_own = |radar: &RadarQuery<'_>, hit: &Hit| {
        let own = radar.motion.own;
        own.is_some() && instances.get(hit.instance as usize).map(|i| i.object) == own
    };
    for _ in 0..OWN_SURFACES {
        // Rays that met the own body go on behind it.
        let (mut places, mut onward) = (Vec::new(), Vec::new());
        for (number, (radar, hits)) in radars.iter().zip(&hits).enumerate() {
            let mut rays = Onward { directions: Vec::new(), nearest_m: Vec::new(), ..all[number] };
            for (ray, hit) in hits.iter().enumerate() {
                if let Some(hit) = hit.filter(|hit| is_own(radar, hit)) {
                    places.push((number, ray));
                    rays.directions.push(drawn[number][ray].direction);
                    rays.nearest_m.push(hit.t + STEP_M);
                }
            }
            if !rays.directions.is_empty() {
                onward.push(rays);
            }
        }
        if onward.is_empty() {
            break;
        }
        let queries: Vec<RayQuery<'_>> = onward.iter().map(Onward::query).collect();
        let next = scene.trace(&queries)?;
        for ((number, ray), hit) in places.into_iter().zip(next.iter().flat_map(Hits::iter)) {
            hits[number][ray] = hit;
        }
    }
    let others = |(radar, hits): (&RadarQuery<'_>, Vec<Option<Hit>>)| {
        hits.into_iter().map(|hit| hit.filter(|hit| !is_own(radar, hit))).collect()
    };
    Ok(radars.iter().zip(hits).map(others).collect())
}

/// Rays of a radar that are followed.
struct Onward {
    origin: Vec3,
    farthest_m: f32,
    directions: Vec<Vec3>,
    /// From where on each looks; empty where that is the radar.
    nearest_m: Vec<f32>,
}

impl Onward {
    fn query(&self) -> RayQuery<'_> {
        RayQuery::of(RayBatch {
            origin: self.origin,
            directions: &self.directions,
            range_m: [0.0, self.farthest_m],
            nearest_m: &self.nearest_m,
        })
    }
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
            rcs_dbsm: self.rcs_dbsm,
            snr_db: self.snr_db,
            id: self.id,
            tag: self.tag,
        }
    }
}
