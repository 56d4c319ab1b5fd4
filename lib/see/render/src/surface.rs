//! Surface points behind pixels: the pixel's ray met with the triangle that is known to be there.

use std::ops::Range;

use glam::{DVec3, Mat3, Vec2, Vec3};
use schema::geometry::{Instance, MeshPart, Snapshot, TriMesh};
use schema::mesh_textures::MeshTextures;
use simd::{F32x8, LANES, Vec3x8};

use crate::bend::Bend;
use crate::buffer::VisibilityBuffer;
use crate::camera::PinholeCamera;

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
    /// Unit normal of the triangle's plane, on the camera's side, local frame.
    pub normal_local: Vec3,
    /// As in [`VisibilityBuffer::depth_m`].
    pub depth_m: f32,
    /// What is there.
    pub part: &'a MeshPart,
}

/// An instance as the camera sees it: what is the same for all its pixels.
struct View<'a> {
    instance: &'a Instance,
    mesh: &'a TriMesh,
    /// Camera in the object frame.
    origin: Vec3,
    /// Optical to object frame.
    rotation: Mat3,
    /// Object to local frame.
    to_local: Mat3,
    translation: Vec3,
}

impl<'a> View<'a> {
    fn new(camera: &PinholeCamera, snapshot: &'a Snapshot, instance: &'a Instance) -> Option<Self> {
        let mesh = snapshot.meshes.get(instance.mesh as usize)?;
        let to_local = Mat3::from(instance.local_from_object.matrix3);
        let translation = Vec3::from(instance.local_from_object.translation);
        let object_from_local = to_local.as_dmat3().transpose();
        let camera_m: DVec3 = camera.local_from_optical.translation.as_dvec3();
        let optical = Mat3::from(camera.local_from_optical.matrix3).as_dmat3();
        Some(Self {
            instance,
            mesh,
            // In double precision: the difference of two places far from the local origin loses nothing.
            origin: (object_from_local * (camera_m - translation.as_dvec3())).as_vec3(),
            rotation: (object_from_local * optical).as_mat3(),
            to_local,
            translation,
        })
    }
}

/// Eight points of one surface.
#[derive(Clone, Copy, Debug, Default)]
pub struct SurfacePoints {
    /// Snapshot's local frame, metres.
    pub position_local: Vec3x8,
    /// Object frame, metres.
    pub position_object: Vec3x8,
    /// As in [`VisibilityBuffer::depth_m`].
    pub depth_m: F32x8,
}

/// A triangle as the camera sees it: what is the same for all its pixels.
#[derive(Clone, Copy)]
pub struct SurfaceTriangle<'v, 'a> {
    /// Index into the snapshot's instances.
    pub instance: u32,
    /// Index into the triangles of that instance's mesh.
    pub triangle: u32,
    /// What is there.
    pub part: &'a MeshPart,
    /// Unit normal of the triangle's plane, on the camera's side, local frame.
    pub normal_local: Vec3,
    view: &'v View<'a>,
    /// First corner, in the object frame relative to the camera; and in the object frame.
    a: Vec3,
    corner: Vec3,
    normal: Vec3,
    /// Distance of the plane from the camera along `normal` (times its length).
    offset: f32,
}

impl<'v, 'a> SurfaceTriangle<'v, 'a> {
    fn new(view: &'v View<'a>, instance: u32, triangle: u32) -> Option<Self> {
        view.mesh.triangles.get(triangle as usize)?;
        let [corner, second, third] = view.mesh.corners(triangle as usize);
        let a = corner - view.origin;
        let normal = (second - corner).cross(third - corner);
        let offset = a.dot(normal);
        // The camera is on the side to which the normal points when the plane's offset is negative.
        let facing = if offset > 0.0 { -normal } else { normal };
        Some(Self {
            instance,
            triangle,
            part: view.mesh.part(triangle as usize),
            view,
            a,
            corner,
            normal,
            offset,
            normal_local: (view.to_local * facing).normalize_or_zero(),
        })
    }

    /// The instance that it is of.
    #[must_use]
    pub fn placed(&self) -> &'a Instance {
        self.view.instance
    }

    /// Its corners, object frame, metres.
    #[must_use]
    pub fn corners_object_m(&self) -> [Vec3; 3] {
        self.view.mesh.corners(self.triangle as usize)
    }

    /// Where the camera is, object frame, metres.
    #[must_use]
    pub fn camera_object_m(&self) -> Vec3 {
        self.view.origin
    }

    /// The pictures on its mesh, if it has some, and where its corners are in them.
    #[must_use]
    pub fn textures(&self) -> Option<(&'a MeshTextures, [Vec2; 3])> {
        let textures = self.view.mesh.textures.as_deref()?;
        Some((textures, *textures.corners.get(self.triangle as usize)?))
    }

    /// How light bends over it; `None` where it is flat.
    #[must_use]
    pub fn bend(&self) -> Option<Bend> {
        let mesh = self.view.mesh;
        let normals = mesh.bent(self.triangle as usize)?;
        let side = if self.offset > 0.0 { -1.0 } else { 1.0 };
        Bend::new(mesh.corners(self.triangle as usize), normals, &self.view.to_local, side)
    }

    /// The mean of its corners' normals for light (unit), on the camera's side, local frame; that of its
    /// plane where it is flat.
    #[must_use]
    pub fn mean_normal_local(&self) -> Vec3 {
        let Some([a, b, c]) = self.view.mesh.bent(self.triangle as usize) else { return self.normal_local };
        let side = if self.offset > 0.0 { -1.0 } else { 1.0 };
        (self.view.to_local * ((a + b + c) * side)).normalize_or(self.normal_local)
    }

    /// The share of the light of sky and ground that reaches its corners past its own body; `None` where that
    /// is all.
    #[must_use]
    pub fn open(&self) -> Option<[f32; 3]> {
        let open = self.view.mesh.corner_visibility.get(self.triangle as usize)?;
        Some(open.map(|open| f32::from(open) * (1.0 / 255.0)))
    }

    /// The points of eight pixels, as [`Surfaces::at`] gives each: `x` are their columns, all in row `y`.
    #[inline]
    pub fn points(&self, buffer: &VisibilityBuffer, x: &[u32; LANES], y: u32) -> SurfacePoints {
        let direction = buffer.directions_optical(x, y).turned(&self.view.rotation);
        let slope = direction.dot(Vec3x8::splat(self.normal));
        let exact = self.offset / slope;
        // Not a number, endless and behind fail this.
        let usable = exact.simd_gt(0.0) & exact.simd_lt(f32::INFINITY);
        let depth_m = if usable.all() {
            exact
        } else {
            usable.select(exact, F32x8::from(x.map(|x| buffer.depth_m[buffer.index(x, y)])))
        };
        let from_corner = direction * depth_m - Vec3x8::splat(self.a);
        let position_object = Vec3x8::splat(self.corner) + from_corner;
        let position_local =
            position_object.turned(&self.view.to_local) + Vec3x8::splat(self.view.translation);
        SurfacePoints { position_local, position_object, depth_m }
    }

    #[inline]
    fn point(&self, direction_optical: Vec3, depth_m: f32) -> SurfacePoint<'a> {
        let direction = self.view.rotation * direction_optical;
        let slope = direction.dot(self.normal);
        // The plane seen edge-on has no one point: then the buffer's depth decides.
        let exact = self.offset / slope;
        let depth_m = if exact.is_finite() && exact > 0.0 { exact } else { depth_m };
        let from_corner = direction * depth_m - self.a;
        let position_object = self.corner + from_corner;
        SurfacePoint {
            instance: self.instance,
            triangle: self.triangle,
            position_local: self.view.to_local * position_object + self.view.translation,
            position_object,
            normal_local: self.normal_local,
            depth_m,
            part: self.part,
        }
    }
}

/// How many words at the start of a list are all the same.
#[inline]
fn alike(words: &[u32], word: u32) -> usize {
    // Blocks first, in wide registers.
    let (blocks, _) = words.as_chunks::<8>();
    let whole = 8 * blocks.iter().take_while(|b| b.iter().all(|&w| w == word)).count();
    whole + words[whole..].iter().take_while(|&&w| w == word).count()
}

/// Reads surface points out of a [`VisibilityBuffer`], whichever renderer filled it.
pub struct Surfaces<'a> {
    buffer: &'a VisibilityBuffer,
    /// Number of the first object behind panes.
    first_behind: u32,
    /// By instance, and after them objects behind panes; none for those whose mesh the snapshot does not
    /// hold.
    views: Vec<Option<View<'a>>>,
}

impl<'a> Surfaces<'a> {
    /// Prepares the reading; `snapshot` must be the one that was seen.
    #[must_use]
    pub fn new(buffer: &'a VisibilityBuffer, snapshot: &'a Snapshot) -> Self {
        let all = snapshot.instances.iter().chain(&snapshot.cabins);
        let views = all.map(|i| View::new(&buffer.camera, snapshot, i)).collect();
        Self { buffer, first_behind: snapshot.instances.len() as u32, views }
    }

    /// The surface point at the centre of one pixel, `None` for sky.
    #[must_use]
    pub fn at(&self, x: u32, y: u32) -> Option<SurfacePoint<'a>> {
        let index = self.buffer.index(x, y);
        let facet = self.facet(self.buffer.instance[index], self.buffer.triangle[index])?;
        Some(facet.point(self.buffer.direction_optical(x, y), self.buffer.depth_m[index]))
    }

    /// Calls `each(columns, facet)` for every span of a row, in order: neighbours that see one triangle, or
    /// the sky (`None`).
    pub fn for_each_span(&self, y: u32, mut each: impl FnMut(Range<u32>, Option<&SurfaceTriangle<'_, 'a>>)) {
        let start = self.buffer.index(0, y);
        let end = start + self.buffer.width as usize;
        let (instances, triangles) = (&self.buffer.instance[start..end], &self.buffer.triangle[start..end]);
        let mut first = 0;
        while first < instances.len() {
            let seen = (instances[first], triangles[first]);
            let same_triangle = alike(&triangles[first..], seen.1);
            let length = alike(&instances[first..first + same_triangle], seen.0);
            let facet = self.facet(seen.0, seen.1);
            each(first as u32..(first + length) as u32, facet.as_ref());
            first += length;
        }
    }

    /// Whether a number is that of something that stands behind panes.
    #[must_use]
    pub fn is_behind_panes(&self, instance: u32) -> bool {
        instance >= self.first_behind
    }

    /// A triangle of an instance (or of objects behind panes, as [`Snapshot::behind`] numbers them) as
    /// the camera sees it; `None` where there is no such.
    #[must_use]
    pub fn facet(&self, instance: u32, triangle: u32) -> Option<SurfaceTriangle<'_, 'a>> {
        SurfaceTriangle::new(self.views.get(instance as usize)?.as_ref()?, instance, triangle)
    }
}
