//! Writes junctions.

use super::records::{geometry, link};
use super::xml::{Attributes, Xml, maybe};
use crate::model::{
    BoundarySegment, Connection, ConnectionKind, CrossPath, CrossPathEnd, ElevationGrid, Junction,
    JunctionGroup, JunctionKind, SegmentEnd,
};

pub(super) fn junction(xml: &mut Xml, junction: &Junction) {
    let kind = junction.kind.xml();
    let orientation = junction.main_road.as_ref().map(|m| m.orientation.xml());
    let mut attributes: Attributes<'_> =
        vec![("id", &junction.id), ("name", &junction.name), ("type", &kind)];
    if let Some(main) = &junction.main_road {
        let stretch: Attributes<'_> =
            vec![("mainRoad", &main.road), ("sStart", &main.s_start), ("sEnd", &main.s_end)];
        attributes.extend(stretch);
    }
    maybe(&mut attributes, "orientation", &orientation);
    xml.open("junction", &attributes);
    let direct = junction.kind == JunctionKind::Direct;
    junction.connections.iter().for_each(|c| connection(xml, c, direct));
    for stretch in &junction.crossing {
        let attributes: Attributes<'_> = vec![
            ("id", &stretch.id),
            ("roadId", &stretch.road),
            ("sStart", &stretch.s_start),
            ("sEnd", &stretch.s_end),
        ];
        xml.leaf("roadSection", &attributes);
    }
    junction.cross_paths.iter().for_each(|p| cross_path(xml, p));
    for priority in &junction.priorities {
        let mut attributes: Attributes<'_> = Vec::new();
        maybe(&mut attributes, "high", &priority.high);
        maybe(&mut attributes, "low", &priority.low);
        xml.leaf("priority", &attributes);
    }
    for controller in &junction.controllers {
        let mut attributes: Attributes<'_> = vec![("id", &controller.id), ("type", &controller.kind)];
        maybe(&mut attributes, "sequence", &controller.sequence);
        xml.leaf("controller", &attributes);
    }
    if !junction.plan_view.is_empty() {
        xml.open("planView", &[]);
        junction.plan_view.iter().for_each(|g| geometry(xml, g));
        xml.close();
    }
    if !junction.boundary.is_empty() {
        xml.open("boundary", &[]);
        junction.boundary.iter().for_each(|s| boundary_segment(xml, s));
        xml.close();
    }
    if let Some(grid) = &junction.elevation_grid {
        elevation_grid(xml, grid);
    }
    xml.kept(&junction.kept);
    xml.close();
}

fn connection(xml: &mut Xml, connection: &Connection, direct: bool) {
    let road = if direct { "linkedRoad" } else { "connectingRoad" };
    let (contact, kind) = (connection.contact.xml(), connection.kind.xml());
    let mut attributes: Attributes<'_> = vec![("id", &connection.id)];
    if connection.kind == ConnectionKind::Default || !connection.incoming_road.is_empty() {
        attributes.push(("incomingRoad", &connection.incoming_road));
    }
    if connection.kind == ConnectionKind::Default || !connection.connecting_road.is_empty() {
        attributes.push((road, &connection.connecting_road));
    }
    attributes.push(("contactPoint", &contact));
    if connection.kind != ConnectionKind::Default {
        attributes.push(("type", &kind));
    }
    xml.open("connection", &attributes);
    link(xml, "predecessor", &connection.predecessor);
    link(xml, "successor", &connection.successor);
    for link in &connection.lane_links {
        let mut attributes: Attributes<'_> = vec![("from", &link.from), ("to", &link.to)];
        maybe(&mut attributes, "overlapZone", &link.overlap_m);
        xml.leaf("laneLink", &attributes);
    }
    xml.close();
}

fn cross_path(xml: &mut Xml, path: &CrossPath) {
    let attributes: Attributes<'_> = vec![
        ("id", &path.id),
        ("crossingRoad", &path.crossing_road),
        ("roadAtStart", &path.start.road),
        ("roadAtEnd", &path.end.road),
    ];
    xml.open("crossPath", &attributes);
    let mut end = |name: &str, end: &CrossPathEnd| {
        xml.leaf(name, &[("s", &end.s), ("from", &end.from), ("to", &end.to)]);
    };
    end("startLaneLink", &path.start);
    end("endLaneLink", &path.end);
    xml.close();
}

fn segment_end(end: SegmentEnd) -> String {
    match end {
        SegmentEnd::Begin => "begin".to_owned(),
        SegmentEnd::End => "end".to_owned(),
        SegmentEnd::At(s) => s.to_string(),
    }
}

fn boundary_segment(xml: &mut Xml, segment: &BoundarySegment) {
    match segment {
        BoundarySegment::Lane { road, lane, from, to } => {
            let (from, to) = (segment_end(*from), segment_end(*to));
            let attributes: Attributes<'_> = vec![
                ("type", &"lane"),
                ("roadId", road),
                ("boundaryLane", lane),
                ("sStart", &from),
                ("sEnd", &to),
            ];
            xml.leaf("segment", &attributes);
        }
        BoundarySegment::Joint { road, contact, from_lane, to_lane, transition_m } => {
            let contact = contact.xml();
            let mut attributes: Attributes<'_> =
                vec![("type", &"joint"), ("roadId", road), ("contactPoint", &contact)];
            maybe(&mut attributes, "jointLaneStart", from_lane);
            maybe(&mut attributes, "jointLaneEnd", to_lane);
            attributes.push(("transitionLength", transition_m));
            xml.leaf("segment", &attributes);
        }
    }
}

fn elevation_grid(xml: &mut Xml, grid: &ElevationGrid) {
    xml.open("elevationGrid", &[("sStart", &grid.s_start), ("gridSpacing", &grid.spacing_m)]);
    for row in &grid.rows {
        let list = |heights: &[f64]| heights.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
        let (left, right) = (list(&row.left_m), list(&row.right_m));
        xml.leaf("elevation", &[("left", &left), ("center", &row.centre_m), ("right", &right)]);
    }
    xml.close();
}

pub(super) fn group(xml: &mut Xml, group: &JunctionGroup) {
    xml.open("junctionGroup", &[("name", &group.name), ("id", &group.id), ("type", &group.kind)]);
    for junction in &group.junctions {
        xml.leaf("junctionReference", &[("junction", junction)]);
    }
    xml.close();
}
