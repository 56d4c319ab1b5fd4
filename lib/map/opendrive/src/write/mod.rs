//! Writes a network as an OpenDRIVE file.

mod junctions;
mod lanes;
mod objects;
mod records;
mod signals;
mod structures;
mod xml;

use std::fmt::Display;

use crate::model::{Header, Network, Road};
use records::{cubics, geometry, link, speed};
use xml::{Attributes, Xml, unless_default, unless_empty};

/// The network as the text of an OpenDRIVE file.
///
/// Reading it back gives the same network, to the bit: for every network that was read from a file, but for
/// its warnings and counts of unknown elements. One built in memory may hold what no file can say: a revision
/// of 0.0 becomes 1.7, control characters in texts are dropped, records come back in order of s, and so on.
#[must_use]
pub fn write(network: &Network) -> String {
    let mut xml = Xml::new();
    xml.open("OpenDRIVE", &[]);
    header(&mut xml, &network.header);
    for item in &network.roads {
        road(&mut xml, item);
    }
    for item in &network.controllers {
        signals::controller(&mut xml, item);
    }
    for item in &network.junctions {
        junctions::junction(&mut xml, item);
    }
    for item in &network.junction_groups {
        junctions::group(&mut xml, item);
    }
    for item in &network.stations {
        structures::station(&mut xml, item);
    }
    xml.kept(&network.kept);
    xml.finish()
}

fn header(xml: &mut Xml, header: &Header) {
    let (major, minor) = if header.revision.0 == 0 { (1, 7) } else { header.revision };
    let mut attributes: Attributes<'_> = vec![
        ("revMajor", &major),
        ("revMinor", &minor),
        ("name", &header.name),
        ("version", &header.version),
        ("date", &header.date),
        ("vendor", &header.vendor),
    ];
    if let Some([north, south, east, west]) = &header.bounds_m {
        attributes.extend([
            ("north", north as &dyn Display),
            ("south", south),
            ("east", east),
            ("west", west),
        ]);
    }
    xml.open("header", &attributes);
    if let Some(text) = &header.geo_reference {
        xml.text("geoReference", text);
    }
    let o = &header.offset;
    // By bits: -0 is written, too.
    if [o.x_m, o.y_m, o.z_m, o.hdg_rad].iter().any(|v| v.to_bits() != 0) {
        xml.leaf("offset", &[("x", &o.x_m), ("y", &o.y_m), ("z", &o.z_m), ("hdg", &o.hdg_rad)]);
    }
    xml.kept(&header.kept);
    xml.close();
}

fn road(xml: &mut Xml, road: &Road) {
    let mut attributes: Attributes<'_> =
        vec![("name", &road.name), ("length", &road.length_m), ("id", &road.id)];
    let junction = road.junction.as_deref().unwrap_or("-1");
    attributes.push(("junction", &junction));
    let rule = road.rule.xml();
    unless_default(&mut attributes, "rule", &road.rule, &rule);
    xml.open("road", &attributes);
    xml.open("link", &[]);
    link(xml, "predecessor", &road.predecessor);
    link(xml, "successor", &road.successor);
    for neighbour in &road.neighbours {
        let (side, direction) = (neighbour.side.xml(), neighbour.direction.xml());
        xml.leaf("neighbor", &[("side", &side), ("elementId", &neighbour.id), ("direction", &direction)]);
    }
    xml.close();
    for kind in &road.types {
        let mut attributes: Attributes<'_> = vec![("s", &kind.s), ("type", &kind.kind)];
        unless_empty(&mut attributes, "country", &kind.country);
        xml.open("type", &attributes);
        if let Some(limit) = &kind.speed {
            speed(xml, limit, None);
        }
        xml.close();
    }
    xml.open("planView", &[]);
    for piece in &road.plan_view {
        geometry(xml, piece);
    }
    xml.close();
    xml.open("elevationProfile", &[]);
    cubics(xml, "elevation", "s", &road.elevation);
    xml.close();
    xml.open("lateralProfile", &[]);
    cubics(xml, "superelevation", "s", &road.superelevation);
    for crossfall in &road.crossfall {
        let (side, c) = (crossfall.side.xml(), &crossfall.angle_rad);
        xml.leaf(
            "crossfall",
            &[("side", &side), ("s", &c.s), ("a", &c.a), ("b", &c.b), ("c", &c.c), ("d", &c.d)],
        );
    }
    for shape in &road.shape {
        let c = &shape.cubic_of_t;
        xml.leaf(
            "shape",
            &[("s", &shape.s), ("t", &c.s), ("a", &c.a), ("b", &c.b), ("c", &c.c), ("d", &c.d)],
        );
    }
    xml.kept(&road.cross_section_surface);
    xml.close();
    lanes::lanes(xml, road);
    objects::objects(xml, road);
    signals::signals(xml, road);
    structures::railroad(xml, road);
    xml.kept(&road.kept);
    xml.close();
}
