//! What the windows of a building look like.

use glam::Vec3;
use schema::ObjectId;
use schema::geometry::Wall;

use super::room::REVEAL_M;

/// Paint of window frames, linear: white, black, oak, dark brown, green, grey.
const FRAME_RGB: [Vec3; 6] = [
    Vec3::splat(0.55),
    Vec3::new(0.05, 0.048, 0.045),
    Vec3::new(0.16, 0.09, 0.045),
    Vec3::new(0.06, 0.03, 0.018),
    Vec3::new(0.03, 0.06, 0.04),
    Vec3::splat(0.2),
];
/// Paint of shutters and of sheets before loggias, linear.
const PAINT_RGB: [Vec3; 7] = [
    Vec3::new(0.03, 0.10, 0.06),
    Vec3::new(0.18, 0.04, 0.03),
    Vec3::new(0.05, 0.11, 0.20),
    Vec3::new(0.35, 0.33, 0.29),
    Vec3::new(0.42, 0.29, 0.10),
    Vec3::new(0.11, 0.06, 0.035),
    Vec3::new(0.28, 0.31, 0.33),
];

/// A number of a building, 0 to 1.
pub(super) fn own(object: ObjectId, salt: i32) -> f32 {
    crate::textures::unit(crate::textures::hash2(i32::from(object), salt, 0x51ed))
}

/// What a front is divided into.
pub(super) struct Style {
    pub(super) bay_m: f32,
    /// Width and height of openings over those of bays and storeys.
    pub(super) opening: [f32; 2],
    /// Panes beside one another in a usual window.
    pub(super) panes: f32,
    /// How far panes stand back, metres.
    pub(super) reveal_m: f32,
    /// Strength of window sills, and of bands between storeys.
    pub(super) sill: f32,
    pub(super) band: f32,
    /// Width of the stone around openings, metres; 0 for none.
    pub(super) surround_m: f32,
    pub(super) shutter_rgb: Option<Vec3>,
    /// Where a bar across parts windows, share of their height.
    pub(super) transom: Option<f32>,
    pub(super) frame_rgb: Vec3,
    /// Of the sheets before loggias.
    pub(super) panel_rgb: Vec3,
    /// Share of light that panes mirror and let through.
    pub(super) mirror: f32,
    pub(super) clear: f32,
}

impl Style {
    #[inline]
    pub(super) fn of(wall: Wall, pick: &impl Fn(i32) -> f32) -> Self {
        let (wide, high) = (pick(2), pick(3));
        let common = Self {
            bay_m: 2.6 + pick(1),
            opening: [0.40 + 0.18 * wide, 0.46 + 0.14 * high],
            panes: [1.0, 2.0, 2.0, 2.0, 3.0][(5.0 * pick(4)) as usize],
            reveal_m: REVEAL_M,
            sill: 1.0,
            band: if pick(5) > 0.5 { 1.0 } else { 0.0 },
            surround_m: [0.0, 0.0, 0.1, 0.14][(4.0 * pick(15)) as usize],
            shutter_rgb: None,
            transom: [None, None, Some(0.7), Some(0.5)][(4.0 * pick(14)) as usize],
            frame_rgb: FRAME_RGB[(FRAME_RGB.len() as f32 * pick(16)) as usize],
            panel_rgb: PAINT_RGB[(PAINT_RGB.len() as f32 * pick(17)) as usize],
            // Two panes mirror at four faces.
            mirror: 0.13,
            clear: 0.75,
        };
        let shutter_rgb = (pick(13) > 0.68).then(|| common.panel_rgb * 0.6);
        match wall {
            // Shutters need the room that stone around windows would take.
            Wall::Plaster | Wall::Brick => match shutter_rgb {
                Some(_) => Self { shutter_rgb, surround_m: 0.0, ..common },
                None => common,
            },
            Wall::Ashlar => Self { band: 1.0, opening: [0.38 + 0.1 * wide, 0.55 + 0.1 * high], ..common },
            Wall::Panels => Self {
                bay_m: 3.2 + pick(1),
                opening: [0.6 + 0.25 * wide, 0.44 + 0.08 * high],
                panes: if wide < 0.5 { 2.0 } else { 3.0 },
                sill: 0.0,
                band: 0.0,
                surround_m: 0.0,
                transom: None,
                reveal_m: 0.1,
                ..common
            },
            Wall::Curtain => Self {
                bay_m: 1.4 + 0.5 * pick(1),
                opening: [0.955, 0.66 + 0.2 * high],
                panes: 1.0,
                reveal_m: 0.03,
                sill: 0.0,
                band: 0.0,
                surround_m: 0.0,
                transom: None,
                mirror: 0.22,
                clear: 0.45,
                ..common
            },
        }
    }
}
