//! Writes signals and controllers.

use super::xml::{Attributes, Xml, maybe, unless_empty};
use crate::model::{Controller, LaneValidity, Road, Signal, SignalPosition, SignalReference};

/// A leaf, or an element with validity ranges.
pub(super) fn with_validity(
    xml: &mut Xml,
    name: &'static str,
    attributes: &Attributes<'_>,
    ranges: &[LaneValidity],
) {
    if ranges.is_empty() {
        xml.leaf(name, attributes);
        return;
    }
    xml.open(name, attributes);
    validity(xml, ranges);
    xml.close();
}

pub(super) fn validity(xml: &mut Xml, ranges: &[LaneValidity]) {
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
    unless_empty(&mut attributes, "countryRevision", &signal.country_revision);
    maybe(&mut attributes, "value", &signal.value);
    match &unit {
        Some(unit) => attributes.push(("unit", unit)),
        None => unless_empty(&mut attributes, "unit", &signal.other_unit),
    }
    maybe(&mut attributes, "height", &signal.height_m);
    maybe(&mut attributes, "width", &signal.width_m);
    maybe(&mut attributes, "length", &signal.length_m);
    xml.open("signal", &attributes);
    validity(xml, &signal.validity);
    for dependency in &signal.dependencies {
        xml.leaf("dependency", &[("id", &dependency.id), ("type", &dependency.kind)]);
    }
    for reference in &signal.references {
        let attributes: Attributes<'_> = vec![
            ("elementType", &reference.element),
            ("elementId", &reference.id),
            ("type", &reference.kind),
        ];
        xml.leaf("reference", &attributes);
    }
    match &signal.position {
        Some(SignalPosition::Inertial { xyz_m: [x, y, z], hdg_rad, pitch_rad, roll_rad }) => xml.leaf(
            "positionInertial",
            &[("x", x), ("y", y), ("z", z), ("hdg", hdg_rad), ("pitch", pitch_rad), ("roll", roll_rad)],
        ),
        Some(SignalPosition::Road { road, s, t, z_offset_m, h_offset_rad, pitch_rad, roll_rad }) => {
            let attributes: Attributes<'_> = vec![
                ("roadId", road),
                ("s", s),
                ("t", t),
                ("zOffset", z_offset_m),
                ("hOffset", h_offset_rad),
                ("pitch", pitch_rad),
                ("roll", roll_rad),
            ];
            xml.leaf("positionRoad", &attributes);
        }
        None => {}
    }
    xml.kept(&signal.kept);
    xml.close();
}

fn reference(xml: &mut Xml, reference: &SignalReference) {
    let orientation = reference.orientation.xml();
    let attributes: Attributes<'_> =
        vec![("id", &reference.id), ("s", &reference.s), ("t", &reference.t), ("orientation", &orientation)];
    with_validity(xml, "signalReference", &attributes, &reference.validity);
}

pub(super) fn controller(xml: &mut Xml, controller: &Controller) {
    let mut attributes: Attributes<'_> = vec![("id", &controller.id), ("name", &controller.name)];
    maybe(&mut attributes, "sequence", &controller.sequence);
    xml.open("controller", &attributes);
    for id in &controller.signals {
        let kind = controller.control_types.get(id).map(String::as_str).unwrap_or_default();
        xml.leaf("control", &[("signalId", id), ("type", &kind)]);
    }
    xml.close();
}
