//! A rasteriser's picture beside what rays of the same camera hit: equal, pixel by pixel, but where rounding
//! decides. Where that is, is worked out here from corners and poses, in double precision.

use glam::{Affine3A, DVec2, DVec3, Mat3, Vec3};
use render::{Hits, PinholeCamera, RayBatch, SKY, VisibilityBuffer};
use schema::geometry::Snapshot;

/// An edge farther than this from a pixel's centre decides nothing, nor does one that the rounding of
/// single-precision places and directions can't carry there.
const MARGIN_PX: f64 = 1e-4;
/// Units in the last place by which places and directions are rounded at most, on their way from an object to
/// a product.
const UNITS: f64 = 4.0;

/// A camera at a place that looks along a direction, level sideways.
#[must_use]
pub fn camera_at(from: Vec3, along: Vec3, width: u32, height: u32, fov_rad: f32) -> PinholeCamera {
    let forward = along.normalize();
    let right = forward.cross(Vec3::Z).normalize();
    let rotation = Mat3::from_cols(right, forward.cross(right), forward);
    let pose = Affine3A { matrix3: rotation.into(), translation: from.into() };
    PinholeCamera::centred(pose, width, height, fov_rad)
}

/// What was compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Agreement {
    /// Pixels that show something.
    pub seen: usize,
    /// Those within rounding of an edge of what they show, or of where two surfaces or a surface and the near
    /// plane meet.
    pub on_edges: usize,
    /// Those of them that differ.
    pub differing: usize,
    /// Those of them again where two surfaces are equally near, within rounding.
    pub tied: usize,
}

impl std::ops::AddAssign for Agreement {
    fn add_assign(&mut self, other: Self) {
        self.seen += other.seen;
        self.on_edges += other.on_edges;
        self.differing += other.differing;
        self.tied += other.tied;
    }
}

/// The rays through the centres of a camera's pixels, row by row.
#[derive(Debug)]
pub struct PixelRays {
    camera: PinholeCamera,
    directions: Vec<Vec3>,
    nearest_m: Vec<f32>,
    /// Metres along a ray for a metre of planar depth.
    lengths: Vec<f32>,
}

impl PixelRays {
    /// Of a camera.
    #[must_use]
    pub fn new(camera: &PinholeCamera) -> Self {
        let pixels = (0..camera.height).flat_map(|y| (0..camera.width).map(move |x| (x, y)));
        let optical = pixels.map(|(x, y)| camera.direction_optical(x as f32 + 0.5, y as f32 + 0.5));
        let (lengths, directions): (Vec<f32>, Vec<Vec3>) = optical
            .map(|d| (d.length(), camera.local_from_optical.transform_vector3(d) / d.length()))
            .unzip();
        let nearest_m = lengths.iter().map(|length| camera.near_m * length).collect();
        Self { camera: *camera, directions, nearest_m, lengths }
    }

    /// To be traced.
    #[must_use]
    pub fn batch(&self) -> RayBatch<'_> {
        let longest = self.lengths.iter().fold(1.0f32, |most, &length| most.max(length));
        RayBatch {
            origin: self.camera.local_from_optical.translation.into(),
            directions: &self.directions,
            range_m: [0.0, self.camera.far_m * longest],
            nearest_m: &self.nearest_m,
        }
    }

    /// Compares what they hit with what a rasteriser saw.
    ///
    /// # Errors
    /// The first pixel that differs though no edge is near, in words.
    pub fn compare(
        &self,
        world: &Snapshot,
        seen: &VisibilityBuffer,
        hits: &Hits,
    ) -> Result<Agreement, String> {
        let mut found = Agreement::default();
        for y in 0..seen.height {
            for x in 0..seen.width {
                let i = seen.index(x, y);
                let raster = (seen.instance[i] != SKY).then(|| (seen.instance[i], seen.triangle[i]));
                // Rays end on a sphere, pictures on a plane.
                let hit = hits.get(i).filter(|hit| hit.t <= self.camera.far_m * self.lengths[i]);
                let traced = hit.map(|hit| (hit.instance, hit.triangle));
                let d = DVec3::new(
                    (f64::from(x) + 0.5 - f64::from(self.camera.cx)) / f64::from(self.camera.fx),
                    (f64::from(y) + 0.5 - f64::from(self.camera.cy)) / f64::from(self.camera.fy),
                    1.0,
                );
                let view = |id: (u32, u32)| Placed::new(world, &self.camera, id, d);
                let [a, b] = [raster, traced].map(|id| id.map(view));
                found.seen += usize::from(a.is_some() || b.is_some());
                if raster == traced {
                    found.on_edges += usize::from(a.is_some_and(|a| a.on_edge));
                    let Some((a, hit)) = a.zip(hit) else { continue };
                    let [picture, ray] = [seen.depth_m[i], hit.t / self.lengths[i]].map(f64::from);
                    if [picture, ray].iter().any(|depth_m| (1.0 / depth_m - a.inverse_depth).abs() > a.slack)
                    {
                        return Err(format!(
                            "pixel {x} {y} sees {raster:?} at {picture} m, a ray at {ray} m: {a:?}"
                        ));
                    }
                    continue;
                }
                found.on_edges += 1;
                found.differing += 1;
                // A renderer that missed the nearer triangle must have had an edge there.
                let by_rounding = match (a, b) {
                    (Some(a), Some(b)) => {
                        let ahead = a.inverse_depth - b.inverse_depth;
                        let nearer = if ahead > 0.0 { a } else { b };
                        let is_tie = ahead.abs() <= a.slack + b.slack;
                        found.tied += usize::from(is_tie);
                        is_tie || nearer.on_edge
                    }
                    (Some(one), None) | (None, Some(one)) => one.on_edge,
                    (None, None) => true,
                };
                if !by_rounding {
                    return Err(format!(
                        "pixel {x} {y}: rasterised {raster:?} {a:?}, traced {traced:?} {b:?}, off all edges"
                    ));
                }
            }
        }
        Ok(found)
    }
}

/// A triangle about the centre of a pixel.
#[derive(Clone, Copy, Debug)]
struct Placed {
    /// Whether rounding decides if it is seen there.
    on_edge: bool,
    inverse_depth: f64,
    /// By which that may be off, or change within the margin.
    slack: f64,
}

impl Placed {
    /// `d` is the direction of the pixel's centre, with z = 1.
    fn new(world: &Snapshot, camera: &PinholeCamera, (instance, triangle): (u32, u32), d: DVec3) -> Self {
        let placed = &world.instances[instance as usize];
        let object = Mat3::from(placed.local_from_object.matrix3).as_dmat3();
        let optical = Mat3::from(camera.local_from_optical.matrix3).as_dmat3().transpose();
        let between = placed.local_from_object.translation.as_dvec3()
            - camera.local_from_optical.translation.as_dvec3();
        let source = world.mesh(placed).corners(triangle as usize);
        let corners = source.map(|p| optical * (object * p.as_dvec3() + between));
        let unit = UNITS * f64::from(f32::EPSILON);
        // Places are rounded by so many metres at most.
        let reach_m = source.iter().fold(0.0, |most: f64, p| most.max(f64::from(p.abs().max_element())));
        let rounded_m = unit * (reach_m + between.abs().max_element());

        // A product with a plane's normal changes by so much within the margin, and by rounding it and the
        // direction.
        let per_px = |n: DVec3| DVec2::new(n.x / f64::from(camera.fx), n.y / f64::from(camera.fy)).length();
        let off = |n: DVec3| MARGIN_PX * per_px(n) + unit * n.length() * d.length();

        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a);
        let volume = a.dot(normal);
        let mut inside = true;
        let mut outside = false;
        for (p, q) in [(b, c), (c, a), (a, b)] {
            let edge = p.cross(q) * volume.signum();
            let slack = off(edge) + rounded_m * (p.length() + q.length()) * d.length();
            inside &= edge.dot(d) > slack;
            outside |= edge.dot(d) < -slack;
        }
        let inverse_depth = normal.dot(d) / volume;
        let tilt = rounded_m * normal.length() / volume.abs();
        let slack = off(normal) / volume.abs() + inverse_depth.abs() * (tilt + 2.0 * unit);
        let ends = [camera.near_m, camera.far_m].map(|m| (inverse_depth - 1.0 / f64::from(m)).abs() <= slack);
        Self { on_edge: (!inside && !outside) || ends[0] || ends[1], inverse_depth, slack }
    }
}
