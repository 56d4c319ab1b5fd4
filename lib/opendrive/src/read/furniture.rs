//! Reads signals, objects, junctions and controllers.

use roxmltree::Node;

use super::ReadError;
use super::context::{Context, text_or_empty};
use crate::model::{
    Bridge, Connection, ContactPoint, Controller, Corner, Junction, JunctionController, JunctionKind,
    LaneLink, LaneValidity, Object, Orientation, Outline, Repeat, Road, Signal, SignalReference, SpeedUnit,
    Tunnel, TunnelType,
};

pub(super) fn signals(context: &mut Context, node: Node<'_, '_>, road: &mut Road) -> Result<(), ReadError> {
    for child in node.children().filter(Node::is_element) {
        match child.tag_name().name() {
            "signal" => road.signals.push(signal(context, child)?),
            "signalReference" => road.signal_references.push(SignalReference {
                id: context.text(child, "id")?,
                s: context.number(child, "s")?,
                t: context.number_or_zero(child, "t"),
                orientation: context.word(child, "orientation", Orientation::from_xml),
                validity: validity(context, child)?,
            }),
            "userData" => {}
            _ => context.unknown(child),
        }
    }
    Ok(())
}

fn signal(context: &mut Context, node: Node<'_, '_>) -> Result<Signal, ReadError> {
    Ok(Signal {
        id: context.text(node, "id")?,
        name: text_or_empty(node, "name"),
        s: context.number(node, "s")?,
        t: context.number(node, "t")?,
        z_offset_m: context.number_or_zero(node, "zOffset"),
        h_offset_rad: context.number_or_zero(node, "hOffset"),
        pitch_rad: context.number_or_zero(node, "pitch"),
        roll_rad: context.number_or_zero(node, "roll"),
        orientation: context.word(node, "orientation", Orientation::from_xml),
        dynamic: matches!(node.attribute("dynamic"), Some("yes" | "true" | "1")),
        country: text_or_empty(node, "country"),
        kind: text_or_empty(node, "type"),
        subtype: text_or_empty(node, "subtype"),
        value: context.maybe_number(node, "value"),
        unit: node.attribute("unit").and_then(SpeedUnit::from_xml),
        text: text_or_empty(node, "text"),
        height_m: context.maybe_number(node, "height"),
        width_m: context.maybe_number(node, "width"),
        validity: validity(context, node)?,
    })
}

fn validity(context: &Context, node: Node<'_, '_>) -> Result<Vec<LaneValidity>, ReadError> {
    let ranges = node.children().filter(|n| n.tag_name().name() == "validity");
    ranges
        .map(|n| {
            Ok(LaneValidity { from: context.lane_id(n, "fromLane")?, to: context.lane_id(n, "toLane")? })
        })
        .collect()
}

pub(super) fn objects(context: &mut Context, node: Node<'_, '_>, road: &mut Road) -> Result<(), ReadError> {
    for child in node.children().filter(Node::is_element) {
        match child.tag_name().name() {
            "object" => road.objects.push(object(context, child)?),
            "bridge" => road.bridges.push(Bridge {
                id: text_or_empty(child, "id"),
                name: text_or_empty(child, "name"),
                kind: text_or_empty(child, "type"),
                s: context.number(child, "s")?,
                length_m: context.number(child, "length")?,
                validity: validity(context, child)?,
            }),
            "tunnel" => road.tunnels.push(Tunnel {
                id: text_or_empty(child, "id"),
                name: text_or_empty(child, "name"),
                kind: context.word(child, "type", TunnelType::from_xml),
                s: context.number(child, "s")?,
                length_m: context.number(child, "length")?,
                lighting: context.maybe_number(child, "lighting"),
                daylight: context.maybe_number(child, "daylight"),
                validity: validity(context, child)?,
            }),
            "userData" => {}
            _ => context.unknown(child),
        }
    }
    Ok(())
}

fn object(context: &mut Context, node: Node<'_, '_>) -> Result<Object, ReadError> {
    let mut object = Object {
        id: text_or_empty(node, "id"),
        name: text_or_empty(node, "name"),
        kind: text_or_empty(node, "type"),
        subtype: text_or_empty(node, "subtype"),
        s: context.number(node, "s")?,
        t: context.number(node, "t")?,
        z_offset_m: context.number_or_zero(node, "zOffset"),
        hdg_rad: context.number_or_zero(node, "hdg"),
        pitch_rad: context.number_or_zero(node, "pitch"),
        roll_rad: context.number_or_zero(node, "roll"),
        orientation: context.word(node, "orientation", Orientation::from_xml),
        length_m: context.maybe_number(node, "length"),
        width_m: context.maybe_number(node, "width"),
        height_m: context.maybe_number(node, "height"),
        radius_m: context.maybe_number(node, "radius"),
        validity: validity(context, node)?,
        ..Object::default()
    };
    for child in node.children().filter(Node::is_element) {
        match child.tag_name().name() {
            "outline" => object.outlines.extend(outline(context, child)?),
            "outlines" => {
                for inner in child.children().filter(|n| n.tag_name().name() == "outline") {
                    object.outlines.extend(outline(context, inner)?);
                }
            }
            "repeat" => {
                let repeat = repeat(context, child, &object)?;
                object.repeats.push(repeat);
            }
            "validity" | "userData" => {}
            _ => context.unknown(child),
        }
    }
    Ok(object)
}

fn outline(context: &mut Context, node: Node<'_, '_>) -> Result<Option<Outline>, ReadError> {
    let mut outline = Outline { closed: node.attribute("closed") != Some("false"), corners: Vec::new() };
    for corner in node.children().filter(Node::is_element) {
        match corner.tag_name().name() {
            "cornerLocal" => outline.corners.push(Corner::Local {
                u_m: context.number(corner, "u")?,
                v_m: context.number(corner, "v")?,
                z_m: context.number_or_zero(corner, "z"),
                height_m: context.number_or_zero(corner, "height"),
            }),
            "cornerRoad" => outline.corners.push(Corner::Road {
                s: context.number(corner, "s")?,
                t: context.number(corner, "t")?,
                dz_m: context.number_or_zero(corner, "dz"),
                height_m: context.number_or_zero(corner, "height"),
            }),
            "userData" => {}
            _ => context.unknown(corner),
        }
    }
    Ok((!outline.corners.is_empty()).then_some(outline))
}

fn repeat(context: &mut Context, node: Node<'_, '_>, object: &Object) -> Result<Repeat, ReadError> {
    let mut pair = |start: &str, end: &str| {
        let first = context.maybe_number(node, start);
        let last = context.maybe_number(node, end);
        first.or(last).map(|value| [value, last.unwrap_or(value)])
    };
    let t = pair("tStart", "tEnd").unwrap_or([object.t; 2]);
    let z_offset = pair("zOffsetStart", "zOffsetEnd").unwrap_or([object.z_offset_m; 2]);
    let height = pair("heightStart", "heightEnd");
    let width = pair("widthStart", "widthEnd");
    Ok(Repeat {
        s: context.number(node, "s")?,
        length_m: context.number(node, "length")?,
        distance_m: context.number_or_zero(node, "distance"),
        t_m: t,
        z_offset_m: z_offset,
        height_m: height,
        width_m: width,
    })
}

pub(super) fn junction(context: &mut Context, node: Node<'_, '_>) -> Result<Junction, ReadError> {
    let mut junction = Junction {
        id: context.text(node, "id")?,
        name: text_or_empty(node, "name"),
        kind: context.word(node, "type", JunctionKind::from_xml),
        ..Junction::default()
    };
    for child in node.children().filter(Node::is_element) {
        match child.tag_name().name() {
            "connection" => junction.connections.extend(connection(context, child)?),
            "controller" => junction.controllers.push(JunctionController {
                id: context.text(child, "id")?,
                kind: text_or_empty(child, "type"),
                sequence: sequence(child),
            }),
            "userData" => {}
            _ => context.unknown(child),
        }
    }
    Ok(junction)
}

/// A `connection`; none where it does not name both roads, which is noted.
fn connection(context: &mut Context, node: Node<'_, '_>) -> Result<Option<Connection>, ReadError> {
    // Direct junctions name the other road `linkedRoad`.
    let roads =
        (node.attribute("incomingRoad"), node.attribute("connectingRoad").or(node.attribute("linkedRoad")));
    let (Some(incoming), Some(connecting)) = roads else {
        context.warn(node, None, "connection without incoming or connecting road: left out");
        return Ok(None);
    };
    let mut connection = Connection {
        id: text_or_empty(node, "id"),
        incoming_road: incoming.to_owned(),
        connecting_road: connecting.to_owned(),
        contact: context.word(node, "contactPoint", ContactPoint::from_xml),
        lane_links: Vec::new(),
    };
    for link in node.children().filter(|n| n.tag_name().name() == "laneLink") {
        let link = LaneLink { from: context.lane_id(link, "from")?, to: context.lane_id(link, "to")? };
        connection.lane_links.push(link);
    }
    Ok(Some(connection))
}

fn sequence(node: Node<'_, '_>) -> Option<u32> {
    node.attribute("sequence")?.trim().parse().ok()
}

pub(super) fn controller(context: &mut Context, node: Node<'_, '_>) -> Result<Controller, ReadError> {
    let mut controller = Controller {
        id: context.text(node, "id")?,
        name: text_or_empty(node, "name"),
        sequence: sequence(node),
        signals: Vec::new(),
    };
    for child in node.children().filter(|n| n.tag_name().name() == "control") {
        let id = context.text(child, "signalId")?;
        // Some writers list every signal several times.
        if !controller.signals.contains(&id) {
            controller.signals.push(id);
        }
    }
    Ok(controller)
}
