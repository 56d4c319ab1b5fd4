//! Writes lane sections, lanes and road markings.

use std::fmt::Display;

use super::xml::Xml;
use super::{cubics, speed};
use crate::model::{Lane, MarkLine, Road, RoadMark, TravelDirection};

pub(super) fn lanes(xml: &mut Xml, road: &Road) {
    xml.open("lanes", &[]);
    cubics(xml, "laneOffset", "s", &road.lane_offset);
    for section in &road.sections {
        xml.open("laneSection", &[("s", &section.s)]);
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
    let (kind, level, direction) = (lane.lane_type.xml(), lane.level, lane.direction.xml());
    let mut attributes: Vec<(&str, &dyn Display)> =
        vec![("id", &lane.id), ("type", &kind), ("level", &level)];
    if lane.direction != TravelDirection::default() {
        attributes.push(("direction", &direction));
    }
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
    for mark in &lane.marks {
        road_mark(xml, mark);
    }
    for limit in &lane.speeds {
        speed(xml, &limit.speed, Some(limit.s_offset));
    }
    for height in &lane.heights {
        xml.leaf(
            "height",
            &[("sOffset", &height.s_offset), ("inner", &height.inner_m), ("outer", &height.outer_m)],
        );
    }
    xml.close();
}

fn road_mark(xml: &mut Xml, mark: &RoadMark) {
    let (kind, colour) = (mark.mark_type.xml(), mark.colour.xml());
    let weight = if mark.bold { "bold" } else { "standard" };
    let change = mark.lane_change.map(|c| c.xml());
    let mut attributes: Vec<(&str, &dyn Display)> =
        vec![("sOffset", &mark.s_offset), ("type", &kind), ("weight", &weight), ("color", &colour)];
    if let Some(width) = &mark.width_m {
        attributes.push(("width", width));
    }
    if let Some(height) = &mark.height_m {
        attributes.push(("height", height));
    }
    if let Some(change) = &change {
        attributes.push(("laneChange", change));
    }
    if mark.lines.is_empty() {
        xml.leaf("roadMark", &attributes);
        return;
    }
    xml.open("roadMark", &attributes);
    xml.open("type", &[("name", &kind)]);
    for item in &mark.lines {
        line(xml, item);
    }
    xml.close();
    xml.close();
}

fn line(xml: &mut Xml, line: &MarkLine) {
    let colour = line.colour.map(|c| c.xml());
    let mut attributes: Vec<(&str, &dyn Display)> = vec![
        ("length", &line.length_m),
        ("space", &line.space_m),
        ("tOffset", &line.t_offset_m),
        ("sOffset", &line.s_offset),
    ];
    if let Some(width) = &line.width_m {
        attributes.push(("width", width));
    }
    if let Some(colour) = &colour {
        attributes.push(("color", colour));
    }
    xml.leaf("line", &attributes);
}
