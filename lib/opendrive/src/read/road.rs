//! Reads a road but for its lanes, signals and objects.

use roxmltree::Node;

use super::context::{Context, text_or_empty};
use super::{ReadError, furniture, lanes};
use crate::model::{
    ContactPoint, Cubic, Curve, Geometry, Road, RoadLink, RoadType, Shape, Speed, SpeedUnit, TrafficRule,
};

/// A `road` element. None where it has no usable geometry, which is noted.
pub(super) fn road(context: &mut Context, node: Node<'_, '_>) -> Result<Option<Road>, ReadError> {
    let mut road = Road {
        id: context.text(node, "id")?,
        name: text_or_empty(node, "name"),
        length_m: context.number(node, "length")?,
        junction: node.attribute("junction").filter(|j| *j != "-1" && !j.is_empty()).map(str::to_owned),
        rule: context.word(node, "rule", TrafficRule::from_xml),
        ..Road::default()
    };
    for child in node.children() {
        match child.tag_name().name() {
            "link" => links(context, child, &mut road)?,
            "type" => {
                let speed =
                    child.children().find(|n| n.has_tag_name("speed") || n.tag_name().name() == "speed");
                road.types.push(RoadType {
                    s: context.number_or_zero(child, "s"),
                    kind: text_or_empty(child, "type"),
                    speed: speed.and_then(|n| self::speed(context, n)),
                });
            }
            "planView" => {
                for piece in child.children().filter(Node::is_element) {
                    if piece.tag_name().name() == "geometry" {
                        road.plan_view.extend(geometry(context, piece)?);
                    } else {
                        context.unknown(piece);
                    }
                }
                context.sort_by_s(child, "geometry", &mut road.plan_view, |g| g.s);
            }
            "elevationProfile" => {
                road.elevation = cubics(context, child, "elevation", "s")?;
            }
            "lateralProfile" => lateral(context, child, &mut road)?,
            "lanes" => {
                road.lane_offset = cubics(context, child, "laneOffset", "s")?;
                lanes::sections(context, child, &mut road)?;
            }
            "objects" => furniture::objects(context, child, &mut road)?,
            "signals" => furniture::signals(context, child, &mut road)?,
            "userData" => {}
            _ => context.unknown(child),
        }
    }
    if road.plan_view.is_empty() || road.length_m <= 0.0 {
        context.warn(node, None, "road without geometry or length: left out");
        return Ok(None);
    }
    if road.sections.is_empty() {
        context.warn(node, None, "road without lane sections");
    }
    context.sort_by_s(node, "type", &mut road.types, |t| t.s);
    Ok(Some(road))
}

fn links(context: &mut Context, node: Node<'_, '_>, road: &mut Road) -> Result<(), ReadError> {
    for child in node.children().filter(Node::is_element) {
        let end = child.tag_name().name();
        if end != "predecessor" && end != "successor" {
            context.unknown(child);
            continue;
        }
        let Some(id) = child.attribute("elementId").map(str::to_owned) else {
            context.warn(child, None, format!("<{end}> has no elementId: ignored"));
            continue;
        };
        let link = match child.attribute("elementType") {
            Some("junction") => RoadLink::Junction { id },
            Some("road") | None => match child.attribute("contactPoint").and_then(ContactPoint::from_xml) {
                Some(contact) => RoadLink::Road { id, contact },
                None => {
                    context.warn(child, None, format!("<{end}> has no contactPoint: ignored"));
                    continue;
                }
            },
            Some(other) => {
                context.warn(child, None, format!("<{end}> elementType=\"{other}\" is unknown: ignored"));
                continue;
            }
        };
        if end == "predecessor" { road.predecessor = Some(link) } else { road.successor = Some(link) }
    }
    Ok(())
}

/// A `speed` element; none where it states no number.
pub(super) fn speed(context: &mut Context, node: Node<'_, '_>) -> Option<Speed> {
    let unit = context.word(node, "unit", SpeedUnit::from_xml);
    match node.attribute("max")?.trim() {
        "no limit" => Some(Speed { max: f64::INFINITY, unit }),
        "undefined" => None,
        _ => context.maybe_number(node, "max").map(|max| Speed { max, unit }),
    }
}

/// All records of one name, in order.
pub(super) fn cubics(
    context: &mut Context,
    parent: Node<'_, '_>,
    tag: &str,
    start: &str,
) -> Result<Vec<Cubic>, ReadError> {
    let mut records = Vec::new();
    for node in parent.children().filter(|n| n.tag_name().name() == tag) {
        records.push(cubic(context, node, start)?);
    }
    context.sort_by_s(parent, tag, &mut records, |c| c.s);
    Ok(records)
}

/// One record; absent coefficients are 0, unreadable ones an error.
pub(super) fn cubic(context: &Context, node: Node<'_, '_>, start: &str) -> Result<Cubic, ReadError> {
    let number = |name: &str| if node.has_attribute(name) { context.number(node, name) } else { Ok(0.0) };
    Ok(Cubic { s: number(start)?, a: number("a")?, b: number("b")?, c: number("c")?, d: number("d")? })
}

fn lateral(context: &mut Context, node: Node<'_, '_>, road: &mut Road) -> Result<(), ReadError> {
    road.superelevation = cubics(context, node, "superelevation", "s")?;
    for child in node.children().filter(Node::is_element) {
        match child.tag_name().name() {
            "superelevation" => {}
            "shape" => {
                let s = context.number(child, "s")?;
                road.shape.push(Shape { s, cubic_of_t: cubic(context, child, "t")? });
            }
            _ => context.unknown(child),
        }
    }
    road.shape.sort_by(|a, b| a.s.total_cmp(&b.s).then(a.cubic_of_t.s.total_cmp(&b.cubic_of_t.s)));
    Ok(())
}

/// A `geometry` element; none for a piece of negative length, which is noted.
fn geometry(context: &mut Context, node: Node<'_, '_>) -> Result<Option<Geometry>, ReadError> {
    let mut piece = Geometry {
        s: context.number(node, "s")?,
        x_m: context.number(node, "x")?,
        y_m: context.number(node, "y")?,
        hdg_rad: context.number(node, "hdg")?,
        length_m: context.number(node, "length")?,
        curve: Curve::Line,
    };
    if piece.length_m < 0.0 {
        context.warn(node, Some(piece.s), "geometry of negative length: left out");
        return Ok(None);
    }
    let coefficients = |node: Node<'_, '_>, names: [&str; 4]| -> Result<[f64; 4], ReadError> {
        let mut values = [0.0; 4];
        for (value, name) in values.iter_mut().zip(names) {
            if node.has_attribute(name) {
                *value = context.number(node, name)?;
            }
        }
        Ok(values)
    };
    let mut found = false;
    for child in node.children().filter(Node::is_element) {
        piece.curve = match child.tag_name().name() {
            "line" => Curve::Line,
            "arc" => Curve::Arc { curvature: context.number(child, "curvature")? },
            "spiral" => Curve::Spiral {
                curvature_start: context.number(child, "curvStart")?,
                curvature_end: context.number(child, "curvEnd")?,
            },
            "poly3" => Curve::Poly3 { v: coefficients(child, ["a", "b", "c", "d"])? },
            "paramPoly3" => {
                let mut u = coefficients(child, ["aU", "bU", "cU", "dU"])?;
                if !["aU", "bU", "cU", "dU"].iter().any(|name| child.has_attribute(*name)) {
                    // Without coefficients nothing moves; a straight piece of the stated length is the only sense.
                    u = [
                        0.0,
                        if child.attribute("pRange") == Some("arcLength") { 1.0 } else { piece.length_m },
                        0.0,
                        0.0,
                    ];
                }
                Curve::ParamPoly3 {
                    u,
                    v: coefficients(child, ["aV", "bV", "cV", "dV"])?,
                    normalised: child.attribute("pRange") != Some("arcLength"),
                }
            }
            _ => continue,
        };
        found = true;
    }
    if !found {
        context.warn(node, Some(piece.s), "geometry of unknown kind: taken as a line");
    }
    Ok(Some(piece))
}
