//! Streaks of falling rain in front of a camera.

use glam::{Vec2, Vec3};
use renderer::VisibilityBuffer;

use super::model::CameraModel;
use super::picture::Picture;
use crate::look::{hash2, unit};

/// Drops at full rain.
const DROPS: f32 = 2600.0;
/// Length of a streak: speed times shutter time, metres.
const STREAK_M: f32 = 0.16;
/// Drops nearer are out of focus, farther are fog.
const NEAREST_M: f32 = 0.7;
const FARTHEST_M: f32 = 9.0;

/// Draws the streaks of drops that are nearer than the scene. Where they fall depends on the camera's place and
/// direction alone: a frame rendered twice has the same drops.
pub(super) fn draw_rain(
    picture: &mut Picture,
    (model, buffer): (&CameraModel, &VisibilityBuffer),
    rain: f32,
    world_from_local_m: Vec3,
) {
    let camera = &buffer.camera;
    let (width, height) = (picture.width as f32, picture.height as f32);
    let place = Vec3::from(camera.local_from_optical.translation) + world_from_local_m;
    let forward = camera.local_from_optical.matrix3.z_axis;
    let seed = hash2(
        (place.x * 64.0) as i32 ^ ((forward.x * 512.0) as i32) << 16,
        (place.y * 64.0) as i32 ^ ((forward.y * 512.0) as i32) << 16,
        buffer.depth_m.get(buffer.depth_m.len() / 2).map_or(0, |d| d.to_bits()),
    );
    let down = camera.local_from_optical.matrix3.transpose() * Vec3::NEG_Z;
    for drop in 0..(DROPS * rain) as i32 {
        let number = |salt: i32| unit(hash2(drop, salt, seed));
        // Evenly by volume up to the farthest: the cube root spreads the distances.
        let t = number(0);
        let z = NEAREST_M + (FARTHEST_M - NEAREST_M) * frames::math::cbrt(f64::from(t)) as f32;
        let start =
            Vec2::new(number(1) * 1.1 * width - 0.05 * width, number(2) * 1.2 * height - 0.2 * height);
        let Some(direction) = model.direction(start.x, start.y) else { continue };
        let tail = direction * z + down * STREAK_M;
        let (end, is_shown) = model.project(tail);
        if !is_shown || tail.length() < 0.3 {
            continue;
        }
        let strength = 0.12 + 0.3 * number(3) / z.max(1.0);
        streak(picture, buffer, start, end, z, strength);
    }
}

/// Lightens a line of pixels, tapered at its ends.
fn streak(
    picture: &mut Picture,
    buffer: &VisibilityBuffer,
    from: Vec2,
    to: Vec2,
    depth_m: f32,
    strength: f32,
) {
    let steps = ((to - from).abs().max_element().ceil() as i32).clamp(1, 400);
    for i in 0..=steps {
        let t = i as f32 / steps as f32;
        let p = from + (to - from) * t;
        if p.x < 0.0 || p.y < 0.0 || p.x >= picture.width as f32 || p.y >= picture.height as f32 {
            continue;
        }
        let index = buffer.index(p.x as u32, p.y as u32);
        if buffer.depth_m[index] < depth_m {
            continue;
        }
        let share = strength * 4.0 * t * (1.0 - t);
        for value in &mut picture.rgb[3 * index..3 * index + 3] {
            let v = f32::from(*value);
            *value = (v + (v * 0.5 + 120.0 - v).max(18.0) * share).clamp(0.0, 255.0) as u8;
        }
    }
}
