//! Reads lane sections, lanes and road markings.

use roxmltree::Node;

use super::ReadError;
use super::context::{Context, elements, flag, named, text_or_empty};
use super::records::{cubics, speed};
use crate::model::{
    AccessRule, Lane, LaneAccess, LaneAdvisory, LaneHeight, LaneMaterial, LaneRule, LaneSection, LaneSpeed,
    LaneType, LineRule, MarkChange, MarkColour, MarkLine, MarkStroke, MarkType, Road, RoadMark,
    TravelDirection,
};

/// Most lanes on one side of a section.
const MAX_LANES: usize = 127;

/// The lane sections of a `lanes` element, with the line of each.
pub(super) fn sections(
    context: &mut Context,
    node: Node<'_, '_>,
    road: &mut Road,
    lines: &mut Vec<u32>,
) -> Result<(), ReadError> {
    let mut found = Vec::new();
    for child in elements(node) {
        match child.tag_name().name() {
            "laneSection" => found.push((section(context, child)?, context.line(child))),
            "laneOffset" => {}
            _ => context.unknown(child),
        }
    }
    context.sort_by_s(node, "laneSection", &mut found, |(section, _)| section.s);
    context.doubled(node, "laneSection", &found, |(section, _)| section.s);
    if found.len() > usize::from(u16::MAX) {
        return Err(context.error(node, "more than 65535 lane sections"));
    }
    (road.sections, *lines) = found.into_iter().unzip();
    Ok(())
}

fn section(context: &mut Context, node: Node<'_, '_>) -> Result<LaneSection, ReadError> {
    let mut section = LaneSection {
        s: context.number(node, "s")?,
        single_side: flag(node, "singleSide"),
        ..LaneSection::default()
    };
    for side in elements(node) {
        if !matches!(side.tag_name().name(), "left" | "center" | "right") {
            context.unknown(side);
            continue;
        }
        for child in elements(side) {
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
        if lanes.len() > MAX_LANES {
            context.warn(
                node,
                Some(section.s),
                format!("more than {MAX_LANES} lanes a side: the rest is left out"),
            );
            lanes.truncate(MAX_LANES);
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
        level: flag(node, "level"),
        direction: context.word(node, "direction", TravelDirection::from_xml),
        advisory: context.word(node, "advisory", LaneAdvisory::from_xml),
        dynamic_type: flag(node, "dynamicLaneType"),
        dynamic_direction: flag(node, "dynamicLaneDirection"),
        road_works: flag(node, "roadWorks"),
        widths: cubics(context, node, "width", "sOffset")?,
        borders: cubics(context, node, "border", "sOffset")?,
        ..Lane::default()
    };
    for child in elements(node) {
        match child.tag_name().name() {
            "width" | "border" => {}
            "link" => links(context, child, &mut lane)?,
            "roadMark" => {
                let mark = road_mark(context, child)?;
                lane.marks.push(mark);
            }
            "speed" => {
                let s_offset = context.number_or_zero(child, "sOffset");
                lane.speeds.extend(speed(context, child).map(|speed| LaneSpeed { s_offset, speed }));
            }
            "height" => lane.heights.push(height(context, child)),
            "material" => lane.materials.push(LaneMaterial {
                s_offset: context.number_or_zero(child, "sOffset"),
                surface: text_or_empty(child, "surface"),
                friction: context.maybe_number(child, "friction"),
                roughness: context.maybe_number(child, "roughness"),
            }),
            "access" => {
                let access = access(context, child);
                lane.accesses.push(access);
            }
            "rule" => lane.rules.push(LaneRule {
                s_offset: context.number_or_zero(child, "sOffset"),
                value: text_or_empty(child, "value"),
            }),
            _ => lane.kept.extend(context.kept(child, &["visibility"])),
        }
    }
    context.sort_by_s(node, "roadMark", &mut lane.marks, |m| m.s_offset);
    context.sort_by_s(node, "speed", &mut lane.speeds, |m| m.s_offset);
    context.sort_by_s(node, "height", &mut lane.heights, |m| m.s_offset);
    context.sort_by_s(node, "material", &mut lane.materials, |m| m.s_offset);
    context.sort_by_s(node, "access", &mut lane.accesses, |m| m.s_offset);
    context.sort_by_s(node, "rule", &mut lane.rules, |m| m.s_offset);
    if lane.id != 0 && lane.widths.is_empty() && lane.borders.is_empty() {
        context.warn(
            node,
            Some(section_s),
            format!("lane {} has neither width nor border: width 0", lane.id),
        );
    }
    Ok(lane)
}

fn links(context: &mut Context, node: Node<'_, '_>, lane: &mut Lane) -> Result<(), ReadError> {
    for end in elements(node) {
        let list = match end.tag_name().name() {
            "predecessor" => &mut lane.predecessors,
            "successor" => &mut lane.successors,
            _ => {
                context.unknown(end);
                continue;
            }
        };
        let id = context.lane_id(end, "id")?;
        if list.len() < MAX_LANES && !list.contains(&id) {
            list.push(id);
        }
    }
    Ok(())
}

/// A `height` element; some writers spell its attributes otherwise.
fn height(context: &mut Context, node: Node<'_, '_>) -> LaneHeight {
    let mut number = |name, other| match context.maybe_number(node, name) {
        Some(value) => value,
        None => context.number_or_zero(node, other),
    };
    LaneHeight {
        s_offset: number("sOffset", "s"),
        inner_m: number("inner", "heightInner"),
        outer_m: number("outer", "heightOuter"),
    }
}

/// An `access` element: one restriction as an attribute, or several in it (revision 1.8).
fn access(context: &mut Context, node: Node<'_, '_>) -> LaneAccess {
    let mut access = LaneAccess {
        s_offset: context.number_or_zero(node, "sOffset"),
        rule: context.word(node, "rule", AccessRule::from_xml),
        restrictions: node.attribute("restriction").map(str::to_owned).into_iter().collect(),
    };
    for child in elements(node) {
        if child.tag_name().name() == "restriction" {
            access.restrictions.extend(child.attribute("type").map(str::to_owned));
        } else {
            context.unknown(child);
        }
    }
    access
}

/// A lane type, also under the names of older revisions.
fn lane_type(text: &str) -> Option<LaneType> {
    LaneType::from_xml(text).or(match text {
        "mwyEntry" => Some(LaneType::Entry),
        "mwyExit" => Some(LaneType::Exit),
        _ => None,
    })
}

fn road_mark(context: &mut Context, node: Node<'_, '_>) -> Result<RoadMark, ReadError> {
    let mut mark = RoadMark {
        s_offset: context.number_or_zero(node, "sOffset"),
        mark_type: context.word(node, "type", MarkType::from_xml),
        colour: context.word(node, "color", MarkColour::from_xml),
        bold: node.attribute("weight") == Some("bold"),
        width_m: context.maybe_number(node, "width"),
        height_m: context.maybe_number(node, "height"),
        lane_change: node.attribute("laneChange").and_then(|t| MarkChange::from_xml(t.trim())),
        material: text_or_empty(node, "material"),
        sway: cubics(context, node, "sway", "ds")?,
        ..RoadMark::default()
    };
    for child in elements(node) {
        match child.tag_name().name() {
            "type" => {
                for line in named(child, "line") {
                    let line = mark_line(context, line, child);
                    mark.lines.push(line);
                }
            }
            "explicit" => {
                for line in named(child, "line") {
                    mark.strokes.push(MarkStroke {
                        s_offset: context.number_or_zero(line, "sOffset"),
                        length_m: context.number_or_zero(line, "length"),
                        t_offset_m: context.number_or_zero(line, "tOffset"),
                        width_m: context.maybe_number(line, "width"),
                        rule: context.word(line, "rule", LineRule::from_xml),
                    });
                }
            }
            "sway" => {}
            _ => context.unknown(child),
        }
    }
    Ok(mark)
}

fn mark_line(context: &mut Context, node: Node<'_, '_>, parent: Node<'_, '_>) -> MarkLine {
    MarkLine {
        length_m: context.number_or_zero(node, "length"),
        space_m: context.number_or_zero(node, "space"),
        t_offset_m: context.number_or_zero(node, "tOffset"),
        s_offset: context.number_or_zero(node, "sOffset"),
        width_m: context.maybe_number(node, "width").or_else(|| context.maybe_number(parent, "width")),
        colour: node.attribute("color").and_then(MarkColour::from_xml),
        rule: context.word(node, "rule", LineRule::from_xml),
    }
}
