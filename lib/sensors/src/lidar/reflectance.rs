//! How much of a lidar's light a surface sends back.

use schema::Tag;
use schema::geometry::{Part, Surface};

/// Share of near-infrared light (905 nm) that a surface sends back, 0 to 1.
///
/// Round figures of the usual measurements for dry surfaces: asphalt 0.15, concrete 0.35, plants 0.5, dark glass 0.05.
/// Signs and road markings are retroreflective. Cloth and surfaces that are nothing in particular follow the brightness
/// of their colour; car paint does not, because its clear coat and the metal flakes under it send back light whatever
/// the pigment.
pub(super) fn reflectance(part: &Part) -> f32 {
    let [r, g, b] = part.rgb;
    let brightness = (0.2126 * r + 0.7152 * g + 0.0722 * b).clamp(0.0, 1.0);
    if part.tag == Tag::TrafficSign && !matches!(part.surface, Surface::Metal) {
        return 1.0;
    }
    match part.surface {
        Surface::Plain | Surface::Gravel | Surface::RoofTiles | Surface::Cloth => 0.15 + 0.6 * brightness,
        Surface::Paint => 0.45,
        Surface::Glass | Surface::Window => 0.05,
        Surface::Metal => 0.4,
        Surface::Rubber => 0.06,
        Surface::Asphalt => 0.15,
        Surface::RoadMarking => 0.8,
        Surface::Concrete | Surface::Facade(_) => 0.35,
        Surface::Grass | Surface::Foliage => 0.5,
        Surface::Wood => 0.35,
        Surface::Lamp(_) => 0.6,
    }
}
