//! From a layout to a network.

use std::borrow::Cow;

use frames::math::cos;
use frames::wrap_pi;
use opendrive::{ContactPoint, Header, Network, Road, RoadLink};

use crate::TownError;
use crate::control::equip;
use crate::decks::{decks, reach_m};
use crate::heights::{EndHeight, elevation};
use crate::ids::Ids;
use crate::junction::{self, Gaps, junction};
use crate::layout::{Layout, Node, NodeKind};
use crate::limits::limit_sign;
use crate::movements::{Movement, crossing};
use crate::node_plan::{NodePlan, node_plans};
use crate::path::{Path, Pose2};
use crate::roundabout;
use crate::route::route;
use crate::seam;
use crate::street::{self, street};
use crate::terrain::Terrain;
use crate::water::waters;

/// Half the distance over which a seam's slope is taken from the ground, metres.
const SLOPE_REACH_M: f64 = 25.0;
/// Share of the steepest slope that a seam may have, so that the roads beside it can round it.
const SEAM_GRADE: f64 = 0.7;
/// The radius of a U-turn's lane is at least half of this, metres.
const LEAST_U_TURN_M: f64 = 10.0;
/// Width of the island before a turning circle, metres.
const CIRCLE_ISLAND_M: f64 = 3.0;
/// Distance between the places that the bounds are taken from, metres.
const BOUND_STEP_M: f64 = 5.0;

/// How much of its relief the ground keeps each time streets are too steep, and how often it gets flatter at
/// most.
const EASE: f64 = 0.85;
const EASINGS: usize = 10;

/// Builds the network. Where streets would be too steep, the ground is flatter.
pub(crate) fn build(layout: &Layout) -> Result<Network, TownError> {
    let mut network = assemble(layout);
    let mut eased = Cow::Borrowed(layout);
    for _ in 0..EASINGS {
        if !matches!(network, Err(TownError::TooSteep { .. })) {
            break;
        }
        eased.to_mut().terrain.flatten(EASE);
        network = assemble(&eased);
    }
    network
}

/// Builds every street and junction.
pub(crate) fn assemble(layout: &Layout) -> Result<Network, TownError> {
    let layout = &with_islands(roundabout::expand(layout)?);
    let mut plans = node_plans(layout)?;
    for (node, plan) in layout.nodes.iter().zip(&mut plans) {
        set_heights(node, plan, &layout.terrain);
    }
    let mut ids = Ids::default();
    let mut network = Network::default();
    for index in 0..layout.edges.len() {
        let road = build_street(&mut ids, layout, &plans, index)?;
        network.roads.push(road);
    }
    for (node, plan) in layout.nodes.iter().zip(&mut plans) {
        for arm in &mut plan.arms {
            let road = &network.roads[arm.edge];
            (arm.road, arm.length_m) = (road.id.clone(), road.length_m);
        }
        if plan.direct {
            join(plan, &mut network.roads);
        } else if !plan.arms.is_empty() && node.kind != NodeKind::MapEdge {
            build_junction(&mut ids, node, plan, &mut network);
        }
    }
    decks(&mut ids, &mut network, &layout.terrain)?;
    waters(&mut ids, &mut network, &layout.waters);
    network.header = header(layout, &network.roads);
    Ok(network)
}

/// Gives streets an island before their turning circles: long vehicles that come out of the circle swing out
/// where others go in.
fn with_islands(mut layout: Layout) -> Layout {
    let nodes = &layout.nodes;
    for edge in &mut layout.edges {
        let two_way = !edge.shape.is_one_way() && !edge.shape.median.through;
        for end in [&mut edge.from, &mut edge.to] {
            let circle = nodes.get(end.node).is_some_and(|n| matches!(n.kind, NodeKind::DeadEnd { .. }));
            if circle && two_way && end.ending.splitter_m == 0.0 {
                end.ending.splitter_m = CIRCLE_ISLAND_M;
            }
        }
    }
    layout
}

/// The arm of an edge's end.
fn socket(plans: &[NodePlan], node: usize, edge: usize, contact: ContactPoint) -> Option<&crate::arm::Arm> {
    plans.get(node)?.arms.iter().find(|arm| arm.edge == edge && arm.contact == contact)
}

/// Level ground for junctions; at seams the ground's slope goes through.
fn set_heights(node: &Node, plan: &mut NodePlan, terrain: &Terrain) {
    let [x, y] = node.at_m;
    let z_m = terrain.bank(x, y) + node.lift_m;
    let grade = match node.kind {
        NodeKind::Seam { .. } | NodeKind::MapEdge => {
            let height = |d: f64| {
                let p = plan.axis.moved(d, 0.0);
                terrain.bank(p.x_m, p.y_m)
            };
            let most = plan.arms.iter().map(|a| a.shape.max_grade).fold(f64::INFINITY, f64::min) * SEAM_GRADE;
            let slope = (height(SLOPE_REACH_M) - height(-SLOPE_REACH_M)) / (2.0 * SLOPE_REACH_M);
            slope.clamp(-most, most)
        }
        _ => 0.0,
    };
    let axis = plan.axis;
    for arm in &mut plan.arms {
        let (ahead, _) = axis.locate(arm.outward);
        arm.z_m = z_m + grade * ahead;
        arm.slope = grade * cos(wrap_pi(arm.outward.heading_rad - axis.heading_rad));
    }
}

fn build_street(ids: &mut Ids, layout: &Layout, plans: &[NodePlan], index: usize) -> Result<Road, TownError> {
    let edge = &layout.edges[index];
    let origin = Pose2 { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 };
    let mut ends = [(origin, EndHeight { z_m: 0.0, slope: 0.0, lift_m: 0.0 }); 2];
    for (slot, contact) in ends.iter_mut().zip([ContactPoint::Start, ContactPoint::End]) {
        let node = edge.at(contact).node;
        let Some(arm) = socket(plans, node, index, contact) else { continue };
        let along = if contact == ContactPoint::Start { arm.slope } else { -arm.slope };
        let lift_m = layout.nodes[node].lift_m;
        *slot = (arm.outward, EndHeight { z_m: arm.z_m, slope: along, lift_m });
    }
    let path = route(edge, [ends[0].0, ends[1].0])?;
    let heights = [ends[0].1, ends[1].1];
    let elevation = elevation(edge, &path, &layout.terrain, heights)?;
    let endings = [edge.from.ending, edge.to.ending];
    street(ids, street::Plan { name: &edge.name, path, elevation, shape: &edge.shape, endings })
}

/// Joins two roads lane to lane.
fn join(plan: &NodePlan, roads: &mut [Road]) {
    let [a, b] = &plan.arms[..] else { return };
    for (own, other) in [(a, b), (b, a)] {
        let road = &mut roads[own.edge];
        let link = Some(RoadLink::Road { id: other.road.clone(), contact: other.contact });
        let section = match own.contact {
            ContactPoint::Start => {
                road.predecessor = link;
                road.sections.first_mut()
            }
            ContactPoint::End => {
                road.successor = link;
                road.sections.last_mut()
            }
        };
        let Some(section) = section else { continue };
        let pairs = own.lanes.entering.iter().zip(&other.lanes.leaving);
        for (from, to) in pairs.chain(own.lanes.leaving.iter().zip(&other.lanes.entering)) {
            let lanes = if from.lane > 0 { &mut section.left } else { &mut section.right };
            let Some(lane) = lanes.iter_mut().find(|l| l.id == from.lane) else { continue };
            match own.contact {
                ContactPoint::Start => lane.predecessors.push(to.lane),
                ContactPoint::End => lane.successors.push(to.lane),
            }
        }
    }
}

fn movements(node: &Node, plan: &NodePlan) -> Vec<Movement> {
    let arms = &plan.arms;
    match node.kind {
        NodeKind::Crossing(_) => crossing(arms, node.lefts),
        NodeKind::Seam { .. } => seam::movements(arms, plan.axis),
        NodeKind::Crossover => seam::crossover(arms, plan.axis, LEAST_U_TURN_M),
        NodeKind::DeadEnd { .. } => seam::turning(&arms[0]),
        NodeKind::RailCrossing => seam::rail(arms),
        NodeKind::Ring => seam::ring(arms),
        NodeKind::MapEdge | NodeKind::Roundabout { .. } => Vec::new(),
    }
}

fn build_junction(ids: &mut Ids, node: &Node, plan: &NodePlan, network: &mut Network) {
    let area = junction::Plan {
        name: &node.name,
        arms: &plan.arms,
        kerb_radius_m: plan.kerb_radius_m,
        gaps: match node.kind {
            NodeKind::Crossing(_) | NodeKind::Ring | NodeKind::DeadEnd { .. } => Gaps::Pave,
            NodeKind::Seam { .. } => Gaps::Close,
            _ => Gaps::Leave,
        },
        circle_m: if let NodeKind::DeadEnd { radius_m } = node.kind { radius_m } else { 0.0 },
    };
    let mut built = junction(ids, &area, movements(node, plan));
    let (controllers, furniture) = equip(ids, &mut built, &plan.arms, &plan.holds);
    for (i, (arm, here)) in plan.arms.iter().zip(furniture).enumerate() {
        let street = &mut network.roads[arm.edge];
        street.signals.extend(limit_sign(ids, &plan.arms, i, street));
        street.signals.extend(here.signals);
        street.objects.extend(here.objects);
        let link = Some(RoadLink::Junction { id: built.junction.id.clone() });
        match arm.contact {
            ContactPoint::Start => street.predecessor = link,
            ContactPoint::End => street.successor = link,
        }
    }
    network.roads.extend(built.roads);
    network.junctions.push(built.junction);
    network.controllers.extend(controllers);
}

fn header(layout: &Layout, roads: &[Road]) -> Header {
    // North, south, east, west.
    let mut bounds = [f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY];
    for road in roads {
        let (path, reach) = (Path::of(road), reach_m(road) + 1.0);
        let count = (road.length_m / BOUND_STEP_M).ceil().max(1.0) as u32;
        for i in 0..=count {
            let p = path.pose_at(road.length_m * f64::from(i) / f64::from(count));
            bounds = [
                bounds[0].max(p.y_m + reach),
                bounds[1].min(p.y_m - reach),
                bounds[2].max(p.x_m + reach),
                bounds[3].min(p.x_m - reach),
            ];
        }
    }
    Header {
        revision: (1, 7),
        name: layout.name.clone(),
        version: "1.00".into(),
        // No date: the same town has the same bytes on every day.
        vendor: "Convoy".into(),
        bounds_m: Some(bounds).filter(|b| b.iter().all(|v| v.is_finite())),
        geo_reference: Some(layout.geo_reference.clone()).filter(|text| !text.is_empty()),
        ..Header::default()
    }
}
