//! Markings, kerbs and rails.

use nalgebra::{Point3, Vector3};
use opendrive::{MarkType, Stripe};

use crate::page::Page;
use crate::picture::{Colour, Paint};
use crate::sheet::{Order, Sheet};
use crate::stretch::{Carrier, Stretch};
use crate::style::{self, Class};

/// Lines thinner than this on the sheet are drawn so wide, pixels.
const THIN_PX: f64 = 0.45;
/// Dashes shorter than this become a paler line, pixels.
const SHORT_PX: f64 = 1.6;
/// Kerbs are shown on scales finer than this, metres a pixel.
const KERB_BELOW_M_PER_PX: f64 = 0.6;
/// Distance between the rails, width of a rail, length, width and spacing of the sleepers, metres.
const GAUGE_M: f64 = 1.5;
const RAIL_M: f64 = 0.12;
const SLEEPER_M: [f64; 3] = [2.5, 0.28, 0.65];
/// Sleepers nearer to each other than this are left out, pixels.
const SLEEPERS_PX: f64 = 1.6;

pub(crate) fn draw(sheet: &mut Sheet<'_>) {
    let stretches = std::mem::take(&mut sheet.stretches);
    for stretch in &stretches {
        for stripe in sheet.map.stripes_of(stretch.road, stretch.section) {
            if let Some((paint, order, dash)) = stripe_style(stripe, sheet.page) {
                draw_stripe(sheet, stretch, stripe, paint, order, dash);
            }
        }
        rails(sheet, stretch);
    }
    sheet.stretches = stretches;
}

/// Paint, order and dashes of a stripe on this scale.
fn stripe_style(stripe: &Stripe, page: &Page) -> Option<(Paint, Order, Option<[f64; 2]>)> {
    if stripe.mark_type == MarkType::Curb {
        let paint = Paint::line(style::KERB, page.px_min(0.15, THIN_PX));
        return (page.m_per_px < KERB_BELOW_M_PER_PX).then_some((paint, Order::Kerb, None));
    }
    let mut colour = style::paint_colour(stripe.colour);
    let mut dash = stripe.dash;
    if let Some([line, gap]) = dash
        && page.px(line.min(gap)) < SHORT_PX
    {
        colour = mixed(Class::Asphalt.colour(), colour, line / (line + gap));
        dash = None;
    }
    Some((Paint::line(colour, page.px_min(stripe.width_m, THIN_PX)), Order::Mark, dash))
}

fn mixed(a: Colour, b: Colour, part: f64) -> Colour {
    let mix = |i: usize| (f64::from(a[i]) * (1.0 - part) + f64::from(b[i]) * part).round() as u8;
    [mix(0), mix(1), mix(2), 255]
}

fn draw_stripe(
    sheet: &mut Sheet<'_>,
    stretch: &Stretch,
    stripe: &Stripe,
    paint: Paint,
    order: Order,
    dash: Option<[f64; 2]>,
) {
    let Some(border) = border_of(stretch, stripe.border_of) else { return };
    let (start, end) = (stripe.s_start, stripe.s_end);
    let parts: Vec<[f64; 2]> = match dash {
        Some([line, gap]) if line > 0.0 && gap > 0.0 => {
            let count = ((end - start) / (line + gap)).ceil().clamp(0.0, 100_000.0) as usize;
            let from = |i: usize| start + i as f64 * (line + gap);
            (0..count).map(|i| [from(i), (from(i) + line).min(end)]).collect()
        }
        _ => stretch
            .runs()
            .map(|run| run.samples.map(|i| stretch.s[i]))
            .map(|[from, to]| [from.max(start), to.min(end)])
            .collect(),
    };
    for [from, to] in parts.into_iter().filter(|[from, to]| to > from) {
        let Some(piece) = stretch.piece_at(0.5 * (from + to)) else { continue };
        if piece.carrier == Carrier::Tunnel {
            continue;
        }
        let chain = aside(stretch.along(border, from, to), stripe.t_offset_m);
        if sheet.page.shows(&chain, 4.0) {
            sheet.layers.add(piece.level, order, sheet.page.chain(&chain), false, paint);
        }
    }
}

/// The outer border of a lane, or the centre line for lane 0.
fn border_of(stretch: &Stretch, lane: i16) -> Option<&[Point3<f64>]> {
    let band = |id: i16| stretch.bands.iter().find(|b| b.lane == id);
    match lane {
        0 => band(1).map(|b| &*b.line.right).or_else(|| band(-1).map(|b| &*b.line.left)),
        1.. => band(lane).map(|b| &*b.line.left),
        _ => band(lane).map(|b| &*b.line.right),
    }
}

/// A chain moved to its left.
pub(crate) fn aside(chain: Vec<Point3<f64>>, left_m: f64) -> Vec<Point3<f64>> {
    if left_m == 0.0 {
        return chain;
    }
    let last = chain.len().saturating_sub(1);
    (0..chain.len())
        .map(|i| {
            let along = chain[(i + 1).min(last)] - chain[i.saturating_sub(1)];
            let left = Vector3::new(-along.y, along.x, 0.0).try_normalize(1e-9).unwrap_or_default();
            chain[i] + left * left_m
        })
        .collect()
}

fn rails(sheet: &mut Sheet<'_>, stretch: &Stretch) {
    let page = sheet.page;
    for band in stretch.bands.iter().filter(|b| b.class == Class::Rail) {
        for run in stretch.runs().filter(|r| r.carrier != Carrier::Tunnel) {
            let [from, to] = run.samples.map(|i| stretch.s[i]);
            let middle = stretch.along(&band.line.centre, from, to);
            // Level crossings are paved between the rails.
            if page.px(SLEEPER_M[2]) >= SLEEPERS_PX && !stretch.in_junction {
                let dash = [page.px(SLEEPER_M[1]), page.px(SLEEPER_M[2] - SLEEPER_M[1])];
                let paint = Paint::dashed(style::SLEEPER, page.px(SLEEPER_M[0]), dash);
                sheet.layers.add(run.level, Order::Sleeper, page.chain(&middle), false, paint);
            }
            let paint = Paint::line(style::RAIL, page.px_min(RAIL_M, 0.6));
            for side in [0.5, -0.5] {
                let rail = aside(middle.clone(), side * GAUGE_M);
                sheet.layers.add(run.level, Order::Rail, page.chain(&rail), false, paint);
            }
        }
    }
}
