//! Colour pictures: how they follow light and lens, and one picture to compare with.

use std::fs::File;
use std::path::PathBuf;

use crate::common::{
    film, grey_sight, optics, picture, set_view, snapshot, standing_view, street, with_scene,
};
use schema::geometry::{Snapshot, Surface, Wall};
use schema::tables::Weather;
use schema::{Tag, lights};
use settings::{CameraSettings, Optics};
use shading::Picture;

/// The street from the middle of its right lane.
fn of_street(snapshot: &Snapshot, weather: &Weather, optics: Optics) -> Picture {
    picture(snapshot, &standing_view([0.0, -5.2, 0.0], [0.0; 3], optics), weather)
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0.0), |(sum, n), v| (sum + v, n + 1.0));
    assert!(n > 0.0, "there are no such pixels");
    sum / n
}

fn green(p: &Picture) -> impl Iterator<Item = f64> + '_ {
    p.rgb.iter().skip(1).step_by(3).map(|&v| f64::from(v))
}

#[test]
fn half_the_opening_is_half_the_light() {
    let street = street(false);
    let at = |f_stop: f64| {
        let settings = CameraSettings { f_stop, ..CameraSettings::default() };
        let view = set_view([0.0, -5.2, 0.0], [0.0; 3], optics(200, 112), &settings);
        picture(&street, &view, &Weather::default())
    };
    let (open, stopped) = (at(1.8), at(1.8 * std::f64::consts::SQRT_2));
    let mut ratios: Vec<f64> = open
        .rgb
        .iter()
        .zip(&stopped.rgb)
        .filter(|(a, b)| (40..=215).contains(*a) && (40..=215).contains(*b))
        .map(|(a, b)| film(*a) / film(*b))
        .collect();
    ratios.sort_by(f64::total_cmp);
    assert!(ratios.len() > 10_000);
    // One level of 8 bits is up to 5 % of the light.
    let at_share = |share: f64| ratios[(share * ratios.len() as f64) as usize];
    assert!((at_share(0.5) - 2.0).abs() < 0.03, "{}", at_share(0.5));
    assert!(at_share(0.05) > 1.85 && at_share(0.95) < 2.15, "{} {}", at_share(0.05), at_share(0.95));
}

#[test]
fn corners_lose_the_share_that_was_asked_for() {
    let street = street(false);
    let (width, height) = (200u32, 112u32);
    let with = |vignetting: f64| {
        let settings = CameraSettings { vignetting, ..CameraSettings::default() };
        let view = set_view([0.0, -5.2, 0.0], [0.0; 3], optics(width, height), &settings);
        picture(&street, &view, &Weather::default())
    };
    let (clear, dark) = (with(0.0), with(0.6));
    // Means over rings, of what is neither black nor white in either.
    let (mut sums, corner) = ([(0.0, 0.0); 5], (100.0_f64 * 100.0 + 56.0 * 56.0).sqrt());
    for (i, (a, b)) in clear.rgb.iter().zip(&dark.rgb).enumerate() {
        let (x, y) = ((i as u32 / 3) % width, i as u32 / 3 / width);
        let away = (f64::from(x) + 0.5 - 100.0, f64::from(y) + 0.5 - 56.0);
        let share = (away.0 * away.0 + away.1 * away.1) / (corner * corner);
        if (60..=210).contains(a) && (60..=210).contains(b) {
            let sum = &mut sums[(share * 5.0) as usize];
            *sum = (sum.0 + film(*b) / film(*a) - (1.0 - 0.6 * share), sum.1 + 1.0);
        }
    }
    for (ring, (off, count)) in sums.into_iter().enumerate() {
        assert!(count > 300.0 && (off / count).abs() < 0.02, "ring {ring}: {} of {count}", off / count);
    }
}

#[test]
fn night_is_darker_than_noon() {
    let street = street(false);
    let brightness = |sun_altitude_deg: f64| {
        let weather = Weather { sun_altitude_deg, ..Weather::default() };
        mean(green(&of_street(&street, &weather, optics(200, 112))))
    };
    let (noon, night) = (brightness(60.0), brightness(-30.0));
    assert!((70.0..190.0).contains(&noon), "{noon}");
    assert!(night < 0.6 * noon && night > 8.0, "{night} {noon}");
}

#[test]
fn fronts_that_face_the_sun_are_the_bright_ones() {
    let street = street(false);
    let optics = optics(200, 112);
    let view = standing_view([0.0, -5.2, 0.0], [0.0; 3], optics.clone());
    let seen = with_scene(&street, |scene| grey_sight(scene, &view)).seen;
    // Fronts left of the street look south, those right of it north.
    let fronts = |left: bool| {
        let street = &street;
        seen.instance.iter().enumerate().filter_map(move |(pixel, &i)| {
            let house = street.instances.get(i as usize)?;
            let front = street.mesh(house).parts[0].surface == Surface::Facade(Wall::Plaster);
            (front && (house.local_from_object.translation.y > 0.0) == left).then_some(pixel)
        })
    };
    // Mean of the fronts on the left, mean of those on the right, how far north the sun stands.
    let lit_from = |sun_azimuth_deg: f64| {
        let weather =
            Weather { sun_altitude_deg: 35.0, sun_azimuth_deg, cloudiness: 0.0, ..Weather::default() };
        let p = of_street(&street, &weather, optics.clone());
        let of = |left| mean(fronts(left).map(|pixel| f64::from(p.rgb[3 * pixel + 1])));
        [of(true), of(false), weather.direction_to_sun()[1]]
    };
    let suns = [0.0, 90.0, 180.0, 270.0].map(lit_from);
    // Of four sides, one is north and one south.
    let south = suns.iter().find(|sun| sun[2] < -0.5).expect("a sun in the south");
    let north = suns.iter().find(|sun| sun[2] > 0.5).expect("a sun in the north");
    assert!(south[0] > 1.1 * north[0] && north[1] > 1.1 * south[1], "{south:?} {north:?}");
}

#[test]
fn fog_hides_what_is_far() {
    let street = street(false);
    let optics = optics(200, 112);
    let view = standing_view([0.0, -5.2, 0.0], [0.0; 3], optics.clone());
    let seen = with_scene(&street, |scene| grey_sight(scene, &view)).seen;
    // The same clouds in both, so that nothing but fog makes the difference.
    let clear = Weather { cloudiness: 90.0, fog_density: 0.0, ..Weather::default() };
    let foggy = Weather { fog_density: 90.0, fog_distance_m: 0.0, fog_falloff: 0.0, ..clear };
    let spread = |weather: &Weather, depth_m: std::ops::Range<f32>| {
        let p = of_street(&street, weather, optics.clone());
        let there = |p: Picture| -> Vec<f64> {
            green(&p).zip(&seen.depth_m).filter(|(_, d)| depth_m.contains(d)).map(|(v, _)| v).collect()
        };
        let values = there(p);
        let m = mean(values.iter().copied());
        mean(values.iter().map(|v| (v - m) * (v - m))).sqrt()
    };
    let (far, near) = (60.0..400.0, 0.0..12.0);
    let ratio = |band: &std::ops::Range<f32>| spread(&foggy, band.clone()) / spread(&clear, band.clone());
    assert!(ratio(&far) < 0.35, "{}", ratio(&far));
    assert!(ratio(&near) > 2.0 * ratio(&far), "{} {}", ratio(&near), ratio(&far));
}

#[test]
fn street_lamps_and_windows_shine_as_told() {
    let picture = |lamp: [f32; 3], window: [f32; 3]| {
        let mut snapshot = street(true);
        for instance in &mut snapshot.instances {
            if instance.lights == lights::STREET_LAMP {
                instance.glow = lamp;
            } else if instance.lights == lights::BUILDING {
                instance.glow = window;
            }
        }
        let weather = Weather { sun_altitude_deg: -40.0, ..Weather::default() };
        of_street(&snapshot, &weather, optics(320, 180)).rgb
    };
    let sum = |rgb: &[u8], k: usize| rgb.iter().skip(k).step_by(3).map(|&v| f64::from(v)).sum::<f64>();
    let all = |rgb: &[u8]| (0..3).map(|k| sum(rgb, k)).sum::<f64>();
    let [dark, dim, bright] = [0.0, 1.0, 2.5].map(|s: f32| all(&picture([s, 0.76 * s, 0.47 * s], [0.0; 3])));
    assert!(dark < 0.98 * dim && dim < 0.98 * bright, "{dark} {dim} {bright}");
    let (green, red) = (picture([0.0; 3], [0.0, 1.0, 0.0]), picture([0.0; 3], [1.0, 0.0, 0.0]));
    let none = picture([0.0; 3], [0.0; 3]);
    // In drawn colours, but not in those alone.
    for (k, own, other) in [(1, &green, &red), (0, &red, &green)] {
        assert!(sum(own, k) > 1.01 * sum(&none, k) && sum(own, k) > 1.003 * sum(other, k));
        assert!(sum(other, k) > 1.001 * sum(&none, k));
    }
}

/// A picture looks as it did when somebody last looked at it.
///
/// `tests/data/street.png` is the hand-made street on a clear day, made by this test with `CONVOY_ACCEPT=1`.
/// Values may differ by two levels, which is what two painters may; one in 500 by more, where the smoothing
/// of edges decides otherwise.
#[test]
fn the_street_looks_as_it_did() {
    let weather = Weather {
        sun_altitude_deg: 42.0,
        sun_azimuth_deg: 150.0,
        cloudiness: 25.0,
        wetness: 0.0,
        precipitation: 0.0,
        precipitation_deposits: 0.0,
        fog_density: 0.0,
        ..Weather::default()
    };
    let got = of_street(&street(false), &weather, optics(160, 90));
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/street.png");
    if std::env::var_os("CONVOY_ACCEPT").is_some() {
        let file = File::create(&path).expect("the file is written");
        let mut encoder = png::Encoder::new(file, got.width, got.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header().and_then(|mut w| w.write_image_data(&got.rgb)).expect("is encoded");
        return;
    }
    let file = File::open(&path).expect("CONVOY_ACCEPT=1 makes it");
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().expect("is PNG");
    let mut want = vec![0; reader.output_buffer_size().expect("is small")];
    let info = reader.next_frame(&mut want).expect("has an image");
    assert_eq!((info.width, info.height, want.len()), (got.width, got.height, got.rgb.len()));
    let far = got.rgb.iter().zip(&want).filter(|(a, b)| a.abs_diff(**b) > 2).count();
    assert!(far * 500 <= want.len(), "{far} of {} values differ by more than two levels", want.len());
}

#[test]
fn an_empty_world_is_sky() {
    let empty = snapshot(Vec::new(), Vec::new());
    let p = of_street(&empty, &Weather::default(), optics(17, 6));
    assert_eq!(p.rgb.len(), 3 * 17 * 6);
    // Blue above.
    assert!(p.rgb[2] > p.rgb[0], "{:?}", &p.rgb[..3]);
    let sight =
        with_scene(&empty, |scene| grey_sight(scene, &standing_view([0.0; 3], [0.0; 3], optics(17, 6))));
    assert!(sensors::pixel_counts(&empty, &sight.seen).is_empty());
    let tags = crate::common::encoded::<schema::images::Semantic>(&empty, &sight);
    let mut reader = png::Decoder::new(std::io::Cursor::new(tags)).read_info().expect("is PNG");
    let mut rgb = vec![0; reader.output_buffer_size().expect("is small")];
    reader.next_frame(&mut rgb).expect("has an image");
    assert_eq!(rgb[..3], Tag::Sky.camera_rgb());
}
