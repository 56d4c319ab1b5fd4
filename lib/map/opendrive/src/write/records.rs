//! Writes records that occur in several places.

use std::fmt::Display;

use super::xml::{Attributes, Xml};
use crate::model::{Cubic, Curve, Geometry, RoadLink, Speed};

/// A `predecessor` or `successor` of a road, if there is one.
pub(super) fn link(xml: &mut Xml, name: &'static str, link: &Option<RoadLink>) {
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
pub(super) fn speed(xml: &mut Xml, speed: &Speed, s_offset: Option<f64>) {
    let max = if speed.max.is_finite() { speed.max.to_string() } else { "no limit".to_owned() };
    let unit = speed.unit.xml();
    let mut attributes: Attributes<'_> = Vec::new();
    if let Some(s_offset) = &s_offset {
        attributes.push(("sOffset", s_offset));
    }
    attributes.extend([("max", &max as &dyn Display), ("unit", &unit)]);
    xml.leaf("speed", &attributes);
}

pub(super) fn cubics(xml: &mut Xml, name: &str, start: &'static str, records: &[Cubic]) {
    for c in records {
        xml.leaf(name, &[(start, &c.s), ("a", &c.a), ("b", &c.b), ("c", &c.c), ("d", &c.d)]);
    }
}

pub(super) fn geometry(xml: &mut Xml, g: &Geometry) {
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
