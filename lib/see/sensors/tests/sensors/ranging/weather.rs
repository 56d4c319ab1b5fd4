//! Rain and fog against the formulas of their models, worked out here by themselves.

use std::f64::consts::PI;

use frames::math::{cos, exp, ln, pow, sin, tan};
use glam::{Affine3A, Vec3};
use render::Renderer;
use schema::geometry::Surface;
use schema::tables::Weather;
use schema::{ReturnKind, Tag};
use sensors::{Lidar, LidarMoment, LidarSweep};
use settings::{BeamSpec, LidarSpec, Returned, ScanPattern, WeatherSpec};

use super::stream;
use crate::common::{at, block, instance, prepared, snapshot};

const REACH_M: f64 = 120.0;
const DETECTED: f64 = 0.1;
const FLOOR: f64 = DETECTED / (REACH_M * REACH_M);
const DIVERGENCE_RAD: f64 = 0.003;
/// Fresnel reflectance of water, (0.328 / 2.328)^2.
const DROP: f64 = 0.328 * 0.328 / (2.328 * 2.328);

/// Level beams to the left, within 30 degrees of the y axis once they are turned so.
fn spec(channels: u32, columns: u32) -> LidarSpec {
    LidarSpec {
        scan: ScanPattern { channels, columns, upper_rad: 1e-4, lower_rad: -1e-4, horizontal_fov_rad: 1.0 },
        dropoff_rate: 0.0,
        dropoff_zero_intensity: 0.0,
        noise_m: 0.0,
        weather: Some(WeatherSpec { detected: DETECTED }),
        ..LidarSpec::vehicle()
    }
}

fn fog(percent: f64) -> Weather {
    Weather { fog_density: percent, ..Weather::default() }
}

fn rain(percent: f64) -> Weather {
    Weather { precipitation: percent, ..Weather::default() }
}

/// A sweep ahead with a wall of concrete that stands straight across at a distance, if there is one.
fn sweep(spec: &LidarSpec, wall_m: Option<f32>, weather: Weather) -> LidarSweep {
    let walls = wall_m.map(|m| instance(0, 6, at(m + 0.5, 0.0, -50.0, 0.0)));
    let world = snapshot(
        vec![block([1.0, 400.0, 100.0], Tag::Building, Surface::Concrete)],
        walls.into_iter().collect(),
    );
    let renderer = prepared(&world);
    let scene = &*renderer.place(&world).expect("all meshes are prepared");
    let moment = LidarMoment { weather, ..LidarMoment::standing(5, Affine3A::IDENTITY) };
    Lidar::new(spec).expect("is small").sweep(scene, &moment, &stream()).expect("has no device")
}

fn one_beam() -> LidarSpec {
    let spec = spec(1, 1);
    LidarSpec {
        scan: ScanPattern { horizontal_fov_rad: 0.0, upper_rad: 0.0, lower_rad: 0.0, ..spec.scan },
        ..spec
    }
}

fn kinds(sweep: &LidarSweep, kind: ReturnKind) -> usize {
    sweep.of_beam.as_ref().expect("is told").kind.iter().filter(|&&k| k == kind as u8).count()
}

fn ranges(sweep: &LidarSweep) -> Vec<f64> {
    let point = |k: usize| Vec3::new(sweep.x_m[k], sweep.y_m[k], sweep.z_m[k]);
    (0..sweep.len()).map(|k| f64::from(point(k).length())).collect()
}

#[test]
fn fog_weakens_a_wall_as_its_extinction_says() {
    // 50 %: 0.5 (0.02 + 0.03 0.5) = 0.0175 a metre, 100 %: 0.05.
    for (percent, extinction, wall_m) in [(0.0, 0.0, 60.0), (50.0, 0.0175, 25.0), (100.0, 0.05, 20.0)] {
        let sweep = sweep(&one_beam(), Some(wall_m), fog(percent));
        assert_eq!((sweep.id.as_slice(), kinds(&sweep, ReturnKind::Surface)), ([6].as_slice(), 1));
        let d = f64::from(wall_m);
        let want = 0.35 * exp(-0.004 * d) * exp(-2.0 * extinction * d);
        assert!((f64::from(sweep.intensity[0]) / want - 1.0).abs() < 1e-4, "{} {want}", sweep.intensity[0]);
    }
}

#[test]
fn what_is_weaker_than_the_floor_is_lost() {
    // 0.35 exp(-2 0.05 d) / d^2 falls below the floor of 0.1 / 120^2.
    let power = |d: f64| 0.35 * exp(-0.1 * d) / (d * d);
    let lost_m =
        (200..1200).map(|k| 0.1 * f64::from(k)).find(|d| power(*d) < FLOOR).expect("is lost somewhere");
    assert!((30.0..60.0).contains(&lost_m), "{lost_m}");
    let last = Returned { first: false, strongest: false, last: true };
    let base = one_beam();
    let spec = LidarSpec { beam: BeamSpec { returned: last, ..base.beam.clone() }, ..base };
    let seen = |m: f64| kinds(&sweep(&spec, Some(m as f32), fog(100.0)), ReturnKind::Surface);
    assert_eq!((seen(lost_m - 0.2), seen(lost_m + 0.1)), (1, 0));
    // In clear air concrete is seen as far as the lidar reaches.
    let clear = |m: f32| sweep(&one_beam(), Some(m), fog(0.0)).len();
    assert_eq!((clear(119.9), clear(120.5)), (1, 0));
}

/// Power of the echo of fog at a distance of the pulse's middle, over that of a white surface: Hahner et al.,
/// with Simpson's rule.
fn fog_power(extinction: f64, middle_m: f64) -> f64 {
    let (c, half_s) = (299_792_458.0, 20e-9);
    let backscatter = 0.046 / (ln(20.0) / extinction);
    let f = |t: f64| {
        let r = middle_m + 0.5 * c * half_s - 0.5 * c * t;
        let overlap = ((r - 0.9) / 0.1).clamp(0.0, 1.0);
        if overlap == 0.0 {
            return 0.0;
        }
        let pulse = sin(PI * t / (2.0 * half_s));
        pulse * pulse * overlap * exp(-2.0 * extinction * r) / (r * r)
    };
    simpson(f, 0.0, 2.0 * half_s) * backscatter / (1e-6 / PI)
}

fn simpson(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let n = 4000;
    let step = (to - from) / f64::from(n);
    let sum: f64 = (0..=n)
        .map(|k| {
            let weight = if k == 0 || k == n {
                1.0
            } else if k % 2 == 1 {
                4.0
            } else {
                2.0
            };
            weight * f(from + step * f64::from(k))
        })
        .sum();
    sum * step / 3.0
}

#[test]
fn dense_fog_sends_light_back_where_its_echo_peaks() {
    let places = (0..1000).map(|k| 0.01 * f64::from(k));
    let (peak_m, power) =
        places.map(|m| (m, fog_power(0.05, m))).max_by(|a, b| a.1.total_cmp(&b.1)).expect("has a peak");
    assert!(power > FLOOR && fog_power(0.0175, peak_m) < FLOOR, "{power} {FLOOR}");
    let spec = spec(64, 256);
    let sweep = sweep(&spec, None, fog(100.0));
    let n = 64 * 256;
    // All that is not of the agent's own body: 1.04 m to the side, 2.44 m ahead.
    let ranges = ranges(&sweep);
    assert_eq!(kinds(&sweep, ReturnKind::Fog), sweep.len());
    assert!(sweep.id.iter().all(|&id| id == 0) && sweep.tag.iter().all(|&tag| tag == 0));
    assert!(sweep.cos_angle.iter().all(|&cos| cos == 0.0));
    // Ten metres times Beta(2, 20): its distribution at some distances beyond the crop, 1 - (1 - x)^20 (1 +
    // 20 x).
    for beyond_m in [3.2, 3.6, 4.5] {
        let x = (beyond_m - peak_m) / 10.0;
        let want = if x <= 0.0 { 1.0 } else { pow(1.0 - x, 20.0) * (1.0 + 20.0 * x) };
        let got = ranges.iter().filter(|r| **r > beyond_m).count() as f64 / f64::from(n);
        assert!((got - want).abs() < 0.02, "beyond {beyond_m} m (peak {peak_m} m): {got} {want}");
    }
    let bare = exp(-0.004 * ranges[0]);
    let want = bare * power * peak_m * peak_m;
    assert!((f64::from(sweep.intensity[0]) / want - 1.0).abs() < 0.02, "{} {want}", sweep.intensity[0]);
    // Where a surface is stronger it is returned, unless the nearest is asked for.
    assert_eq!(self::sweep(&one_beam(), Some(20.0), fog(100.0)).id, [6]);
}

/// Drops in a beam up to a distance that are at least of a power: LISA's cone and drop sizes by Marshall and
/// Palmer.
fn drops(mmph: f64, power: f64, to_m: f64) -> f64 {
    let slope = 4.1 * pow(mmph, -0.21);
    let extinction = rain_extinction(mmph);
    let f = |r: f64| {
        let width_m = tan(DIVERGENCE_RAD) * r;
        let share = (power * r * r * exp(2.0 * extinction * r) / DROP).sqrt();
        if share > 1.0 {
            return 0.0;
        }
        let least_mm = (1e3 * width_m * share).max(0.05);
        PI / 4.0 * width_m * width_m * 8000.0 / slope * exp(-slope * least_mm)
    };
    simpson(f, 1.5, to_m)
}

fn rain_extinction(mmph: f64) -> f64 {
    let slope = 4.1 * pow(mmph, -0.21);
    // Two cross-sections a drop: integral of 2 (pi / 4) D^2 8000 exp(-s D), in mm^2 a cubic metre.
    simpson(|d| 0.5 * PI * d * d * 8000.0 * exp(-slope * d), 0.0, 40.0) * 1e-6
}

/// To the left, where the own body is nowhere.
fn sideways(channels: u32, columns: u32, wall_m: Option<f32>, weather: Weather) -> LidarSweep {
    let walls = wall_m.map(|m| instance(0, 6, at(0.0, m + 0.5, -50.0, 0.0)));
    let world = snapshot(
        vec![block([400.0, 1.0, 100.0], Tag::Building, Surface::Concrete)],
        walls.into_iter().collect(),
    );
    let renderer = prepared(&world);
    let scene = &*renderer.place(&world).expect("all meshes are prepared");
    let base = spec(channels, columns);
    // All around, of which the test takes the part to the left.
    let spec = LidarSpec { scan: ScanPattern { horizontal_fov_rad: 2.0 * PI, ..base.scan }, ..base };
    let moment = LidarMoment { weather, ..LidarMoment::standing(5, Affine3A::IDENTITY) };
    Lidar::new(&spec).expect("is small").sweep(scene, &moment, &stream()).expect("has no device")
}

/// Whether a return is within 30 degrees of the y axis.
fn is_left(sweep: &LidarSweep, k: usize) -> bool {
    sweep.y_m[k] > cos(PI / 6.0) as f32 * Vec3::new(sweep.x_m[k], sweep.y_m[k], sweep.z_m[k]).length()
}

#[test]
fn as_many_beams_meet_drops_as_the_model_expects() {
    for (percent, mmph) in [(20.0, 10.0), (100.0, 50.0)] {
        let sweep = sideways(128, 1024, None, rain(percent));
        // Beams of a sixth of the turn.
        let beams = 128.0 * 1024.0 / 6.0;
        let chance = 1.0 - exp(-drops(mmph, FLOOR, REACH_M));
        let got = (0..sweep.len()).filter(|&k| is_left(&sweep, k)).count() as f64;
        let sigma = (beams * chance * (1.0 - chance)).sqrt();
        assert!((0.05..0.6).contains(&chance), "{chance}");
        assert!((got - beams * chance).abs() < 4.0 * sigma + 130.0, "{percent} %: {got}, {}", beams * chance);
        assert_eq!(kinds(&sweep, ReturnKind::Rain), sweep.len());
        assert!(ranges(&sweep).iter().all(|r| *r > 1.499), "nothing is received from nearer");
        assert!(sweep.id.iter().all(|&id| id == 0) && sweep.tag.iter().all(|&tag| tag == 0));
    }
}

#[test]
fn a_drop_that_outshines_a_wall_takes_its_place() {
    let sweep = sideways(128, 1024, Some(35.0), rain(100.0));
    let extinction = rain_extinction(50.0);
    let (mut drowned, mut beams, mut wanted) = (0.0_f64, 0.0_f64, 0.0_f64);
    for k in 0..sweep.len() {
        if !is_left(&sweep, k) {
            continue;
        }
        beams += 1.0;
        if sweep.id[k] == 0 {
            drowned += 1.0;
            continue;
        }
        let d = f64::from(Vec3::new(sweep.x_m[k], sweep.y_m[k], sweep.z_m[k]).length());
        let facing = 0.25 + 0.75 * f64::from(sweep.cos_angle[k]);
        let want = 0.35 * facing * exp(-0.004 * d) * exp(-2.0 * extinction * d);
        assert!((f64::from(sweep.intensity[k]) / want - 1.0).abs() < 1e-3, "{} {want}", sweep.intensity[k]);
    }
    assert!((beams - 128.0 * 1024.0 / 6.0).abs() < 130.0, "every beam returns something: {beams}");
    // Over the angles from the wall's normal.
    let steps = 60;
    for k in 0..steps {
        let angle = PI / 6.0 * (f64::from(k) + 0.5) / f64::from(steps);
        let d = 35.0 / cos(angle);
        let power = 0.35 * (0.25 + 0.75 * cos(angle)) * exp(-2.0 * extinction * d) / (d * d);
        wanted += beams / f64::from(steps) * (1.0 - exp(-drops(50.0, power, d)));
    }
    assert!(wanted > 100.0, "{wanted}");
    assert!((drowned - wanted).abs() < 4.0 * wanted.sqrt(), "{drowned} {wanted}");
}

#[test]
fn all_echoes_of_a_beam_may_be_asked_for() {
    let returned = Returned { first: true, strongest: true, last: true };
    let base = spec(64, 256);
    let all = LidarSpec { beam: BeamSpec { returned, ..base.beam.clone() }, ..base };
    let sweep = sweep(&all, Some(20.0), fog(100.0));
    let told = sweep.of_beam.as_ref().expect("is told");
    let walls = sweep.id.iter().filter(|&&id| id == 6).count();
    assert_eq!(walls, 64 * 256);
    assert!(kinds(&sweep, ReturnKind::Fog) > 1000);
    let ranges = ranges(&sweep);
    for k in 0..sweep.len() {
        assert!(told.number[k] <= told.count[k] && told.count[k] <= 2);
        if told.number[k] == 2 {
            assert!((told.number[k - 1], told.kind[k - 1]) == (1, ReturnKind::Fog as u8));
            assert!(ranges[k - 1] < ranges[k] && sweep.ring[k - 1] == sweep.ring[k]);
        }
    }
}

#[test]
fn weather_is_the_same_on_any_number_of_threads() {
    let weather = Weather { fog_density: 90.0, ..rain(80.0) };
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("starts");
        pool.install(|| sideways(32, 512, Some(30.0), weather))
    };
    let one = with(1);
    assert!(one == with(3));
    assert!(kinds(&one, ReturnKind::Rain) > 50 && kinds(&one, ReturnKind::Surface) > 50);
    // In clear air, what is bright enough is as it is to a lidar that knows no weather.
    let clear = sweep(&spec(32, 64), Some(30.0), Weather::default());
    let blind = sweep(&LidarSpec { weather: None, ..spec(32, 64) }, Some(30.0), Weather::default());
    assert!(clear.intensity.iter().zip(&blind.intensity).all(|(a, b)| (a - b).abs() < 1e-6));
    assert!(LidarSweep { of_beam: None, intensity: blind.intensity.clone(), ..clear } == blind);
}

#[test]
fn soaked_ground_sends_back_half_and_walls_what_they_did() {
    let looking_down = LidarSpec {
        scan: ScanPattern { upper_rad: -0.5, lower_rad: -0.5, horizontal_fov_rad: 0.0, ..one_beam().scan },
        ..one_beam()
    };
    let intensity = |surface, wetness: f64| {
        let world = snapshot(
            vec![block([400.0, 400.0, 1.0], Tag::Road, surface)],
            vec![instance(0, 1, at(0.0, 0.0, -3.0, 0.0))],
        );
        let renderer = prepared(&world);
        let scene = &*renderer.place(&world).expect("all meshes are prepared");
        let weather = Weather { wetness, ..Weather::default() };
        let moment = LidarMoment { weather, ..LidarMoment::standing(5, Affine3A::IDENTITY) };
        let swept = Lidar::new(&looking_down).expect("is small").sweep(scene, &moment, &stream());
        f64::from(swept.expect("has no device").intensity[0])
    };
    let range_m = 2.0 / sin(0.5);
    let dry = 0.15 * exp(-0.004 * range_m) * (0.25 + 0.75 * sin(0.5));
    assert!((intensity(Surface::Asphalt, 0.0) / dry - 1.0).abs() < 1e-4);
    let share = |surface, wetness| intensity(surface, wetness) / intensity(surface, 0.0);
    assert!((share(Surface::Asphalt, 100.0) - 0.5).abs() < 1e-4);
    assert!((share(Surface::Concrete, 50.0) - 0.75).abs() < 1e-4);
    assert!((share(Surface::RoadMarking, 100.0) - 0.3).abs() < 1e-4);
    assert_eq!(share(Surface::Grass, 100.0), 1.0);
    let wall = |wetness| sweep(&one_beam(), Some(30.0), Weather { wetness, ..Weather::default() }).intensity;
    assert_eq!(wall(0.0), wall(100.0));
}
