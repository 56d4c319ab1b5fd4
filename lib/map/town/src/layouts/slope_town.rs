//! A small town on a slope: streets along it, a main street among them, and short lanes between neighbouring
//! ones that hardly ever line up.

use frames::math::sin;
use random::Stream;
use std::f64::consts::TAU;

use super::graph::{Graph, LineId, PointId};
use crate::TownParameters;
use crate::layout::{Control, NodeKind};
use crate::section::{CrossSection, Side};

/// Speed limits of the main street and of the others, km/h.
const MAIN_KMH: f64 = 50.0;
const STREET_KMH: f64 = 30.0;
/// Steepest lanes.
const GRADE: f64 = 0.12;
const PARKING_M: f64 = 2.1;
/// Narrow streets and their sidewalks, metres.
const NARROW_M: f64 = 3.0;
const NARROW_SIDEWALK_M: f64 = 1.8;
/// Two junctions of a street nearer than the first figure are one, and otherwise further apart than the
/// second, metres.
const SAME_M: f64 = 15.0;
const APART_M: f64 = 56.0;
/// Least difference between the beginnings of neighbouring streets, metres.
const BLOCK_M: f64 = 85.0;
/// Streets wander from point to point, at most so far apart, metres.
const STEP_M: f64 = 75.0;

/// What a town on a slope is like; x along its streets, y across them, metres.
pub(super) struct Slope {
    /// Streets along the slope.
    pub(super) rows: usize,
    /// Where a street at a y may begin.
    pub(super) west_m: Box<dyn Fn(f64) -> f64>,
    /// Where they end.
    pub(super) east_m: f64,
    /// Largest |y|.
    pub(super) half_width_m: f64,
    /// Places in the world where the main street begins and ends.
    pub(super) ends: [[f64; 2]; 2],
    pub(super) parking_share: f64,
}

/// A street along the slope.
struct Row {
    y_m: f64,
    from_m: f64,
    /// Junctions: x, point, and whether lanes come from below and from above.
    joints: Vec<(f64, PointId, [bool; 2])>,
}

/// Adds a town to a graph. `place` takes its coordinates to the world.
pub(super) fn slope_town(
    graph: &mut Graph,
    draws: &mut Stream,
    parameters: &TownParameters,
    slope: &Slope,
    place: &dyn Fn(f64, f64) -> [f64; 2],
) {
    let rows = slope.rows.max(2);
    let mut main = rows / 2;
    let gap = (2.0 * (slope.half_width_m - 30.0) / (rows as f64 - 1.0)).min(135.0);
    let (swing_m, phase) = (draws.uniform(16.0, 28.0), draws.uniform(0.0, TAU));
    // The streets wind with the slope and fan out along it.
    let (west, span) = ((slope.west_m)(0.0), slope.east_m - (slope.west_m)(0.0));
    let bent = move |x: f64, y: f64| {
        let fan = 0.72 + 0.28 * ((x - west) / span.max(1.0)).clamp(0.0, 1.0);
        y * fan + swing_m * sin(TAU * x / 520.0 + phase + 0.003 * y)
    };
    let mut streets: Vec<Row> = (0..rows)
        .map(|j| {
            let y_m = (j as f64 - main as f64) * gap + if j == main { 0.0 } else { draws.uniform(-9.0, 9.0) };
            Row { y_m, from_m: (slope.west_m)(0.8 * y_m.abs() + swing_m), joints: Vec::new() }
        })
        .collect();
    // Away from the main street they begin where their inner neighbour does, or a block further east.
    for (j, inner) in (0..main).rev().map(|j| (j, j + 1)).chain((main + 1..rows).map(|j| (j, j - 1))) {
        let (own, inner) = (streets[j].from_m, streets[inner].from_m);
        streets[j].from_m = if own > inner + 1.0 { own.max(inner + BLOCK_M) } else { inner };
    }
    // Those without room for a block are left out, and what lies beyond them.
    let long = |j: &usize| streets[*j].from_m < slope.east_m - BLOCK_M;
    let first = (0..main).rev().take_while(long).last().unwrap_or(main);
    let last = (main + 1..rows).take_while(long).last().unwrap_or(main);
    streets.truncate(last + 1);
    streets.drain(..first);
    main -= first;
    for j in 0..streets.len() - 1 {
        lanes_between(graph, draws, slope, &mut streets, j, &|x, y| place(x, bent(x, y)));
    }
    let side = Side::town(1, parameters.lane_width_m).with_sidewalk(parameters.sidewalk_m);
    for (j, street) in streets.iter_mut().enumerate() {
        street.joints.sort_by(|a, b| a.0.total_cmp(&b.0));
        let shape = if j == main {
            CrossSection::both_ways(side.with_parking(PARKING_M), MAIN_KMH)
        } else {
            narrow(draws, slope)
        };
        let name = if j == main { "Main Street".into() } else { format!("Slope {j}") };
        let line = graph.line(name, shape, [110.0, 10.0]);
        row(graph, line, street, (j == main).then_some(slope.ends), &|x, y| place(x, bent(x, y)));
        for (_, point, sides) in &street.joints {
            let both = sides[0] && sides[1];
            let control = match both {
                true if j == main => Control::Signals,
                true => Control::AllStop,
                false if j == main => Control::MinorStop,
                false => Control::MinorYield,
            };
            graph.kind(*point, NodeKind::Crossing(control));
        }
    }
}

/// A lane or a street away from the main one, each side with parked cars or without.
fn narrow(draws: &mut Stream, slope: &Slope) -> CrossSection {
    let mut side = || {
        let parked = draws.chance(slope.parking_share);
        Side::town(1, NARROW_M).with_sidewalk(NARROW_SIDEWALK_M).with_parking(if parked {
            PARKING_M
        } else {
            0.0
        })
    };
    let (left, right) = (side(), side());
    CrossSection { left, max_grade: GRADE, ..CrossSection::both_ways(right, STREET_KMH) }
}

/// Lanes up the slope from a street to the next, block by block. `at` takes places of the town to the world.
fn lanes_between(
    graph: &mut Graph,
    draws: &mut Stream,
    slope: &Slope,
    streets: &mut [Row],
    j: usize,
    at: &dyn Fn(f64, f64) -> [f64; 2],
) {
    let from = streets[j].from_m.max(streets[j + 1].from_m);
    let mut x = from;
    let mut lane = 0;
    loop {
        let last = x >= slope.east_m - 1.0;
        let slant = if last || lane == 0 { 0.0 } else { draws.uniform(-26.0, 26.0) };
        let ends = [(j, x - slant, 1), (j + 1, x + slant, 0)];
        let free = ends.iter().all(|(row, x, _)| joint(&streets[*row], *x).is_some());
        let placed = free || last || lane == 0;
        if placed {
            let points = ends.map(|(row, x, side)| {
                let street = &mut streets[row];
                let found = joint(street, x).flatten();
                let index = found.unwrap_or_else(|| {
                    let point = graph.point(at(x, street.y_m));
                    street.joints.push((x, point, [false; 2]));
                    street.joints.len() - 1
                });
                street.joints[index].2[side] = true;
                street.joints[index].1
            });
            let line = graph.line(format!("Lane {j}-{lane}"), narrow(draws, slope), [30.0, 5.0]);
            graph.lead(line, &points);
            lane += 1;
        }
        if last {
            break;
        }
        x += if placed { draws.uniform(78.0, 125.0) } else { 12.0 };
        // The last lane closes the block at the end.
        if x > slope.east_m - 70.0 {
            x = slope.east_m;
        }
    }
}

/// Where a lane may join a street: at a junction that is there already (its index), or at a new one; nothing
/// where it would be too near to another.
fn joint(street: &Row, x: f64) -> Option<Option<usize>> {
    let near = |limit: f64| street.joints.iter().position(|(at, ..)| (at - x).abs() < limit);
    match near(SAME_M) {
        Some(index) => Some(Some(index)),
        None if near(APART_M).is_some() => None,
        None => Some(None),
    }
}

/// Leads a street through its junctions, bent between them.
fn row(
    graph: &mut Graph,
    line: LineId,
    street: &Row,
    ends: Option<[[f64; 2]; 2]>,
    place: &dyn Fn(f64, f64) -> [f64; 2],
) {
    let mut stops: Vec<PointId> = Vec::new();
    if let Some([first, _]) = ends {
        stops.push(graph.point(first));
    }
    let mut before: Option<f64> = None;
    for (x, point, _) in &street.joints {
        if let Some(from) = before {
            let parts = ((x - from) / STEP_M).floor().max(1.0) as usize;
            for i in 1..parts {
                let at = from + (x - from) * i as f64 / parts as f64;
                stops.push(graph.point(place(at, street.y_m)));
            }
        }
        stops.push(*point);
        before = Some(*x);
    }
    if let Some([_, last]) = ends {
        stops.push(graph.point(last));
    }
    graph.lead(line, &stops);
}
