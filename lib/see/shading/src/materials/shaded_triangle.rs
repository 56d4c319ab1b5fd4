//! What looks are made from and of: a triangle, points on it, and how these send light back.

use glam::Vec3;
use render::SurfaceTriangle;
use schema::geometry::{Instance, MeshPart, Surface};
use schema::{ObjectId, Tag};
use simd::{F32x8, Vec3x8};

use super::front::Front;
use super::laid::Laid;
use super::lane::{Across, Kerbed};
pub(crate) use super::points::Points;
use super::uv_surface::UvSurface;

/// What is the same for all points of one triangle.
pub(crate) struct ShadedTriangle<'a> {
    pub(super) part: &'a MeshPart,
    pub(super) paint: Vec3,
    pub(super) lights: u32,
    pub(super) glow: Vec3,
    pub(super) object: ObjectId,
    pub(crate) normal_local: Vec3,
    pub(super) normal_object: Vec3,
    /// Where the camera is.
    pub(super) eye_object_m: Vec3,
    /// The axes of an upright or sloping surface, object frame; of clothes those along which normals lean.
    pub(super) tangents_object: [Vec3; 2],
    /// How it is divided, if it is a house front.
    pub(super) front: Option<Front>,
    /// The pictures on it, if it has some of its own.
    pub(super) uv_surface: Option<UvSurface<'a>>,
    /// Where on its lane it lies, if it is a piece of one.
    pub(super) lane: Option<Across>,
    /// How it lies along its sidewalk, if it is a piece of one.
    pub(super) laid: Option<Laid>,
    /// Where kerbs stand beside it.
    pub(super) kerbed: Option<Kerbed>,
}

/// How points send light back.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BrdfSample {
    /// Share of light scattered evenly, linear RGB.
    pub(crate) albedo: Vec3x8,
    /// How much normals lean along [`ShadedTriangle::tangents_local`]; none where the surface is even.
    pub(crate) lean: Option<[F32x8; 2]>,
    /// Light of its own, in units of what the film shows as white; none for most.
    pub(crate) emission: Option<Vec3x8>,
    /// What it mirrors; nothing for dull surfaces.
    pub(crate) specular: Option<Specular>,
}

/// How points mirror.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Specular {
    /// Share of light mirrored at normal incidence; 0 without gloss.
    pub(crate) mirror: F32x8,
    /// Width of the highlight: 0 mirror, 1 dull.
    pub(crate) roughness: F32x8,
}

/// What is the same for all surfaces of a frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Surroundings {
    /// Wetness of the ground, 0 to 1.
    pub(crate) wetness: f32,
    /// Puddles, 0 to 1.
    pub(crate) puddles: f32,
    /// Rain, 0 to 1.
    pub(crate) rain: f32,
    /// Number of the frame: in each, rain falls elsewhere.
    pub(crate) frame: u32,
    /// World coordinates of the local origin, wrapped.
    pub(crate) world_from_local_m: Vec3,
}

impl Surroundings {
    /// Whether the ground is wet anywhere.
    pub(crate) fn are_wet(&self) -> bool {
        self.wetness > 0.0 || self.puddles > 0.0
    }

    /// World coordinates of textures repeat after this distance, metres: a whole number of tiles at every
    /// scale, so that there is no seam.
    pub(crate) const WRAP_M: f64 = 4096.0;
}

impl<'a> ShadedTriangle<'a> {
    pub(crate) fn new(instance: &Instance, triangle: &SurfaceTriangle<'_, 'a>) -> Self {
        let object_from_local = instance.local_from_object.matrix3.transpose();
        let normal_local = triangle.normal_local;
        let corners_object_m = triangle.corners_object_m();
        let part = triangle.part;
        let normal_object = object_from_local * normal_local;
        let tangents_object = match part.surface {
            Surface::Clothes(_) => tangents_local(part, normal_local).map(|axis| object_from_local * axis),
            _ => upright(normal_object),
        };
        let front = match part.surface {
            Surface::Facade(wall) if normal_object.z.abs() < 0.85 => {
                Some(Front::new(wall, instance.object, tangents_object[0], corners_object_m))
            }
            _ => None,
        };
        let is_road = part.surface.is_asphalt() && part.tag == Tag::Road;
        Self {
            part,
            paint: Vec3::from_array(instance.paint),
            lights: instance.lights,
            glow: Vec3::from_array(instance.glow),
            object: instance.object,
            normal_local,
            normal_object,
            eye_object_m: triangle.camera_object_m(),
            tangents_object,
            front,
            uv_surface: UvSurface::new(part.surface, triangle.textures(), corners_object_m, || {
                upright(normal_local).map(|axis| object_from_local * axis)
            }),
            lane: if is_road { Across::new(corners_object_m) } else { None },
            laid: Laid::new(part.tag, triangle.textures(), corners_object_m),
            kerbed: Kerbed::new(part.surface, corners_object_m),
        }
    }

    /// Whether it sends light back to where it came from.
    pub(crate) fn is_sheeting(&self) -> bool {
        self.part.surface == Surface::Reflector
    }

    /// Whether textures lie on it by the plan of the world, as on all ground.
    pub(super) fn is_ground(&self) -> bool {
        is_level(self.normal_local)
    }

    /// The axes of its texture, local frame: x and y of the world on the ground, elsewhere (on roofs too) to
    /// the right of someone who looks at it and up.
    pub(crate) fn tangents_local(&self) -> [Vec3; 2] {
        tangents_local(self.part, self.normal_local)
    }
}

/// See [`ShadedTriangle::tangents_local`].
fn tangents_local(part: &MeshPart, normal_local: Vec3) -> [Vec3; 2] {
    let is_built = part.tag == Tag::Building
        || matches!(part.surface, Surface::RoofTiles | Surface::Gravel | Surface::Textured(_));
    if is_level(normal_local) && !is_built { [Vec3::X, Vec3::Y] } else { upright(normal_local) }
}

/// Whether a surface with such a normal is ground.
pub(super) fn is_level(normal_local: Vec3) -> bool {
    normal_local.z > 0.8
}

/// To the right of someone who looks at a surface, and up.
fn upright(normal: Vec3) -> [Vec3; 2] {
    let right = Vec3::new(-normal.y, normal.x, 0.0).normalize_or(Vec3::X);
    [right, normal.cross(right)]
}

impl BrdfSample {
    /// A surface that mirrors nothing.
    #[inline]
    pub(super) fn dull(albedo: Vec3x8) -> Self {
        Self { albedo, ..Self::default() }
    }

    /// One that leans as its texture says.
    #[inline]
    pub(super) fn leaning(albedo: Vec3x8, lean: [F32x8; 2]) -> Self {
        Self { albedo, lean: Some(lean), ..Self::default() }
    }

    #[inline]
    pub(super) fn glossy(albedo: Vec3x8, mirror: f32, roughness: f32) -> Self {
        let specular = Specular { mirror: F32x8::splat(mirror), roughness: F32x8::splat(roughness) };
        Self { albedo, specular: Some(specular), ..Self::default() }
    }
}

/// A colour in so many shades.
#[inline]
pub(super) fn shades(rgb: Vec3, shade: F32x8) -> Vec3x8 {
    Vec3x8::new(shade * rgb.x, shade * rgb.y, shade * rgb.z)
}
