//! Large scales: every lane, marking and sign.

use std::collections::BTreeSet;

use nalgebra::Point3;
use opendrive::Map;

use crate::page::Page;
use crate::picture::{Paint, Picture, Shape};
use crate::sheet::{Layers, Order, Sheet};
use crate::stretch::{Carrier, Stretch, stretches};
use crate::style::{self, Class, Key};
use crate::{levels, marks, symbols, things};

/// Land on both sides of a street with sidewalks that is shown as built-up, metres.
const BUILT_UP_M: f64 = 38.0;
/// Extent of the shadow that a deck throws, metres, and its least extent, pixels.
const SHADOW_M: f64 = 1.6;
const SHADOW_PX: f64 = 1.6;

/// Draws everything and tells what occurred.
pub(crate) fn draw(map: &Map, page: &Page, picture: &mut Picture) -> BTreeSet<Key> {
    let mut stretches = stretches(map, page);
    let margin_px = page.px(BUILT_UP_M);
    stretches.retain(|s| s.edges().is_some_and(|[r, l]| page.shows(r.iter().chain(l), margin_px)));
    levels::assign(&mut stretches);
    let mut sheet = Sheet { map, page, stretches, layers: Layers::default(), legend: BTreeSet::new() };

    built_up(&sheet, picture);
    things::water(map, page, &mut sheet.legend, picture);
    surfaces(&mut sheet);
    marks::draw(&mut sheet);
    things::on_roads(&mut sheet);
    for shape in std::mem::take(&mut sheet.layers).into_shapes() {
        picture.shape(shape);
    }
    things::beside_roads(&mut sheet, picture);
    symbols::draw(&mut sheet, picture);
    sheet.legend
}

/// The land along streets with sidewalks.
fn built_up(sheet: &Sheet<'_>, picture: &mut Picture) {
    let walked = sheet.stretches.iter().filter(|s| s.bands.iter().any(|b| b.class == Class::Sidewalk));
    let chains = walked.filter_map(|stretch| {
        let [right, left] = stretch.edges()?;
        let whole = stretch.runs().flat_map(|run| stretch.shape_samples(&run));
        Some(whole.map(|i| sheet.page.at(&nalgebra::center(&right[i], &left[i]))).collect())
    });
    let paint = Paint::round_line(style::BUILT_UP, sheet.page.px(2.0 * BUILT_UP_M));
    picture.shape(Shape { chains: chains.collect(), closed: false, paint });
}

fn surfaces(sheet: &mut Sheet<'_>) {
    let page = sheet.page;
    let stretches = std::mem::take(&mut sheet.stretches);
    for stretch in &stretches {
        let groups = stretch.groups();
        for run in stretch.runs() {
            let samples = stretch.shape_samples(&run);
            let ring_px = |ring: &Vec<Point3<f64>>| page.chain(ring);
            let deck = run.carrier == Carrier::Bridge || run.level > 0;
            if deck || run.carrier == Carrier::Tunnel {
                outline(sheet, stretch, &samples, run.level, run.carrier);
            }
            if run.carrier == Carrier::Tunnel {
                continue;
            }
            for group in &groups {
                let class = stretch.bands[group.start].class;
                for ring in stretch.rings(group, &samples) {
                    sheet.legend.insert(Key::Surface(class));
                    let paint = Paint::sealed(class.colour());
                    sheet.layers.add(run.level, Order::Surface(class), ring_px(&ring), true, paint);
                }
            }
        }
    }
    sheet.stretches = stretches;
}

/// Edges and shadow of a deck, or the dashed body of a tunnel.
fn outline(sheet: &mut Sheet<'_>, stretch: &Stretch, samples: &[usize], level: i8, carrier: Carrier) {
    let page = sheet.page;
    let Some(edges) = stretch.edges() else { return };
    let [right, left] = edges.map(|edge| page.chain(samples.iter().map(|i| &edge[*i])));
    let ring: Vec<[f64; 2]> = left.iter().chain(right.iter().rev()).copied().collect();
    if carrier == Carrier::Tunnel {
        sheet.legend.insert(Key::Tunnel);
        sheet.layers.add(level, Order::Shadow, ring, true, Paint::fill(style::TUNNEL));
        let dash_px = [page.px_min(3.0, 4.0), page.px_min(2.0, 3.0)];
        let paint = Paint::dashed(style::TUNNEL_EDGE, page.px_min(0.4, 1.1), dash_px);
        for edge in [right, left] {
            sheet.layers.add(level, Order::Parapet, edge, false, paint);
        }
        return;
    }
    sheet.legend.insert(Key::Bridge);
    shadow(sheet, stretch, samples, level);
    // Half of the line is covered by the surface.
    let paint = Paint::line(style::PARAPET, 2.0 * page.px_min(0.5, 1.0));
    for edge in [right, left] {
        sheet.layers.add(level, Order::Parapet, edge, false, paint);
    }
}

/// The shadow of a deck, which ends before the deck does: it must not fall on the road that leads there.
fn shadow(sheet: &mut Sheet<'_>, stretch: &Stretch, samples: &[usize], level: i8) {
    let page = sheet.page;
    let away_px = page.px_min(SHADOW_M, SHADOW_PX);
    let ([first, .., last], Some(edges)) = (samples, stretch.edges()) else { return };
    let trim_m = 2.0 * away_px * page.m_per_px;
    let (from, to) = (stretch.s[*first] + trim_m, stretch.s[*last] - trim_m);
    if from >= to {
        return;
    }
    let [right, left] = edges.map(|edge| page.chain(&stretch.along(edge, from, to)));
    let ring = left.iter().chain(right.iter().rev()).map(|[x, y]| [x + away_px, y + away_px]);
    sheet.layers.add(level, Order::Shadow, ring.collect(), true, Paint::fill(style::SHADOW));
}
