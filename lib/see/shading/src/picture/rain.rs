//! Streaks of falling rain in front of a camera.

use crate::textures::{hash2, unit};
use glam::{Vec2, Vec3};
use render::VisibilityBuffer;

use super::picture::Picture;
use crate::materials::Surroundings;
use render::CameraModel;
use render::CameraView;

/// Drops in a cubic metre at full rain: those that are large enough to be seen.
const DROPS_PER_M3: f32 = 7.0;
/// How far a drop falls while the shutter is open, metres: 8 m/s for a fiftieth of a second.
const STREAK_M: f32 = 0.16;
/// For what part of a frame period the shutter is open.
const SHUTTER: f32 = 0.4;
/// Drops nearer are out of focus, farther are fog.
const NEAREST_M: f32 = 0.7;
const FARTHEST_M: f32 = 9.0;

/// Rain at a moment, the same for all cameras that see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rain {
    /// 0 to 1.
    pub(super) strength: f32,
    /// Number of the frame: in each, other drops fall.
    pub(super) frame: u32,
    pub(super) world_from_local_m: Vec3,
}

/// Draws the streaks of drops that are nearer than what is seen. Drops have their places in the world: two
/// cameras that look at one see it both, and streaks lean towards a camera that drives.
pub(super) fn draw_rain(picture: &mut Picture, view: &CameraView, buffer: &VisibilityBuffer, rain: Rain) {
    let turn = view.local_from_optical.matrix3.transpose();
    let camera = Vec3::from(view.local_from_optical.translation);
    let moved = camera - Vec3::from(view.previous_local_from_optical.translation);
    let way = turn * (Vec3::NEG_Z * STREAK_M - moved * SHUTTER);
    let place = camera + rain.world_from_local_m;
    let corner = (place - Vec3::splat(FARTHEST_M)).floor().as_ivec3();
    let side = 2 * FARTHEST_M as i32 + 1;
    for i in 0..side * side * side {
        let cell = corner + glam::IVec3::new(i % side, i / side % side, i / (side * side));
        let middle = turn * (cell.as_vec3() + Vec3::splat(0.5) - place);
        if middle.z < 0.0 || middle.length() > FARTHEST_M + 1.0 {
            continue;
        }
        // Places repeat, and an agent may stand where they begin anew.
        let [x, y, z] = cell.to_array().map(|c| c & (Surroundings::WRAP_M as i32 - 1));
        let seed = hash2(x, y, hash2(z, rain.frame as i32, 0x5bd1));
        let number = |drop: i32, salt: i32| unit(hash2(drop, salt, seed));
        for drop in 0..(DROPS_PER_M3 * rain.strength + number(-1, 0)) as i32 {
            let within = Vec3::new(number(drop, 0), number(drop, 1), number(drop, 2));
            let start = turn * (cell.as_vec3() + within - place);
            if start.z < NEAREST_M || start.length() > FARTHEST_M {
                continue;
            }
            if let Some((ends, depth_m)) = shown(&view.model, [start, start + way]) {
                let strength = 0.12 + 0.3 * number(drop, 3) / start.z.max(1.0);
                streak(picture, buffer, ends, depth_m, strength);
            }
        }
    }
}

/// Where both ends of a streak (optical frame) fall, and its depth as pictures tell depths.
fn shown(model: &CameraModel, ends: [Vec3; 2]) -> Option<([Vec2; 2], f32)> {
    let [(from, is_in), (to, is_out)] = ends.map(|end| model.project(end));
    let depth_m = ends[0].length() / model.direction(from.x, from.y)?.length();
    (is_in && is_out && ends[1].length() > 0.3).then_some(([from, to], depth_m))
}

/// Lightens a line of pixels, tapered at its ends.
fn streak(
    picture: &mut Picture,
    buffer: &VisibilityBuffer,
    [from, to]: [Vec2; 2],
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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::Affine3A;
    use settings::{CameraSettings, Optics};

    use super::*;

    /// A black picture over open ground, looking along x turned by so much, of a camera that moved there.
    fn wet(yaw_rad: f32, moved: Vec3, frame: u32) -> Picture {
        wet_at([Vec3::ZERO, Vec3::new(3.2, -7.1, 0.6)], yaw_rad, moved, frame, f32::INFINITY)
    }

    /// The same from a place in a local frame whose origin is somewhere in the world, before a wall at a
    /// planar depth.
    fn wet_at([place, world]: [Vec3; 2], yaw_rad: f32, moved: Vec3, frame: u32, wall_m: f32) -> Picture {
        let (width, height) = (320, 200);
        let forward = glam::Mat3::from_cols(Vec3::NEG_Y, Vec3::NEG_Z, Vec3::X);
        let turn = glam::Mat3::from_rotation_z(yaw_rad) * forward;
        let at = |place: Vec3| Affine3A::from_mat3_translation(turn, place);
        let model = CameraModel::new(&Optics::pinhole(width, height, frames::deg(90.0))).expect("is small");
        let view = CameraView {
            local_from_optical: at(place),
            previous_local_from_optical: at(place - moved),
            model: Arc::new(model),
            settings: CameraSettings::default(),
        };
        let mut buffer = VisibilityBuffer::empty(&view.pinhole());
        buffer.depth_m.fill(wall_m);
        let mut picture = Picture { width, height, rgb: vec![0; 3 * 320 * 200], electrons: 1 };
        let rain = Rain { strength: 0.3, frame, world_from_local_m: world };
        draw_rain(&mut picture, &view, &buffer, rain);
        picture
    }

    fn lit(picture: &Picture) -> impl Iterator<Item = (u32, u32)> {
        let width = picture.width;
        let pixels = picture.rgb.chunks(3).enumerate();
        pixels.filter(|(_, p)| p[0] > 0).map(move |(i, _)| (i as u32 % width, i as u32 / width))
    }

    #[test]
    fn two_cameras_see_the_same_drops() {
        let (ahead, aside) = (wet(0.0, Vec3::ZERO, 4), wet(0.5, Vec3::ZERO, 4));
        // A pixel of the one picture seen by the other, by turning its ray.
        let other = |(x, y): (u32, u32)| {
            let (u, v) = ((x as f32 + 0.5 - 160.0) / 160.0, (y as f32 + 0.5 - 100.0) / 160.0);
            // The ray's way ahead and to the left.
            let (sin, cos) = frames::math::f32::sin_cos(-0.5);
            let (ahead, left) = (cos + u * sin, sin - u * cos);
            let (x, y) = (160.0 - 160.0 * left / ahead, 100.0 + 160.0 * v / ahead);
            (ahead > 0.1 && (2.0..318.0).contains(&x) && (2.0..198.0).contains(&y))
                .then_some((x as u32, y as u32))
        };
        let seen: std::collections::BTreeSet<_> = lit(&aside).collect();
        let near =
            |(x, y): (u32, u32)| (x - 2..=x + 2).any(|x| (y - 2..=y + 2).any(|y| seen.contains(&(x, y))));
        let (mut both, mut all) = (0, 0);
        for place in lit(&ahead).filter_map(other) {
            all += 1;
            both += u32::from(near(place));
        }
        assert!(all > 500 && both * 100 > all * 97, "{both} of {all}");
        let others = wet(0.0, Vec3::ZERO, 5);
        assert_ne!(others, ahead, "in the next frame others fall");
    }

    #[test]
    fn agents_on_both_sides_of_the_worlds_origin_see_the_same_drops() {
        // The same place: 2 m ahead of an origin at -1 m, which repeats as 4095, and at an origin at 1 m.
        let west = Vec3::new(4095.0, 4095.5, 4095.75);
        let east = Vec3::new(1.0, 0.5, 0.25);
        let a = wet_at([Vec3::new(2.0, 1.0, 0.5), west], 0.0, Vec3::ZERO, 4, f32::INFINITY);
        let b = wet_at([Vec3::ZERO, east], 0.0, Vec3::ZERO, 4, f32::INFINITY);
        // But for what rounding of 4096 m moves by a pixel.
        let differ = a.rgb.iter().zip(&b.rgb).filter(|(a, b)| a != b).count();
        let wet = b.rgb.iter().filter(|v| **v > 0).count();
        assert!(wet > 2000 && differ * 20 < wet, "{differ} of {wet}");
    }

    #[test]
    fn drops_before_a_wall_are_seen_and_those_behind_it_are_not() {
        let place = [Vec3::ZERO, Vec3::new(3.2, -7.1, 0.6)];
        let before = |wall_m: f32| lit(&wet_at(place, 0.0, Vec3::ZERO, 4, wall_m)).count();
        let counts = [0.5, 3.0, 6.0, 9.1].map(before);
        assert_eq!([counts[0], counts[3]], [0, before(f32::INFINITY)]);
        assert!(counts[1] > 0 && counts[1] < counts[2] && counts[2] < counts[3], "{counts:?}");
    }

    #[test]
    fn drops_lean_towards_who_drives() {
        // From the middle of the picture streaks part when the camera goes ahead: lengths across grow.
        let width_of = |picture: &Picture| lit(picture).filter(|(x, _)| x.abs_diff(160) > 80).count();
        assert!(width_of(&wet(0.0, Vec3::X, 4)) > width_of(&wet(0.0, Vec3::ZERO, 4)));
    }
}
