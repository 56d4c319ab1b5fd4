//! How strong a radar's echo is: cross-section of what a ray met, and signal to noise.

use frames::math;
use schema::geometry::{Part, Surface};

/// Echoes weaker than this are as good as none, dB (of a square metre, and over the noise).
pub(crate) const FLOOR_DB: f64 = -80.0;
/// Distance at which [`schema::settings::RadarSpec::snr_db`] is stated, metres.
pub(crate) const REFERENCE_M: f64 = 100.0;

/// Cross-section of the patch that a ray stands for, square metres.
///
/// A rough surface of reflectivity `r` that fills a solid angle `w` at distance `d` and is met at an angle `a` has the
/// cross-section `4 r w d^2 cos a`: that of a diffuse (Lambertian) patch, of which `w d^2 / cos a` is the area. Cross-sections
/// of the rays that met an object add up to its own.
pub(crate) fn cross_section_m2(part: &Part, solid_angle_sr: f64, range_m: f64, cos_angle: f64) -> f64 {
    4.0 * reflectivity(part) * solid_angle_sr * range_m * range_m * cos_angle
}

/// A cross-section in dB of a square metre.
pub(crate) fn dbsm(cross_section_m2: f64) -> f64 {
    if cross_section_m2 > 0.0 { (10.0 * math::log10(cross_section_m2)).max(FLOOR_DB) } else { FLOOR_DB }
}

/// Signal to noise by the radar equation: `at_reference_db` for a square metre at [`REFERENCE_M`], 40 dB less for each tenfold
/// distance.
pub(crate) fn snr_db(at_reference_db: f64, rcs_dbsm: f64, range_m: f64) -> f64 {
    let way_db = 40.0 * math::log10(range_m.max(1e-3) / REFERENCE_M);
    (at_reference_db + rcs_dbsm - way_db).max(FLOOR_DB)
}

/// Solid angle that a ray of an elliptic cone stands for, steradian.
///
/// A ray ends on the plane one metre ahead at `(w r cos phi, h r sin phi)`, with `r` and `phi` drawn evenly: `n` rays are
/// `n / (2 pi w h r)` a square metre there. `r` is kept from 0, where they are infinitely dense.
pub(crate) fn solid_angle_sr(half_width: f64, half_height: f64, radius: f64, rays: u32, along: f64) -> f64 {
    let rays = f64::from(rays.max(1));
    let patch = std::f64::consts::TAU * half_width * half_height * radius.max(0.5 / rays) / rays;
    // A patch of the plane at distance 1 / along is met at that angle.
    patch * along * along * along
}

/// Share of a wave of 77 GHz that a surface sends back diffusely, 0 to 1. Round figures of our own: a car's rear of 3 m2
/// comes to 8 dBsm and a person to -6, amid what is measured; road and grass, met at a grazing angle, to next to nothing.
fn reflectivity(part: &Part) -> f64 {
    match part.surface {
        Surface::Paint | Surface::Metal => 0.5,
        Surface::Lamp(_) | Surface::Glass | Surface::Window => 0.25,
        Surface::Concrete | Surface::Facade(_) => 0.2,
        Surface::Skin(finish) => 0.15 + 0.35 * f64::from(finish.metallic),
        Surface::Plain | Surface::Gravel | Surface::RoofTiles => 0.15,
        Surface::Cloth => 0.1,
        Surface::Rubber | Surface::Wood => 0.08,
        Surface::Foliage | Surface::Grass => 0.04,
        Surface::Asphalt | Surface::RoadMarking => 0.02,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_times_the_distance_costs_forty_decibels() {
        assert!((snr_db(10.0, 3.0, 100.0) - 13.0).abs() < 1e-12);
        assert!((snr_db(10.0, 3.0, 10.0) - 53.0).abs() < 1e-12);
        assert_eq!(dbsm(0.0), FLOOR_DB);
        assert!((dbsm(2.0) - 3.010_3).abs() < 1e-4);
    }

    #[test]
    fn rays_share_out_the_cone() {
        // A narrow cone: an ellipse of half sides 0.01 and 0.005 at a metre. Radii at the middle of 1000 even steps.
        let sum: f64 =
            (0..1000).map(|k| solid_angle_sr(0.01, 0.005, (f64::from(k) + 0.5) / 1000.0, 1000, 1.0)).sum();
        assert!((sum - std::f64::consts::PI * 0.01 * 0.005).abs() < 1e-9, "{sum}");
    }
}
