//! Writes objects.

use std::fmt::Display;

use super::signals::{validity, with_validity};
use super::structures;
use super::xml::{Attributes, Xml, if_true, maybe, unless_empty};
use crate::model::{
    Corner, CornerReference, Object, ObjectBorder, ObjectMarking, ObjectReference, Outline, Repeat, Road,
    SkeletonVertex,
};

pub(super) fn objects(xml: &mut Xml, road: &Road) {
    let nothing = road.objects.is_empty()
        && road.object_references.is_empty()
        && road.bridges.is_empty()
        && road.tunnels.is_empty();
    if nothing {
        return;
    }
    xml.open("objects", &[]);
    road.objects.iter().for_each(|o| object(xml, o));
    road.object_references.iter().for_each(|r| reference(xml, r));
    structures::bridges_and_tunnels(xml, road);
    xml.close();
}

fn object(xml: &mut Xml, object: &Object) {
    let orientation = object.orientation.xml();
    let mut attributes: Attributes<'_> = vec![
        ("id", &object.id),
        ("name", &object.name),
        ("type", &object.kind),
        ("subtype", &object.subtype),
        ("s", &object.s),
        ("t", &object.t),
        ("zOffset", &object.z_offset_m),
        ("hdg", &object.hdg_rad),
        ("pitch", &object.pitch_rad),
        ("roll", &object.roll_rad),
        ("orientation", &orientation),
    ];
    maybe(&mut attributes, "length", &object.length_m);
    maybe(&mut attributes, "width", &object.width_m);
    maybe(&mut attributes, "height", &object.height_m);
    maybe(&mut attributes, "radius", &object.radius_m);
    maybe(&mut attributes, "validLength", &object.valid_length_m);
    if object.dynamic {
        attributes.push(("dynamic", &"yes"));
    }
    if_true(&mut attributes, "perpToRoad", object.perpendicular);
    xml.open("object", &attributes);
    object.repeats.iter().for_each(|r| repeat(xml, r));
    outlines(xml, &object.outlines);
    skeleton(xml, object);
    for material in &object.materials {
        let paint = material.paint.map(|c| c.xml());
        let mut attributes: Attributes<'_> = Vec::new();
        unless_empty(&mut attributes, "surface", &material.surface);
        maybe(&mut attributes, "friction", &material.friction);
        maybe(&mut attributes, "roughness", &material.roughness);
        maybe(&mut attributes, "roadMarkColor", &paint);
        xml.leaf("material", &attributes);
    }
    validity(xml, &object.validity);
    if let Some(parking) = &object.parking {
        xml.leaf("parkingSpace", &[("access", &parking.access), ("restrictions", &parking.restrictions)]);
    }
    if !object.markings.is_empty() {
        xml.open("markings", &[]);
        object.markings.iter().for_each(|m| marking(xml, m, &object.outlines));
        xml.close();
    }
    if !object.borders.is_empty() {
        xml.open("borders", &[]);
        object.borders.iter().for_each(|b| border(xml, b, &object.outlines));
        xml.close();
    }
    xml.kept(&object.kept);
    xml.close();
}

/// Id of an outline's first corner: corners are numbered through all outlines, so that references are
/// unambiguous.
fn first_corner_id(outlines: &[Outline], outline: usize) -> usize {
    outlines.iter().take(outline).map(|o| o.corners.len()).sum()
}

fn outlines(xml: &mut Xml, outlines: &[Outline]) {
    if outlines.is_empty() {
        return;
    }
    xml.open("outlines", &[]);
    for (i, outline) in outlines.iter().enumerate() {
        let lane_type = outline.lane_type.map(|t| t.xml());
        let mut attributes: Attributes<'_> =
            vec![("id", &i), ("closed", &outline.closed), ("outer", &outline.outer)];
        unless_empty(&mut attributes, "fillType", &outline.fill);
        maybe(&mut attributes, "laneType", &lane_type);
        xml.open("outline", &attributes);
        let first = first_corner_id(outlines, i);
        for (k, corner) in outline.corners.iter().enumerate() {
            let (name, place, height) = place(corner);
            let id = first + k;
            let mut attributes: Attributes<'_> = vec![("id", &id)];
            attributes.extend(place);
            attributes.push(("height", height));
            xml.leaf(name, &attributes);
        }
        xml.close();
    }
    xml.close();
}

/// Name of a corner's element, its coordinates and its height.
fn place(corner: &Corner) -> (&'static str, [(&'static str, &dyn Display); 3], &f64) {
    match corner {
        Corner::Local { u_m, v_m, z_m, height_m } => {
            ("cornerLocal", [("u", u_m), ("v", v_m), ("z", z_m)], height_m)
        }
        Corner::Road { s, t, dz_m, height_m } => ("cornerRoad", [("s", s), ("t", t), ("dz", dz_m)], height_m),
    }
}

fn skeleton(xml: &mut Xml, object: &Object) {
    if object.skeleton.is_empty() {
        return;
    }
    xml.open("skeleton", &[]);
    for (i, line) in object.skeleton.iter().enumerate() {
        xml.open("polyline", &[("id", &i)]);
        line.vertices.iter().enumerate().for_each(|(k, v)| vertex(xml, k, v));
        xml.close();
    }
    xml.close();
}

fn vertex(xml: &mut Xml, id: usize, vertex: &SkeletonVertex) {
    let (_, place, _) = place(&vertex.place);
    let name = match vertex.place {
        Corner::Local { .. } => "vertexLocal",
        Corner::Road { .. } => "vertexRoad",
    };
    let mut attributes: Attributes<'_> = vec![("id", &id)];
    attributes.extend(place);
    maybe(&mut attributes, "radius", &vertex.radius_m);
    if_true(&mut attributes, "intersectionPoint", vertex.on_ground);
    xml.leaf(name, &attributes);
}

fn repeat(xml: &mut Xml, repeat: &Repeat) {
    let mut attributes: Attributes<'_> = vec![
        ("s", &repeat.s),
        ("length", &repeat.length_m),
        ("distance", &repeat.distance_m),
        ("tStart", &repeat.t_m[0]),
        ("tEnd", &repeat.t_m[1]),
        ("zOffsetStart", &repeat.z_offset_m[0]),
        ("zOffsetEnd", &repeat.z_offset_m[1]),
    ];
    if let Some([b, c, d]) = &repeat.t_cubic {
        attributes.extend([("bT", b as &dyn Display), ("cT", c), ("dT", d)]);
    }
    let pairs = [
        ("heightStart", "heightEnd", &repeat.height_m),
        ("widthStart", "widthEnd", &repeat.width_m),
        ("lengthStart", "lengthEnd", &repeat.object_length_m),
        ("radiusStart", "radiusEnd", &repeat.radius_m),
    ];
    for (start_name, end_name, pair) in pairs {
        if let Some([start, end]) = pair {
            attributes.extend([(start_name, start as &dyn Display), (end_name, end)]);
        }
    }
    if_true(&mut attributes, "detachFromReferenceLine", repeat.detached);
    xml.leaf("repeat", &attributes);
}

fn marking(xml: &mut Xml, marking: &ObjectMarking, outlines: &[Outline]) {
    let (side, colour) = (marking.side.map(|s| s.xml()), marking.colour.xml());
    let weight = if marking.bold { "bold" } else { "standard" };
    let mut attributes: Attributes<'_> = vec![
        ("color", &colour),
        ("weight", &weight),
        ("zOffset", &marking.z_offset_m),
        ("lineLength", &marking.line_m),
        ("spaceLength", &marking.space_m),
        ("startOffset", &marking.start_offset_m),
        ("stopOffset", &marking.stop_offset_m),
    ];
    maybe(&mut attributes, "side", &side);
    maybe(&mut attributes, "width", &marking.width_m);
    xml.open("marking", &attributes);
    corner_references(xml, &marking.corners, outlines);
    xml.close();
}

fn border(xml: &mut Xml, border: &ObjectBorder, outlines: &[Outline]) {
    let mut attributes: Attributes<'_> =
        vec![("type", &border.kind), ("width", &border.width_m), ("outlineId", &border.outline)];
    if_true(&mut attributes, "useCompleteOutline", border.complete);
    xml.open("border", &attributes);
    corner_references(xml, &border.corners, outlines);
    xml.close();
}

fn corner_references(xml: &mut Xml, corners: &[CornerReference], outlines: &[Outline]) {
    for corner in corners {
        xml.leaf("cornerReference", &[("id", &(first_corner_id(outlines, corner.outline) + corner.corner))]);
    }
}

fn reference(xml: &mut Xml, reference: &ObjectReference) {
    let orientation = reference.orientation.xml();
    let mut attributes: Attributes<'_> =
        vec![("id", &reference.id), ("s", &reference.s), ("t", &reference.t), ("orientation", &orientation)];
    maybe(&mut attributes, "zOffset", &reference.z_offset_m);
    maybe(&mut attributes, "validLength", &reference.valid_length_m);
    with_validity(xml, "objectReference", &attributes, &reference.validity);
}
