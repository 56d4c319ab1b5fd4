//! Reads lane sections, lanes and road markings.

use roxmltree::Node;

use super::ReadError;
use super::context::Context;
use super::road::{cubics, speed};
use crate::model::{
    Lane, LaneHeight, LaneSection, LaneSpeed, LaneType, MarkChange, MarkColour, MarkLine, MarkType, Road,
    RoadMark, TravelDirection,
};

/// The lane sections of a `lanes` element.
pub(super) fn sections(context: &mut Context, node: Node<'_, '_>, road: &mut Road) -> Result<(), ReadError> {
    for child in node.children().filter(Node::is_element) {
        match child.tag_name().name() {
            "laneSection" => road.sections.push(section(context, child)?),
            "laneOffset" | "userData" => {}
            _ => context.unknown(child),
        }
    }
    context.sort_by_s(node, "laneSection", &mut road.sections, |s| s.s);
    if road.sections.len() > usize::from(u16::MAX) {
        return Err(context.error(node, "more than 65535 lane sections"));
    }
    Ok(())
}

fn section(context: &mut Context, node: Node<'_, '_>) -> Result<LaneSection, ReadError> {
    let mut section = LaneSection { s: context.number(node, "s")?, ..LaneSection::default() };
    for side in node.children().filter(Node::is_element) {
        match side.tag_name().name() {
            "left" | "center" | "right" => {}
            "userData" => continue,
            _ => {
                context.unknown(side);
                continue;
            }
        }
        for child in side.children().filter(Node::is_element) {
            if child.tag_name().name() != "lane" {
                context.unknown(child);
                continue;
            }
            let lane = lane(context, child, section.s)?;
            // The id decides the side: it does so in every query.
            match lane.id {
                0 => section.centre = lane,
                1.. => section.left.push(lane),
                _ => section.right.push(lane),
            }
        }
    }
    section.left.sort_by_key(|l| l.id);
    section.right.sort_by_key(|l| -i32::from(l.id));
    for lanes in [&mut section.left, &mut section.right] {
        let before = lanes.len();
        lanes.dedup_by_key(|l| l.id);
        if lanes.len() < before {
            context.warn(node, Some(section.s), "two lanes have one id: the first is kept");
        }
        if lanes.last().is_some_and(|l| usize::from(l.id.unsigned_abs()) != lanes.len()) {
            context.warn(node, Some(section.s), "lane ids have gaps: the lanes are taken side by side");
        }
    }
    Ok(section)
}

fn lane(context: &mut Context, node: Node<'_, '_>, section_s: f64) -> Result<Lane, ReadError> {
    let mut lane = Lane {
        id: context.lane_id(node, "id")?,
        lane_type: context.word(node, "type", lane_type),
        level: matches!(node.attribute("level"), Some("true" | "1")),
        direction: context.word(node, "direction", TravelDirection::from_xml),
        widths: cubics(context, node, "width", "sOffset")?,
        borders: cubics(context, node, "border", "sOffset")?,
        ..Lane::default()
    };
    for child in node.children().filter(Node::is_element) {
        match child.tag_name().name() {
            "width" | "border" | "userData" => {}
            "link" => {
                for end in child.children().filter(Node::is_element) {
                    match end.tag_name().name() {
                        "predecessor" => lane.predecessors.push(context.lane_id(end, "id")?),
                        "successor" => lane.successors.push(context.lane_id(end, "id")?),
                        _ => context.unknown(end),
                    }
                }
            }
            "roadMark" => {
                let mark = road_mark(context, child);
                lane.marks.push(mark);
            }
            "speed" => {
                let s_offset = context.number_or_zero(child, "sOffset");
                lane.speeds.extend(speed(context, child).map(|speed| LaneSpeed { s_offset, speed }));
            }
            "height" => lane.heights.push(LaneHeight {
                s_offset: context.number_or_zero(child, "sOffset"),
                inner_m: context.number_or_zero(child, "inner"),
                outer_m: context.number_or_zero(child, "outer"),
            }),
            _ => context.unknown(child),
        }
    }
    context.sort_by_s(node, "roadMark", &mut lane.marks, |m| m.s_offset);
    context.sort_by_s(node, "speed", &mut lane.speeds, |m| m.s_offset);
    context.sort_by_s(node, "height", &mut lane.heights, |m| m.s_offset);
    if lane.id != 0 && lane.widths.is_empty() && lane.borders.is_empty() {
        context.warn(
            node,
            Some(section_s),
            format!("lane {} has neither width nor border: width 0", lane.id),
        );
    }
    Ok(lane)
}

/// A lane type, also under the names of older revisions.
fn lane_type(text: &str) -> Option<LaneType> {
    LaneType::from_xml(text).or(match text {
        "mwyEntry" => Some(LaneType::Entry),
        "mwyExit" => Some(LaneType::Exit),
        _ => None,
    })
}

fn road_mark(context: &mut Context, node: Node<'_, '_>) -> RoadMark {
    let mut mark = RoadMark {
        s_offset: context.number_or_zero(node, "sOffset"),
        mark_type: context.word(node, "type", MarkType::from_xml),
        colour: context.word(node, "color", MarkColour::from_xml),
        bold: node.attribute("weight") == Some("bold"),
        width_m: context.maybe_number(node, "width"),
        height_m: context.maybe_number(node, "height"),
        lane_change: node.attribute("laneChange").and_then(|t| MarkChange::from_xml(t.trim())),
        lines: Vec::new(),
    };
    for child in node.children().filter(Node::is_element) {
        match child.tag_name().name() {
            "type" => {
                for line in child.children().filter(|n| n.tag_name().name() == "line") {
                    mark.lines.push(MarkLine {
                        length_m: context.number_or_zero(line, "length"),
                        space_m: context.number_or_zero(line, "space"),
                        t_offset_m: context.number_or_zero(line, "tOffset"),
                        s_offset: context.number_or_zero(line, "sOffset"),
                        width_m: context.maybe_number(line, "width").or(context.maybe_number(child, "width")),
                        colour: line.attribute("color").and_then(MarkColour::from_xml),
                    });
                }
            }
            "userData" => {}
            _ => context.unknown(child),
        }
    }
    mark
}
