//! Surface points behind pixels: the pixel's ray met with the triangle that is known to be there.

use glam::{DVec3, Vec3};
use schema::geometry::{Instance, Part};

use crate::buffer::{SKY, VisibilityBuffer};
use crate::camera::PinholeCamera;
use crate::scene::{Placed, Scene};

/// A point on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint<'a> {
    /// Index into the snapshot's instances.
    pub instance: u32,
    /// Index into the triangles of that instance's mesh.
    pub triangle: u32,
    /// Snapshot's local frame, metres.
    pub position_local: Vec3,
    /// Object frame, metres.
    pub position_object: Vec3,
    /// Weights of the triangle's corners; they sum to 1.
    pub barycentric: [f32; 3],
    /// Unit normal of the triangle's plane, on the camera's side, local frame.
    pub normal_local: Vec3,
    /// Planar depth along the optical axis, metres.
    pub depth_m: f32,
    /// What is there.
    pub part: &'a Part,
}

/// An instance as the camera sees it: what is the same for all its pixels.
#[derive(Clone, Copy)]
struct View {
    /// Camera in the object frame.
    origin: Vec3,
    /// Optical to object frame.
    rotation: glam::Mat3,
}

impl View {
    fn new(camera: &PinholeCamera, placed: &Placed<'_>) -> Self {
        let object_from_local = placed.rotation.as_dmat3().transpose();
        let camera_m: DVec3 = camera.local_from_optical.translation.as_dvec3();
        let optical = glam::Mat3::from(camera.local_from_optical.matrix3).as_dmat3();
        Self {
            // In double precision: the difference of two places far from the local origin loses nothing.
            origin: (object_from_local * (camera_m - placed.translation.as_dvec3())).as_vec3(),
            rotation: (object_from_local * optical).as_mat3(),
        }
    }
}

/// A triangle as the camera sees it: what is the same for all its pixels.
#[derive(Clone, Copy)]
struct Facet<'a> {
    instance: u32,
    triangle: u32,
    part: &'a Part,
    view: View,
    placed: &'a Placed<'a>,
    /// First corner, in the object frame relative to the camera; and in the object frame.
    a: Vec3,
    corner: Vec3,
    normal: Vec3,
    /// Distance of the plane from the camera along `normal` (times its length).
    offset: f32,
    /// Weights of the second and third corner grow along these, from the first corner.
    gradient: [Vec3; 2],
    normal_local: Vec3,
}

impl<'a> Facet<'a> {
    fn new(scene: &'a Scene<'_>, view: View, instance: u32, triangle: u32) -> Option<Self> {
        let placed = scene.placed(instance)?;
        let source = &placed.mesh.source;
        source.triangles.get(triangle as usize)?;
        let [corner, second, third] = source.corners(triangle as usize);
        let (a, p, q) = (corner - view.origin, second - corner, third - corner);
        let normal = p.cross(q);
        let scale = 1.0 / normal.length_squared();
        let offset = a.dot(normal);
        // The camera is on the side to which the normal points when the plane's offset is negative.
        let facing = if offset > 0.0 { -normal } else { normal };
        Some(Self {
            instance,
            triangle,
            part: source.part(triangle as usize),
            view,
            placed,
            a,
            corner,
            normal,
            offset,
            gradient: [q.cross(normal) * scale, normal.cross(p) * scale],
            normal_local: (placed.rotation * facing).normalize_or_zero(),
        })
    }

    #[inline]
    fn point(&self, camera: &PinholeCamera, x: u32, y: u32, depth_m: f32) -> SurfacePoint<'a> {
        let direction = self.view.rotation * camera.direction_optical(x as f32 + 0.5, y as f32 + 0.5);
        let slope = direction.dot(self.normal);
        // The plane seen edge-on has no one point: then the buffer's depth decides.
        let exact = self.offset / slope;
        let depth_m = if exact.is_finite() && exact > 0.0 { exact } else { depth_m };
        let from_corner = direction * depth_m - self.a;
        let (v, w) = (from_corner.dot(self.gradient[0]), from_corner.dot(self.gradient[1]));
        let position_object = self.corner + from_corner;
        SurfacePoint {
            instance: self.instance,
            triangle: self.triangle,
            position_local: self.placed.rotation * position_object + self.placed.translation,
            position_object,
            barycentric: [1.0 - v - w, v, w],
            normal_local: self.normal_local,
            depth_m,
            part: self.part,
        }
    }
}

/// Reads surface points out of a [`VisibilityBuffer`].
pub struct Surfaces<'a> {
    buffer: &'a VisibilityBuffer,
    scene: &'a Scene<'a>,
    views: Vec<Option<View>>,
}

impl<'a> Surfaces<'a> {
    pub(crate) fn new(buffer: &'a VisibilityBuffer, scene: &'a Scene<'a>) -> Self {
        let views =
            scene.all_placed().iter().map(|p| p.as_ref().map(|p| View::new(&buffer.camera, p))).collect();
        Self { buffer, scene, views }
    }

    /// The instance that a point is on.
    #[must_use]
    pub fn instance(&self, point: &SurfacePoint<'_>) -> &'a Instance {
        &self.scene.snapshot().instances[point.instance as usize]
    }

    /// The surface point at the centre of one pixel, `None` for sky.
    #[must_use]
    pub fn at(&self, x: u32, y: u32) -> Option<SurfacePoint<'a>> {
        let index = self.buffer.index(x, y);
        let facet = self.facet(self.buffer.instance[index], self.buffer.triangle[index])?;
        Some(facet.point(&self.buffer.camera, x, y, self.buffer.depth_m[index]))
    }

    /// Calls `each(x, point)` for every pixel of a row, in order; neighbours on one triangle share its set-up.
    pub fn for_each_in_row(&self, y: u32, mut each: impl FnMut(u32, Option<&SurfacePoint<'a>>)) {
        let start = self.buffer.index(0, y);
        let end = start + self.buffer.width as usize;
        let row = self.buffer.instance[start..end]
            .iter()
            .zip(&self.buffer.triangle[start..end])
            .zip(&self.buffer.depth_m[start..end]);
        let mut current = (SKY, SKY);
        let mut facet = None;
        for (x, ((&instance, &triangle), &depth_m)) in row.enumerate() {
            if (instance, triangle) != current {
                current = (instance, triangle);
                facet = self.facet(instance, triangle);
            }
            let point = facet.as_ref().map(|f| f.point(&self.buffer.camera, x as u32, y, depth_m));
            each(x as u32, point.as_ref());
        }
    }

    fn facet(&self, instance: u32, triangle: u32) -> Option<Facet<'a>> {
        let view = (*self.views.get(instance as usize)?)?;
        Facet::new(self.scene, view, instance, triangle)
    }
}

/// One point without preparation.
pub(crate) fn single<'a>(
    buffer: &VisibilityBuffer,
    scene: &'a Scene<'_>,
    x: u32,
    y: u32,
) -> Option<SurfacePoint<'a>> {
    let index = buffer.index(x, y);
    let instance = buffer.instance[index];
    let view = View::new(&buffer.camera, scene.placed(instance)?);
    let facet = Facet::new(scene, view, instance, buffer.triangle[index])?;
    Some(facet.point(&buffer.camera, x, y, buffer.depth_m[index]))
}
