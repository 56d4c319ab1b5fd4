//! Objects: crosswalks, stop lines, parking spaces, islands, buildings, greenery, water.

use nalgebra::{Point3, Vector3};
use opendrive::{Crosswalk, Map, ObjectInfo};
use std::collections::BTreeSet;

use crate::page::Page;
use crate::picture::{Paint, Picture, Shape};
use crate::sheet::{Order, Sheet};
use crate::style::{self, Key};
use crate::symbols::disc;

/// Painted and blank part of a zebra crossing, metres.
const ZEBRA_M: [f64; 2] = [0.5, 0.5];
/// Bars narrower than this become a paler area, pixels.
const BAR_PX: f64 = 0.7;
/// Crown of a tree whose size is not stated, metres.
const CROWN_M: f64 = 2.5;

/// What an object is to a map reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Crosswalk,
    StopLine,
    Arrow,
    ParkingSpace,
    Island,
    Building,
    Tree,
    Greenery,
    Barrier,
    Water,
    Other,
}

fn kind(object: &ObjectInfo) -> Kind {
    let (kind, name) = (object.kind.to_ascii_lowercase(), object.name.to_ascii_lowercase());
    let named = |words: &[&str]| words.iter().any(|w| kind.contains(w) || name.contains(w));
    match kind.as_str() {
        "crosswalk" => Kind::Crosswalk,
        "parkingspace" => Kind::ParkingSpace,
        "trafficisland" => Kind::Island,
        "building" => Kind::Building,
        "tree" => Kind::Tree,
        "vegetation" => Kind::Greenery,
        "barrier" | "railing" | "soundbarrier" | "wall" => Kind::Barrier,
        _ if named(&["crosswalk"]) => Kind::Crosswalk,
        _ if named(&["stopline", "stop line", "stop_line"]) => Kind::StopLine,
        _ if object.is_arrow() => Kind::Arrow,
        _ if object.is_water() => Kind::Water,
        _ => Kind::Other,
    }
}

/// Rings of an object: its outlines, or the rectangle or circle of its size.
fn rings(object: &ObjectInfo) -> Vec<Vec<Point3<f64>>> {
    let closed = object.outlines.iter().filter(|o| o.closed && o.base.len() > 2);
    let rings: Vec<Vec<Point3<f64>>> = closed.map(|o| o.base.clone()).collect();
    let half = object.size_m * 0.5;
    if rings.is_empty() && half.x > 0.0 && half.y > 0.0 {
        let corner = |x: f64, y: f64| object.pose * Point3::new(x * half.x, y * half.y, 0.0);
        return vec![vec![corner(1.0, 1.0), corner(-1.0, 1.0), corner(-1.0, -1.0), corner(1.0, -1.0)]];
    }
    rings
}

/// Rivers and lakes, under everything.
pub(crate) fn water(map: &Map, page: &Page, legend: &mut BTreeSet<Key>, picture: &mut Picture) {
    let waters = map.objects().iter().filter(|o| kind(o) == Kind::Water);
    for ring in waters.flat_map(rings).filter(|ring| page.shows(ring, 0.0)) {
        legend.insert(Key::Water);
        let paint = Paint { fill: Some(style::WATER), ..Paint::line(style::SHORE, page.px_min(0.6, 1.2)) };
        picture.shape(Shape::ring(page.chain(&ring), paint));
    }
}

/// What is painted or built on the carriageway.
pub(crate) fn on_roads(sheet: &mut Sheet<'_>) {
    let (map, page) = (sheet.map, sheet.page);
    for crosswalk in map.crosswalks().iter().filter(|c| page.shows(&c.polygon, 0.0)) {
        if let Some(level) = sheet.level_at(crosswalk.road, crosswalk.s) {
            zebra(sheet, crosswalk, level);
        }
    }
    for object in map.objects() {
        let kind = kind(object);
        if !matches!(kind, Kind::StopLine | Kind::Arrow | Kind::ParkingSpace | Kind::Island) {
            continue;
        }
        let Some(level) = sheet.level_at(object.road, object.s) else { continue };
        for ring in rings(object).into_iter().filter(|ring| page.shows(ring, 0.0)) {
            let ring = page.chain(&ring);
            let (order, paint) = match kind {
                Kind::StopLine | Kind::Arrow => (Order::Mark, Paint::sealed(style::WHITE)),
                Kind::Island => {
                    let edge = Paint::line(style::KERB, page.px_min(0.2, 0.5));
                    (Order::Crosswalk, Paint { fill: Some(style::ISLAND), ..edge })
                }
                _ => (Order::Mark, Paint::line(style::PARKING_LINE, page.px_min(0.1, 0.35))),
            };
            sheet.layers.add(level, order, ring, true, paint);
        }
    }
}

/// Bars across a crosswalk's longer axis.
fn zebra(sheet: &mut Sheet<'_>, crosswalk: &Crosswalk, level: i8) {
    let Some((ends, depth_m)) = axis(&crosswalk.polygon) else { return };
    let page = sheet.page;
    sheet.legend.insert(Key::Crosswalk);
    let bar_px = page.px(ZEBRA_M[0]);
    let width_px = page.px(depth_m);
    let paint = if bar_px >= BAR_PX {
        Paint::dashed(style::WHITE, width_px, ZEBRA_M.map(|m| page.px(m)))
    } else {
        let mut pale = Paint::line([214, 214, 216, 255], width_px);
        if width_px < 1.2 {
            pale = Paint::line(style::WHITE, 1.2);
        }
        pale
    };
    sheet.layers.add(level, Order::Crosswalk, page.chain(&ends), false, paint);
}

/// The longer middle axis of a polygon that is about a rectangle, and its extent across, metres.
fn axis(polygon: &[Point3<f64>]) -> Option<([Point3<f64>; 2], f64)> {
    let edge = |i: usize| polygon[(i + 1) % polygon.len()] - polygon[i];
    let longest = (0..polygon.len()).max_by(|a, b| edge(*a).norm().total_cmp(&edge(*b).norm()))?;
    let along = edge(longest).try_normalize(1e-6)?;
    let across = Vector3::new(-along.y, along.x, 0.0);
    let origin = *polygon.first()?;
    let range = |axis: &Vector3<f64>| {
        polygon
            .iter()
            .map(|p| (p - origin).dot(axis))
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)])
    };
    let ([a, b], [c, d]) = (range(&along), range(&across));
    let middle = origin + across * (0.5 * (c + d));
    Some(([middle + along * a, middle + along * b], d - c))
}

/// The objects beside the roads.
pub(crate) fn beside_roads(sheet: &mut Sheet<'_>, picture: &mut Picture) {
    let (map, page) = (sheet.map, sheet.page);
    for object in map.objects() {
        let at: Point3<f64> = object.pose.translation().into();
        match kind(object) {
            Kind::Building => {
                for ring in rings(object).into_iter().filter(|ring| page.shows(ring, 0.0)) {
                    sheet.legend.insert(Key::Building);
                    let edge = Paint::line([168, 154, 140, 255], 0.7);
                    let paint = Paint { fill: Some(style::BUILDING), ..edge };
                    picture.shape(Shape::ring(page.chain(&ring), paint));
                }
            }
            Kind::Tree if page.shows([&at], 0.0) => {
                sheet.legend.insert(Key::Greenery);
                let radius_m = Some(0.5 * object.size_m.x).filter(|r| *r > 0.3).unwrap_or(CROWN_M);
                let ring = disc(page.at(&at), page.px_min(radius_m, 1.2), 10);
                picture.shape(Shape::ring(ring, Paint::fill(style::GREENERY)));
            }
            Kind::Greenery => {
                for ring in rings(object).into_iter().filter(|ring| page.shows(ring, 0.0)) {
                    sheet.legend.insert(Key::Greenery);
                    picture.shape(Shape::ring(page.chain(&ring), Paint::fill(style::GREENERY)));
                }
            }
            Kind::Barrier => {
                for outline in object.outlines.iter().filter(|o| page.shows(&o.base, 0.0)) {
                    let chain = page.chain(&outline.base);
                    picture.shape(Shape::chain(chain, Paint::line(style::BARRIER, page.px_min(0.3, 0.8))));
                }
            }
            _ => {}
        }
    }
}
