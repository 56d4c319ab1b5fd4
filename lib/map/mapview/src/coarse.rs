//! Small scales: roads as lines, coloured by their kind.

use std::collections::{BTreeMap, BTreeSet};

use opendrive::{LaneType, Map, Road, RoadLink};

use crate::page::Page;
use crate::picture::{Paint, Picture, Shape};
use crate::stretch::{Carrier, Piece, Stretch, stretches};
use crate::style::{self, Class, Key, RoadClass};
use crate::{levels, things};

/// Roads without a stated kind: above the first limit they are motorways, under the second streets, m/s.
const FAST_MPS: f64 = 105.0 / 3.6;
const SLOW_MPS: f64 = 55.0 / 3.6;
/// Land on both sides of a street with sidewalks that is shown as built-up, metres.
const BUILT_UP_M: f64 = 80.0;
/// Casing on both sides, pixels: on the ground and on decks.
const CASING_PX: [f64; 2] = [0.6, 1.3];

/// Draws everything and tells what occurred.
pub(crate) fn draw(map: &Map, page: &Page, picture: &mut Picture) -> BTreeSet<Key> {
    let mut stretches = stretches(map, page);
    stretches.retain(|s| s.edges().is_some_and(|[r, l]| page.shows(r.iter().chain(l), page.px(BUILT_UP_M))));
    levels::assign(&mut stretches);
    let mut legend = BTreeSet::new();
    let walked = stretches.iter().filter(|s| s.bands.iter().any(|b| b.class == Class::Sidewalk));
    let chains = walked.flat_map(|s| s.runs().map(|run| centre(s, &run, page, |_| true).0)).collect();
    let paint = Paint::round_line(style::BUILT_UP, page.px(2.0 * BUILT_UP_M));
    picture.shape(Shape { chains, closed: false, paint });
    things::water(map, page, &mut legend, picture);

    // Level, whether covered by its casing, class, then the line itself: sorted, this is the painting order.
    let mut lines: Vec<(i8, bool, RoadClass, Line)> = Vec::new();
    let mut classes: BTreeMap<&str, RoadClass> = BTreeMap::new();
    let road_of = |stretch: &Stretch| map.network().roads.get(stretch.road as usize);
    for stretch in &stretches {
        let Some(road) = road_of(stretch) else { continue };
        classes.insert(&road.id, class_of(map, stretch, road));
    }
    for stretch in &stretches {
        let Some(road) = road_of(stretch) else { continue };
        let own = class_of(map, stretch, road);
        let class = joined_class(road, &classes).unwrap_or(own);
        for run in stretch.runs() {
            let line = Line::new(stretch, &run, page, class);
            lines.push((run.level, false, class, line.clone()));
            lines.push((run.level, true, class, line));
        }
    }
    lines.sort_by_key(|(level, fill, class, _)| (*level, *fill, *class));
    for (_, fill, class, line) in lines {
        legend.insert(Key::Road(class));
        line.paint(fill, class, picture, &mut legend);
    }
    legend
}

/// A road on the sheet.
#[derive(Clone, Debug)]
struct Line {
    chain: Vec<[f64; 2]>,
    width_px: f64,
    carrier: Carrier,
    over: bool,
}

impl Line {
    fn new(stretch: &Stretch, run: &Piece, page: &Page, class: RoadClass) -> Self {
        // The directions of a motorway have ways of their own at a seam: they meet in its median.
        let wheels = |c: Class| {
            matches!(c, Class::Asphalt | Class::Junction | Class::Bus | Class::Rail)
                || (stretch.in_junction && c == Class::Median)
        };
        let (chain, width_m) = centre(stretch, run, page, wheels);
        // Half-pixel steps: fewer kinds of line, shorter files.
        let width_px = (2.0 * page.px_min(width_m, class.least_px())).round() / 2.0;
        Self { chain, width_px, carrier: run.carrier, over: run.level > 0 }
    }

    fn paint(self, fill: bool, class: RoadClass, picture: &mut Picture, legend: &mut BTreeSet<Key>) {
        let [body, edge] = class.colours();
        let deck = self.over || self.carrier == Carrier::Bridge;
        let paint = match (self.carrier, class, fill) {
            (Carrier::Tunnel, ..) => {
                legend.insert(Key::Tunnel);
                Paint::dashed(edge, 0.6 * self.width_px, [4.0, 3.0])
            }
            (_, RoadClass::Rail, false) => Paint::line(edge, self.width_px),
            (_, RoadClass::Rail, true) => Paint::dashed(body, 0.5 * self.width_px, [5.0, 5.0]),
            (_, _, false) => {
                let wide = self.width_px + 2.0 * CASING_PX[usize::from(deck)];
                if deck {
                    legend.insert(Key::Bridge);
                    Paint::line(style::PARAPET, wide)
                } else {
                    Paint::round_line(edge, wide)
                }
            }
            (_, _, true) => Paint::round_line(body, self.width_px),
        };
        picture.shape(Shape::chain(self.chain, paint));
    }
}

/// The middle of some bands, and their widest extent, metres; of all bands where none is wanted.
fn centre(
    stretch: &Stretch,
    run: &Piece,
    page: &Page,
    wanted: impl Fn(Class) -> bool,
) -> (Vec<[f64; 2]>, f64) {
    let mut chosen: Vec<usize> =
        (0..stretch.bands.len()).filter(|i| wanted(stretch.bands[*i].class)).collect();
    if chosen.is_empty() {
        chosen = (0..stretch.bands.len()).collect();
    }
    let (Some(first), Some(last)) = (chosen.first(), chosen.last()) else { return (Vec::new(), 0.0) };
    let (right, left) = (&stretch.bands[*first].line.right, &stretch.bands[*last].line.left);
    let mut width_m = 0.0f64;
    let chain = stretch
        .shape_samples(run)
        .into_iter()
        .map(|i| {
            width_m = width_m.max((left[i] - right[i]).norm());
            page.at(&nalgebra::center(&right[i], &left[i]))
        })
        .collect();
    (chain, width_m)
}

/// The kind of a connecting road: the lesser of the roads it joins, as far as they are drawn.
fn joined_class(road: &Road, classes: &BTreeMap<&str, RoadClass>) -> Option<RoadClass> {
    road.junction.as_ref()?;
    let joined = [&road.predecessor, &road.successor].into_iter().flatten().filter_map(|link| match link {
        RoadLink::Road { id, .. } => classes.get(id.as_str()).copied(),
        _ => None,
    });
    joined.min()
}

/// The kind of a road by itself.
fn class_of(map: &Map, stretch: &Stretch, road: &Road) -> RoadClass {
    if stretch.bands.iter().all(|b| b.class == Class::Rail || b.class == Class::Verge) {
        return RoadClass::Rail;
    }
    let kind = road.types.iter().map(|t| t.kind.as_str()).next().unwrap_or_default();
    let walked = stretch.bands.iter().any(|b| b.class == Class::Sidewalk);
    let lanes = map.lanes();
    let place = (stretch.road, stretch.section);
    let limit = lanes[lanes.partition_point(|l| (l.id.road, l.id.section) < place)..]
        .iter()
        .take_while(|l| (l.id.road, l.id.section) == place)
        .filter(|l| l.lane_type == LaneType::Driving)
        .filter_map(|l| l.speed_limit_mps)
        .fold(0.0, f64::max);
    match kind {
        "motorway" => RoadClass::Motorway,
        "rural" if !walked => RoadClass::Rural,
        "lowSpeed" | "pedestrian" => RoadClass::Street,
        // Some writers call every road a town's.
        _ if walked || (limit > 0.0 && limit < SLOW_MPS) => RoadClass::Street,
        _ if limit > FAST_MPS => RoadClass::Motorway,
        _ => RoadClass::Rural,
    }
}
