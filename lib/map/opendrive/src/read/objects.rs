//! Reads objects.

use roxmltree::Node;

use super::ReadError;
use super::context::{Context, elements, flag, named, text_or_empty};
use super::signals::validity;
use super::structures;
use crate::model::{
    BoxSide, Corner, CornerReference, LaneType, MarkColour, Object, ObjectBorder, ObjectMarking,
    ObjectMaterial, ObjectReference, Orientation, Outline, ParkingSpace, Repeat, Road, SkeletonLine,
    SkeletonVertex,
};

/// The objects of a road, with the line of each.
pub(super) fn objects(
    context: &mut Context,
    node: Node<'_, '_>,
    road: &mut Road,
    lines: &mut Vec<u32>,
) -> Result<(), ReadError> {
    for child in elements(node) {
        match child.tag_name().name() {
            "object" => {
                let object = object(context, child)?;
                if context.sane(child, &numbers(&object)) {
                    road.objects.push(object);
                    lines.push(context.line(child));
                }
            }
            "objectReference" => road.object_references.push(ObjectReference {
                id: context.text(child, "id")?,
                s: context.number(child, "s")?,
                t: context.number_or_zero(child, "t"),
                z_offset_m: context.maybe_number(child, "zOffset"),
                valid_length_m: context.maybe_number(child, "validLength"),
                orientation: context.word(child, "orientation", Orientation::from_xml),
                validity: validity(context, child)?,
            }),
            "bridge" => road.bridges.push(structures::bridge(context, child)?),
            "tunnel" => road.tunnels.push(structures::tunnel(context, child)?),
            _ => context.unknown(child),
        }
    }
    Ok(())
}

/// Every number that has a part in where an object stands and how large it is.
fn numbers(object: &Object) -> Vec<f64> {
    let mut numbers = vec![object.s, object.t, object.z_offset_m, object.hdg_rad];
    numbers.extend([object.length_m, object.width_m, object.height_m, object.radius_m].into_iter().flatten());
    for corner in object.outlines.iter().flat_map(|o| &o.corners) {
        match *corner {
            Corner::Local { u_m: a, v_m: b, z_m: c, height_m: d }
            | Corner::Road { s: a, t: b, dz_m: c, height_m: d } => {
                numbers.extend([a, b, c, d]);
            }
        }
    }
    for repeat in &object.repeats {
        let pairs = [repeat.height_m, repeat.width_m, repeat.object_length_m, repeat.radius_m];
        numbers.extend([repeat.s, repeat.length_m, repeat.distance_m]);
        numbers
            .extend([Some(repeat.t_m), Some(repeat.z_offset_m)].into_iter().chain(pairs).flatten().flatten());
        if let Some([b, c, d]) = repeat.t_cubic {
            let reach = repeat.length_m.abs().max(1.0);
            numbers.extend([b * reach, c * reach * reach, d * reach * reach * reach]);
        }
    }
    numbers
}

/// The ids of an object's outlines and of their corners, as written or counted, for those who refer to them.
#[derive(Default)]
struct OutlineIds {
    outlines: Vec<(u32, Vec<u32>)>,
}

impl OutlineIds {
    /// The corner with an id: of one outline, else of the first that has it.
    fn corner(&self, outline: Option<usize>, id: u32) -> Option<CornerReference> {
        (outline.into_iter().chain(0..self.outlines.len())).find_map(|outline| {
            let (_, corners) = self.outlines.get(outline)?;
            let corner = corners.iter().position(|c| *c == id)?;
            Some(CornerReference { outline, corner })
        })
    }
}

fn object(context: &mut Context, node: Node<'_, '_>) -> Result<Object, ReadError> {
    let mut object = Object {
        id: text_or_empty(node, "id"),
        name: text_or_empty(node, "name"),
        kind: text_or_empty(node, "type"),
        subtype: text_or_empty(node, "subtype"),
        s: context.number(node, "s")?,
        t: context.number(node, "t")?,
        z_offset_m: context.number_or_zero(node, "zOffset"),
        hdg_rad: context.number_or_zero(node, "hdg"),
        pitch_rad: context.number_or_zero(node, "pitch"),
        roll_rad: context.number_or_zero(node, "roll"),
        orientation: context.word(node, "orientation", Orientation::from_xml),
        length_m: context.maybe_number(node, "length"),
        width_m: context.maybe_number(node, "width"),
        height_m: context.maybe_number(node, "height"),
        radius_m: context.maybe_number(node, "radius"),
        validity: validity(context, node)?,
        valid_length_m: context.maybe_number(node, "validLength"),
        dynamic: flag(node, "dynamic"),
        perpendicular: flag(node, "perpToRoad"),
        ..Object::default()
    };
    let mut ids = OutlineIds::default();
    // Markings inside outlines, with the index of theirs; they may refer to corners that come later.
    let mut inner_markings = Vec::new();
    for wrapper in named(node, "outlines").chain([node]) {
        for child in named(wrapper, "outline") {
            let Some((outline, id, corners)) = outline(context, child, ids.outlines.len())? else { continue };
            inner_markings.extend(named(child, "markings").map(|n| (n, ids.outlines.len())));
            object.outlines.push(outline);
            ids.outlines.push((id, corners));
        }
    }
    for child in elements(node) {
        match child.tag_name().name() {
            "outline" | "outlines" | "validity" => {}
            "repeat" => {
                let repeat = repeat(context, child, &object)?;
                object.repeats.push(repeat);
            }
            "parkingSpace" => {
                object.parking = Some(ParkingSpace {
                    access: text_or_empty(child, "access"),
                    restrictions: text_or_empty(child, "restrictions"),
                });
                elements(child).for_each(|n| context.unknown(n));
            }
            "material" => object.materials.push(ObjectMaterial {
                surface: text_or_empty(child, "surface"),
                friction: context.maybe_number(child, "friction"),
                roughness: context.maybe_number(child, "roughness"),
                paint: child.attribute("roadMarkColor").and_then(MarkColour::from_xml),
            }),
            "borders" => {
                for inner in named(child, "border") {
                    let border = border(context, inner, &ids);
                    object.borders.push(border);
                }
            }
            "markings" => markings(context, child, &ids, None, &mut object.markings),
            "skeleton" => {
                for inner in named(child, "polyline") {
                    let line = polyline(context, inner)?;
                    object.skeleton.push(line);
                }
            }
            _ => object.kept.extend(context.kept(child, &["surface"])),
        }
    }
    for (markings_node, outline) in inner_markings {
        markings(context, markings_node, &ids, Some(outline), &mut object.markings);
    }
    Ok(object)
}

/// An outline with its id and those of its corners; none without corners.
fn outline(
    context: &mut Context,
    node: Node<'_, '_>,
    index: usize,
) -> Result<Option<(Outline, u32, Vec<u32>)>, ReadError> {
    let no = |name| matches!(node.attribute(name).map(str::trim), Some("false" | "0"));
    let mut outline = Outline {
        closed: !no("closed"),
        outer: !no("outer"),
        fill: text_or_empty(node, "fillType"),
        lane_type: node.attribute("laneType").and_then(|t| LaneType::from_xml(t.trim())),
        corners: Vec::new(),
    };
    let mut ids = Vec::new();
    for child in elements(node) {
        let corner = match child.tag_name().name() {
            "cornerLocal" => local(context, child)?,
            "cornerRoad" => on_road(context, child)?,
            "markings" => continue,
            _ => {
                context.unknown(child);
                continue;
            }
        };
        ids.push(id_of(child, "id").unwrap_or(ids.len() as u32));
        outline.corners.push(corner);
    }
    if outline.corners.is_empty() {
        context.warn(node, None, "outline without corners: left out");
        return Ok(None);
    }
    Ok(Some((outline, id_of(node, "id").unwrap_or(index as u32), ids)))
}

fn id_of(node: Node<'_, '_>, name: &str) -> Option<u32> {
    node.attribute(name)?.trim().parse().ok()
}

fn local(context: &mut Context, node: Node<'_, '_>) -> Result<Corner, ReadError> {
    Ok(Corner::Local {
        u_m: context.number(node, "u")?,
        v_m: context.number(node, "v")?,
        z_m: context.number_or_zero(node, "z"),
        height_m: context.number_or_zero(node, "height"),
    })
}

fn on_road(context: &mut Context, node: Node<'_, '_>) -> Result<Corner, ReadError> {
    Ok(Corner::Road {
        s: context.number(node, "s")?,
        t: context.number(node, "t")?,
        dz_m: context.number_or_zero(node, "dz"),
        height_m: context.number_or_zero(node, "height"),
    })
}

fn repeat(context: &mut Context, node: Node<'_, '_>, object: &Object) -> Result<Repeat, ReadError> {
    let mut pair = |start: &str, end: &str| {
        let first = context.maybe_number(node, start);
        let last = context.maybe_number(node, end);
        first.or(last).map(|value| [value, last.unwrap_or(value)])
    };
    let t = pair("tStart", "tEnd").unwrap_or([object.t; 2]);
    let z_offset = pair("zOffsetStart", "zOffsetEnd").unwrap_or([object.z_offset_m; 2]);
    let height = pair("heightStart", "heightEnd");
    let width = pair("widthStart", "widthEnd");
    let object_length = pair("lengthStart", "lengthEnd");
    let radius = pair("radiusStart", "radiusEnd");
    let cubic = ["bT", "cT", "dT"].map(|name| context.maybe_number(node, name));
    Ok(Repeat {
        s: context.number(node, "s")?,
        length_m: context.number(node, "length")?,
        distance_m: context.number_or_zero(node, "distance"),
        t_m: t,
        t_cubic: cubic.iter().any(Option::is_some).then(|| cubic.map(|c| c.unwrap_or(0.0))),
        z_offset_m: z_offset,
        height_m: height,
        width_m: width,
        object_length_m: object_length,
        radius_m: radius,
        detached: flag(node, "detachFromReferenceLine"),
    })
}

/// The corners that a border or marking refers to.
fn corners(
    context: &mut Context,
    node: Node<'_, '_>,
    ids: &OutlineIds,
    outline: Option<usize>,
) -> Vec<CornerReference> {
    let mut found = Vec::new();
    for child in elements(node) {
        if child.tag_name().name() != "cornerReference" {
            context.unknown(child);
            continue;
        }
        match id_of(child, "id").and_then(|id| ids.corner(outline, id)) {
            Some(corner) => found.push(corner),
            None => context.warn(child, None, "no outline has the corner that is meant: ignored"),
        }
    }
    found
}

fn border(context: &mut Context, node: Node<'_, '_>, ids: &OutlineIds) -> ObjectBorder {
    let id = id_of(node, "outlineId").unwrap_or(0);
    let outline = ids.outlines.iter().position(|(outline, _)| *outline == id);
    if outline.is_none() {
        context.warn(node, None, format!("<border> names outline {id}, which does not exist"));
    }
    ObjectBorder {
        kind: text_or_empty(node, "type"),
        width_m: context.number_or_zero(node, "width"),
        outline: outline.unwrap_or(0),
        complete: flag(node, "useCompleteOutline"),
        corners: corners(context, node, ids, outline),
    }
}

fn markings(
    context: &mut Context,
    node: Node<'_, '_>,
    ids: &OutlineIds,
    outline: Option<usize>,
    found: &mut Vec<ObjectMarking>,
) {
    for child in elements(node) {
        if child.tag_name().name() != "marking" {
            context.unknown(child);
            continue;
        }
        found.push(ObjectMarking {
            side: child.attribute("side").and_then(|side| BoxSide::from_xml(side.trim())),
            corners: corners(context, child, ids, outline),
            colour: context.word(child, "color", MarkColour::from_xml),
            bold: child.attribute("weight") == Some("bold"),
            width_m: context.maybe_number(child, "width"),
            z_offset_m: context.number_or_zero(child, "zOffset"),
            line_m: context.number_or_zero(child, "lineLength"),
            space_m: context.number_or_zero(child, "spaceLength"),
            start_offset_m: context.number_or_zero(child, "startOffset"),
            stop_offset_m: context.number_or_zero(child, "stopOffset"),
        });
    }
}

fn polyline(context: &mut Context, node: Node<'_, '_>) -> Result<SkeletonLine, ReadError> {
    let mut line = SkeletonLine::default();
    for child in elements(node) {
        let place = match child.tag_name().name() {
            "vertexLocal" => local(context, child)?,
            "vertexRoad" => on_road(context, child)?,
            _ => {
                context.unknown(child);
                continue;
            }
        };
        line.vertices.push(SkeletonVertex {
            place,
            radius_m: context.maybe_number(child, "radius"),
            on_ground: flag(child, "intersectionPoint"),
        });
    }
    Ok(line)
}
