//! What gathers along kerbs lies on their side of a lane, near them, and nowhere else.

use crate::common::{MeshBuilder, at, film, instance, optics, picture, set_view, snapshot};
use glam::Vec3;
use schema::Tag;
use schema::geometry::{Kerbs, Snapshot, Surface};
use schema::tables::Weather;
use settings::CameraSettings;

const WIDTH_M: f32 = 3.5;

/// A lane along x, its right border at y = -1.75 m, in pieces of 4 m as maps have them.
fn lane(surface: Surface) -> Snapshot {
    let mut lane = MeshBuilder::default();
    let part = lane.part(Tag::Road, surface, [0.085, 0.085, 0.09]);
    let corner = |k: i32, share: f32| Vec3::new(4.0 * k as f32, (share - 0.5) * WIDTH_M, 0.0);
    for k in -2..12 {
        lane.quad(part, [corner(k, 0.0), corner(k + 1, 0.0), corner(k + 1, 1.0), corner(k, 1.0)]);
    }
    snapshot(vec![lane.finish()], vec![instance(0, 1, at(0.0, 0.0, 0.0, 0.0))])
}

/// Brightness on the film over 48 m of the lane, in strips of 0.25 m from its right border on.
fn across(surface: Surface) -> Vec<f64> {
    let settings = CameraSettings { bloom: 0.0, vignetting: 0.0, noise: 0.0, ..CameraSettings::default() };
    let weather = Weather { cloudiness: 100.0, fog_density: 0.0, ..Weather::default() };
    let scene = lane(surface);
    let strips = (WIDTH_M / 0.25) as usize;
    let (mut sums, mut counts) = (vec![0.0; strips], vec![0.0; strips]);
    // Straight down from 2.4 m over the lane: up in the picture is x, left is y.
    let (width, height, up_m) = (320u32, 180u32, 2.4);
    let focal = f64::from(width) / 2.0 / frames::math::tan(frames::deg(40.0));
    for k in 0..12 {
        let x_m = f64::from(k) * 4.0;
        let down = [0.0, frames::deg(90.0), 0.0];
        // The camera sits 0.6 m ahead of the agent and 1.6 m over it.
        let view = set_view([x_m - 1.6, 0.0, up_m + 0.6], down, optics(width, height), &settings);
        let picture = picture(&scene, &view, &weather);
        for y in 0..height {
            for x in 0..width {
                let from_right_m =
                    f64::from(WIDTH_M) / 2.0 - (f64::from(x) + 0.5 - f64::from(width) / 2.0) / focal * up_m;
                let strip = (from_right_m / 0.25).floor();
                if strip >= 0.0 && (strip as usize) < strips {
                    sums[strip as usize] += film(picture.rgb[3 * (y * width + x) as usize + 1]);
                    counts[strip as usize] += 1.0;
                }
            }
        }
    }
    sums.iter().zip(&counts).map(|(sum, count)| sum / count).collect()
}

#[test]
fn grime_gathers_at_the_foot_of_kerbs() {
    let plain = across(Surface::Asphalt);
    let over = |kerbs| -> Vec<f64> {
        across(Surface::KerbedAsphalt(kerbs)).iter().zip(&plain).map(|(a, b)| a / b).collect()
    };
    let (right, left, both) = (over(Kerbs::Right), over(Kerbs::Left), over(Kerbs::Both));
    let last = right.len() - 1;
    // A quarter of a metre from the kerb a third of the light or more is gone; beyond a metre nothing is.
    assert!(right[0] < 0.67 && left[last] < 0.67, "{right:?} {left:?}");
    assert!(right[..3].is_sorted() && left[last - 2..].is_sorted_by(|a, b| a >= b), "{right:?} {left:?}");
    for k in 4..right.len() {
        assert!((right[k] - 1.0).abs() < 1e-9 && (left[last - k] - 1.0).abs() < 1e-9, "{k}");
    }
    for k in 0..4 {
        assert!((both[k] - right[k]).abs() < 1e-9 && (both[last - k] - left[last - k]).abs() < 1e-9, "{k}");
    }
}
