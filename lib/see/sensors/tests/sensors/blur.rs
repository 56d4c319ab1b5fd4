//! Pictures are smeared by motion and blurred out of focus when the configuration says so.

use crate::common::{MeshBuilder, at, film, optics, picture, set_view, snapshot, street};
use glam::{Affine3A, Vec3};
use schema::Tag;
use schema::geometry::{Instance, Snapshot, Surface};
use schema::tables::Weather;
use settings::CameraSettings;

const WIDTH: u32 = 320;

fn settings() -> CameraSettings {
    CameraSettings { bloom: 0.0, vignetting: 0.0, noise: 0.0, ..CameraSettings::default() }
}

/// A white board 10.6 m ahead, 4 m wide, that came so far to the right in a frame; 40 m ahead a black wall.
fn passing(moved_m: f32) -> Snapshot {
    let board = |half_m: f32, rgb: [f32; 3]| {
        let mut b = MeshBuilder::default();
        let part = b.part(Tag::Building, Surface::Plain, rgb);
        let corner = |y: f32, z: f32| Vec3::new(0.0, half_m * y, half_m * z);
        b.quad(part, [corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)]);
        b.finish()
    };
    let here = at(10.6, 0.0, 1.6, 0.0);
    let came = Affine3A::from_translation(Vec3::new(0.0, moved_m, 0.0)) * here;
    let white = Instance { previous_local_from_object: came, ..crate::common::instance(0, 7, here) };
    let black = crate::common::instance(1, 8, at(40.6, 0.0, 1.6, 0.0));
    snapshot(vec![board(2.0, [0.7; 3]), board(60.0, [0.0; 3])], vec![white, black])
}

/// Film values of the row in the middle.
fn row(snapshot: &Snapshot, settings: &CameraSettings) -> Vec<f64> {
    let view = set_view([0.0; 3], [0.0; 3], optics(WIDTH, 180), settings);
    let weather = Weather { cloudiness: 100.0, fog_density: 0.0, ..Weather::default() };
    let picture = picture(snapshot, &view, &weather);
    let start = 3 * (90 * WIDTH) as usize;
    picture.rgb[start..start + 3 * WIDTH as usize].chunks(3).map(|rgb| film(rgb[1])).collect()
}

#[test]
fn what_moves_covers_each_place_for_its_share_of_the_time() {
    // A pixel is a 190.7th of the distance; the board comes 20 pixels in a frame, and half of that while the
    // shutter is open.
    let focal = 0.5 * f64::from(WIDTH) / frames::math::tan(frames::deg(40.0));
    let moved_m = (20.0 * 10.0 / focal) as f32;
    let sharp = row(&passing(moved_m), &settings());
    let half = row(&passing(moved_m), &CameraSettings { exposure_time_s: 0.025, ..settings() });
    let (left, right) = (160.0 - 2.0 * focal / 10.0, 160.0 + 2.0 * focal / 10.0);
    let (white, black) = (sharp[160], sharp[20]);
    assert!(white > 10.0 * black);
    for (x, value) in half.iter().enumerate() {
        let covered = (value - black) / (white - black);
        let x = x as f64 + 0.5;
        // It was 10 pixels to the left when the shutter opened.
        let want =
            ((x - (left - 10.0)) / 10.0).clamp(0.0, 1.0) - ((x - (right - 10.0)) / 10.0).clamp(0.0, 1.0);
        assert!((covered - want).abs() < 0.12, "{x}: {covered} {want}");
    }
}

#[test]
fn still_pictures_stay_as_they_are() {
    let mut scene = street(false);
    for instance in &mut scene.instances {
        instance.previous_local_from_object = instance.local_from_object;
    }
    let view = |settings: CameraSettings| set_view([0.0, -5.2, 0.0], [0.0; 3], optics(WIDTH, 180), &settings);
    let weather = Weather::default();
    let sharp = picture(&scene, &view(settings()), &weather);
    let open = picture(&scene, &view(CameraSettings { exposure_time_s: 0.02, ..settings() }), &weather);
    assert!(sharp == open);
    let soft =
        picture(&scene, &view(CameraSettings { aperture_mm: 20.0, focus_m: 3.0, ..settings() }), &weather);
    assert!(sharp != soft);
}

#[test]
fn edges_out_of_focus_are_as_wide_as_their_discs() {
    // Set to the wall behind: a point of the board becomes a disc of 40 mm (1 / 10 - 1 / 40) times the focal
    // length.
    let lens = CameraSettings { aperture_mm: 40.0, focus_m: 40.0, ..settings() };
    let blurred = row(&passing(0.0), &lens);
    let (white, black) = (blurred[160], blurred[20]);
    let focal = 0.5 * f64::from(WIDTH) / frames::math::tan(frames::deg(40.0));
    let wide = 0.04 * (1.0 / 10.0 - 1.0 / 40.0) * focal;
    // A disc over an edge: between 0.1 and 0.9 of it are 0.69 of its width.
    let within = blurred[..160]
        .iter()
        .filter(|value| (0.1..0.9).contains(&((**value - black) / (white - black))))
        .count();
    assert!(within.abs_diff((0.69 * wide).round() as usize) <= 1, "{within} of {wide}");
    let focused = row(&passing(0.0), &CameraSettings { focus_m: 10.0, ..lens });
    let sharp = row(&passing(0.0), &settings());
    let differ = focused.iter().zip(&sharp).filter(|(a, b)| (*a - *b).abs() > 0.05 * white).count();
    assert!(differ <= 2, "{differ}");
}
