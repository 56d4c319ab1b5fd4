use std::f64::consts::FRAC_PI_2;

use super::*;

/// A box of 4 x 2 x 1.5 m on the ground at (10, 20, 3), turned to the left, as the layout has it.
fn item(more: &[(&str, Value)]) -> Value {
    let sign = |k: usize, bit: usize| if k & bit == 0 { -1.0 } else { 1.0 };
    let corner = |k: usize| [10.0 + sign(k, 2), 20.0 + 2.0 * sign(k, 4), 3.75 + 0.75 * sign(k, 1)];
    let vector = |v: [f64; 3]| Value::Numbers { shape: vec![3], values: v.to_vec() };
    let text = |text: &str| Value::Text(text.to_owned());
    let facts = [("role_name", "npc_vehicle_3"), ("color", "1,2,255"), ("base_type", "car")];
    let mut entries = vec![
        ("id", Value::Int(300)),
        ("type", text("vehicle.car.sedan")),
        ("is_alive", Value::Bool(true)),
        ("is_active", Value::Bool(true)),
        ("is_dormant", Value::Bool(false)),
        ("parent", Value::None),
        ("attributes", Value::Dict(facts.map(|(k, v)| (k.to_owned(), text(v))).to_vec())),
        ("rotation", vector([0.0, 0.0, 90.0])),
        ("linear_velocity", vector([0.0, 5.5, 0.0])),
        ("angular_velocity", vector([-180.0, 0.0, 90.0])),
        ("semantic_tags", Value::List(vec![Value::Int(14)])),
        ("bounding_box", Value::Numbers { shape: vec![8, 3], values: (0..8).flat_map(corner).collect() }),
        ("distance_to_ego", Value::Float(12.5)),
        ("angle_to_ego", Value::Float(-90.0)),
    ];
    for (key, value) in more {
        entries.retain(|(known, _)| known != key);
        entries.push((key, value.clone()));
    }
    Value::Dict(entries.into_iter().map(|(k, v)| (k.to_owned(), v)).collect())
}

/// A box as it is read.
pub(crate) fn car() -> Labelled {
    labelled(&item(&[]), false).expect("a box")
}

#[test]
fn a_car_is_read_in_radians_with_right_handed_rates() {
    let car = car();
    assert_eq!((car.id, car.class, car.model.as_str()), (300, DetectionClass::Car, "car.sedan"));
    assert_eq!((car.center_m(), car.foot_m()), ([10.0, 20.0, 3.75], [10.0, 20.0, 3.0]));
    assert_eq!(car.size_m(), [4.0, 2.0, 1.5]);
    assert_eq!(car.rpy_rad, [0.0, 0.0, FRAC_PI_2]);
    assert_eq!(car.angular_velocity_radps, [std::f32::consts::PI, 0.0, std::f32::consts::FRAC_PI_2]);
    assert_eq!((car.distance_m, car.angle_rad), (12.5, Some(-FRAC_PI_2)));
    assert_eq!((car.role_name.as_str(), car.color.as_slice()), ("npc_vehicle_3", [1, 2, 255].as_slice()));
    assert_eq!(car.attributes.to_string(), r#"{"base_type":"car"}"#);
    assert!(car.seen.is_none());
    let own = labelled(&item(&[("angle_to_ego", Value::Float(f64::NAN))]), false).expect("a box");
    assert_eq!(own.angle_rad, None);
}

#[test]
fn lights_and_scenery_are_what_a_store_says_of_them() {
    let text = |text: &str| Value::Text(text.to_owned());
    let facts =
        |pairs: &[(&str, &str)]| Value::Dict(pairs.iter().map(|(k, v)| ((*k).to_owned(), text(v))).collect());
    let light = item(&[
        ("semantic_tags", Value::List(vec![Value::Int(7)])),
        ("type", text("traffic.traffic_light")),
        ("attributes", facts(&[])),
        ("state", text("Green")),
        ("green_time", Value::Float(11.5)),
        ("opendrive_id", text("285")),
        ("pole_index", Value::Int(2)),
    ]);
    let light = labelled(&light, false).expect("a box");
    assert_eq!(
        (light.is_alive, light.is_active, light.signal_state),
        (false, false, Some(SignalState::Green))
    );
    assert_eq!((light.model.as_str(), light.opendrive_id.as_deref()), ("traffic_light", Some("285")));
    assert_eq!(light.attributes.to_string(), r#"{"green_time":"11.5","pole_index":"2"}"#);
    let sign = item(&[
        ("semantic_tags", Value::List(vec![Value::Int(8)])),
        ("type", text("TrafficSigns")),
        ("is_alive", Value::Bool(false)),
        ("attributes", facts(&[("model", "sign.yield"), ("opendrive_id", "3"), ("value", "5")])),
        ("sign_type", text("yield")),
    ]);
    let sign = labelled(&sign, false).expect("a box");
    assert_eq!((sign.model.as_str(), sign.opendrive_id.as_deref()), ("sign.yield", Some("3")));
    assert_eq!(sign.attributes.to_string(), r#"{"sign_type":"yield","value":"5"}"#);
}

#[test]
fn what_no_store_can_hold_is_refused_by_name() {
    let list = |items: Vec<Value>| Value::List(items);
    let nan = Value::Numbers { shape: vec![3], values: vec![0.0, f64::NAN, 0.0] };
    for (key, value) in [
        ("id", Value::Float(1.0)),
        ("type", Value::None),
        ("semantic_tags", list(vec![Value::Int(32)])),
        ("semantic_tags", list(vec![Value::Int(1)])),
        ("bounding_box", nan.clone()),
        ("rotation", nan.clone()),
        ("linear_velocity", nan),
        ("distance_to_ego", Value::Float(f64::NAN)),
        ("angle_to_ego", Value::Float(1e9)),
        ("attributes", Value::Dict(vec![("a".into(), Value::Int(1))])),
        ("is_alive", Value::Int(1)),
    ] {
        let error = labelled(&item(&[(key, value)]), false).expect_err("refused").to_string();
        assert!(error.contains(&format!("`{key}`")), "{key}: {error}");
    }
    let error = labelled(&item(&[]), true).expect_err("refused").to_string();
    assert_eq!(error, "object 300: has no such `class` as a store can hold");
    let error = boxes(&list(vec![item(&[]), item(&[])]), false).expect_err("refused").to_string();
    assert_eq!(error, "box 1: object 300 is there twice");
    assert_eq!(boxes(&Value::Int(3), false).expect_err("refused").to_string(), "is no list of boxes");
    let none = Value::Numbers { shape: vec![0], values: vec![] };
    assert_eq!(boxes(&none, false).expect("a list"), []);
}

#[test]
fn what_was_seen_is_kept() {
    let seen = item(&[
        ("num_lidar_pts", Value::Int(5)),
        ("num_radar_pts", Value::Int(0)),
        ("valid_flag", Value::Bool(true)),
        ("class", Value::Text("car".into())),
        ("difficulty", Value::Text("hard".into())),
    ]);
    let seen = labelled(&seen, true).expect("a box").seen.expect("was seen");
    assert_eq!((seen.num_lidar_pts, seen.num_radar_pts, seen.valid_flag), (5, 0, true));
}
