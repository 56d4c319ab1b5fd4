//! Writes a network as OpenDRIVE 1.7.

mod furniture;
mod lanes;
mod xml;

use std::fmt::Display;

use crate::model::{
    Cubic, Curve, Geometry, Header, HeaderOffset, Network, Road, RoadLink, Speed, TrafficRule,
};
use xml::Xml;

/// The network as the text of an OpenDRIVE file.
///
/// Reading it back gives the same network, to the bit, but for its warnings and for what no file can say: the
/// revision becomes 1.7 where it is older than 1.4 or not set, and control characters in texts are dropped.
#[must_use]
pub fn write(network: &Network) -> String {
    let mut xml = Xml::new();
    xml.open("OpenDRIVE", &[]);
    header(&mut xml, &network.header);
    for item in &network.roads {
        road(&mut xml, item);
    }
    for item in &network.controllers {
        furniture::controller(&mut xml, item);
    }
    for item in &network.junctions {
        furniture::junction(&mut xml, item);
    }
    xml.finish()
}

fn header(xml: &mut Xml, header: &Header) {
    let (major, minor) = if header.revision < (1, 4) { (1, 7) } else { header.revision };
    let mut attributes: Vec<(&str, &dyn Display)> = vec![
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
    if *o != HeaderOffset::default() {
        xml.leaf("offset", &[("x", &o.x_m), ("y", &o.y_m), ("z", &o.z_m), ("hdg", &o.hdg_rad)]);
    }
    xml.close();
}

fn road(xml: &mut Xml, road: &Road) {
    let mut attributes: Vec<(&str, &dyn Display)> =
        vec![("name", &road.name), ("length", &road.length_m), ("id", &road.id)];
    let junction = road.junction.as_deref().unwrap_or("-1");
    attributes.push(("junction", &junction));
    let rule = road.rule.xml();
    if road.rule != TrafficRule::default() {
        attributes.push(("rule", &rule));
    }
    xml.open("road", &attributes);
    xml.open("link", &[]);
    for (name, link) in [("predecessor", &road.predecessor), ("successor", &road.successor)] {
        match link {
            Some(RoadLink::Road { id, contact }) => {
                xml.leaf(
                    name,
                    &[("elementType", &"road"), ("elementId", id), ("contactPoint", &contact.xml())],
                );
            }
            Some(RoadLink::Junction { id }) => {
                xml.leaf(name, &[("elementType", &"junction"), ("elementId", id)])
            }
            None => {}
        }
    }
    xml.close();
    for kind in &road.types {
        xml.open("type", &[("s", &kind.s), ("type", &kind.kind)]);
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
    for shape in &road.shape {
        let c = &shape.cubic_of_t;
        xml.leaf(
            "shape",
            &[("s", &shape.s), ("t", &c.s), ("a", &c.a), ("b", &c.b), ("c", &c.c), ("d", &c.d)],
        );
    }
    xml.close();
    lanes::lanes(xml, road);
    furniture::objects(xml, road);
    furniture::signals(xml, road);
    xml.close();
}

/// A `speed` element, with an offset when it belongs to a lane.
fn speed(xml: &mut Xml, speed: &Speed, s_offset: Option<f64>) {
    let max = if speed.max.is_finite() { speed.max.to_string() } else { "no limit".to_owned() };
    let unit = speed.unit.xml();
    let mut attributes: Vec<(&str, &dyn Display)> = Vec::new();
    if let Some(s_offset) = &s_offset {
        attributes.push(("sOffset", s_offset));
    }
    attributes.extend([("max", &max as &dyn Display), ("unit", &unit)]);
    xml.leaf("speed", &attributes);
}

fn cubics(xml: &mut Xml, name: &str, start: &str, records: &[Cubic]) {
    for c in records {
        xml.leaf(name, &[(start, &c.s), ("a", &c.a), ("b", &c.b), ("c", &c.c), ("d", &c.d)]);
    }
}

fn geometry(xml: &mut Xml, g: &Geometry) {
    let place: [(&str, &dyn Display); 5] =
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
            let mut attributes: Vec<(&str, &dyn Display)> = vec![("pRange", &range)];
            attributes.extend(["aU", "bU", "cU", "dU"].into_iter().zip(u.iter().map(|x| x as &dyn Display)));
            attributes.extend(["aV", "bV", "cV", "dV"].into_iter().zip(v.iter().map(|x| x as &dyn Display)));
            xml.leaf("paramPoly3", &attributes);
        }
    }
    xml.close();
}
