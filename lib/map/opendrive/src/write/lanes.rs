//! Writes lane sections, lanes and road markings.

use super::records::{cubics, speed};
use super::xml::{Attributes, Xml, if_true, maybe, unless_default, unless_empty};
use crate::model::{AccessRule, Lane, LaneAccess, MarkLine, MarkStroke, Road, RoadMark};

pub(super) fn lanes(xml: &mut Xml, road: &Road) {
    xml.open("lanes", &[]);
    cubics(xml, "laneOffset", "s", &road.lane_offset);
    for section in &road.sections {
        let mut attributes: Attributes<'_> = vec![("s", &section.s)];
        if_true(&mut attributes, "singleSide", section.single_side);
        xml.open("laneSection", &attributes);
        // The format wants ids in descending order: from left to right.
        if !section.left.is_empty() {
            xml.open("left", &[]);
            section.left.iter().rev().for_each(|l| lane(xml, l));
            xml.close();
        }
        xml.open("center", &[]);
        lane(xml, &section.centre);
        xml.close();
        if !section.right.is_empty() {
            xml.open("right", &[]);
            section.right.iter().for_each(|l| lane(xml, l));
            xml.close();
        }
        xml.close();
    }
    xml.close();
}

fn lane(xml: &mut Xml, lane: &Lane) {
    let (kind, direction, advisory) = (lane.lane_type.xml(), lane.direction.xml(), lane.advisory.xml());
    let mut attributes: Attributes<'_> = vec![("id", &lane.id), ("type", &kind), ("level", &lane.level)];
    unless_default(&mut attributes, "direction", &lane.direction, &direction);
    unless_default(&mut attributes, "advisory", &lane.advisory, &advisory);
    if_true(&mut attributes, "dynamicLaneType", lane.dynamic_type);
    if_true(&mut attributes, "dynamicLaneDirection", lane.dynamic_direction);
    if_true(&mut attributes, "roadWorks", lane.road_works);
    xml.open("lane", &attributes);
    xml.open("link", &[]);
    for id in &lane.predecessors {
        xml.leaf("predecessor", &[("id", id)]);
    }
    for id in &lane.successors {
        xml.leaf("successor", &[("id", id)]);
    }
    xml.close();
    cubics(xml, "border", "sOffset", &lane.borders);
    cubics(xml, "width", "sOffset", &lane.widths);
    lane.marks.iter().for_each(|m| road_mark(xml, m));
    for material in &lane.materials {
        let mut attributes: Attributes<'_> = vec![("sOffset", &material.s_offset)];
        unless_empty(&mut attributes, "surface", &material.surface);
        maybe(&mut attributes, "friction", &material.friction);
        maybe(&mut attributes, "roughness", &material.roughness);
        xml.leaf("material", &attributes);
    }
    for limit in &lane.speeds {
        speed(xml, &limit.speed, Some(limit.s_offset));
    }
    lane.accesses.iter().for_each(|a| access(xml, a));
    for height in &lane.heights {
        xml.leaf(
            "height",
            &[("sOffset", &height.s_offset), ("inner", &height.inner_m), ("outer", &height.outer_m)],
        );
    }
    for rule in &lane.rules {
        xml.leaf("rule", &[("sOffset", &rule.s_offset), ("value", &rule.value)]);
    }
    xml.kept(&lane.kept);
    xml.close();
}

/// One restriction goes into an attribute, as all revisions have it; several need those of revision 1.8.
fn access(xml: &mut Xml, access: &LaneAccess) {
    let rule = match access.rule {
        AccessRule::Deny => "deny",
        AccessRule::Allow => "allow",
    };
    let mut attributes: Attributes<'_> = vec![("sOffset", &access.s_offset), ("rule", &rule)];
    if let [single] = &access.restrictions[..] {
        attributes.push(("restriction", single));
        xml.leaf("access", &attributes);
        return;
    }
    xml.open("access", &attributes);
    for restriction in &access.restrictions {
        xml.leaf("restriction", &[("type", restriction)]);
    }
    xml.close();
}

fn road_mark(xml: &mut Xml, mark: &RoadMark) {
    let (kind, colour) = (mark.mark_type.xml(), mark.colour.xml());
    let weight = if mark.bold { "bold" } else { "standard" };
    let change = mark.lane_change.map(|c| c.xml());
    let mut attributes: Attributes<'_> =
        vec![("sOffset", &mark.s_offset), ("type", &kind), ("weight", &weight), ("color", &colour)];
    unless_empty(&mut attributes, "material", &mark.material);
    maybe(&mut attributes, "width", &mark.width_m);
    maybe(&mut attributes, "height", &mark.height_m);
    maybe(&mut attributes, "laneChange", &change);
    if mark.lines.is_empty() && mark.strokes.is_empty() && mark.sway.is_empty() {
        xml.leaf("roadMark", &attributes);
        return;
    }
    xml.open("roadMark", &attributes);
    cubics(xml, "sway", "ds", &mark.sway);
    if !mark.lines.is_empty() {
        xml.open("type", &[("name", &kind)]);
        mark.lines.iter().for_each(|l| line(xml, l));
        xml.close();
    }
    if !mark.strokes.is_empty() {
        xml.open("explicit", &[]);
        mark.strokes.iter().for_each(|s| stroke(xml, s));
        xml.close();
    }
    xml.close();
}

fn line(xml: &mut Xml, line: &MarkLine) {
    let (colour, rule) = (line.colour.map(|c| c.xml()), line.rule.xml());
    let mut attributes: Attributes<'_> = vec![
        ("length", &line.length_m),
        ("space", &line.space_m),
        ("tOffset", &line.t_offset_m),
        ("sOffset", &line.s_offset),
    ];
    unless_default(&mut attributes, "rule", &line.rule, &rule);
    maybe(&mut attributes, "width", &line.width_m);
    maybe(&mut attributes, "color", &colour);
    xml.leaf("line", &attributes);
}

fn stroke(xml: &mut Xml, stroke: &MarkStroke) {
    let rule = stroke.rule.xml();
    let mut attributes: Attributes<'_> =
        vec![("length", &stroke.length_m), ("tOffset", &stroke.t_offset_m), ("sOffset", &stroke.s_offset)];
    unless_default(&mut attributes, "rule", &stroke.rule, &rule);
    maybe(&mut attributes, "width", &stroke.width_m);
    xml.leaf("line", &attributes);
}
