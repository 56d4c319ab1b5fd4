//! The objects that an agent lists.

use nalgebra::Vector3;
use scene::LabelledBox;
use schema::tables::BoxRow;
use schema::{Attribute, DetectionClass, Tag};
use serde_json::Value;

use super::handedness::{LeftPose, left, left_angles, turned_away};
use super::options::{Options, Variant};
use super::record::{map, number, numbers};
use super::roster::FIRST_NAME;

/// Kilometres an hour.
pub(super) fn kmh(velocity_mps: [f64; 3]) -> f64 {
    3.6 * Vector3::from(velocity_mps).norm()
}

/// The type that V2X-Real's loaders know objects of a class by; none where they know none. Those that they do
/// not know are dropped by them without a word.
pub(super) fn type_of(class: DetectionClass) -> Option<&'static str> {
    Some(match class {
        DetectionClass::Car => "Car",
        DetectionClass::Truck => "Truck",
        DetectionClass::Bus => "Bus",
        DetectionClass::Pedestrian => "Pedestrian",
        DetectionClass::Motorcycle => "Motorcycle",
        // A bicycle is known with a rider only.
        DetectionClass::Bicycle => "BicycleRider",
        _ => return None,
    })
}

/// The same of a box, told more closely.
fn type_of_box(raw: &BoxRow, class: DetectionClass) -> Option<&'static str> {
    let is_ridden = raw.semantic_tags.contains(&(Tag::Rider as u8));
    Some(match class {
        DetectionClass::Truck if raw.attributes.get(&Attribute::BaseType) == Some("van") => "Van",
        // Spelt as the loaders spell it.
        DetectionClass::Motorcycle if is_ridden => "MotorcyleRider",
        other => type_of(other)?,
    })
}

/// The class of a box, if boxes of it are listed.
pub(super) fn listed_class(raw: &BoxRow, options: &Options) -> Option<DetectionClass> {
    DetectionClass::from_name(&raw.class).filter(|class| options.shared().classes.contains(class))
}

/// The middle of a box's bottom face, metres, world.
fn bottom_m(raw: &BoxRow) -> Vector3<f64> {
    let corners = raw.corners_m.as_chunks::<3>().0;
    [0, 2, 4, 6].map(|at: usize| Vector3::from(corners[at])).iter().sum::<Vector3<f64>>() / 4.0
}

/// The objects of an agent's list of which it has a point, by name. Lidars are those of all agents: none of
/// them may see an object from behind along its own axis ([`turned_away`]).
pub(super) fn listed<'a>(
    own: impl Iterator<Item = &'a LabelledBox>,
    options: &Options,
    lidars: &[LeftPose],
) -> Vec<(String, Value)> {
    let mut found = Vec::new();
    for LabelledBox { raw, seen } in own {
        let Some(class) = listed_class(raw, options) else { continue };
        if seen.as_ref().is_some_and(|seen| seen.num_lidar_pts > 0) {
            let name = (FIRST_NAME + i64::from(raw.id)).to_string();
            found.push((name, entry(raw, class, options.variant, lidars)));
        }
    }
    found
}

/// What is said of an object. Loaders add `location` and `center` in the axes of the world.
fn entry(raw: &BoxRow, class: DetectionClass, variant: Variant, lidars: &[LeftPose]) -> Value {
    let location = bottom_m(raw);
    let center = Vector3::from(raw.center_m) - location;
    let of_type = (variant == Variant::V2xReal).then(|| type_of_box(raw, class)).flatten();
    let fields = [
        ("angle", numbers(turned_away(left_angles(raw.rpy_rad), lidars))),
        ("center", numbers(left(center.into()))),
        ("extent", numbers(raw.size_m.map(|side| 0.5 * side))),
        ("location", numbers(left(location.into()))),
        ("speed", number(kmh(raw.velocity_mps.map(f64::from)))),
    ];
    map(fields.into_iter().chain(of_type.map(|name| ("obj_type", name.into()))))
}

#[cfg(test)]
mod tests {
    use frames::{Object, OrientedBox, Pose, World, deg};
    use schema::Attributes;
    use schema::tables::ValidBoxRow;

    use super::*;
    use crate::command::usual;
    use crate::opv2v::record::to_json;

    /// A box of 4 x 2 x 1.5 m on a slope of 10 degrees, seen by some points.
    fn car(class: &str, num_lidar_pts: u32) -> LabelledBox {
        let rpy_rad = [0.0, deg(10.0), deg(30.0)];
        let pose = Pose::<World, Object>::from_xyz_rpy([100.0, 50.0, 7.0], rpy_rad);
        let bounds = OrientedBox::standing(pose, 4.0, 2.0, 1.5);
        let mut corners_m = [0.0; 24];
        for (to, corner) in corners_m.as_chunks_mut::<3>().0.iter_mut().zip(bounds.corners()) {
            *to = corner.coords.into();
        }
        let raw = BoxRow {
            id: 41,
            class: class.into(),
            corners_m,
            center_m: bounds.centre().coords.into(),
            size_m: [4.0, 2.0, 1.5],
            rpy_rad,
            velocity_mps: [3.0, 4.0, 0.0],
            ..BoxRow::default()
        };
        LabelledBox { raw, seen: Some(ValidBoxRow { num_lidar_pts, ..ValidBoxRow::default() }) }
    }

    fn json(rows: &[LabelledBox], options: &Options) -> Vec<(String, String)> {
        let listed = listed(rows.iter(), options, &[]);
        let text = |value| String::from_utf8(to_json(value)).expect("is text");
        listed.iter().map(|(name, value)| (name.clone(), text(value))).collect()
    }

    #[test]
    fn a_car_by_hand() {
        let found = json(
            &[car("car", 1), car("car", 0), car("pedestrian", 5)],
            &Options::new(Variant::Opv2v, usual()),
        );
        // From its footprint the middle is 0.75 m along its own up, which leans forward by sin 10 degrees.
        let lean = 0.75 * 0.173_648_178;
        let center =
            [lean * 0.866_025_404, -lean * 0.5, 0.75 * 0.984_807_753].map(|v: f64| (v * 1e6).round() / 1e6);
        let expected = format!(
            r#"{{"angle":[0.0,-30.0,-10.0],"center":[{},{},{}],"extent":[2.0,1.0,0.75],"location":[100.0,-50.0,7.0],"speed":18.0}}"#,
            center[0], center[1], center[2]
        );
        assert_eq!(found, [("10041".to_owned(), expected)]);
    }

    #[test]
    fn v2x_real_knows_types() {
        let options = Options::new(Variant::V2xReal, usual());
        let type_of = |row: LabelledBox| {
            let found = listed([&row].into_iter(), &options, &[]);
            found.first().and_then(|(_, value)| value["obj_type"].as_str()).map(str::to_owned)
        };
        for (class, expected) in [
            ("car", Some("Car")),
            ("truck", Some("Truck")),
            ("bus", Some("Bus")),
            ("pedestrian", Some("Pedestrian")),
            ("motorcycle", Some("Motorcycle")),
            ("bicycle", Some("BicycleRider")),
            ("traffic_cone", None),
        ] {
            assert_eq!(type_of(car(class, 3)).as_deref(), expected, "{class}");
        }
        let mut ridden = car("motorcycle", 3);
        ridden.raw.semantic_tags = vec![Tag::Rider as u8, Tag::Motorcycle as u8];
        assert_eq!(type_of(ridden).as_deref(), Some("MotorcyleRider"));
        let mut van = car("truck", 3);
        van.raw.attributes = Attributes::new().with(Attribute::BaseType, "van");
        assert_eq!(type_of(van).as_deref(), Some("Van"));
    }
}
