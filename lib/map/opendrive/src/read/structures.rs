//! Reads bridges, tunnels, railway switches and stations.

use roxmltree::Node;

use super::ReadError;
use super::context::{Context, elements, text_or_empty};
use super::signals::validity;
use crate::model::{
    Bridge, Platform, PlatformSegment, Road, RoadSide, Station, Switch, SwitchPosition, SwitchTrack,
    TrackDirection, Tunnel, TunnelType,
};

pub(super) fn bridge(context: &mut Context, node: Node<'_, '_>) -> Result<Bridge, ReadError> {
    Ok(Bridge {
        id: text_or_empty(node, "id"),
        name: text_or_empty(node, "name"),
        kind: text_or_empty(node, "type"),
        s: context.number(node, "s")?,
        length_m: context.number(node, "length")?,
        validity: validity(context, node)?,
    })
}

pub(super) fn tunnel(context: &mut Context, node: Node<'_, '_>) -> Result<Tunnel, ReadError> {
    Ok(Tunnel {
        id: text_or_empty(node, "id"),
        name: text_or_empty(node, "name"),
        kind: context.word(node, "type", TunnelType::from_xml),
        s: context.number(node, "s")?,
        length_m: context.number(node, "length")?,
        lighting: context.maybe_number(node, "lighting"),
        daylight: context.maybe_number(node, "daylight"),
        validity: validity(context, node)?,
    })
}

pub(super) fn railroad(context: &mut Context, node: Node<'_, '_>, road: &mut Road) -> Result<(), ReadError> {
    for child in elements(node) {
        if child.tag_name().name() == "switch" {
            road.switches.push(switch(context, child)?);
        } else {
            context.unknown(child);
        }
    }
    Ok(())
}

fn switch(context: &mut Context, node: Node<'_, '_>) -> Result<Switch, ReadError> {
    let mut switch = Switch {
        id: text_or_empty(node, "id"),
        name: text_or_empty(node, "name"),
        position: context.word(node, "position", SwitchPosition::from_xml),
        ..Switch::default()
    };
    for child in elements(node) {
        match child.tag_name().name() {
            "mainTrack" => switch.main = track(context, child)?,
            "sideTrack" => switch.side = track(context, child)?,
            "partner" => switch.partner = Some((text_or_empty(child, "name"), context.text(child, "id")?)),
            _ => context.unknown(child),
        }
    }
    Ok(switch)
}

fn track(context: &mut Context, node: Node<'_, '_>) -> Result<SwitchTrack, ReadError> {
    Ok(SwitchTrack {
        road: context.text(node, "id")?,
        s: context.number(node, "s")?,
        direction: context.word(node, "dir", TrackDirection::from_xml),
    })
}

pub(super) fn station(context: &mut Context, node: Node<'_, '_>) -> Result<Station, ReadError> {
    let mut station = Station {
        id: context.text(node, "id")?,
        name: text_or_empty(node, "name"),
        kind: text_or_empty(node, "type"),
        platforms: Vec::new(),
    };
    for child in elements(node) {
        if child.tag_name().name() == "platform" {
            station.platforms.push(platform(context, child)?);
        } else {
            context.unknown(child);
        }
    }
    Ok(station)
}

fn platform(context: &mut Context, node: Node<'_, '_>) -> Result<Platform, ReadError> {
    let mut platform =
        Platform { id: text_or_empty(node, "id"), name: text_or_empty(node, "name"), segments: Vec::new() };
    for child in elements(node) {
        if child.tag_name().name() == "segment" {
            platform.segments.push(PlatformSegment {
                road: context.text(child, "roadId")?,
                s_start: context.number(child, "sStart")?,
                s_end: context.number(child, "sEnd")?,
                side: context.word(child, "side", RoadSide::from_xml),
            });
        } else {
            context.unknown(child);
        }
    }
    Ok(platform)
}
