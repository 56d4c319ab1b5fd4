//! A renderer that tries every triangle of every instance, in double precision and without any tree, tile or
//! packet: a second implementation of the seam, to which the first must agree.

use std::sync::Arc;

use glam::{DAffine3, DVec3, Mat3};
use render::{
    CameraQuery, Hit, Hits, Outputs, RayBatch, RayQuery, RenderError, Renderer, Scene, VisibilityBuffer,
    pose_before,
};
use schema::geometry::{Instance, Snapshot, TriMesh};

/// Tries every triangle of every instance, in double precision.
#[derive(Debug, Default)]
pub struct BruteRenderer {
    prepared: usize,
}

struct BruteScene<'a> {
    snapshot: &'a Snapshot,
    triangles: Vec<Triangle>,
}

/// A triangle in the local frame.
struct Triangle {
    instance: u32,
    number: u32,
    corners: [DVec3; 3],
    /// Whether it is a pane of a vehicle with something behind it.
    is_pane: bool,
}

impl Renderer for BruteRenderer {
    fn prepare(&mut self, meshes: &[Arc<TriMesh>]) -> Result<(), RenderError> {
        self.prepared += meshes.len();
        Ok(())
    }

    fn place<'a>(&'a self, snapshot: &'a Snapshot) -> Result<Box<dyn Scene + 'a>, RenderError> {
        let (in_snapshot, prepared) = (snapshot.meshes.len(), self.prepared);
        if in_snapshot > prepared {
            return Err(RenderError::Unprepared { in_snapshot, prepared });
        }
        Ok(Box::new(BruteScene::new(snapshot, 0.0, false)))
    }
}

impl<'a> BruteScene<'a> {
    /// The instances as they were at a moment before the frame, with or without objects behind panes.
    fn new(snapshot: &'a Snapshot, before: f32, with_cabins: bool) -> Self {
        let mut triangles = Vec::new();
        let cabins: &[Instance] = if with_cabins { &snapshot.cabins } else { &[] };
        for (number, instance) in snapshot.instances.iter().chain(cabins).enumerate() {
            let pose = pose_before(&instance.previous_local_from_object, &instance.local_from_object, before);
            let rotation = Mat3::from(pose.matrix3).as_dmat3();
            let shift = pose.translation.as_dvec3();
            let mesh = snapshot.mesh(instance);
            for triangle in 0..mesh.triangles.len() {
                let corners = mesh.corners(triangle).map(|p| rotation * p.as_dvec3() + shift);
                let is_pane = mesh.part(triangle).surface.is_window() && snapshot.has_cabin(instance.object);
                triangles.push(Triangle {
                    instance: number as u32,
                    number: triangle as u32,
                    corners,
                    is_pane,
                });
            }
        }
        Self { snapshot, triangles }
    }

    /// Closest hit: Moeller and Trumbore, "Fast, minimum storage ray-triangle intersection" (1997). Of
    /// equals, the first.
    fn closest_of(
        &self,
        origin: DVec3,
        direction: DVec3,
        range: [f64; 2],
        counts: impl Fn(&Triangle) -> bool,
    ) -> Option<Hit> {
        let mut best: Option<(f64, Hit)> = None;
        for triangle in self.triangles.iter().filter(|t| counts(t)) {
            let [a, b, c] = triangle.corners;
            let (e1, e2) = (b - a, c - a);
            let p = direction.cross(e2);
            let determinant = e1.dot(p);
            if determinant == 0.0 || !determinant.is_finite() {
                continue;
            }
            let from_a = origin - a;
            let u = from_a.dot(p) / determinant;
            let q = from_a.cross(e1);
            let v = direction.dot(q) / determinant;
            let t = e2.dot(q) / determinant;
            if u < 0.0 || v < 0.0 || u + v > 1.0 || t < range[0] || t > range[1] {
                continue;
            }
            if best.is_none_or(|(other, _)| t < other) {
                let (instance, number) = (triangle.instance, triangle.number);
                best = Some((t, Hit { t: t as f32, instance, triangle: number, u: u as f32, v: v as f32 }));
            }
        }
        best.map(|(_, hit)| hit)
    }

    fn follow(&self, batch: &RayBatch<'_>, counts: impl Fn(&Triangle) -> bool) -> Hits {
        let mut hits = Hits::none(batch.directions.len());
        for (ray, direction) in batch.directions.iter().enumerate() {
            let (origin, direction) = (batch.origin.as_dvec3(), direction.as_dvec3());
            let range = [batch.nearest_m(ray), batch.range_m[1]].map(f64::from);
            if let Some(hit) = self.closest_of(origin, direction, range, &counts) {
                hits.t[ray] = hit.t;
                hits.instance[ray] = hit.instance;
                hits.triangle[ray] = hit.triangle;
                hits.u[ray] = hit.u;
                hits.v[ray] = hit.v;
            }
        }
        hits
    }

    fn look_through(&self, query: &CameraQuery<'_>) -> VisibilityBuffer {
        let camera = &query.camera;
        let is_among = is_among(query.among);
        let pose = &camera.local_from_optical;
        let local_from_optical = DAffine3 {
            matrix3: Mat3::from(pose.matrix3).as_dmat3(),
            translation: pose.translation.as_dvec3(),
        };
        let mut buffer = VisibilityBuffer::empty(camera);
        for y in 0..camera.height {
            for x in 0..camera.width {
                let column = (f64::from(x) + 0.5 - f64::from(camera.cx)) / f64::from(camera.fx);
                let row = (f64::from(y) + 0.5 - f64::from(camera.cy)) / f64::from(camera.fy);
                // Not of unit length: distances along it are planar depths.
                let direction = local_from_optical.transform_vector3(DVec3::new(column, row, 1.0));
                let range = [f64::from(camera.near_m), f64::from(camera.far_m)];
                let is_opaque = query.panes.row(y) >> (x & 1) & 1 != 0;
                let counts = |t: &Triangle| is_among(t) && (is_opaque || !t.is_pane);
                if let Some(hit) = self.closest_of(local_from_optical.translation, direction, range, counts) {
                    let index = buffer.index(x, y);
                    buffer.instance[index] = hit.instance;
                    buffer.triangle[index] = hit.triangle;
                    buffer.depth_m[index] = hit.t;
                }
            }
        }
        buffer
    }
}

impl Scene for BruteScene<'_> {
    fn snapshot(&self) -> &Snapshot {
        self.snapshot
    }

    fn render(&self, queries: &[CameraQuery<'_>]) -> Result<Vec<VisibilityBuffer>, RenderError> {
        let answer = |query: &CameraQuery<'_>| {
            let mut seen = self.look_through(query);
            if query.outputs == Outputs::Depths {
                (seen.instance, seen.triangle) = (Vec::new(), Vec::new());
            }
            seen
        };
        Ok(queries.iter().map(answer).collect())
    }

    fn trace(&self, queries: &[RayQuery<'_>]) -> Result<Vec<Hits>, RenderError> {
        let answer = |query: &RayQuery<'_>| {
            Self::new(self.snapshot, query.before, query.cabins).follow(&query.rays, is_among(query.among))
        };
        Ok(queries.iter().map(answer).collect())
    }
}

fn is_among(among: Option<&[u32]>) -> impl Fn(&Triangle) -> bool {
    move |triangle| among.is_none_or(|among| among.contains(&triangle.instance))
}
