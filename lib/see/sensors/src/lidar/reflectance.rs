//! How much of a lidar's light a surface sends back, by its material, the angle and the weather.

use frames::math::f32::exp;
use schema::geometry::{MeshPart, Paving, Surface};
use schema::tables::Weather;

use shading::retro;

/// Lights a surface sends back: the shares of near-infrared light (905 nm), 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reflectance {
    /// Scattered to all sides, met straight on.
    pub(super) matt: f32,
    /// Besides, mirrored back where it is met straight on.
    pub(super) mirrored: f32,
    /// Besides, sent back to where it came from by retro-reflecting sheeting.
    pub(super) returned: f32,
}

/// Mirrored light is down to a third where `1 - cos` of the angle is this: 8 degrees.
const MIRRORED_WITHIN: f32 = 0.01;
/// Less of what dry porous ground sends back when it is soaked: water between the grains scatters light on
/// inwards (Lekner and Dorf, "Why some things are darker when wet", Applied Optics 27, 1988, have about
/// half).
const SOAKED: f32 = 0.5;
/// Less of what the glass beads of road markings do, which a film of water covers.
const FLOODED: f32 = 0.7;

impl Reflectance {
    /// Intensity of light met at an angle, of which this is the cosine.
    pub(super) fn at(&self, cos_angle: f32) -> f32 {
        let matt = self.matt * (0.25 + 0.75 * cos_angle);
        if self.mirrored == 0.0 && self.returned == 0.0 {
            return matt;
        }
        let mirrored = self.mirrored * exp((cos_angle - 1.0) / MIRRORED_WITHIN);
        (matt + mirrored + self.returned * retro::share(cos_angle)).min(1.0)
    }
}

/// How wet the ground is as a lidar feels it, 0 to 1: as pictures have it.
pub(super) fn wetness(weather: &Weather) -> f32 {
    (weather.wetness.max(0.8 * weather.precipitation) / 100.0).clamp(0.0, 1.0) as f32
}

/// Of a part of a mesh.
///
/// Round figures of the usual measurements for dry surfaces: asphalt 0.15, concrete 0.35, plants 0.5, dark
/// glass 0.05. Retro-reflecting sheeting is as bright as can be at any angle that it is read from; markings
/// have beads, too. Cloth and surfaces that are nothing in particular follow the brightness of their colour;
/// so does car paint, whose dark pigments swallow this light as well, but for its clear coat, which mirrors.
/// `paint` is the colour of what is painted, `level` whether the surface is (roofs above it are not looked
/// for), `wetness` how wet such is.
pub(super) fn reflectance(part: &MeshPart, paint: [f32; 3], level: bool, wetness: f32) -> Reflectance {
    let brightness = |[r, g, b]: [f32; 3]| (0.2126 * r + 0.7152 * g + 0.0722 * b).clamp(0.0, 1.0);
    let returned = if part.surface == Surface::Reflector { 1.0 } else { 0.0 };
    let wet = if level { wetness } else { 0.0 };
    let (matt, mirrored) = match part.surface {
        Surface::Plain
        | Surface::Reflector
        | Surface::Gravel
        | Surface::RoofTiles
        | Surface::Cloth
        | Surface::Clothes(_) => (0.15 + 0.6 * brightness(part.rgb), 0.0),
        // What is neither metal nor plastic lies between them.
        Surface::Textured(factors) => {
            let plain = 0.15 + 0.6 * brightness(part.rgb);
            (plain + factors.metallic * (0.4 - plain), 0.2 * factors.metallic)
        }
        Surface::Paint => (0.12 + 0.5 * brightness(paint), 0.3),
        Surface::Glass | Surface::Window => (0.05, 0.3),
        Surface::Opening => (0.15, 0.0),
        Surface::Metal => (0.4, 0.2),
        Surface::Rubber => (0.06, 0.0),
        Surface::Asphalt | Surface::KerbedAsphalt(_) | Surface::Paving(Paving::Asphalt) => {
            (0.15 * (1.0 - SOAKED * wet), 0.0)
        }
        Surface::RoadMarking => (0.8 * (1.0 - FLOODED * wet), 0.0),
        Surface::Concrete | Surface::Paving(_) => (0.35 * (1.0 - SOAKED * wet), 0.0),
        Surface::Facade(_) => (0.35, 0.0),
        Surface::Grass | Surface::Foliage => (0.5, 0.0),
        Surface::Wood => (0.35, 0.0),
        Surface::Lamp(_) => (0.6, 0.3),
    };
    Reflectance { matt, mirrored, returned }
}
