//! Writes signals, objects, junctions and controllers.

use std::fmt::Display;

use super::xml::Xml;
use crate::model::{
    Controller, Corner, Junction, JunctionKind, LaneValidity, Object, Repeat, Road, Signal, SignalReference,
};

/// Attributes of one element.
type Attributes<'a> = Vec<(&'static str, &'a dyn Display)>;

/// Adds an attribute where there is a value.
fn maybe<'a, T: Display>(attributes: &mut Attributes<'a>, name: &'static str, value: &'a Option<T>) {
    if let Some(value) = value {
        attributes.push((name, value));
    }
}

/// A leaf, or an element with validity ranges.
fn with_validity(xml: &mut Xml, name: &'static str, attributes: &Attributes<'_>, ranges: &[LaneValidity]) {
    if ranges.is_empty() {
        xml.leaf(name, attributes);
        return;
    }
    xml.open(name, attributes);
    validity(xml, ranges);
    xml.close();
}

fn validity(xml: &mut Xml, ranges: &[LaneValidity]) {
    for range in ranges {
        xml.leaf("validity", &[("fromLane", &range.from), ("toLane", &range.to)]);
    }
}

pub(super) fn signals(xml: &mut Xml, road: &Road) {
    if road.signals.is_empty() && road.signal_references.is_empty() {
        return;
    }
    xml.open("signals", &[]);
    road.signals.iter().for_each(|s| signal(xml, s));
    road.signal_references.iter().for_each(|r| reference(xml, r));
    xml.close();
}

fn signal(xml: &mut Xml, signal: &Signal) {
    let (orientation, unit) = (signal.orientation.xml(), signal.unit.map(|u| u.xml()));
    let dynamic = if signal.dynamic { "yes" } else { "no" };
    let mut attributes: Attributes<'_> = vec![
        ("name", &signal.name),
        ("id", &signal.id),
        ("s", &signal.s),
        ("t", &signal.t),
        ("zOffset", &signal.z_offset_m),
        ("hOffset", &signal.h_offset_rad),
        ("pitch", &signal.pitch_rad),
        ("roll", &signal.roll_rad),
        ("orientation", &orientation),
        ("dynamic", &dynamic),
        ("country", &signal.country),
        ("type", &signal.kind),
        ("subtype", &signal.subtype),
        ("text", &signal.text),
    ];
    maybe(&mut attributes, "value", &signal.value);
    maybe(&mut attributes, "unit", &unit);
    maybe(&mut attributes, "height", &signal.height_m);
    maybe(&mut attributes, "width", &signal.width_m);
    with_validity(xml, "signal", &attributes, &signal.validity);
}

fn reference(xml: &mut Xml, reference: &SignalReference) {
    let orientation = reference.orientation.xml();
    let attributes: Attributes<'_> =
        vec![("id", &reference.id), ("s", &reference.s), ("t", &reference.t), ("orientation", &orientation)];
    with_validity(xml, "signalReference", &attributes, &reference.validity);
}

pub(super) fn objects(xml: &mut Xml, road: &Road) {
    if road.objects.is_empty() && road.bridges.is_empty() && road.tunnels.is_empty() {
        return;
    }
    xml.open("objects", &[]);
    road.objects.iter().for_each(|o| object(xml, o));
    for tunnel in &road.tunnels {
        let kind = tunnel.kind.xml();
        let mut attributes: Attributes<'_> = vec![
            ("id", &tunnel.id),
            ("name", &tunnel.name),
            ("type", &kind),
            ("s", &tunnel.s),
            ("length", &tunnel.length_m),
        ];
        maybe(&mut attributes, "lighting", &tunnel.lighting);
        maybe(&mut attributes, "daylight", &tunnel.daylight);
        with_validity(xml, "tunnel", &attributes, &tunnel.validity);
    }
    for bridge in &road.bridges {
        let attributes: Attributes<'_> = vec![
            ("id", &bridge.id),
            ("name", &bridge.name),
            ("type", &bridge.kind),
            ("s", &bridge.s),
            ("length", &bridge.length_m),
        ];
        with_validity(xml, "bridge", &attributes, &bridge.validity);
    }
    xml.close();
}

fn object(xml: &mut Xml, object: &Object) {
    let orientation = object.orientation.xml();
    let mut attributes: Attributes<'_> = vec![
        ("id", &object.id),
        ("name", &object.name),
        ("type", &object.kind),
        ("subtype", &object.subtype),
        ("s", &object.s),
        ("t", &object.t),
        ("zOffset", &object.z_offset_m),
        ("hdg", &object.hdg_rad),
        ("pitch", &object.pitch_rad),
        ("roll", &object.roll_rad),
        ("orientation", &orientation),
    ];
    maybe(&mut attributes, "length", &object.length_m);
    maybe(&mut attributes, "width", &object.width_m);
    maybe(&mut attributes, "height", &object.height_m);
    maybe(&mut attributes, "radius", &object.radius_m);
    xml.open("object", &attributes);
    object.repeats.iter().for_each(|r| repeat(xml, r));
    if !object.outlines.is_empty() {
        xml.open("outlines", &[]);
        for (i, outline) in object.outlines.iter().enumerate() {
            xml.open("outline", &[("id", &i), ("closed", &outline.closed)]);
            for item in &outline.corners {
                corner(xml, item);
            }
            xml.close();
        }
        xml.close();
    }
    validity(xml, &object.validity);
    xml.close();
}

fn corner(xml: &mut Xml, corner: &Corner) {
    match corner {
        Corner::Local { u_m, v_m, z_m, height_m } => {
            xml.leaf("cornerLocal", &[("u", u_m), ("v", v_m), ("z", z_m), ("height", height_m)]);
        }
        Corner::Road { s, t, dz_m, height_m } => {
            xml.leaf("cornerRoad", &[("s", s), ("t", t), ("dz", dz_m), ("height", height_m)]);
        }
    }
}

fn repeat(xml: &mut Xml, repeat: &Repeat) {
    let mut attributes: Attributes<'_> = vec![
        ("s", &repeat.s),
        ("length", &repeat.length_m),
        ("distance", &repeat.distance_m),
        ("tStart", &repeat.t_m[0]),
        ("tEnd", &repeat.t_m[1]),
        ("zOffsetStart", &repeat.z_offset_m[0]),
        ("zOffsetEnd", &repeat.z_offset_m[1]),
    ];
    if let Some([start, end]) = &repeat.height_m {
        attributes.extend([("heightStart", start as &dyn Display), ("heightEnd", end)]);
    }
    if let Some([start, end]) = &repeat.width_m {
        attributes.extend([("widthStart", start as &dyn Display), ("widthEnd", end)]);
    }
    xml.leaf("repeat", &attributes);
}

pub(super) fn junction(xml: &mut Xml, junction: &Junction) {
    let kind = junction.kind.xml();
    let direct = junction.kind == JunctionKind::Direct;
    xml.open("junction", &[("id", &junction.id), ("name", &junction.name), ("type", &kind)]);
    for connection in &junction.connections {
        let road = if direct { "linkedRoad" } else { "connectingRoad" };
        let contact = connection.contact.xml();
        xml.open(
            "connection",
            &[
                ("id", &connection.id),
                ("incomingRoad", &connection.incoming_road),
                (road, &connection.connecting_road),
                ("contactPoint", &contact),
            ],
        );
        for link in &connection.lane_links {
            xml.leaf("laneLink", &[("from", &link.from), ("to", &link.to)]);
        }
        xml.close();
    }
    for controller in &junction.controllers {
        let mut attributes: Attributes<'_> = vec![("id", &controller.id), ("type", &controller.kind)];
        maybe(&mut attributes, "sequence", &controller.sequence);
        xml.leaf("controller", &attributes);
    }
    xml.close();
}

pub(super) fn controller(xml: &mut Xml, controller: &Controller) {
    let mut attributes: Attributes<'_> = vec![("id", &controller.id), ("name", &controller.name)];
    maybe(&mut attributes, "sequence", &controller.sequence);
    xml.open("controller", &attributes);
    for id in &controller.signals {
        xml.leaf("control", &[("signalId", id), ("type", &"")]);
    }
    xml.close();
}
