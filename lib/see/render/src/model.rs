//! How a camera makes a picture of what is before it.

use std::sync::Arc;

use glam::{Affine3A, Vec2, Vec3};
use rayon::prelude::*;
use settings::{LensModel, Optics};
use simd::{F32x8, LANES, Vec3x8};

use crate::PinholeCamera;
use crate::error::{CameraError, MAX_SIDE_PX};

/// Parts of a pixel that an axis may lie at: crops of a picture then have the same rays, bit for bit.
const AXIS_STEPS: f64 = 1024.0;

/// How a camera makes a picture of what is before it.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraModel {
    optics: Optics,
    /// At the origin, and as if the lens bent nothing.
    straight: PinholeCamera,
    bent: Option<Bent>,
}

/// What a lens does to the rays of a picture.
#[derive(Clone, Debug, PartialEq)]
struct Bent {
    lens: LensModel,
    /// Where each pixel's centre looks, optical frame.
    rays: Arc<[Vec3]>,
}

impl CameraModel {
    /// Of size, intrinsics and lens.
    ///
    /// # Errors
    /// The picture has no pixels or too many, the intrinsics are not those of a camera, or a pixel looks
    /// nowhere.
    pub fn new(optics: &Optics) -> Result<Self, CameraError> {
        let Optics { width, height, fx, fy, cx, cy, lens } = *optics;
        if !(1..=MAX_SIDE_PX).contains(&width) || !(1..=MAX_SIDE_PX).contains(&height) {
            return Err(CameraError::PictureSize { width, height });
        }
        let is_length = |f: f64| (f as f32).is_finite() && f as f32 > 0.0;
        if !(is_length(fx) && is_length(fy) && (cx as f32).is_finite() && (cy as f32).is_finite()) {
            return Err(CameraError::Intrinsics { fx, fy, cx, cy });
        }
        let bent = LensModel::of(&lens).map(|lens| Bent::new(optics, lens)).transpose()?;
        let axis = |at: f64| ((at * AXIS_STEPS).round() / AXIS_STEPS) as f32;
        let straight = PinholeCamera {
            local_from_optical: Affine3A::IDENTITY,
            width,
            height,
            fx: fx as f32,
            fy: fy as f32,
            cx: axis(cx),
            cy: axis(cy),
            near_m: PinholeCamera::NEAR_M,
            far_m: PinholeCamera::FAR_M,
        };
        Ok(Self { optics: optics.clone(), straight, bent })
    }

    /// Size, intrinsics and lens.
    #[must_use]
    pub fn optics(&self) -> &Optics {
        &self.optics
    }

    /// Where each pixel's centre looks in the optical frame, rows from the top, if a lens bends the rays.
    #[must_use]
    pub fn rays(&self) -> Option<&Arc<[Vec3]>> {
        self.bent.as_ref().map(|bent| &bent.rays)
    }

    /// The camera as renderers know it, at a place, as if its lens bent nothing.
    #[must_use]
    pub fn pinhole(&self, local_from_optical: Affine3A) -> PinholeCamera {
        PinholeCamera { local_from_optical, ..self.straight }
    }

    /// Position in the picture of a point in the optical frame, pixels, and whether the camera may show it.
    /// What lies behind or beyond what the lens shows is moved to where that ends.
    #[must_use]
    pub fn project(&self, point: Vec3) -> (Vec2, bool) {
        let Some(bent) = &self.bent else {
            let camera = &self.straight;
            let z = point.z.max(camera.near_m);
            let at = Vec2::new(camera.fx * point.x / z + camera.cx, camera.fy * point.y / z + camera.cy);
            return (at, point.z >= camera.near_m);
        };
        let ([x, y], is_shown) = bent.lens.project(point.to_array().map(f64::from));
        let Optics { fx, fy, cx, cy, .. } = self.optics;
        (Vec2::new((fx * x + cx) as f32, (fy * y + cy) as f32), is_shown)
    }

    /// Columns and rows of eight points, as [`project`](Self::project) has them.
    #[must_use]
    #[inline]
    pub fn project_all(&self, points: &Vec3x8) -> [F32x8; 2] {
        if self.bent.is_some() {
            let places: [Vec2; LANES] = std::array::from_fn(|i| self.project(points.lane(i)).0);
            return [places.map(|p| p.x).into(), places.map(|p| p.y).into()];
        }
        let PinholeCamera { fx, fy, cx, cy, near_m, .. } = self.straight;
        let z = points.z.simd_gt(near_m).select(points.z, F32x8::splat(near_m));
        [points.x * fx / z + cx, points.y * fy / z + cy]
    }

    /// The direction in the optical frame in which a place of the picture looks, pixels; none where the lens
    /// shows nothing. 1 long along the axis, of fisheyes 1 long.
    #[must_use]
    pub fn direction(&self, column: f32, row: f32) -> Option<Vec3> {
        let Some(bent) = &self.bent else {
            return Some(self.straight.direction_optical(column, row));
        };
        let Optics { fx, fy, cx, cy, .. } = self.optics;
        let direction = bent.lens.direction([(f64::from(column) - cx) / fx, (f64::from(row) - cy) / fy])?;
        Some(Vec3::from_array(direction.map(|part| part as f32)))
    }
}

impl Bent {
    fn new(optics: &Optics, lens: LensModel) -> Result<Self, CameraError> {
        let width = optics.width as usize;
        let pixels = width * optics.height as usize;
        let ray = |pixel: usize| {
            let direction = lens.direction(optics.place((pixel % width) as u32, (pixel / width) as u32))?;
            Some(Vec3::from_array(direction.map(|part| part as f32)))
        };
        let rays: Option<Vec<Vec3>> = (0..pixels).into_par_iter().map(ray).collect();
        let Some(rays) = rays else {
            return Err(CameraError::Lens { problem: optics.problem().unwrap_or_default() });
        };
        Ok(Self { lens, rays: rays.into() })
    }
}
