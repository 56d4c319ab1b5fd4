//! Headlights: what they give in each direction, and what stands in their way.

use glam::{Affine3A, Mat3A, Vec3};
use lanes::{Lanes, Vec3s};
use renderer::{PinholeCamera, RenderError, Scene};
use schema::geometry::Instance;
use schema::{ObjectId, Tag};

/// How far headlights are followed, metres.
pub(super) const REACH_M: f32 = 64.0;
/// What a headlight sees of the world: columns, rows and field of view. Beyond it nothing casts a shadow.
const COLUMNS: u32 = 384;
const ROWS: u32 = 128;
const FOV_RAD: f32 = 1.9;
/// Tags of the ground.
const GROUND: [Tag; 6] = [Tag::Road, Tag::RoadLine, Tag::Sidewalk, Tag::Ground, Tag::Terrain, Tag::Water];
/// What is so near is not in the way, metres: rims of the lamp itself.
const NEAR_M: f32 = 0.3;
/// Surfaces are so thick for their own shadow: metres, and more with the distance.
const THICK_M: f32 = 0.10;
const THICK_SHARE: f32 = 0.02;

/// A headlight's lobe by tangents of angles from its middle, each over its half width.
#[inline]
fn lobe(across: Lanes, over: Lanes) -> Lanes {
    let fall = 1.0 / (across * across + over * over + 1.0);
    fall * fall
}

/// Intensity of one headlight, kilocandela, by cosines of the angles between a direction and ahead, left and up.
///
/// As UN Regulation 112 draws passing beams for right-hand traffic: below a cut-off 0.6 degrees under the horizon that rises by
/// 15 degrees on the right, brightest close under it, little above. Driving beams have their middle on the horizon.
#[inline]
pub(super) fn intensity(is_high: bool, [ahead, left, up]: [Lanes; 3]) -> Lanes {
    let forward = ahead.fast_max(Lanes::splat(0.05));
    let (h, v) = (left / forward, up / forward);
    let skirt = ahead.fast_max(Lanes::ZERO);
    let skirt = skirt * skirt * 0.25;
    let is_ahead = ahead.simd_gt(0.0).select(Lanes::ONE, Lanes::ZERO);
    if is_high {
        let near = lobe(h * (1.0 / 0.10), v * (1.0 / 0.06)) * 24.0;
        let wide = lobe(h * (1.0 / 0.40), (v + 0.05) * (1.0 / 0.10)) * 4.0;
        return (near + wide) * is_ahead + skirt;
    }
    let rise = (h * -0.268).fast_clamp(Lanes::ZERO, Lanes::splat(0.05));
    let below = ((rise - 0.010 - v) * (1.0 / 0.010) + 0.5).fast_clamp(Lanes::ZERO, Lanes::ONE);
    let near = lobe((h + 0.03) * (1.0 / 0.14), (v + 0.026) * (1.0 / 0.030)) * 9.0;
    let wide = lobe(h * (1.0 / 0.50), (v + 0.07) * (1.0 / 0.09)) * 2.5;
    (near + wide) * below * is_ahead + skirt
}

/// More than one headlight gives anything so far off its axis in plan, kilocandela: cosine of the least angle there.
pub(super) fn most_kcd(is_high: bool, cos: f32) -> f32 {
    // Beyond the lobes' edges there is their skirt, which ends with the cosine.
    match cos {
        ..=0.0 => 0.0,
        ..0.3 => 0.03,
        ..0.6 => 0.15,
        ..0.9 => 1.0,
        _ if is_high => 29.0,
        _ => 12.0,
    }
}

/// What the headlights of a vehicle see from between them: what is behind that is in shadow.
#[derive(Clone, Debug)]
pub(super) struct Seen {
    camera: PinholeCamera,
    optical_from_local: Affine3A,
    depth_m: Vec<f32>,
}

impl Seen {
    /// From a place, looking ahead; the vehicle itself is not in the way.
    ///
    /// # Errors
    /// The renderer failed.
    pub(super) fn new(
        scene: &dyn Scene,
        own: ObjectId,
        place: Vec3,
        [ahead, up]: [Vec3; 2],
    ) -> Result<Self, RenderError> {
        let right = ahead.cross(up);
        let turn = Mat3A::from_cols(right.into(), (-up).into(), ahead.into());
        let local_from_optical = Affine3A { matrix3: turn, translation: place.into() };
        let camera = PinholeCamera {
            near_m: NEAR_M,
            far_m: REACH_M,
            ..PinholeCamera::centred(local_from_optical, COLUMNS, ROWS, FOV_RAD)
        };
        // Houses and vehicles have their origins within them. Light only grazes the ground, which would shade itself.
        let snapshot = scene.snapshot();
        let is_near = |i: &Instance| {
            i.object != own
                && (Vec3::from(i.local_from_object.translation) - place).length() < REACH_M
                && !snapshot.mesh(i).parts.iter().any(|part| GROUND.contains(&part.tag))
        };
        let instances = (0..).zip(&snapshot.instances);
        let near: Vec<u32> = instances.filter(|(_, i)| is_near(i)).map(|(number, _)| number).collect();
        let depth_m = scene.depths(&camera, Some(&near))?;
        Ok(Self { camera, optical_from_local: local_from_optical.inverse(), depth_m })
    }

    /// Share of the light that reaches places: 1, or 0 behind what is in the way.
    #[inline]
    pub(super) fn reaches(&self, positions: &Vec3s) -> Lanes {
        let turn = glam::Mat3::from(self.optical_from_local.matrix3);
        let q = positions.turned(&turn) + Vec3s::splat(self.optical_from_local.translation.into());
        let is_ahead = q.z.simd_gt(NEAR_M);
        let z = is_ahead.select(q.z, Lanes::ONE);
        let column = (q.x / z * self.camera.fx + self.camera.cx).to_array();
        let row = (q.y / z * self.camera.fy + self.camera.cy).to_array();
        let (near, depth) = (is_ahead.to_bitmask(), z.to_array());
        Lanes::from(std::array::from_fn(|i| {
            let inside = column[i] >= 0.0
                && row[i] >= 0.0
                && column[i] < self.camera.width as f32
                && row[i] < self.camera.height as f32;
            if !inside || near >> i & 1 == 0 {
                return 1.0;
            }
            let seen_m = self.depth_m[row[i] as usize * self.camera.width as usize + column[i] as usize];
            if depth[i] * (1.0 - THICK_SHARE) - THICK_M <= seen_m { 1.0 } else { 0.0 }
        }))
    }
}

#[cfg(test)]
mod tests {
    use renderer::Renderer;
    use schema::geometry::Surface;
    use testkit::{block, instance, snapshot};
    use visibility::CpuRenderer;

    use super::*;

    #[test]
    fn no_direction_gets_more_than_is_said() {
        for is_high in [false, true] {
            for yaw_deg in -180..=180 {
                let (left, ahead) = frames::math::f32::sin_cos((yaw_deg as f32).to_radians());
                for pitch_deg in -60..=60 {
                    let (up, level) = frames::math::f32::sin_cos((pitch_deg as f32).to_radians());
                    let axes = [ahead * level, left * level, up].map(Lanes::splat);
                    let got = intensity(is_high, axes).to_array()[0];
                    assert!(got <= most_kcd(is_high, ahead), "{yaw_deg} {pitch_deg}: {got}");
                }
            }
        }
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
        let seen = Seen::new(&*scene, 1, lamps, [Vec3::X, Vec3::Z]).expect("has no device");
        let lit =
            |x: f32, y: f32, z: f32| seen.reaches(&Vec3s::splat(Vec3::new(x, y, z))).to_array()[3] > 0.5;
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
}
