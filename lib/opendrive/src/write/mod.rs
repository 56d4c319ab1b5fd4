//! Writes a network as an OpenDRIVE file.

mod junctions;
mod lanes;
mod objects;
mod signals;
mod structures;
mod xml;

use std::fmt::Display;

use crate::model::{Cubic, Curve, Geometry, Header, Network, Road, RoadLink, Speed};
use xml::{Attributes, Xml, unless_default, unless_empty};

/// The network as the text of an OpenDRIVE file.
///
/// Reading it back gives the same network, to the bit: for every network that was read from a file, but for its
/// warnings and counts of unknown elements. One built in memory may hold what no file can say: a revision of 0.0 becomes
/// 1.7, control characters in texts are dropped, records come back in order of s, and so on.
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

/// A `predecessor` or `successor` of a road, if there is one.
fn link(xml: &mut Xml, name: &'static str, link: &Option<RoadLink>) {
    match link {
        Some(RoadLink::Road { id, contact }) => {
            let contact = contact.xml();
            xml.leaf(name, &[("elementType", &"road"), ("elementId", id), ("contactPoint", &contact)]);
        }
        Some(RoadLink::Junction { id }) => {
            xml.leaf(name, &[("elementType", &"junction"), ("elementId", id)]);
        }
        Some(RoadLink::Along { id, s, direction }) => {
            let direction = direction.xml();
            let attributes: Attributes<'_> = vec![
                ("elementType", &"road"),
                ("elementId", id),
                ("elementS", s),
                ("elementDir", &direction),
            ];
            xml.leaf(name, &attributes);
        }
        None => {}
    }
}

/// A `speed` element, with an offset when it belongs to a lane.
fn speed(xml: &mut Xml, speed: &Speed, s_offset: Option<f64>) {
    let max = if speed.max.is_finite() { speed.max.to_string() } else { "no limit".to_owned() };
    let unit = speed.unit.xml();
    let mut attributes: Attributes<'_> = Vec::new();
    if let Some(s_offset) = &s_offset {
        attributes.push(("sOffset", s_offset));
    }
    attributes.extend([("max", &max as &dyn Display), ("unit", &unit)]);
    xml.leaf("speed", &attributes);
}

fn cubics(xml: &mut Xml, name: &str, start: &'static str, records: &[Cubic]) {
    for c in records {
        xml.leaf(name, &[(start, &c.s), ("a", &c.a), ("b", &c.b), ("c", &c.c), ("d", &c.d)]);
    }
}

fn geometry(xml: &mut Xml, g: &Geometry) {
    let place: [(&'static str, &dyn Display); 5] =
        [("s", &g.s), ("x", &g.x_m), ("y", &g.y_m), ("hdg", &g.hdg_rad), ("length", &g.length_m)];
    xml.open("geometry", &place);
    match &g.curve {
        Curve::Line => xml.leaf("line", &[]),
        Curve::Arc { curvature } => xml.leaf("arc", &[("curvature", curvature)]),
        Curve::Spiral { curvature_start, curvature_end } => {
            xml.leaf("spiral", &[("curvStart", curvature_start), ("curvEnd", curvature_end)]);
        }
        Curve::Poly3 { v: [a, b, c, d] } => xml.leaf("poly3", &[("a", a), ("b", b), ("c", c), ("d", d)]),
        Curve::ParamPoly3 { u, v, normalised } => {
            let range = if *normalised { "normalized" } else { "arcLength" };
            let mut attributes: Attributes<'_> = vec![("pRange", &range)];
            attributes.extend(["aU", "bU", "cU", "dU"].into_iter().zip(u.iter().map(|x| x as &dyn Display)));
            attributes.extend(["aV", "bV", "cV", "dV"].into_iter().zip(v.iter().map(|x| x as &dyn Display)));
            xml.leaf("paramPoly3", &attributes);
        }
    }
    xml.close();
}
