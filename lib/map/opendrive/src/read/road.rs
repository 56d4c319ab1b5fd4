//! Reads a road but for its lanes, signals and objects.

use roxmltree::Node;

use super::check::RoadLines;
use super::context::{Context, elements, text_or_empty};
use super::records::{cubic, cubics, speed};
use super::{ReadError, lanes, objects, signals, structures};
use crate::model::{
    ContactPoint, Crossfall, Curve, Geometry, Neighbour, NeighbourDirection, Road, RoadLink, RoadSide,
    RoadType, Shape, TrackDirection, TrafficRule,
};

/// A `road` element. None where it has no usable geometry, which is noted.
pub(super) fn road(
    context: &mut Context,
    node: Node<'_, '_>,
) -> Result<Option<(Road, RoadLines)>, ReadError> {
    let mut road = Road {
        id: context.text(node, "id")?,
        name: text_or_empty(node, "name"),
        length_m: context.number(node, "length")?,
        junction: node.attribute("junction").filter(|j| *j != "-1" && !j.is_empty()).map(str::to_owned),
        rule: context.word(node, "rule", TrafficRule::from_xml),
        ..Road::default()
    };
    let mut lines = RoadLines { road: context.line(node), ..RoadLines::default() };
    for child in elements(node) {
        match child.tag_name().name() {
            "link" => links(context, child, &mut road)?,
            "type" => {
                let kind = road_type(context, child);
                road.types.push(kind);
            }
            "planView" => road.plan_view = plan_view(context, child, &mut lines.geometry)?,
            "elevationProfile" => {
                road.elevation = cubics(context, child, "elevation", "s")?;
                for other in elements(child).filter(|n| n.tag_name().name() != "elevation") {
                    context.unknown(other);
                }
            }
            "lateralProfile" => lateral(context, child, &mut road)?,
            "lanes" => {
                road.lane_offset = cubics(context, child, "laneOffset", "s")?;
                lanes::sections(context, child, &mut road, &mut lines.sections)?;
            }
            "objects" => objects::objects(context, child, &mut road, &mut lines.objects)?,
            "signals" => signals::signals(context, child, &mut road, &mut lines.signals)?,
            "railroad" => structures::railroad(context, child, &mut road)?,
            _ => road.kept.extend(context.kept(child, &["surface"])),
        }
    }
    if road.plan_view.is_empty() || road.length_m <= 0.0 {
        context.warn(node, None, "road without geometry or length: left out");
        return Ok(None);
    }
    if let Some((s, what)) = super::check::absurdity(&road) {
        context.warn(node, Some(s), format!("{what} is beyond all measure here: the road is left out"));
        return Ok(None);
    }
    if road.sections.is_empty() {
        context.warn(node, None, "road without lane sections");
    }
    context.sort_by_s(node, "type", &mut road.types, |t| t.s);
    Ok(Some((road, lines)))
}

fn road_type(context: &mut Context, node: Node<'_, '_>) -> RoadType {
    let mut kind = RoadType {
        s: context.number_or_zero(node, "s"),
        kind: text_or_empty(node, "type"),
        speed: None,
        country: text_or_empty(node, "country"),
    };
    for child in elements(node) {
        if child.tag_name().name() == "speed" {
            kind.speed = kind.speed.or(speed(context, child));
        } else {
            context.unknown(child);
        }
    }
    kind
}

fn links(context: &mut Context, node: Node<'_, '_>, road: &mut Road) -> Result<(), ReadError> {
    for child in elements(node) {
        match child.tag_name().name() {
            "predecessor" => road.predecessor = link(context, child),
            "successor" => road.successor = link(context, child),
            "neighbor" => road.neighbours.push(Neighbour {
                side: context.word(child, "side", RoadSide::from_xml),
                id: context.text(child, "elementId")?,
                direction: context.word(child, "direction", NeighbourDirection::from_xml),
            }),
            _ => context.unknown(child),
        }
    }
    Ok(())
}

/// A `predecessor` or `successor` element; none where it does not say what it means, which is noted.
pub(super) fn link(context: &mut Context, node: Node<'_, '_>) -> Option<RoadLink> {
    let end = node.tag_name().name();
    let Some(id) = node.attribute("elementId").map(str::to_owned) else {
        context.warn(node, None, format!("<{end}> has no elementId: ignored"));
        return None;
    };
    match node.attribute("elementType") {
        Some("junction") => Some(RoadLink::Junction { id }),
        Some("road") | None => {
            if let Some(contact) = node.attribute("contactPoint").and_then(ContactPoint::from_xml) {
                return Some(RoadLink::Road { id, contact });
            }
            if let Some(s) = context.maybe_number(node, "elementS") {
                let direction = context.word(node, "elementDir", TrackDirection::from_xml);
                return Some(RoadLink::Along { id, s, direction });
            }
            context.warn(node, None, format!("<{end}> has no contactPoint: ignored"));
            None
        }
        Some(other) => {
            context.warn(node, None, format!("<{end}> elementType=\"{other}\" is unknown: ignored"));
            None
        }
    }
}

fn lateral(context: &mut Context, node: Node<'_, '_>, road: &mut Road) -> Result<(), ReadError> {
    road.superelevation = cubics(context, node, "superelevation", "s")?;
    for child in elements(node) {
        match child.tag_name().name() {
            "superelevation" => {}
            "crossfall" => road.crossfall.push(Crossfall {
                side: context.word(child, "side", RoadSide::from_xml),
                angle_rad: cubic(context, child, "s")?,
            }),
            "shape" => {
                let s = context.number(child, "s")?;
                road.shape.push(Shape { s, cubic_of_t: cubic(context, child, "t")? });
            }
            "crossSectionSurface" => {
                road.cross_section_surface.extend(context.kept(child, &["crossSectionSurface"]));
            }
            _ => context.unknown(child),
        }
    }
    context.sort_by_s(node, "crossfall", &mut road.crossfall, |c| c.angle_rad.s);
    road.shape.sort_by(|a, b| a.s.total_cmp(&b.s).then(a.cubic_of_t.s.total_cmp(&b.cubic_of_t.s)));
    Ok(())
}

/// The pieces of a `planView` element in order, with the line of each.
pub(super) fn plan_view(
    context: &mut Context,
    node: Node<'_, '_>,
    lines: &mut Vec<u32>,
) -> Result<Vec<Geometry>, ReadError> {
    let mut pieces = Vec::new();
    for child in elements(node) {
        if child.tag_name().name() == "geometry" {
            if let Some(piece) = geometry(context, child)? {
                pieces.push((piece, context.line(child)));
            }
        } else {
            context.unknown(child);
        }
    }
    context.sort_by_s(node, "geometry", &mut pieces, |(g, _)| g.s);
    let (pieces, piece_lines) = pieces.into_iter().unzip();
    *lines = piece_lines;
    Ok(pieces)
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
    let mut found = false;
    for child in elements(node) {
        piece.curve = match child.tag_name().name() {
            "line" => Curve::Line,
            "arc" => Curve::Arc { curvature: context.number(child, "curvature")? },
            "spiral" => Curve::Spiral {
                curvature_start: context.number(child, "curvStart")?,
                curvature_end: context.number(child, "curvEnd")?,
            },
            "poly3" => Curve::Poly3 { v: coefficients(context, child, ["a", "b", "c", "d"])? },
            "paramPoly3" => parametric(context, child, piece.length_m)?,
            _ => {
                context.unknown(child);
                continue;
            }
        };
        found = true;
    }
    if !found {
        context.warn(node, Some(piece.s), "geometry of unknown kind: taken as a line");
    }
    Ok(Some(piece))
}

fn parametric(context: &Context, node: Node<'_, '_>, length_m: f64) -> Result<Curve, ReadError> {
    const U: [&str; 4] = ["aU", "bU", "cU", "dU"];
    let normalised = node.attribute("pRange") != Some("arcLength");
    let mut u = coefficients(context, node, U)?;
    if !U.iter().any(|name| node.has_attribute(*name)) {
        // Without coefficients nothing moves; a straight piece of the stated length is the only sense.
        u = [0.0, if normalised { length_m } else { 1.0 }, 0.0, 0.0];
    }
    Ok(Curve::ParamPoly3 { u, v: coefficients(context, node, ["aV", "bV", "cV", "dV"])?, normalised })
}

/// Four numbers, 0 where absent.
fn coefficients(context: &Context, node: Node<'_, '_>, names: [&str; 4]) -> Result<[f64; 4], ReadError> {
    let mut values = [0.0; 4];
    for (value, name) in values.iter_mut().zip(names) {
        if node.has_attribute(name) {
            *value = context.number(node, name)?;
        }
    }
    Ok(values)
}
