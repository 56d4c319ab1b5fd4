//! Signals and signs.

use frames::math::sin_cos;
use opendrive::SignalInfo;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::picture::{Anchor, Paint, Picture, Shape, Text};
use crate::sheet::Sheet;
use crate::style::{self, Key};

/// Radius of a symbol on large scales, metres, and its least and largest radius on the sheet, pixels.
const RADIUS_M: f64 = 0.9;
const RADIUS_PX: [f64; 2] = [2.6, 11.0];
/// Symbols larger than this show their details, pixels.
const DETAIL_PX: f64 = 5.0;

/// What a signal shows.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Face {
    Light,
    Stop,
    Yield,
    Speed(Option<f64>),
    RailCross,
    Sign,
}

/// The faces of German (StVO) numbers, which CARLA uses as well, and of names that tell.
fn face(signal: &SignalInfo) -> Option<Face> {
    let name = signal.name.to_ascii_lowercase();
    if signal.kind.eq_ignore_ascii_case("roadmark") || name.contains("stopline") || name.contains("stencil") {
        return None;
    }
    if signal.dynamic {
        return Some(Face::Light);
    }
    Some(match signal.kind.as_str() {
        "206" => Face::Stop,
        "205" => Face::Yield,
        "274" => Face::Speed(signal.value),
        "201" => Face::RailCross,
        _ if name.contains("stop") => Face::Stop,
        _ if name.contains("yield") => Face::Yield,
        _ => Face::Sign,
    })
}

pub(crate) fn draw(sheet: &mut Sheet<'_>, picture: &mut Picture) {
    let page = sheet.page;
    let radius_px = page.px(RADIUS_M).clamp(RADIUS_PX[0], RADIUS_PX[1]);
    for signal in sheet.map.signals() {
        let Some(face) = face(signal) else { continue };
        if page.shows([&signal.on_surface], radius_px) {
            sheet.legend.insert(match face {
                Face::Light => Key::Light,
                Face::Stop => Key::Stop,
                Face::Yield => Key::Yield,
                Face::Speed(_) => Key::Speed,
                Face::RailCross => Key::RailCross,
                Face::Sign => Key::Sign,
            });
            symbol(picture, page.at(&signal.on_surface), radius_px, face);
        }
    }
}

/// A regular polygon with a corner at `from_rad`, seen from above.
fn polygon([x, y]: [f64; 2], radius_px: f64, corners: u32, from_rad: f64) -> Vec<[f64; 2]> {
    (0..corners)
        .map(|i| sin_cos(from_rad + f64::from(i) * TAU / f64::from(corners)))
        .map(|(sin, cos)| [x + radius_px * cos, y - radius_px * sin])
        .collect()
}

/// A disc as a polygon.
pub(crate) fn disc(at: [f64; 2], radius_px: f64, corners: u32) -> Vec<[f64; 2]> {
    polygon(at, radius_px, corners, 0.0)
}

/// The symbols of the legend.
pub(crate) fn legend_symbol(picture: &mut Picture, at: [f64; 2], key: Key) {
    let face = match key {
        Key::Light => Face::Light,
        Key::Stop => Face::Stop,
        Key::Yield => Face::Yield,
        Key::Speed => Face::Speed(None),
        Key::RailCross => Face::RailCross,
        _ => Face::Sign,
    };
    symbol(picture, at, 5.0, face);
}

fn symbol(picture: &mut Picture, at: [f64; 2], r: f64, face: Face) {
    let edge = (0.22 * r).clamp(0.6, 1.6);
    let mut ring = |ring: Vec<[f64; 2]>, paint: Paint| picture.shape(Shape::ring(ring, paint));
    let bordered = |fill, colour| Paint { fill: Some(fill), ..Paint::line(colour, edge) };
    match face {
        Face::Light if r >= DETAIL_PX => {
            let (w, h) = (0.62 * r, 1.25 * r);
            let [x, y] = at;
            let housing = vec![[x - w, y - h], [x + w, y - h], [x + w, y + h], [x - w, y + h]];
            ring(housing, bordered(style::INK, style::WHITE));
            for (up, colour) in [(1.0, style::RED), (0.0, style::AMBER), (-1.0, style::GO)] {
                ring(disc([x, y - up * 0.78 * r], 0.33 * r, 10), Paint::fill(colour));
            }
        }
        Face::Light => {
            ring(disc(at, r, 12), Paint::fill(style::INK));
            ring(disc(at, 0.5 * r, 8), Paint::fill(style::AMBER));
        }
        Face::Stop => ring(polygon(at, 1.08 * r, 8, PI / 8.0), bordered(style::RED, style::WHITE)),
        Face::Yield => ring(polygon(at, 1.25 * r, 3, -FRAC_PI_2), bordered(style::WHITE, style::RED)),
        Face::Speed(value) => {
            ring(disc(at, r, 14), bordered(style::WHITE, style::RED));
            if let Some(value) = value.filter(|_| r >= 7.0) {
                picture.text(Text {
                    at: [at[0], at[1] + 0.3 * r],
                    anchor: Anchor::Middle,
                    size_px: 0.9 * r,
                    bold: true,
                    colour: style::INK,
                    text: format!("{value:.0}"),
                });
            }
        }
        Face::RailCross => {
            let arm = |angle: f64| {
                let (sin, cos) = sin_cos(angle);
                vec![[at[0] - r * cos, at[1] - r * sin], [at[0] + r * cos, at[1] + r * sin]]
            };
            for angle in [PI / 5.0, -PI / 5.0] {
                picture.shape(Shape::chain(arm(angle), Paint::line(style::WHITE, 3.2 * edge)));
            }
            for angle in [PI / 5.0, -PI / 5.0] {
                picture.shape(Shape::chain(arm(angle), Paint::line(style::RED, 1.6 * edge)));
            }
        }
        Face::Sign => ring(disc(at, 0.8 * r, 10), bordered(style::BLUE, style::WHITE)),
    }
}
