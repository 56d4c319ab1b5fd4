//! Rooms behind windows: a box behind each, met by the way one looks into it (van Dongen, "Interior mapping",
//! 2008).

use glam::Vec3;
use simd::{F32x8, U32x8, Vec3x8, unit};

/// How far panes stand behind the wall's face, metres.
pub(super) const REVEAL_M: f32 = 0.14;

/// Where windows are looked into: wall coordinates, metres (along the wall, up, inwards).
#[derive(Clone, Copy)]
pub(super) struct Gaze {
    /// Way from the camera to the point, not of unit length; inwards is above 0.
    pub(super) along: F32x8,
    pub(super) up: F32x8,
    pub(super) inward: F32x8,
}

/// Eight places on panes, each with its room.
pub(super) struct Pane {
    /// From the left wall and the floor of the room, metres.
    pub(super) at_m: [F32x8; 2],
    /// Width and height of rooms, metres.
    pub(super) size_m: [f32; 2],
    /// From the left and lower edge of the opening to the right and upper one, 0 to 1.
    pub(super) in_opening: [F32x8; 2],
    /// A random word for each room.
    pub(super) word: U32x8,
}

/// What is seen through a pane.
pub(super) struct Inside {
    /// Share of the daylight at the window that comes back.
    pub(super) by_day: Vec3x8,
    /// Light that comes out while its lamp burns; 1 is about the mean.
    pub(super) by_night: Vec3x8,
}

/// What is seen through eight panes.
#[inline]
pub(super) fn inside(gaze: &Gaze, pane: &Pane) -> Inside {
    let [width, height] = pane.size_m;
    let draw = |salt: u32| unit(pane.word * salt);
    let depth = draw(0x9e37_79b1) * 3.0 + 2.5;
    let tiny = |v: F32x8| v.abs().simd_lt(1e-5).select(F32x8::splat(1e-5), v);
    let (along, up, inward) = (tiny(gaze.along), tiny(gaze.up), gaze.inward.fast_max(F32x8::splat(1e-4)));
    // How far along the way each plane is met: a side wall, floor or ceiling, the back.
    let ahead = |way: F32x8, at: F32x8, size: f32| {
        (way.simd_gt(0.0).select(F32x8::splat(size), F32x8::ZERO) - at) / way
    };
    let (side, level, back) =
        (ahead(along, pane.at_m[0], width), ahead(up, pane.at_m[1], height), depth / inward);
    let least = side.fast_min(level).fast_min(back).fast_max(F32x8::ZERO);
    let (x, y, z) = (pane.at_m[0] + along * least, pane.at_m[1] + up * least, inward * least);
    let is_level = level.simd_le(least);
    let is_back = back.simd_le(least);
    let tone = draw(0x85eb_ca6b) * 0.45 + 0.4;
    let warm = draw(0xc2b2_ae35);
    let is_floor = is_level & up.simd_lt(0.0);
    let mut shade = is_level.select(F32x8::splat(0.85), tone);
    shade = is_floor.select(tone * 0.35, shade);
    // Cupboards and sofas stand against the back; pictures hang over them.
    let low = draw(0x27d4_eb2f) * 1.1 + 0.5;
    let from = draw(0x1656_67b1) * 0.6 * width;
    let furnished = is_back & y.simd_lt(low) & x.simd_gt(from) & x.simd_lt(from + 0.45 * width);
    shade = furnished.select(tone * 0.3, shade);
    let room = Vec3x8::new(shade, shade * (1.0 - warm * 0.1), shade * (1.0 - warm * 0.25));
    // Daylight comes from the window alone; the lamp hangs in the middle.
    let day = 0.2 / (z * z * 0.7 + 1.0);
    let (dx, dy, dz) = (x - 0.5 * width, y - height, z - depth * 0.5);
    let lamp = 3.4 / (dx * dx + dy * dy + dz * dz + 2.2);
    let mut by_day = room * day;
    let mut by_night = room * lamp;
    // Curtains at both sides, blinds from above; most windows have little of either.
    let [across, high] = pane.in_opening;
    let drawn = draw(0xd3a2_646c) * draw(0xfd70_46c5) * 0.55;
    let down = draw(0xb55a_4f09);
    let down = down.simd_gt(0.7).select((down - 0.7) * 2.6, F32x8::ZERO);
    let cloth = across.simd_lt(drawn) | across.simd_gt(1.0 - drawn) | high.simd_gt(1.0 - down);
    if cloth.any() {
        let folds = across * 14.0;
        let fold = (folds - folds.floor() - 0.5).abs() * 0.4 + 0.8;
        let fabric = Vec3x8::splat(Vec3::new(0.30, 0.28, 0.24)) * (fold * (draw(0x68bc_21eb) * 0.7 + 0.4));
        by_day = fabric.or(cloth, by_day);
        by_night = (fabric * F32x8::splat(3.0)).or(cloth, by_night);
    }
    Inside { by_day, by_night }
}
