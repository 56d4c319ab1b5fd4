//! Reads junctions.

use roxmltree::Node;

use super::ReadError;
use super::check::JunctionLines;
use super::context::{Context, elements, named, parse_number, text_or_empty};
use super::road::{link, plan_view};
use super::signals::sequence;
use crate::model::{
    BoundarySegment, Connection, ConnectionKind, ContactPoint, CrossPath, CrossPathEnd, CrossingStretch,
    ElevationGrid, GridRow, Junction, JunctionController, JunctionGroup, JunctionKind, LaneLink, Orientation,
    Priority, SegmentEnd, VirtualStretch,
};

pub(super) fn junction(
    context: &mut Context,
    node: Node<'_, '_>,
) -> Result<(Junction, JunctionLines), ReadError> {
    let mut junction = Junction {
        id: context.text(node, "id")?,
        name: text_or_empty(node, "name"),
        kind: context.word(node, "type", JunctionKind::from_xml),
        ..Junction::default()
    };
    let mut lines = JunctionLines { junction: context.line(node), ..JunctionLines::default() };
    if let Some(road) = node.attribute("mainRoad") {
        junction.main_road = Some(VirtualStretch {
            road: road.to_owned(),
            s_start: context.number_or_zero(node, "sStart"),
            s_end: context.number_or_zero(node, "sEnd"),
            orientation: context.word(node, "orientation", Orientation::from_xml),
        });
    }
    for child in elements(node) {
        match child.tag_name().name() {
            "connection" => {
                if let Some(connection) = connection(context, child)? {
                    junction.connections.push(connection);
                    lines.connections.push(context.line(child));
                }
            }
            "controller" => junction.controllers.push(JunctionController {
                id: context.text(child, "id")?,
                kind: text_or_empty(child, "type"),
                sequence: sequence(child),
            }),
            "priority" => junction.priorities.push(Priority {
                high: child.attribute("high").map(str::to_owned),
                low: child.attribute("low").map(str::to_owned),
            }),
            "crossPath" => junction.cross_paths.push(cross_path(context, child)?),
            "roadSection" => junction.crossing.push(CrossingStretch {
                id: text_or_empty(child, "id"),
                road: context.text(child, "roadId")?,
                s_start: context.number(child, "sStart")?,
                s_end: context.number(child, "sEnd")?,
            }),
            "boundary" => {
                for segment in named(child, "segment") {
                    junction.boundary.extend(boundary_segment(context, segment)?);
                }
            }
            "planView" => junction.plan_view = plan_view(context, child, &mut Vec::new())?,
            "elevationGrid" => junction.elevation_grid = Some(elevation_grid(context, child)?),
            _ => junction.kept.extend(context.kept(child, &["surface", "objects"])),
        }
    }
    Ok((junction, lines))
}

/// A `connection`; none where it does not name both roads, which is noted.
fn connection(context: &mut Context, node: Node<'_, '_>) -> Result<Option<Connection>, ReadError> {
    // Direct junctions name the other road `linkedRoad`.
    let incoming = node.attribute("incomingRoad");
    let connecting = node.attribute("connectingRoad").or(node.attribute("linkedRoad"));
    let kind = context.word(node, "type", ConnectionKind::from_xml);
    if kind == ConnectionKind::Default && (incoming.is_none() || connecting.is_none()) {
        context.warn(node, None, "connection without incoming or connecting road: left out");
        return Ok(None);
    }
    let mut connection = Connection {
        id: text_or_empty(node, "id"),
        incoming_road: incoming.unwrap_or_default().to_owned(),
        connecting_road: connecting.unwrap_or_default().to_owned(),
        contact: context.word(node, "contactPoint", ContactPoint::from_xml),
        kind,
        ..Connection::default()
    };
    for child in elements(node) {
        match child.tag_name().name() {
            "laneLink" => connection.lane_links.push(LaneLink {
                from: context.lane_id(child, "from")?,
                to: context.lane_id(child, "to")?,
                overlap_m: context.maybe_number(child, "overlapZone"),
            }),
            "predecessor" => connection.predecessor = link(context, child),
            "successor" => connection.successor = link(context, child),
            _ => context.unknown(child),
        }
    }
    Ok(Some(connection))
}

fn cross_path(context: &mut Context, node: Node<'_, '_>) -> Result<CrossPath, ReadError> {
    let mut path = CrossPath {
        id: text_or_empty(node, "id"),
        crossing_road: context.text(node, "crossingRoad")?,
        ..CrossPath::default()
    };
    path.start.road = context.text(node, "roadAtStart")?;
    path.end.road = context.text(node, "roadAtEnd")?;
    for child in elements(node) {
        let end = match child.tag_name().name() {
            "startLaneLink" => &mut path.start,
            "endLaneLink" => &mut path.end,
            _ => {
                context.unknown(child);
                continue;
            }
        };
        *end = CrossPathEnd {
            road: std::mem::take(&mut end.road),
            s: context.number(child, "s")?,
            from: context.lane_id(child, "from")?,
            to: context.lane_id(child, "to")?,
        };
    }
    Ok(path)
}

/// A `segment` of a boundary; none of a kind that the standard does not have, which is noted.
fn boundary_segment(context: &mut Context, node: Node<'_, '_>) -> Result<Option<BoundarySegment>, ReadError> {
    let road = context.text(node, "roadId")?;
    match node.attribute("type") {
        Some("lane") => Ok(Some(BoundarySegment::Lane {
            road,
            lane: context.lane_id(node, "boundaryLane")?,
            from: segment_end(context, node, "sStart")?,
            to: segment_end(context, node, "sEnd")?,
        })),
        Some("joint") => {
            let lane = |name| node.attribute(name).map(|_| context.lane_id(node, name)).transpose();
            let (from_lane, to_lane) = (lane("jointLaneStart")?, lane("jointLaneEnd")?);
            Ok(Some(BoundarySegment::Joint {
                road,
                contact: context.word(node, "contactPoint", ContactPoint::from_xml),
                from_lane,
                to_lane,
                transition_m: context.number_or_zero(node, "transitionLength"),
            }))
        }
        other => {
            let kind = other.unwrap_or_default();
            context.warn(node, None, format!("<segment> type=\"{kind}\" is unknown: left out"));
            Ok(None)
        }
    }
}

fn segment_end(context: &Context, node: Node<'_, '_>, name: &str) -> Result<SegmentEnd, ReadError> {
    match node.attribute(name).map(str::trim) {
        Some("begin" | "start") => Ok(SegmentEnd::Begin),
        Some("end") => Ok(SegmentEnd::End),
        _ => context.number(node, name).map(SegmentEnd::At),
    }
}

fn elevation_grid(context: &mut Context, node: Node<'_, '_>) -> Result<ElevationGrid, ReadError> {
    let mut grid = ElevationGrid {
        s_start: context.number(node, "sStart")?,
        spacing_m: context.number(node, "gridSpacing")?,
        rows: Vec::new(),
    };
    for row in named(node, "elevation") {
        let list = |name| -> Result<Vec<f64>, ReadError> {
            let numbers = row.attribute(name).unwrap_or_default().split_ascii_whitespace();
            let read = |text| {
                parse_number(text)
                    .ok_or_else(|| context.error(row, format!("{name}: \"{text}\" is not a finite number")))
            };
            numbers.map(read).collect()
        };
        let (left_m, right_m) = (list("left")?, list("right")?);
        grid.rows.push(GridRow { centre_m: context.number(row, "center")?, left_m, right_m });
    }
    Ok(grid)
}

pub(super) fn group(context: &mut Context, node: Node<'_, '_>) -> Result<JunctionGroup, ReadError> {
    let mut group = JunctionGroup {
        id: context.text(node, "id")?,
        name: text_or_empty(node, "name"),
        kind: text_or_empty(node, "type"),
        junctions: Vec::new(),
    };
    for child in elements(node) {
        if child.tag_name().name() == "junctionReference" {
            group.junctions.push(context.text(child, "junction")?);
        } else {
            context.unknown(child);
        }
    }
    Ok(group)
}
