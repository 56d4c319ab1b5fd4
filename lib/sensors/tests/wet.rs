//! Wet ground mirrors what stands on it; nothing else of what cameras tell knows that it rained.

mod common;

use common::{
    Builder, at, film, instance, optics, picture, set_view, sight, snapshot, standing_view, street,
    with_scene,
};
use glam::Vec3;
use schema::Tag;
use schema::geometry::{Snapshot, Surface};
use schema::images::{Depth, Instance, Semantic};
use schema::settings::CameraSettings;
use schema::tables::Weather;
use sensors::Picture;

/// Rain has just stopped: all is wet, and there are puddles.
fn soaked() -> Weather {
    let Weather { sun_altitude_deg, .. } = Weather::default();
    Weather {
        wetness: 100.0,
        precipitation: 0.0,
        precipitation_deposits: 100.0,
        cloudiness: 100.0,
        fog_density: 0.0,
        sun_altitude_deg,
        ..Weather::default()
    }
}

/// Asphalt, and over it a board that faces the camera: how far away, its left and right end, its lower and upper one.
fn board([away_m, left_m, right_m, low_m, high_m]: [f32; 5], rgb: [f32; 3]) -> Snapshot {
    let mut ground = Builder::default();
    let part = ground.part(Tag::Road, Surface::Asphalt, [0.1; 3]);
    let corner = |x: f32, y: f32| Vec3::new(90.0 * x, 90.0 * y, 0.0);
    ground.quad(part, [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
    let mut board = Builder::default();
    let part = board.part(Tag::Building, Surface::Plain, rgb);
    let corner = |y: f32, z: f32| Vec3::new(away_m, y, z);
    board.quad(
        part,
        [corner(right_m, low_m), corner(right_m, high_m), corner(left_m, high_m), corner(left_m, low_m)],
    );
    let here = at(0.0, 0.0, 0.0, 0.0);
    snapshot(vec![ground.done(), board.done()], vec![instance(0, 1, here), instance(1, 2, here)])
}

fn plain() -> CameraSettings {
    CameraSettings { bloom: 0.0, vignetting: 0.0, noise: 0.0, ..CameraSettings::default() }
}

#[test]
fn a_board_is_mirrored_where_the_law_of_reflection_has_it() {
    // The camera is 1.6 m over the ground and 0.6 m ahead of the agent.
    let (width, height) = (320u32, 180u32);
    let view = set_view([0.0; 3], [0.0; 3], optics(width, height), &plain());
    for size in [[12.6, 1.0, -1.5, 1.6, 2.6], [30.6, 9.0, 6.0, 0.4, 8.0], [8.6, -1.0, -3.0, 0.2, 1.2]] {
        let [white, black] = [[0.9; 3], [0.02; 3]].map(|rgb| picture(&board(size, rgb), &view, &soaked()));
        let seen = with_scene(&board(size, [0.5; 3]), |scene| sight(scene, &view, &soaked())).seen;
        // Where the colour of the board is seen on the ground.
        let (mut sums, mut weights) = ([0.0; 2], 0.0);
        let (mut within, focal) = (0.0, f64::from(seen.camera.fx));
        let [away, left, right, low, high] = size.map(f64::from);
        let away = away - 0.6;
        let place = |level: f64, across: f64| {
            [
                0.5 * f64::from(width) - focal * across / away,
                0.5 * f64::from(height) + focal * (level + 1.6) / away,
            ]
        };
        let ([x0, y0], [x1, y1]) = (place(low, left), place(high, right));
        for (pixel, (a, b)) in white.rgb.chunks(3).zip(black.rgb.chunks(3)).enumerate() {
            if seen.instance[pixel] != 0 {
                continue;
            }
            let (x, y) = ((pixel as u32 % width) as f64 + 0.5, (pixel as u32 / width) as f64 + 0.5);
            // Level water mirrors so much (Schlick).
            let down = (y - 0.5 * f64::from(height)) / focal;
            let grazing = 1.0 - down / (1.0 + down * down).sqrt();
            let share = 0.02 + 0.96 * frames::math::pow(grazing, 5.0);
            let more = (film(a[1]) - film(b[1])) / share;
            sums = [sums[0] + more * x, sums[1] + more * y];
            weights += more;
            // Rough places blur it, most of all up and down.
            if (x0 - 3.0..x1 + 3.0).contains(&x) && (y0 - 24.0..y1 + 24.0).contains(&y) {
                within += more;
            }
        }
        let (x, y) = (sums[0] / weights, sums[1] / weights);
        assert!(weights > 100.0 && within > 0.97 * weights, "{size:?}: {within} of {weights}");
        let (right_x, right_y) = (0.5 * (x0 + x1), 0.5 * (y0 + y1));
        assert!((x - right_x).abs() < 2.0, "{size:?}: {x} {right_x}");
        assert!((y - right_y).abs() < 0.1 * (y1 - y0) + 2.0, "{size:?}: {y} {right_y}");
    }
}

#[test]
fn low_angles_mirror_most() {
    let view = set_view([0.0; 3], [0.0; 3], optics(320, 180), &plain());
    // A wall from the ground to the sky.
    let size = [40.6, 60.0, -60.0, 0.0, 60.0];
    let [white, black] = [[0.9; 3], [0.02; 3]].map(|rgb| picture(&board(size, rgb), &view, &soaked()));
    let more = |row: usize| -> i32 {
        let row = 3 * 320 * row..3 * 320 * (row + 1);
        white.rgb[row.clone()].iter().zip(&black.rgb[row]).map(|(a, b)| i32::from(*a) - i32::from(*b)).sum()
    };
    let falling = [105, 120, 140, 170].map(more);
    assert!(falling.windows(2).all(|w| w[0] > w[1]) && falling[3] > 0, "{falling:?}");
}

#[test]
fn dry_ground_mirrors_nothing() {
    let view = set_view([0.0; 3], [0.0; 3], optics(320, 180), &plain());
    let dry = Weather { wetness: 0.0, precipitation_deposits: 0.0, ..soaked() };
    let size = [12.6, 1.0, -1.5, 1.6, 2.6];
    let [white, black]: [Picture; 2] =
        [[0.9; 3], [0.02; 3]].map(|rgb| picture(&board(size, rgb), &view, &dry));
    assert!(white.rgb[3 * 320 * 100..] == black.rgb[3 * 320 * 100..]);
}

#[test]
fn labels_know_no_rain_and_pictures_no_threads() {
    let scene = street(false);
    let view = standing_view([0.0, -5.2, 0.0], [0.0, 0.0, 0.1], optics(320, 180));
    let rain = Weather { precipitation: 70.0, ..soaked() };
    let looked = |weather: &Weather| with_scene(&scene, |scene| sight(scene, &view, weather));
    let (wet, dry) = (looked(&rain), looked(&Weather::default()));
    assert!(wet.picture != dry.picture);
    assert!(wet.seen == dry.seen);
    assert!(common::encoded::<Depth>(&scene, &wet) == common::encoded::<Depth>(&scene, &dry));
    assert!(common::encoded::<Semantic>(&scene, &wet) == common::encoded::<Semantic>(&scene, &dry));
    assert!(common::encoded::<Instance>(&scene, &wet) == common::encoded::<Instance>(&scene, &dry));
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("starts");
        assert!(pool.install(|| looked(&rain)).picture == wet.picture, "{threads} threads");
    }
}
