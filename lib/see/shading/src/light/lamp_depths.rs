//! Shadows of lamps: depth maps seen from the lamp.

use glam::{Affine3A, Mat3A, Vec3};
use rayon::prelude::*;
use render::{PinholeCamera, RenderError, Scene, Stipple};
use schema::ObjectId;
use schema::geometry::{Instance, Snapshot};
use simd::{F32x8, Vec3x8};

use super::lens::depths;
use super::walls::is_ground;

/// What is so near is not in the way, metres: rims of the lamp itself.
const NEAR_M: f32 = 0.3;
/// Surfaces are so thick for their own shadow: metres, and more with the distance.
const THICK_M: f32 = 0.10;
const THICK_SHARE: f32 = 0.02;
/// They are looked at from so far before them, texels, where light grazes them.
const OFF: f32 = 1.25;

/// How a lamp looks at the world: columns, rows, field of view across, and how far. Beyond it nothing casts a
/// shadow.
#[derive(Clone, Copy, Debug)]
pub(super) struct LampView {
    columns: u32,
    rows: u32,
    fov_rad: f32,
    reach_m: f32,
}

impl LampView {
    pub(super) const HEADLIGHT: Self =
        Self { columns: 384, rows: 128, fov_rad: 1.9, reach_m: super::headlight::REACH_M };
    /// Of a street lamp two and a quarter times as far to the sides as it is high, where its light is faint.
    pub(super) const WIDE: Self =
        Self { columns: 320, rows: 320, fov_rad: 2.3, reach_m: 1.2 * super::street::REACH_M };
}

/// What a lamp, or both headlights of a vehicle from between them, see: what is behind that is in shadow.
#[derive(Clone, Debug)]
pub(super) struct LampDepths {
    camera: PinholeCamera,
    optical_from_local: Affine3A,
    depth_m: Vec<f32>,
}

/// From where a lamp looks; its own object is not in the way.
#[derive(Clone, Copy, Debug)]
pub(super) struct LampEye {
    pub(super) own: ObjectId,
    pub(super) place: Vec3,
    pub(super) ahead: Vec3,
    /// Square to `ahead`.
    pub(super) up: Vec3,
    pub(super) view: LampView,
}

impl LampEye {
    fn camera(&self) -> PinholeCamera {
        let Self { place, ahead, up, view, .. } = *self;
        let right = ahead.cross(up);
        let turn = Mat3A::from_cols(right.into(), (-up).into(), ahead.into());
        let local_from_optical = Affine3A { matrix3: turn, translation: place.into() };
        PinholeCamera {
            near_m: NEAR_M,
            far_m: view.reach_m,
            ..PinholeCamera::centred(local_from_optical, view.columns, view.rows, view.fov_rad)
        }
    }

    /// The instances that may be in the way. Houses and vehicles have their origins within them. Light only
    /// grazes the ground, which would shade itself.
    fn near(&self, snapshot: &Snapshot) -> Vec<u32> {
        let is_near = |i: &Instance| {
            i.object != self.own
                && (Vec3::from(i.local_from_object.translation) - self.place).length() < self.view.reach_m
                && !is_ground(snapshot.mesh(i))
        };
        let instances = (0..).zip(&snapshot.instances);
        instances.filter(|(_, i)| is_near(i)).map(|(number, _)| number).collect()
    }
}

impl LampDepths {
    /// What lamps see, all asked for at once, in their order.
    ///
    /// # Errors
    /// The renderer failed.
    pub(super) fn of(scene: &dyn Scene, eyes: &[LampEye]) -> Result<Vec<Self>, RenderError> {
        let asked = |eye: &LampEye| (eye.camera(), eye.near(scene.snapshot()));
        let asked: Vec<(PinholeCamera, Vec<u32>)> = eyes.par_iter().map(asked).collect();
        let cameras = asked.iter().map(|(camera, near)| (camera, Some(&near[..]), Stipple::OPAQUE));
        let seen = asked.iter().zip(depths(scene, cameras)?);
        let depths = seen.map(|((camera, _), depth_m)| Self {
            camera: *camera,
            optical_from_local: camera.local_from_optical.inverse(),
            depth_m,
        });
        Ok(depths.collect())
    }

    /// Share of the light that reaches places of surfaces that look along the normals: 1, or 0 behind what is
    /// in the way; of the four texels around each.
    #[inline]
    pub(super) fn reaches(&self, positions: &Vec3x8, normals: &Vec3x8) -> F32x8 {
        let turn = glam::Mat3::from(self.optical_from_local.matrix3);
        let q = positions.turned(&turn) + Vec3x8::splat(self.optical_from_local.translation.into());
        // From before the surface, the more the beam runs along it: its depth changes much from texel to
        // texel, and it would shade itself.
        let n = normals.turned(&turn);
        let facing = q.dot(n);
        let along =
            (1.0 - facing * facing / q.length_squared().fast_max(F32x8::splat(1e-6))).fast_max(F32x8::ZERO);
        let q = q + n * (along * q.z.abs() * (OFF / self.camera.fx));
        let is_ahead = q.z.simd_gt(NEAR_M);
        let z = is_ahead.select(q.z, F32x8::ONE);
        let column = (q.x / z * self.camera.fx + (self.camera.cx - 0.5)).to_array();
        let row = (q.y / z * self.camera.fy + (self.camera.cy - 0.5)).to_array();
        let (near, nearest) = (is_ahead.to_bitmask(), (z * (1.0 - THICK_SHARE) - THICK_M).to_array());
        let (columns, rows) = (self.camera.width as usize, self.camera.height as usize);
        F32x8::from(std::array::from_fn(|i| {
            let (x, y) = (column[i], row[i]);
            let inside = x >= 0.0 && y >= 0.0 && x < (columns - 1) as f32 && y < (rows - 1) as f32;
            if !inside || near >> i & 1 == 0 {
                return 1.0;
            }
            let first = y as usize * columns + x as usize;
            let lit = |at: usize| if nearest[i] <= self.depth_m[at] { 1.0 } else { 0.0 };
            let (fx, fy) = (x - x.floor(), y - y.floor());
            let along = |first: usize| {
                let left: f32 = lit(first);
                left + (lit(first + 1) - left) * fx
            };
            let upper = along(first);
            upper + (along(first + columns) - upper) * fy
        }))
    }
}

#[cfg(test)]
mod tests {
    use render::Renderer;
    use render::cpu::CpuRenderer;
    use schema::Tag;
    use schema::geometry::Surface;
    use testkit::{block, instance, snapshot};

    use super::*;

    /// What a lamp of object 1 sees.
    fn seen_by(scene: &dyn Scene, place: Vec3, [ahead, up]: [Vec3; 2], view: LampView) -> LampDepths {
        let eye = LampEye { own: 1, place, ahead, up, view };
        LampDepths::of(scene, &[eye]).expect("has no device").remove(0)
    }

    #[test]
    fn what_is_behind_a_car_is_dark() {
        // A block 2 m wide and 1.5 m high, 10 m ahead, and the vehicle whose lamps these are around them.
        let at = |x: f32| Affine3A::from_translation(Vec3::new(x, 0.0, 0.0));
        let meshes = vec![block([1.0, 2.0, 1.5], Tag::Car, Surface::Paint)];
        let snapshot = snapshot(meshes, vec![instance(0, 1, at(0.0)), instance(0, 2, at(10.5))]);
        let mut renderer = CpuRenderer::default();
        renderer.prepare(&snapshot.meshes).expect("has no device");
        let scene = renderer.place(&snapshot).expect("all meshes are prepared");
        let lamps = Vec3::new(0.4, 0.0, 0.65);
        let seen = seen_by(&*scene, lamps, [Vec3::X, Vec3::Z], LampView::HEADLIGHT);
        let share = |place: Vec3| seen.reaches(&Vec3x8::splat(place), &Vec3x8::splat(-Vec3::X)).to_array()[3];
        let lit = |x: f32, y: f32, z: f32| share(Vec3::new(x, y, z)) > 0.5;
        // Its face itself, and what is before it and beside it.
        assert!(lit(10.0, 0.3, 0.7) && lit(6.0, 0.0, 0.0) && lit(20.0, 6.0, 0.0));
        // Behind it the shadow grows: at 30 m it is 6 m wide and reaches 3.2 m up.
        for (y, z) in [(0.0, 0.5), (2.7, 0.5), (-2.7, 2.0), (0.0, 3.0)] {
            assert!(!lit(30.0, y, z), "{y} {z}");
        }
        for (y, z) in [(3.5, 0.5), (-3.5, 2.0), (0.0, 3.6)] {
            assert!(lit(30.0, y, z), "{y} {z}");
        }
        // To the sides and behind nothing is in the way.
        assert!(lit(0.0, 5.0, 0.5) && lit(-20.0, 0.0, 0.5));
    }

    #[test]
    fn walls_along_a_beam_do_not_shade_themselves() {
        for (off_m, view) in
            [(1.0f32, LampView::HEADLIGHT), (4.0, LampView::HEADLIGHT), (1.5, LampView::WIDE)]
        {
            // A wall along the beam.
            let wall = Affine3A::from_translation(Vec3::new(30.0, off_m + 0.25, 0.0));
            let meshes = vec![block([60.0, 0.5, 6.0], Tag::Building, Surface::Plain)];
            let snapshot = snapshot(meshes, vec![instance(0, 2, wall)]);
            let mut renderer = CpuRenderer::default();
            renderer.prepare(&snapshot.meshes).expect("has no device");
            let scene = renderer.place(&snapshot).expect("all meshes are prepared");
            let seen = seen_by(&*scene, Vec3::Z, [Vec3::X, Vec3::Z], view);
            let normal = Vec3x8::splat(-Vec3::Y);
            for k in 0..400 {
                let place = Vec3::new(3.0 + 0.11 * k as f32, off_m, 0.5 + 0.003 * k as f32);
                let share = seen.reaches(&Vec3x8::splat(place), &normal).to_array()[3];
                assert!(share > 0.99, "{place}: {share}");
            }
        }
    }

    #[test]
    fn what_is_under_a_roof_is_dark_to_a_street_lamp() {
        // A lamp 8 m up, and a block 4 m wide and 1.6 m high that begins 3 m beside it.
        let pole = Affine3A::from_translation(Vec3::new(0.0, -1.0, 0.0));
        let car = Affine3A::from_translation(Vec3::new(5.0, 0.0, 0.0));
        let meshes = vec![block([4.0, 2.0, 1.6], Tag::Car, Surface::Paint)];
        let snapshot = snapshot(meshes, vec![instance(0, 1, pole), instance(0, 2, car)]);
        let mut renderer = CpuRenderer::default();
        renderer.prepare(&snapshot.meshes).expect("has no device");
        let scene = renderer.place(&snapshot).expect("all meshes are prepared");
        let axes = [-Vec3::Z, Vec3::X];
        let seen = seen_by(&*scene, 8.0 * Vec3::Z, axes, LampView::WIDE);
        let up = Vec3x8::splat(Vec3::Z);
        let share = |x: f32, y: f32| seen.reaches(&Vec3x8::splat(Vec3::new(x, y, 0.0)), &up).to_array()[3];
        // Its far upper edge lies at 7 m, so its shadow ends at 7 * 8 / 6.4.
        let end = 7.0 * 8.0 / 6.4;
        for (x, want) in [(2.8, 1.0), (3.3, 0.0), (end - 0.3, 0.0), (end + 0.2, 1.0), (15.0, 1.0)] {
            assert_eq!(share(x, 0.0), want, "{x}");
        }
        // Its edge is as wide as a texel (0.11 m), half lit in the middle, and set back by less than one.
        let across: f32 = (-75..25).map(|k| share(end + k as f32 * 0.004, 0.0)).sum::<f32>() / 100.0;
        assert!((across - 0.5).abs() < 0.25, "{across}");
    }
}
