//! The edge of the sheet: name, facts, scale bar, north arrow, legend.

use std::collections::BTreeSet;

use opendrive::Map;

use crate::page::{EDGE_PX, Page, ViewOptions};
use crate::picture::{Anchor, Paint, Picture, Shape, Text};
use crate::style::{self, Class, Key};
use crate::symbols;

/// Height of the title block, and of a row of the legend, pixels.
const TITLE_PX: f64 = 46.0;
const ROW_PX: f64 = 20.0;
/// Swatches of the legend, pixels.
const SWATCH_PX: [f64; 2] = [18.0, 11.0];
/// Longest scale bar as a share of the map's width.
const BAR_SHARE: f64 = 0.22;

pub(crate) fn draw(
    map: &Map,
    page: &Page,
    options: &ViewOptions,
    legend: &BTreeSet<Key>,
    picture: &mut Picture,
) {
    let [map_w, map_h] = page.map_px;
    let rows = rows(legend, map_w);
    let bottom = EDGE_PX + map_h;
    picture.width_px = map_w + 2.0 * EDGE_PX;
    picture.height_px = bottom + TITLE_PX + rows.len() as f64 * ROW_PX + 0.5 * EDGE_PX;
    margins(page, picture);

    let network = map.network();
    let title = options.title.clone().unwrap_or_else(|| network.header.name.clone());
    // Names of files may hold what XML cannot.
    let title = title.replace(char::is_control, " ");
    let title = if title.trim().is_empty() { "Road network".to_owned() } else { title };
    text(picture, [EDGE_PX, bottom + 24.0], Anchor::Start, 19.0, true, style::INK, &title);
    text(picture, [EDGE_PX, bottom + 40.0], Anchor::Start, 11.0, false, style::FAINT_INK, &facts(map));
    picture.title = title;
    scale_bar(page, picture, bottom);
    north_arrow(page, picture);
    for (i, row) in rows.iter().enumerate() {
        let y = bottom + TITLE_PX + (i as f64 + 0.5) * ROW_PX;
        let mut x = EDGE_PX;
        for key in row {
            swatch(picture, [x, y], *key);
            let at = [x + SWATCH_PX[0] + 5.0, y + 4.0];
            text(picture, at, Anchor::Start, 11.0, false, style::INK, label(*key));
            x += entry_px(*key);
        }
    }
}

fn text(
    p: &mut Picture,
    at: [f64; 2],
    anchor: Anchor,
    size_px: f64,
    bold: bool,
    colour: [u8; 4],
    text: &str,
) {
    p.text(Text { at, anchor, size_px, bold, colour, text: text.to_owned() });
}

/// Covers what was drawn beyond the map, and frames it.
fn margins(page: &Page, picture: &mut Picture) {
    let ([x, y], [w, h]) = (page.origin_px, page.map_px);
    let [width, height] = [picture.width_px, picture.height_px];
    // Lines may reach far beyond the sheet, but the sheet ends where the picture does.
    for (at, size) in [
        ([0.0, 0.0], [width, y]),
        ([0.0, y + h], [width, height - y - h]),
        ([0.0, y], [x, h]),
        ([x + w, y], [width - x - w, h]),
    ] {
        picture.shape(Shape::rectangle(at, size, Paint::fill(style::PAPER)));
    }
    picture.shape(Shape::rectangle([x, y], [w, h], Paint::line(style::INK, 1.2)));
}

/// Length of roads, junctions, signals, heights.
fn facts(map: &Map) -> String {
    let network = map.network();
    let roads = network.roads.iter().filter(|r| r.junction.is_none());
    let length_km = roads.map(|r| r.length_m).sum::<f64>() / 1000.0;
    let lights = map.signals().iter().filter(|s| s.dynamic).count();
    let mut low = f64::INFINITY;
    let mut high = f64::NEG_INFINITY;
    for (i, road) in network.roads.iter().enumerate() {
        for step in 0..=8 {
            if let Some(p) = map.road_point(i as u32, road.length_m * f64::from(step) / 8.0, 0.0, 0.0) {
                (low, high) = (low.min(p.z), high.max(p.z));
            }
        }
    }
    let mut facts = vec![format!("{length_km:.1} km of roads")];
    let mut count = |n: usize, one: &str, many: &str| match n {
        0 => {}
        1 => facts.push(format!("1 {one}")),
        n => facts.push(format!("{n} {many}")),
    };
    count(network.junctions.len(), "junction", "junctions");
    count(lights, "traffic light", "traffic lights");
    if high - low >= 0.5 {
        // Adding zero turns a rounded -0 into 0.
        let [low, high] = [low, high].map(|z| z.round() + 0.0);
        facts.push(format!("heights {low} to {high} m"));
    }
    facts.join(", ")
}

/// The largest of 1, 2, 5 times a power of ten metres that fits.
fn bar_m(longest_m: f64) -> f64 {
    let mut length = 1.0;
    for step in [2.0, 2.5, 2.0].into_iter().cycle().take(24) {
        if length * step > longest_m {
            break;
        }
        length *= step;
    }
    length
}

fn scale_bar(page: &Page, picture: &mut Picture, bottom: f64) {
    let length_m = bar_m(BAR_SHARE * page.map_px[0] * page.m_per_px);
    let length = page.px(length_m);
    let (right, y) = (EDGE_PX + page.map_px[0], bottom + 26.0);
    for (i, colour) in [style::INK, style::PAPER, style::INK, style::PAPER].into_iter().enumerate() {
        let part = 0.25 * length;
        let at = [right - length + i as f64 * part, y];
        let paint = Paint { fill: Some(colour), ..Paint::line(style::INK, 0.8) };
        picture.shape(Shape::rectangle(at, [part, 5.0], paint));
    }
    let name =
        if length_m >= 1000.0 { format!("{:.0} km", length_m / 1000.0) } else { format!("{length_m:.0} m") };
    text(picture, [right - length, y - 4.0], Anchor::Middle, 10.0, false, style::INK, "0");
    text(picture, [right, y - 4.0], Anchor::End, 10.0, false, style::INK, &name);
}

fn north_arrow(page: &Page, picture: &mut Picture) {
    let (x, y) = (EDGE_PX + page.map_px[0] - 26.0, EDGE_PX + 30.0);
    let disc = symbols::disc([x, y], 19.0, 32);
    picture.shape(Shape::ring(disc, Paint::fill([253, 253, 251, 215])));
    let half = |side: f64| vec![[x, y - 14.0], [x + side * 7.0, y + 8.0], [x, y + 3.5]];
    picture.shape(Shape::ring(half(-1.0), Paint { fill: Some(style::INK), ..Paint::line(style::INK, 0.8) }));
    picture.shape(Shape::ring(half(1.0), Paint { fill: Some(style::WHITE), ..Paint::line(style::INK, 0.8) }));
    text(picture, [x, y + 17.0], Anchor::Middle, 9.0, true, style::INK, "N");
}

fn label(key: Key) -> &'static str {
    match key {
        Key::Road(class) => class.label(),
        Key::Surface(class) => class.label(),
        Key::Water => "Water",
        Key::Building => "Building",
        Key::Greenery => "Trees",
        Key::Bridge => "Bridge",
        Key::Tunnel => "Tunnel",
        Key::Crosswalk => "Crosswalk",
        Key::Light => "Traffic light",
        Key::Stop => "Stop",
        Key::Yield => "Yield",
        Key::Speed => "Speed limit",
        Key::RailCross => "Level crossing",
        Key::Sign => "Other sign",
    }
}

/// Width of an entry, pixels; in a reader's own font texts may be longer.
fn entry_px(key: Key) -> f64 {
    SWATCH_PX[0] + 5.0 + 1.1 * typeface::length_px(label(key), 11.0, typeface::Weight::Regular) + 14.0
}

fn rows(legend: &BTreeSet<Key>, width_px: f64) -> Vec<Vec<Key>> {
    let mut rows: Vec<Vec<Key>> = Vec::new();
    let mut used = f64::INFINITY;
    for key in legend {
        if used + entry_px(*key) > width_px {
            rows.push(Vec::new());
            used = 0.0;
        }
        used += entry_px(*key);
        if let Some(row) = rows.last_mut() {
            row.push(*key);
        }
    }
    rows
}

/// The picture of an entry, left of and level with its text.
fn swatch(picture: &mut Picture, [x, y]: [f64; 2], key: Key) {
    let [w, h] = SWATCH_PX;
    let corner = [x, y - 0.5 * h];
    let level = |inset: f64| vec![[x, y + inset], [x + w, y + inset]];
    let framed = |fill| Paint { fill: Some(fill), ..Paint::line(style::FAINT_INK, 0.6) };
    match key {
        Key::Road(class) => {
            let [body, edge] = class.colours();
            let rail = class == style::RoadClass::Rail;
            picture.shape(Shape::chain(level(0.0), Paint::line(edge, if rail { 3.0 } else { 6.0 })));
            let over = if rail { Paint::dashed(body, 1.5, [4.0, 4.0]) } else { Paint::line(body, 4.2) };
            picture.shape(Shape::chain(level(0.0), over));
        }
        Key::Surface(Class::Rail) => {
            picture.shape(Shape::rectangle(corner, [w, h], Paint::fill(Class::Rail.colour())));
            picture.shape(Shape::chain(level(0.0), Paint::dashed(style::SLEEPER, 8.0, [1.6, 2.4])));
            for inset in [-2.6, 2.6] {
                picture.shape(Shape::chain(level(inset), Paint::line(style::RAIL, 1.0)));
            }
        }
        Key::Surface(class) => picture.shape(Shape::rectangle(corner, [w, h], framed(class.colour()))),
        Key::Water => picture.shape(Shape::rectangle(corner, [w, h], framed(style::WATER))),
        Key::Building => picture.shape(Shape::rectangle(corner, [w, h], framed(style::BUILDING))),
        Key::Greenery => {
            let ring = symbols::disc([x + 0.5 * w, y], 5.0, 16);
            picture.shape(Shape::ring(ring, Paint::fill(style::GREENERY)));
        }
        Key::Bridge => {
            picture.shape(Shape::chain(level(0.0), Paint::line(style::PARAPET, 9.0)));
            picture.shape(Shape::chain(level(0.0), Paint::line(Class::Asphalt.colour(), 6.0)));
        }
        Key::Tunnel => {
            picture.shape(Shape::chain(level(0.0), Paint::line(style::TUNNEL, 7.0)));
            for inset in [-3.5, 3.5] {
                picture.shape(Shape::chain(level(inset), Paint::dashed(style::TUNNEL_EDGE, 1.2, [4.0, 3.0])));
            }
        }
        Key::Crosswalk => {
            picture.shape(Shape::rectangle(corner, [w, h], Paint::fill(Class::Asphalt.colour())));
            picture.shape(Shape::chain(level(0.0), Paint::dashed(style::WHITE, 8.0, [2.0, 2.0])));
        }
        Key::Light | Key::Stop | Key::Yield | Key::Speed | Key::RailCross | Key::Sign => {
            symbols::legend_symbol(picture, [x + 0.5 * w, y], key);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_bars_have_round_lengths() {
        for (longest, want) in
            [(1.2, 1.0), (7.0, 5.0), (55.0, 50.0), (199.0, 100.0), (200.0, 200.0), (2300.0, 2000.0)]
        {
            assert_eq!(bar_m(longest), want);
        }
    }
}
