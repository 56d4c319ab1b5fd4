//! Roundabouts: a ring of one-way pieces and a small junction for each street.

use frames::math::{asin, cos, sin, tan};
use frames::wrap_pi;
use opendrive::ContactPoint;
use std::f64::consts::{FRAC_PI_2, TAU};

use crate::TownError;
use crate::arm::{counter_clockwise, inner_m, runs};
use crate::junction::lead_m;
use crate::layout::{Edge, Layout, Line, Node, NodeKind, Role};
use crate::node_plan::heading;
use crate::path::{Piece, Pose2};
use crate::section::{CrossSection, Side, paved_m};
use crate::terrain::Pad;

/// Width of a circulating lane, metres: one alone, or each of two.
const LANE_M: [f64; 2] = [5.0, 4.2];
/// Paved strip round the central island, metres.
const APRON_M: f64 = 1.0;
/// Speed limit on the ring, km/h.
const RING_KMH: f64 = 30.0;
/// Width of the splitter islands of streets that bring none of their own, metres.
const SPLITTER_M: f64 = 3.0;
/// Radius up to which entries and exits widen where there is room, metres.
const CORNER_M: f64 = 14.0;
/// Least radius that is left inside of an entry's sidewalk, metres.
const LEAST_M: f64 = 3.0;
/// Least length of a piece of the ring between two streets, metres.
const PIECE_M: f64 = 4.0;
/// By how much the island grows at a time where the streets have no room, and how often at most.
const GROW_M: f64 = 1.0;
const GROWN: u32 = 30;
/// The ground is levelled this far beyond the streets' ends, and blends out as far again, metres.
const LEVEL_M: f64 = 12.0;

/// Replaces every roundabout by its parts. An island that is too small for the streets grows.
pub(crate) fn expand(layout: &Layout) -> Result<Layout, TownError> {
    let mut out = layout.clone();
    for (index, node) in layout.nodes.iter().enumerate() {
        if let NodeKind::Roundabout { island_m, lanes } = node.kind {
            let lanes = lanes.clamp(1, 2);
            let tried = |grown: u32| {
                let mut out = out.clone();
                ring(layout, &mut out, index, node, island_m + GROW_M * f64::from(grown), lanes)?;
                Ok(out)
            };
            let built = (1..=GROWN).fold(tried(0), |found, grown| found.or_else(|_| tried(grown)));
            out = built?;
        }
    }
    // Nodes keep their numbers; what a roundabout was stays as an end without streets.
    Ok(out)
}

/// A street at a roundabout.
struct Street {
    edge: usize,
    contact: ContactPoint,
    heading_rad: f64,
    /// Half the angle of its small junction, radians.
    half_rad: f64,
    /// From the centre to the street's end, metres.
    distance_m: f64,
}

fn ring(
    layout: &Layout,
    out: &mut Layout,
    index: usize,
    node: &Node,
    island_m: f64,
    lanes: u8,
) -> Result<(), TownError> {
    let problem = |problem: &str| TownError::Layout {
        place: if node.name.is_empty() { format!("node {index}") } else { node.name.clone() },
        problem: problem.into(),
    };
    let lane_m = LANE_M[usize::from(lanes > 1)];
    let (mut streets, sidewalk_m) = streets(layout, out, index, node, [island_m, lane_m], lanes)
        .ok_or_else(|| problem("the roundabout is too small for its streets"))?;
    if streets.len() < 2 {
        return Err(problem("a roundabout needs two streets or more"));
    }
    streets.sort_by(|a, b| a.heading_rad.total_cmp(&b.heading_rad));

    let [x_m, y_m] = node.at_m;
    let at = |angle: f64| Pose2 {
        x_m: x_m + island_m * cos(angle),
        y_m: y_m + island_m * sin(angle),
        heading_rad: wrap_pi(angle + FRAC_PI_2),
    };
    let radius_m = streets.iter().map(|s| s.distance_m).fold(0.0, f64::max) + LEVEL_M;
    out.terrain.pads.push(Pad { at_m: node.at_m, radius_m, blend_m: 2.0 * radius_m });
    let side = Side::town(lanes, lane_m).with_sidewalk(sidewalk_m);
    let bare = Side { sidewalk_m: 0.0, ..side };
    let shape = CrossSection { right: side, ..CrossSection::one_way(bare, APRON_M, RING_KMH) };
    let mut parts = Vec::new();
    for street in &streets {
        let middle = at(street.heading_rad);
        let part = out.node(Node {
            at_m: [middle.x_m, middle.y_m],
            kind: NodeKind::Ring,
            kerb_radius_m: CORNER_M,
            ..node.clone()
        });
        parts.push(part);
        let centre = Pose2 { x_m, y_m, heading_rad: street.heading_rad };
        let edge = &mut out.edges[street.edge];
        let end = if street.contact == ContactPoint::Start { &mut edge.from } else { &mut edge.to };
        (end.node, end.role) = (part, Role::Fixed(centre.moved(street.distance_m, 0.0)));
    }
    for (i, street) in streets.iter().enumerate() {
        let j = (i + 1) % streets.len();
        let gap = counter_clockwise(street.heading_rad, streets[j].heading_rad);
        let turn = if streets.len() == 1 { TAU } else { gap } - street.half_rad - streets[j].half_rad;
        if turn * island_m < PIECE_M {
            return Err(problem("the streets of the roundabout are too close together"));
        }
        let start = at(street.heading_rad + street.half_rad);
        let end = at(streets[j].heading_rad - streets[j].half_rad);
        let mut piece = Edge::new(format!("{} ring", node.name).trim().to_owned(), parts[i], parts[j], shape);
        piece.line = Line::Chain(start, vec![Piece::Arc(1.0 / island_m, turn * island_m)]);
        piece.from.role = Role::Ring(start);
        piece.to.role = Role::Ring(end.turned(std::f64::consts::PI));
        piece.min_radius_m = 0.0;
        out.edge(piece);
    }
    Ok(())
}

/// The streets of a roundabout, with splitter islands where they need them, and the width of the ring's
/// sidewalk, metres; none where one of them does not fit. `[island_m, lane_m]`: radius of the island, width
/// of a lane round it.
fn streets(
    layout: &Layout,
    out: &mut Layout,
    index: usize,
    node: &Node,
    [island_m, lane_m]: [f64; 2],
    lanes: u8,
) -> Option<(Vec<Street>, f64)> {
    let mut sidewalk_m = 0.0f64;
    let mut streets: Vec<Street> = Vec::new();
    for (i, edge) in out.edges.iter_mut().enumerate() {
        for contact in [ContactPoint::Start, ContactPoint::End] {
            let end = if contact == ContactPoint::Start { &mut edge.from } else { &mut edge.to };
            if end.node != index {
                continue;
            }
            let two_way = !edge.shape.is_one_way();
            if two_way && !edge.shape.median.through && end.ending.splitter_m == 0.0 {
                end.ending.splitter_m = SPLITTER_M;
            }
            sidewalk_m = sidewalk_m.max(edge.shape.right.sidewalk_m);
            let strips = edge.shape.end_lanes(&end.ending, contact);
            let heading_rad = wrap_pi(heading(layout, &layout.edges[i], contact));
            // A street has its crosswalk where it has sidewalks on both sides.
            let walked = node.crosswalks && edge.shape.left.sidewalk_m.min(edge.shape.right.sidewalk_m) > 0.0;
            // What turns into the ring is as wide as it is on the street, or as there.
            let sides = [&strips.entering, &strips.leaving].map(|s| {
                let common = runs(s).count().min(lanes.into()) as f64;
                let inner_m = inner_m(s, 0);
                let paved_m = (paved_m(s) - inner_m).max(common * lane_m + 0.5);
                // Where no lanes turn, the mere kerb leads round the corner from the ring's outer edge.
                let ring_m = island_m + if common > 0.0 { 0.0 } else { f64::from(lanes) * lane_m };
                Corner { ring_m, inner_m, paved_m }
            });
            let beyond_m = edge.shape.right.beyond_kerb_m().max(edge.shape.left.beyond_kerb_m());
            let (half_rad, reach_m) = fit(sides, beyond_m)?;
            let kerb_m = island_m + f64::from(lanes) * lane_m + 0.5;
            let distance_m = reach_m.max(kerb_m + 1.0) + lead_m(walked);
            streets.push(Street { edge: i, contact, heading_rad, half_rad, distance_m });
        }
    }
    Some((streets, sidewalk_m))
}

/// One side of a street at a roundabout.
#[derive(Clone, Copy, Debug)]
struct Corner {
    /// Radius of the circle that its traffic turns into or out of, metres.
    ring_m: f64,
    /// From the street's axis to its innermost lane, metres.
    inner_m: f64,
    /// From there to the kerb, metres.
    paved_m: f64,
}

/// Half the angle of a street's junction on the ring, and how far from the centre the street's straight part
/// may begin: the smallest angle at which entry and exit turn round the kerb with room for the sidewalk.
/// `sides`: entering and leaving.
///
/// In the street's frame (x outwards, y to the entering side) the entry comes in along y = e and meets the
/// tangent of the ring at angle a, x = (r - e sin a) / cos a; from there it is u = (r sin a - e) / cos a
/// along the ring's tangent to the ring, and the turn is a quarter less a.
fn fit(sides: [Corner; 2], beyond_m: f64) -> Option<(f64, f64)> {
    let least = sides.iter().map(|side| (side.inner_m + 2.5) / side.ring_m).fold(0.0, f64::max);
    if least >= 1.0 {
        return None;
    }
    let mut angle = asin(least);
    while angle < 1.2 {
        let mut reach = 0.0f64;
        let fits = sides.iter().all(|side| {
            let Corner { ring_m, inner_m, paved_m } = *side;
            let leg = (ring_m * sin(angle) - inner_m) / cos(angle);
            let radius = leg / tan(0.5 * (FRAC_PI_2 - angle));
            reach = reach.max((ring_m - inner_m * sin(angle)) / cos(angle) + leg);
            radius - paved_m - beyond_m >= LEAST_M
        });
        if fits {
            return Some((angle, reach));
        }
        angle += 0.01;
    }
    None
}
