//! Reads signals and their controllers.

use std::collections::BTreeSet;

use roxmltree::Node;

use super::ReadError;
use super::context::{Context, elements, flag, named, text_or_empty};
use crate::model::{
    Controller, ElementReference, LaneValidity, Orientation, Road, Signal, SignalDependency, SignalPosition,
    SignalReference, SpeedUnit,
};

/// The signals of a road, with the line of each.
pub(super) fn signals(
    context: &mut Context,
    node: Node<'_, '_>,
    road: &mut Road,
    lines: &mut Vec<u32>,
) -> Result<(), ReadError> {
    for child in elements(node) {
        match child.tag_name().name() {
            "signal" => {
                let signal = signal(context, child)?;
                if context.sane(child, &numbers(&signal)) {
                    road.signals.push(signal);
                    lines.push(context.line(child));
                }
            }
            "signalReference" => road.signal_references.push(SignalReference {
                id: context.text(child, "id")?,
                s: context.number(child, "s")?,
                t: context.number_or_zero(child, "t"),
                orientation: context.word(child, "orientation", Orientation::from_xml),
                validity: validity(context, child)?,
            }),
            _ => context.unknown(child),
        }
    }
    Ok(())
}

/// Every number that has a part in where a signal stands and how large it is.
fn numbers(signal: &Signal) -> Vec<f64> {
    let mut numbers = vec![signal.s, signal.t, signal.z_offset_m, signal.h_offset_rad];
    numbers.extend(signal.height_m.iter().chain(&signal.width_m).chain(&signal.length_m));
    match &signal.position {
        Some(SignalPosition::Inertial { xyz_m, hdg_rad, .. }) => {
            numbers.extend(xyz_m);
            numbers.push(*hdg_rad);
        }
        Some(SignalPosition::Road { s, t, z_offset_m, h_offset_rad, .. }) => {
            numbers.extend([s, t, z_offset_m, h_offset_rad]);
        }
        None => {}
    }
    numbers
}

fn signal(context: &mut Context, node: Node<'_, '_>) -> Result<Signal, ReadError> {
    let unit = node.attribute("unit").unwrap_or_default();
    let speed_unit = SpeedUnit::from_xml(unit.trim());
    let mut signal = Signal {
        id: context.text(node, "id")?,
        name: text_or_empty(node, "name"),
        s: context.number(node, "s")?,
        t: context.number(node, "t")?,
        z_offset_m: context.number_or_zero(node, "zOffset"),
        h_offset_rad: context.number_or_zero(node, "hOffset"),
        pitch_rad: context.number_or_zero(node, "pitch"),
        roll_rad: context.number_or_zero(node, "roll"),
        orientation: context.word(node, "orientation", Orientation::from_xml),
        dynamic: flag(node, "dynamic"),
        country: text_or_empty(node, "country"),
        country_revision: text_or_empty(node, "countryRevision"),
        kind: text_or_empty(node, "type"),
        subtype: text_or_empty(node, "subtype"),
        value: context.maybe_number(node, "value"),
        unit: speed_unit,
        other_unit: if speed_unit.is_some() { String::new() } else { unit.to_owned() },
        text: text_or_empty(node, "text"),
        height_m: context.maybe_number(node, "height"),
        width_m: context.maybe_number(node, "width"),
        length_m: context.maybe_number(node, "length"),
        validity: validity(context, node)?,
        ..Signal::default()
    };
    for child in elements(node) {
        match child.tag_name().name() {
            "validity" => {}
            "dependency" => signal.dependencies.push(SignalDependency {
                id: context.text(child, "id")?,
                kind: text_or_empty(child, "type"),
            }),
            "reference" => signal.references.push(ElementReference {
                element: text_or_empty(child, "elementType"),
                id: context.text(child, "elementId")?,
                kind: text_or_empty(child, "type"),
            }),
            "positionInertial" | "positionRoad" => signal.position = Some(position(context, child)?),
            _ => {
                let standard = ["staticBoard", "vmsBoard", "semantics"];
                signal.kept.extend(context.kept(child, &standard));
            }
        }
    }
    Ok(signal)
}

fn position(context: &mut Context, node: Node<'_, '_>) -> Result<SignalPosition, ReadError> {
    let (pitch_rad, roll_rad) = (context.number_or_zero(node, "pitch"), context.number_or_zero(node, "roll"));
    if node.tag_name().name() == "positionInertial" {
        return Ok(SignalPosition::Inertial {
            xyz_m: [context.number(node, "x")?, context.number(node, "y")?, context.number(node, "z")?],
            hdg_rad: context.number_or_zero(node, "hdg"),
            pitch_rad,
            roll_rad,
        });
    }
    Ok(SignalPosition::Road {
        road: context.text(node, "roadId")?,
        s: context.number(node, "s")?,
        t: context.number(node, "t")?,
        z_offset_m: context.number_or_zero(node, "zOffset"),
        h_offset_rad: context.number_or_zero(node, "hOffset"),
        pitch_rad,
        roll_rad,
    })
}

/// The `validity` elements of a node.
pub(super) fn validity(context: &Context, node: Node<'_, '_>) -> Result<Vec<LaneValidity>, ReadError> {
    named(node, "validity")
        .map(|n| {
            Ok(LaneValidity { from: context.lane_id(n, "fromLane")?, to: context.lane_id(n, "toLane")? })
        })
        .collect()
}

pub(super) fn controller(context: &mut Context, node: Node<'_, '_>) -> Result<Controller, ReadError> {
    let mut controller = Controller {
        id: context.text(node, "id")?,
        name: text_or_empty(node, "name"),
        sequence: sequence(node),
        ..Controller::default()
    };
    let mut seen = BTreeSet::new();
    for child in elements(node) {
        if child.tag_name().name() != "control" {
            context.unknown(child);
            continue;
        }
        let id = context.text(child, "signalId")?;
        // Some writers list every signal several times.
        if seen.insert(id.clone()) {
            if let Some(kind) = child.attribute("type").filter(|kind| !kind.is_empty()) {
                controller.control_types.insert(id.clone(), kind.to_owned());
            }
            controller.signals.push(id);
        }
    }
    Ok(controller)
}

/// Place in an order, if stated.
pub(super) fn sequence(node: Node<'_, '_>) -> Option<u32> {
    node.attribute("sequence")?.trim().parse().ok()
}
