//! From where a light looks at the world.

use frames::LocalOrigin;
use glam::{Affine3A, DVec3, Mat3A, Vec3, Vec3A};
use render::{CameraQuery, Outputs, PinholeCamera, RenderError, Scene, Stipple};

/// Distance of the stand-in for the sun, metres: far enough that its rays are within a degree of parallel,
/// near enough that depths keep a millimetre in `f32`.
const LIGHT_M: f32 = 10_000.0;
/// Heights around the place that cast and receive shadows, metres.
const REACH_M: f32 = 900.0;
/// Texels a side of the blocks whose depths are summed up.
pub(super) const BLOCK: usize = 8;
/// Places of lenses along the light are this far apart, metres.
const STEP_M: f64 = 64.0;

/// Light passes half of the panes, as about half passes two panes of 70 % each: the soft edges of shadows
/// make grey of the pattern.
const HALF_OF_PANES: Stipple = Stipple::new([[false, true], [true, false]]);

/// Depths of what cameras see of a scene, each of all instances or of some; panes of vehicles are opaque
/// where a pattern says so. All cameras are asked at once.
///
/// # Errors
/// The renderer failed.
pub(super) fn depths<'q>(
    scene: &dyn Scene,
    cameras: impl IntoIterator<Item = (&'q PinholeCamera, Option<&'q [u32]>, Stipple)>,
) -> Result<Vec<Vec<f32>>, RenderError> {
    let query = |(camera, among, panes): (&PinholeCamera, _, _)| CameraQuery {
        camera: *camera,
        among,
        outputs: Outputs::Depths,
        panes,
    };
    let queries: Vec<CameraQuery<'_>> = cameras.into_iter().map(query).collect();
    Ok(scene.render(&queries)?.into_iter().map(|seen| seen.depth_m).collect())
}

/// How large a map is, and how finely lenses for it are told apart.
#[derive(Clone, Copy, Debug)]
pub(super) struct Size {
    pub(super) half_m: f32,
    /// Texels a side.
    pub(super) side: u32,
    /// Lenses stand this many texels apart: an even number of blocks.
    cell: u32,
    /// Directions are told apart by this share of a radian.
    steps: f32,
    /// Whether the light shines through panes.
    through_panes: bool,
    /// Static objects are as detailed as they are at this distance, metres: leaves are some texels wide.
    detail_m: f64,
}

/// Fine near by, coarse far away. A light's direction is rounded so that shadows of what is ten metres high
/// move by less than half of a map's soft edge.
pub(super) const MAPS: [Size; 3] = [
    Size { half_m: 12.0, side: 768, cell: 256, steps: 256.0, through_panes: true, detail_m: 25.0 },
    Size { half_m: 45.0, side: 1024, cell: 384, steps: 256.0, through_panes: true, detail_m: 60.0 },
    Size { half_m: 160.0, side: 768, cell: 192, steps: 64.0, through_panes: true, detail_m: 160.0 },
];
/// The map from above.
pub(super) const ABOVE: Size =
    Size { half_m: 56.0, side: 448, cell: 192, steps: 256.0, through_panes: false, detail_m: 160.0 };
/// The map of houses from above.
pub(super) const HOUSES: Size =
    Size { half_m: 128.0, side: 256, cell: 64, steps: 256.0, through_panes: false, detail_m: 160.0 };
/// No lens stands farther from the place that it is for, metres.
pub(super) const ASIDE_M: f64 = 66.0;

impl Size {
    pub(super) fn texel_m(&self) -> f32 {
        2.0 * self.half_m / self.side as f32
    }

    /// Texels a side of all that a lens sees: the map of any place in its cell.
    fn whole_side(&self) -> u32 {
        self.side + self.cell
    }

    /// A direction as lenses of this size tell it from others.
    pub(super) fn rounded(&self, to_light: Vec3) -> Vec3 {
        ((to_light * self.steps).round() / self.steps).normalize_or(Vec3::Z)
    }
}

/// Where a lens is. All that it sees of static objects follows from this: not from the agent that it looks
/// for, nor the frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct LensKey {
    /// Bits of the direction to the light.
    to_light: [u32; 3],
    /// Bits of a texel's width, and texels a side.
    texel_m: u32,
    side: u32,
    /// Cells across and down, steps along the light, from the world's origin.
    cell: [i64; 3],
}

/// How a light looks at the world from one place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lens {
    pub(super) key: LensKey,
    pub(super) right: Vec3,
    pub(super) down: Vec3,
    pub(super) forward: Vec3,
    pub(super) texel_m: f32,
    /// Texels a side.
    pub(super) side: u32,
    /// What it looks at, in the world.
    pub(super) centre_m: DVec3,
    /// Whether the light shines through panes.
    through_panes: bool,
    /// As [`Size::detail_m`].
    pub(super) detail_m: f64,
}

/// A square of a lens's texels: the first column and row (whole blocks), and texels a side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    pub(super) corner: [u32; 2],
    pub(super) side: u32,
}

impl Lens {
    /// The lens of the cell that a place is in, and the window around that place.
    pub(super) fn at(place_m: DVec3, to_light: Vec3, size: &Size) -> (Self, Window) {
        let forward = -to_light;
        let right = forward.cross(if forward.z.abs() < 0.99 { Vec3::Z } else { Vec3::Y }).normalize();
        let down = forward.cross(right);
        let texel_m = size.texel_m();
        // Whole blocks from the world's origin, so that edges of shadows do not swim when the agent moves.
        let block_m = f64::from(texel_m) * BLOCK as f64;
        let blocks = |axis: Vec3| (axis.as_dvec3().dot(place_m) / block_m).round() as i64;
        let per_cell = i64::from(size.cell) / BLOCK as i64;
        let (x, y) = (blocks(right), blocks(down));
        let cell = [x, y].map(|b| (b + per_cell / 2).div_euclid(per_cell));
        let along = (forward.as_dvec3().dot(place_m) / STEP_M).round();
        let metres = |cell: i64| (cell * per_cell) as f64 * block_m;
        let centre_m = right.as_dvec3() * metres(cell[0])
            + down.as_dvec3() * metres(cell[1])
            + forward.as_dvec3() * (along * STEP_M);
        let corner = [(x, cell[0]), (y, cell[1])].map(|(block, cell)| {
            // From 0 to a cell's width.
            let blocks = (block - cell * per_cell + per_cell / 2).clamp(0, per_cell);
            blocks as u32 * BLOCK as u32
        });
        let key = LensKey {
            to_light: to_light.to_array().map(f32::to_bits),
            texel_m: texel_m.to_bits(),
            side: size.side,
            cell: [cell[0], cell[1], along as i64],
        };
        let Size { through_panes, detail_m, .. } = *size;
        let side = size.whole_side();
        let lens = Self { key, right, down, forward, texel_m, side, centre_m, through_panes, detail_m };
        (lens, Window { corner, side: size.side })
    }

    /// All that it sees.
    pub(super) fn whole(&self) -> Window {
        Window { corner: [0, 0], side: self.side }
    }

    /// Where panes stop its light.
    pub(super) fn panes(&self) -> Stipple {
        if self.through_panes { HALF_OF_PANES } else { Stipple::OPAQUE }
    }

    /// The camera that sees a window, in the local frame of an origin.
    pub(super) fn camera(&self, origin: &LocalOrigin, window: Window) -> PinholeCamera {
        let Self { right, down, forward, .. } = *self;
        let centre = origin.local_from_world(self.centre_m.to_array());
        let local_from_optical = Affine3A {
            matrix3: Mat3A::from_cols(right.into(), down.into(), forward.into()),
            translation: Vec3A::from(centre - forward * LIGHT_M),
        };
        let half = 0.5 * self.side as f32;
        let focal = LIGHT_M / self.texel_m;
        PinholeCamera {
            local_from_optical,
            width: window.side,
            height: window.side,
            fx: focal,
            fy: focal,
            cx: half - window.corner[0] as f32,
            cy: half - window.corner[1] as f32,
            near_m: LIGHT_M - REACH_M,
            far_m: LIGHT_M + REACH_M,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_window_is_around_the_place(
            x in -5e3..5e3f64, y in -5e3..5e3f64, z in -50.0..300.0f64, up in 0.04..1.0f32, turn in 0.0..6.0f32,
        ) {
            let place = DVec3::new(x, y, z);
            let (sin, cos) = frames::math::f32::sin_cos(turn);
            let flat = (1.0 - up * up).sqrt();
            for size in MAPS.iter().chain([&ABOVE, &HOUSES]) {
                let (lens, window) = Lens::at(place, Vec3::new(flat * cos, flat * sin, up), size);
                prop_assert!(window.corner.iter().all(|c| c + window.side <= lens.side && c % BLOCK as u32 == 0));
                let origin = LocalOrigin::near(place.to_array());
                let camera = lens.camera(&origin, window);
                let optical = camera.local_from_optical.inverse().transform_point3(origin.local_from_world(place.to_array()));
                // In the middle of the window, as exactly as whole blocks and slanted rays allow.
                let off = |focal: f32, centre: f32, v: f32| (focal * v / optical.z + centre - 0.5 * window.side as f32).abs();
                prop_assert!(off(camera.fx, camera.cx, optical.x) < 8.0, "{:?}", optical);
                prop_assert!(off(camera.fy, camera.cy, optical.y) < 8.0, "{:?}", optical);
                prop_assert!((optical.z - LIGHT_M).abs() < 33.0);
                prop_assert!((lens.centre_m - place).length() < ASIDE_M);
            }
        }
    }

    #[test]
    fn whoever_stands_in_a_cell_has_its_lens() {
        let light = Vec3::new(0.3, 0.2, 0.9).normalize();
        let lens = |x: f64| Lens::at(DVec3::new(x, 7.0, 0.0), light, &MAPS[2]).0;
        let (a, b) = (lens(100.0), lens(100.4));
        assert_eq!((a.key, a.centre_m), (b.key, b.centre_m));
        assert_ne!(a.key, lens(300.0).key);
    }
}
