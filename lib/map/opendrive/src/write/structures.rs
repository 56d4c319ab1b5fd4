//! Writes bridges, tunnels, railway switches and stations.

use super::signals::with_validity;
use super::xml::{Attributes, Xml, maybe};
use crate::model::{Road, Station, SwitchTrack};

pub(super) fn bridges_and_tunnels(xml: &mut Xml, road: &Road) {
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
}

pub(super) fn railroad(xml: &mut Xml, road: &Road) {
    if road.switches.is_empty() {
        return;
    }
    xml.open("railroad", &[]);
    for switch in &road.switches {
        let position = switch.position.xml();
        xml.open("switch", &[("name", &switch.name), ("id", &switch.id), ("position", &position)]);
        track(xml, "mainTrack", &switch.main);
        track(xml, "sideTrack", &switch.side);
        if let Some((name, id)) = &switch.partner {
            xml.leaf("partner", &[("name", name), ("id", id)]);
        }
        xml.close();
    }
    xml.close();
}

fn track(xml: &mut Xml, name: &str, track: &SwitchTrack) {
    xml.leaf(name, &[("id", &track.road), ("s", &track.s), ("dir", &track.direction.xml())]);
}

pub(super) fn station(xml: &mut Xml, station: &Station) {
    xml.open("station", &[("name", &station.name), ("id", &station.id), ("type", &station.kind)]);
    for platform in &station.platforms {
        xml.open("platform", &[("name", &platform.name), ("id", &platform.id)]);
        for segment in &platform.segments {
            let side = segment.side.xml();
            xml.leaf(
                "segment",
                &[
                    ("roadId", &segment.road),
                    ("sStart", &segment.s_start),
                    ("sEnd", &segment.s_end),
                    ("side", &side),
                ],
            );
        }
        xml.close();
    }
    xml.close();
}
