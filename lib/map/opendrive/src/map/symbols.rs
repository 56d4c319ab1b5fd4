//! What is painted on lanes to be read: arrows, words, bicycles.

use std::f64::consts::PI;

use frames::math::sin_cos;
use frames::wrap_pi;
use lettering::Lettering;
use nalgebra::{Point3, Vector3};

use super::{LaneHit, LaneInfo, Map, ObjectInfo};
use crate::LaneType;

/// Letters on roads are so many times as high as they would be upright: drivers see them at a flat angle.
const STRETCH: f64 = 4.0;
/// Length of a word along its lane where nothing states it, and least and most, metres.
const WORD_M: f64 = 2.8;
/// See [`WORD_M`].
const WORD_RANGE_M: [f64; 2] = [1.2, 4.0];
/// A word is no wider than so much of its lane.
const LANE_SHARE: f64 = 0.66;
/// Words stay so far inside their lane, metres.
const EDGE_M: f64 = 0.05;
/// Width and length of a bicycle, metres.
const BICYCLE_M: [f64; 2] = [1.1, 1.9];
/// Lanes are looked for at most this far beside what is painted, metres: bicycles lie beside those for
/// traffic.
const ASIDE_M: f64 = 4.0;
/// A turn to the left as it is painted in the length of 2.5 m: metres ahead of its middle, and to its left,
/// counter-clockwise.
const TURN_M: [[f64; 2]; 9] = [
    [-1.25, -0.46],
    [0.36, -0.46],
    [0.71, 0.05],
    [1.05, 0.02],
    [0.65, 0.62],
    [0.25, 0.02],
    [0.56, 0.05],
    [0.31, -0.24],
    [-1.25, -0.24],
];

/// Names of words, small and without anything but letters and digits, and what is painted.
const WORDS: [(&str, &str); 12] = [
    ("stop", "STOP"),
    ("slow", "SLOW"),
    ("bus", "BUS"),
    ("buslane", "BUS"),
    ("busonly", "BUS"),
    ("taxi", "TAXI"),
    ("tram", "TRAM"),
    ("school", "SCHOOL"),
    ("schoolzone", "SCHOOL"),
    ("only", "ONLY"),
    ("ahead", "AHEAD"),
    ("yield", "YIELD"),
];

/// Something on a lane that is there to be read.
#[derive(Clone, Debug, PartialEq)]
pub struct RoadSymbol {
    /// What it says: a word, `bicycle`, or nothing for arrows.
    pub word: String,
    /// Where it is.
    pub place: Point3<f64>,
    /// The areas that are painted, corners each once.
    pub areas: Vec<Vec<Point3<f64>>>,
}

enum Symbol {
    Word(String),
    Bicycle,
    Turn { left: bool },
}

impl Map {
    /// Arrows, words and bicycles on lanes: objects of type `roadMark`, and objects and signals whose names
    /// begin with `Stencil`, as CARLA's maps have them. Words are those of a short list, and numbers of one
    /// to three digits; they are readable for the traffic of their lane. In the order of the objects, then of
    /// the signals. Computed anew by every call.
    #[must_use]
    pub fn road_symbols(&self) -> Vec<RoadSymbol> {
        let objects = self.objects().iter().filter_map(|object| self.symbol_of(object));
        let signals = self.signals().iter().filter(|signal| !signal.dynamic).filter_map(|signal| {
            let symbol = meant(&signal.kind, &signal.name)?;
            let size = Vector3::new(0.0, signal.size_m[1].unwrap_or(0.0), 0.0);
            Some(self.painted(symbol, signal.road, signal.on_surface, size, signal.pose.yaw()))
        });
        objects.chain(signals).collect()
    }

    fn symbol_of(&self, object: &ObjectInfo) -> Option<RoadSymbol> {
        let place = Point3::from(object.pose.xyz());
        if object.is_arrow() {
            return Some(RoadSymbol { word: String::new(), place, areas: object.areas() });
        }
        let symbol = meant(&object.kind, &object.name)?;
        // What has an outline of its own is painted as it says.
        if object.outlines.iter().any(|outline| outline.base.len() >= 3) {
            let word = symbol.name();
            return Some(RoadSymbol { word, place, areas: object.areas() });
        }
        Some(self.painted(symbol, object.road, place, object.size_m, object.pose.yaw()))
    }

    /// A symbol about a place, as the traffic of the lane there reads it; where there is none, along a
    /// heading.
    fn painted(
        &self,
        symbol: Symbol,
        road: u32,
        place: Point3<f64>,
        size_m: Vector3<f64>,
        yaw_rad: f64,
    ) -> RoadSymbol {
        // In a junction several ways lead over it: it is for the one in whose middle it lies, and along which
        // it looks.
        let within = |lane: &LaneInfo| lane.lane_type == LaneType::Driving;
        let off = |hit: &LaneHit| {
            let turn_rad =
                self.lane_point(hit.lane, hit.s, 0.0).map_or(PI, |p| wrap_pi(p.heading_rad - yaw_rad));
            hit.t_m.abs() + 2.0 * turn_rad.abs()
        };
        let over = self.lanes_within(place, ASIDE_M, within).into_iter().filter(LaneHit::is_inside);
        let over = over.min_by(|a, b| off(a).total_cmp(&off(b)).then(a.lane.cmp(&b.lane)));
        let beside = || {
            let own = self.lanes_within(place, ASIDE_M, |lane| within(lane) && lane.id.road == road);
            own.into_iter().min_by(|a, b| a.t_m.abs().total_cmp(&b.t_m.abs()))
        };
        let hit = over.or_else(beside).or_else(|| self.nearest_driving_lane(place));
        let hit = hit.filter(|hit| hit.t_m.abs() < 0.5 * hit.width_m + ASIDE_M);
        let lane = hit.as_ref().and_then(|hit| self.lane_point(hit.lane, hit.s, 0.0));
        let heading_rad = lane.map_or(yaw_rad, |lane| lane.heading_rad);
        let hit = hit.filter(LaneHit::is_inside);
        let lane_m = hit.as_ref().map_or(3.0, |hit| hit.width_m);
        // Some files have it farther aside than their lane is wide.
        let aside_m = |half_m: f64| {
            let free_m = (0.5 * lane_m - EDGE_M - half_m).max(0.0);
            hit.as_ref().map_or(0.0, |hit| hit.t_m.clamp(-free_m, free_m) - hit.t_m)
        };
        let (sin, cos) = sin_cos(heading_rad);
        let at = |ahead: f64, left: f64| {
            place + Vector3::new(cos * ahead - sin * left, sin * ahead + cos * left, 0.0)
        };
        // Files state the box around it, whichever way it lies.
        let stated = [size_m.x.max(size_m.y), size_m.x.min(size_m.y)];
        let written = |lettering: &Lettering, length_m: f64, width_m: f64| {
            let aside_m = aside_m(0.5 * width_m);
            let place =
                |[x, y]: &[f64; 2]| at((y - 0.5) * length_m, aside_m + (0.5 - x / lettering.width) * width_m);
            lettering.outlines.iter().map(|outline| outline.iter().map(place).collect()).collect()
        };
        let word = symbol.name();
        let areas = match symbol {
            Symbol::Word(text) => {
                let length_m = if stated[0] > 0.1 { stated[0] } else { WORD_M };
                let length_m = length_m.clamp(WORD_RANGE_M[0], WORD_RANGE_M[1]);
                lettering::write(&text).map_or_else(Vec::new, |lettering| {
                    let natural_m = lettering.width * length_m / STRETCH;
                    let most_m = if stated[1] > 0.1 { stated[1] } else { lane_m };
                    written(&lettering, length_m, natural_m.min(most_m).min(LANE_SHARE * lane_m))
                })
            }
            Symbol::Bicycle => written(&lettering::bicycle(), BICYCLE_M[1], BICYCLE_M[0]),
            Symbol::Turn { left } => {
                let mut ring: Vec<Point3<f64>> =
                    TURN_M.iter().map(|[u, v]| at(*u, if left { *v } else { -v })).collect();
                if !left {
                    ring.reverse();
                }
                vec![ring]
            }
        };
        RoadSymbol { word, place, areas }
    }
}

impl Symbol {
    fn name(&self) -> String {
        match self {
            Self::Word(word) => word.clone(),
            Self::Bicycle => "bicycle".into(),
            Self::Turn { .. } => String::new(),
        }
    }
}

/// What an object or signal of some type and name has painted; none where it is something else.
fn meant(kind: &str, name: &str) -> Option<Symbol> {
    let plain: String = name.chars().filter(char::is_ascii_alphanumeric).collect();
    let plain = plain.to_ascii_lowercase();
    let name = match plain.strip_prefix("stencil") {
        Some(rest) => rest,
        None if kind.eq_ignore_ascii_case("roadMark") => &plain,
        None => return None,
    };
    match name {
        // The fourth type of California's manual turns.
        "arrowtype4l" => return Some(Symbol::Turn { left: true }),
        "arrowtype4r" => return Some(Symbol::Turn { left: false }),
        "bicycle" | "bike" | "bikelane" | "bikesymbol" => return Some(Symbol::Bicycle),
        _ => {}
    }
    let number = name.len() <= 3 && name.parse::<u32>().is_ok_and(|number| number > 0);
    if number {
        return Some(Symbol::Word(name.to_owned()));
    }
    WORDS.iter().find(|(known, _)| *known == name).map(|(_, word)| Symbol::Word((*word).to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_told_by_type_and_name() {
        let word = |kind, name| meant(kind, name).map(|symbol| symbol.name());
        for (kind, name, want) in [
            ("-1", "Stencil_STOP", Some("STOP")),
            ("-1", "Stencil_SchoolZone", Some("SCHOOL")),
            ("roadMark", "Slow", Some("SLOW")),
            ("roadMark", "30", Some("30")),
            ("roadMark", "Bicycle", Some("bicycle")),
            ("-1", "Stencil_ArrowType4R", Some("")),
            // Lines, signs, and what is neither.
            ("roadMark", "StopLine", None),
            ("roadMark", "0", None),
            ("-1", "STOP", None),
            ("-1", "Sign_Stop", None),
            ("pole", "30", None),
        ] {
            assert_eq!(word(kind, name).as_deref(), want, "{kind} {name}");
        }
        assert!(WORDS.iter().all(|(_, word)| lettering::write(word).is_some()));
    }
}
