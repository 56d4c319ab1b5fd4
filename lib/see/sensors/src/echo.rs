//! How strong a radar's echo is: cross-section of what a ray met, and signal to noise.

use frames::math;
use schema::Tag;
use schema::geometry::{MeshPart, Paving, Surface};

/// Echoes weaker than this are as good as none, dB (of a square metre, and over the noise).
pub(crate) const FLOOR_DB: f64 = -80.0;
/// Distance at which [`settings::RadarSpec::snr_db`] is stated, metres.
pub(crate) const REFERENCE_M: f64 = 100.0;

/// How a surface scatters a wave of 77 GHz: shares of what comes in.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Scatter {
    /// Sent to all sides (Lambert).
    diffuse: f64,
    /// Sent into a lobe about the mirrored direction.
    lobe: f64,
    /// How narrow the lobe is: a power.
    narrow: i32,
}

/// Cross-section of the patch that a ray stands for, square metres.
///
/// A patch that fills a solid angle `w` at distance `d` and is met at an angle `a` has the area
/// `w d^2 / cos a`. What it scatters diffusely gives it `4 r cos^2 a` for each square metre. What it scatters
/// into a lobe `((1 + cos p) / 2)^n` about the mirrored direction (p off it; Degli-Esposti and others,
/// "Measurement and modelling of scattering from buildings", IEEE Transactions on Antennas and Propagation
/// 55, 2007, the directive model) is, `2 a` off it and with the lobe's integral `4 pi / (n + 1)`,
/// `s (n + 1) cos a cos^(2 n) a`. Cross-sections of the rays that met an object add up to its own.
pub(crate) fn cross_section_m2(part: &MeshPart, solid_angle_sr: f64, range_m: f64, cos_angle: f64) -> f64 {
    let Scatter { diffuse, lobe, narrow } = scatter(part);
    // cos^2 a, `narrow` times.
    let off = (0..narrow).fold(1.0, |power, _| power * cos_angle * cos_angle);
    (4.0 * diffuse * cos_angle + lobe * f64::from(narrow + 1) * off) * solid_angle_sr * range_m * range_m
}

/// A cross-section in dB of a square metre.
pub(crate) fn dbsm(cross_section_m2: f64) -> f64 {
    if cross_section_m2 > 0.0 { (10.0 * math::log10(cross_section_m2)).max(FLOOR_DB) } else { FLOOR_DB }
}

/// Signal to noise by the radar equation: `at_reference_db` for a square metre at [`REFERENCE_M`], 40 dB less
/// for each tenfold distance.
pub(crate) fn snr_db(at_reference_db: f64, rcs_dbsm: f64, range_m: f64) -> f64 {
    let way_db = 40.0 * math::log10(range_m.max(1e-3) / REFERENCE_M);
    (at_reference_db + rcs_dbsm - way_db).max(FLOOR_DB)
}

/// Solid angle that a ray of an elliptic cone stands for, steradian.
///
/// A ray ends on the plane one metre ahead at `(w r cos phi, h r sin phi)`, with `r` and `phi` drawn evenly:
/// `n` rays are `n / (2 pi w h r)` a square metre there. `r` is kept from 0, where they are infinitely dense.
pub(crate) fn solid_angle_sr(half_width: f64, half_height: f64, radius: f64, rays: u32, along: f64) -> f64 {
    let rays = f64::from(rays.max(1));
    let patch = std::f64::consts::TAU * half_width * half_height * radius.max(0.5 / rays) / rays;
    // A patch of the plane at distance 1 / along is met at that angle.
    patch * along * along * along
}

/// By what a part is made of and of what it is part: `diffuse`, `lobe`, `narrow`.
///
/// | part | shares | why |
/// |---|---|---|
/// | metal: skins of vehicles, frames, rims, posts, plates, boards of signs | 0.15, 0.80, 20 | sends all back; bent and creased within a facet |
/// | lamps | 0.40, 0.30, 10 | clear plastic before reflectors and corners |
/// | glass | 0.02, 0.25, 60 | even; what it lets through is not followed |
/// | plastic of vehicles: sills, grilles, trim | 0.30, 0.30, 10 | lets most pass to ribs, beams and radiators behind it |
/// | tyres | 0.05, 0.05, 5 | absorb |
/// | people, animals, cloth | 0.10, 0, - | skin is wet, no part of a body is even |
/// | walls, concrete, gravel, tiles of roofs, stone | 0.10, 0.15, 15 | rough against 3.9 mm, reflect a sixth of the power straight on |
/// | wood | 0.06, 0.06, 10 | reflects an eighth |
/// | leaves, grass | 0.04, 0, - | |
/// | roads | 0.02, 0, - | met at grazing angles, smooth |
///
/// A person comes to -8 dBsm so, which is the mean of measured ones (Fortuny-Guasch and Chareau, "Radar cross
/// section measurements of pedestrian dummies and humans in the 24/77 GHz frequency bands", JRC, EUR 25762,
/// 2013). The rest are assumptions: round figures by which a saloon has 14 dBsm from the side, 7 from the
/// rear, 3 from the front and 2.5 from between front and side, averaged over 10 degrees. Nothing is followed
/// from face to face, so that corners and hollows, which make real ends of cars brighter, do not. Bumpers
/// that are painted count as skin: the beam behind them sends back what they let through.
fn scatter(part: &MeshPart) -> Scatter {
    let of = |diffuse, lobe, narrow| Scatter { diffuse, lobe, narrow };
    let is_body = matches!(part.tag, Tag::Pedestrian | Tag::Rider);
    match part.surface {
        _ if is_body => of(0.10, 0.0, 0),
        Surface::Paint | Surface::Metal | Surface::Reflector => METAL,
        Surface::Lamp(_) => of(0.40, 0.30, 10),
        Surface::Glass | Surface::Window => of(0.02, 0.25, 60),
        Surface::Plain if is_vehicle(part.tag) => PLASTIC,
        // The board of a sign is a sheet of metal, whatever is printed on it.
        Surface::Plain if part.tag == Tag::TrafficSign => METAL,
        Surface::Textured(factors) => {
            let between = |a: f64, b: f64| a + f64::from(factors.metallic) * (b - a);
            let (diffuse, lobe) =
                (between(PLASTIC.diffuse, METAL.diffuse), between(PLASTIC.lobe, METAL.lobe));
            of(diffuse, lobe, if factors.metallic > 0.5 { METAL.narrow } else { PLASTIC.narrow })
        }
        Surface::Rubber => of(0.05, 0.05, 5),
        Surface::Cloth | Surface::Clothes(_) | Surface::Opening => of(0.10, 0.0, 0),
        Surface::Plain
        | Surface::Concrete
        | Surface::Facade(_)
        | Surface::Gravel
        | Surface::RoofTiles
        | Surface::Paving(Paving::Slabs | Paving::Tiles | Paving::Setts | Paving::Cast) => of(0.10, 0.15, 15),
        Surface::Wood => of(0.06, 0.06, 10),
        Surface::Foliage | Surface::Grass => of(0.04, 0.0, 0),
        Surface::Asphalt
        | Surface::KerbedAsphalt(_)
        | Surface::Paving(Paving::Asphalt)
        | Surface::RoadMarking => of(0.02, 0.0, 0),
    }
}

const METAL: Scatter = Scatter { diffuse: 0.15, lobe: 0.80, narrow: 20 };
const PLASTIC: Scatter = Scatter { diffuse: 0.30, lobe: 0.30, narrow: 10 };

fn is_vehicle(tag: Tag) -> bool {
    matches!(tag, Tag::Car | Tag::Truck | Tag::Bus | Tag::Train | Tag::Motorcycle | Tag::Bicycle)
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
    fn nothing_sends_back_more_than_it_gets() {
        let surfaces = [
            Surface::Paint,
            Surface::Lamp(1),
            Surface::Window,
            Surface::Plain,
            Surface::Rubber,
            Surface::Wood,
        ];
        for surface in surfaces {
            for tag in [Tag::Car, Tag::Building, Tag::TrafficSign, Tag::Pedestrian] {
                let part = MeshPart::new(tag, surface, [0.5; 3]);
                let Scatter { diffuse, lobe, narrow } = scatter(&part);
                assert!(diffuse + lobe <= 1.0, "{part:?}");
                // The integral of a lobe over the sphere, in rings.
                let ring = |k: i32| {
                    let angle = (f64::from(k) + 0.5) * std::f64::consts::PI / 2000.0;
                    let half = 0.5 * (1.0 + math::cos(angle));
                    let pattern = (0..narrow).fold(1.0, |power, _| power * half);
                    pattern * std::f64::consts::TAU * math::sin(angle) * std::f64::consts::PI / 2000.0
                };
                let whole: f64 = (0..2000).map(ring).sum();
                let want = 4.0 * std::f64::consts::PI / f64::from(narrow + 1);
                assert!((whole / want - 1.0).abs() < 1e-4, "{narrow}: {whole}, not {want}");
                // A square metre, straight on and at 45 degrees.
                let sigma = |cos: f64| cross_section_m2(&part, cos, 1.0, cos);
                assert!((sigma(1.0) - 4.0 * diffuse - lobe * f64::from(narrow + 1)).abs() < 1e-12);
                let half = math::pow(0.5, f64::from(narrow)) * std::f64::consts::FRAC_1_SQRT_2;
                let want = 2.0 * diffuse + lobe * f64::from(narrow + 1) * half;
                assert!((sigma(std::f64::consts::FRAC_1_SQRT_2) - want).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn rays_share_out_the_cone() {
        // A narrow cone: an ellipse of half sides 0.01 and 0.005 at a metre. Radii at the middle of 1000 even
        // steps.
        let sum: f64 =
            (0..1000).map(|k| solid_angle_sr(0.01, 0.005, (f64::from(k) + 0.5) / 1000.0, 1000, 1.0)).sum();
        assert!((sum - std::f64::consts::PI * 0.01 * 0.005).abs() < 1e-9, "{sum}");
    }
}
