//! Boxes as records of the layout.

use std::collections::BTreeMap;

use schema::difficulty::difficulty_of;
use schema::tables::{ActorRow, BoxRow, ValidBoxRow};
use schema::{ActorKind, ActorRole, AgentId, Attribute, DetectionClass, SignalState};

use super::pickle::{Record, Value};

schema::columns! {
    /// What boxes do not say of their objects.
    ActorFacts of ActorRow { id: u16, kind: ActorKind, role: ActorRole, color: Vec<u8>, parent: Option<i32> }
}

/// The objects of a scene, by id.
pub(super) struct SceneObjects(BTreeMap<u16, ObjectFacts>);

/// What is known of an object besides its box.
struct ObjectFacts {
    facts: ActorFacts,
    role_name: String,
}

impl SceneObjects {
    /// Of the rows of `log/actors`.
    pub(super) fn new(mut rows: Vec<ActorFacts>) -> Self {
        rows.sort_by_key(|row| row.id);
        let (mut background, mut hazards) = (0, 0);
        let next = |count: &mut u32, word: &str| {
            *count += 1;
            format!("{word}_{}", *count - 1)
        };
        let known = |facts: ActorFacts| {
            let role_name = match (facts.role, facts.kind) {
                (ActorRole::Agent(agent), _) if agent == AgentId::vehicle(0) => "hero".to_owned(),
                (ActorRole::Agent(agent), _) => agent.to_string(),
                (_, ActorKind::Walker) => "npc_walker".to_owned(),
                (ActorRole::Background, ActorKind::Vehicle) => next(&mut background, "npc_vehicle"),
                (ActorRole::Hazard, ActorKind::Vehicle) => next(&mut hazards, "hazard_vehicle"),
                _ => "prop".to_owned(),
            };
            (facts.id, ObjectFacts { facts, role_name })
        };
        Self(rows.into_iter().map(known).collect())
    }

    /// A box before post-processing.
    pub(super) fn raw(&self, row: &BoxRow) -> Record {
        let known = self.0.get(&row.id);
        let class = DetectionClass::from_name(&row.class);
        let is_light = class == Some(DetectionClass::TrafficLight);
        // Traffic lights are actors here and scenery in the store.
        let (alive, active) = (row.is_alive || is_light, row.is_active || is_light);
        let parent = known.and_then(|known| known.facts.parent);
        let mut record: Record = vec![
            ("id", Value::Int(i64::from(row.id))),
            ("type", Value::Text(type_id(row, class))),
            ("is_alive", Value::Bool(alive)),
            ("is_active", Value::Bool(active)),
            ("is_dormant", Value::Bool(row.is_dormant)),
            ("parent", parent.map_or(Value::None, |id| Value::Int(i64::from(id)))),
            ("attributes", Value::Facts(attributes(row, class, known))),
            ("location", Value::Vector(location(row, class))),
            ("rotation", Value::Vector(row.rpy_rad.map(degrees))),
            ("linear_velocity", Value::Vector(row.velocity_mps.map(f64::from))),
            ("angular_velocity", Value::Vector(flipped_deg(row.angular_velocity_radps.map(f64::from)))),
            ("semantic_tags", Value::Ints(row.semantic_tags.iter().map(|&tag| i64::from(tag)).collect())),
            ("bounding_box", Value::Corners(row.corners_m)),
            ("distance_to_ego", Value::Float(row.distance_m)),
            ("angle_to_ego", Value::Float(row.angle_rad.map_or(f64::NAN, degrees))),
        ];
        if is_light {
            say_light(row, &mut record);
        } else if let (false, Some(sign)) = (row.is_alive, row.attributes.get(&Attribute::SignType)) {
            record.push(("sign_type", Value::Text(sign.to_owned())));
        } else if (row.is_alive, class) == (false, Some(DetectionClass::TrafficSign)) {
            record.push(("sign_type", Value::Text(String::new())));
        }
        record
    }
}

/// What post-processing adds to a box.
pub(super) fn processed(mut record: Record, seen: &ValidBoxRow) -> Record {
    say_seen(
        &mut record,
        [seen.num_lidar_pts, seen.num_radar_pts],
        seen.valid_flag,
        &seen.class,
        &seen.difficulty,
    );
    record
}

fn say_seen(record: &mut Record, points: [u32; 2], valid: bool, class: &str, difficulty: &str) {
    record.extend([
        ("num_lidar_pts", Value::Int(i64::from(points[0]))),
        ("num_radar_pts", Value::Int(i64::from(points[1]))),
        ("valid_flag", Value::Bool(valid)),
        ("class", Value::Text(class.to_owned())),
        ("difficulty", Value::Text(difficulty.to_owned())),
    ]);
}

/// The objects of a frame over all agents: the first box of each, points summed up, seen if anybody saw it,
/// its difficulty by points alone.
#[derive(Default)]
pub(super) struct Combined {
    order: Vec<u16>,
    by_id: BTreeMap<u16, Merged>,
}

struct Merged {
    record: Record,
    points: [u32; 2],
    valid: bool,
    class: String,
}

impl Combined {
    /// Adds a box: agents in their order.
    pub(super) fn add(&mut self, raw: &Record, seen: &ValidBoxRow) {
        let merged = self.by_id.entry(seen.id).or_insert_with(|| {
            self.order.push(seen.id);
            let own = |key: &str| matches!(key, "distance_to_ego" | "angle_to_ego");
            let record = raw.iter().filter(|(key, _)| !own(key)).cloned().collect();
            Merged { record, points: [0; 2], valid: false, class: seen.class.clone() }
        });
        merged.points[0] = merged.points[0].saturating_add(seen.num_lidar_pts);
        merged.points[1] = merged.points[1].saturating_add(seen.num_radar_pts);
        merged.valid |= seen.valid_flag;
    }

    /// The records, in the order in which their objects were first met.
    pub(super) fn records(mut self) -> Vec<Record> {
        let merged = self.order.iter().filter_map(|id| self.by_id.remove(id));
        merged
            .map(|Merged { mut record, points, valid, class }| {
                let all = points[0].saturating_add(points[1]);
                say_seen(&mut record, points, valid, &class, difficulty_of(&class, None, all).name());
                record
            })
            .collect()
    }
}

/// An angle of `(-pi, pi]` in degrees from -180 on. What rounding would take to 180 is -180: SimBEV2X's
/// statistics have no bin for it.
fn degrees(rad: f64) -> f64 {
    let degrees = frames::to_deg(rad);
    if degrees > 180.0 - 1e-6 { -180.0 } else { degrees }
}

/// Angular velocities in degrees: their x and y have the opposite sign of a right-handed vector's, z is the
/// yaw rate.
pub(super) fn flipped_deg([x, y, z]: [f64; 3]) -> [f64; 3] {
    [-x, -y, z].map(frames::to_deg)
}

/// Where an object is said to be: the middle of its bottom face, of people that of the body.
fn location(row: &BoxRow, class: Option<DetectionClass>) -> [f64; 3] {
    let opposite = if class == Some(DetectionClass::Pedestrian) { 7 } else { 6 };
    std::array::from_fn(|axis| 0.5 * (row.corners_m[axis] + row.corners_m[3 * opposite + axis]))
}

/// `vehicle.car.coupe`; of scenery the name of its label.
fn type_id(row: &BoxRow, class: Option<DetectionClass>) -> String {
    use DetectionClass::*;
    let own = |prefix: &str| format!("{prefix}.{}", row.model);
    match (class, row.is_alive) {
        (Some(TrafficLight), _) => "traffic.traffic_light".to_owned(),
        (Some(Pedestrian), _) => {
            format!("walker.pedestrian.{}", row.model.strip_prefix("walker.").unwrap_or(&row.model))
        }
        (Some(Car | Truck | Bus | Motorcycle | Bicycle), true) => own("vehicle"),
        (_, true) | (None, false) => own("static.prop"),
        (Some(Car), false) => "Car".to_owned(),
        (Some(Truck), false) => "Truck".to_owned(),
        (Some(Bus), false) => "Bus".to_owned(),
        (Some(Motorcycle), false) => "Motorcycle".to_owned(),
        (Some(Bicycle), false) => "Bicycle".to_owned(),
        (Some(TrafficCone), false) => "TrafficCone".to_owned(),
        (Some(Barrier), false) => "Barrier".to_owned(),
        (Some(TrafficSign), false) => "TrafficSigns".to_owned(),
    }
}

/// The facts of an object, all of them texts. Those of scenery, of which the layout says nothing, have its
/// model first.
fn attributes(
    row: &BoxRow,
    class: Option<DetectionClass>,
    known: Option<&ObjectFacts>,
) -> Vec<(String, String)> {
    let mut facts: Vec<(String, String)> = Vec::new();
    let mut say = |key: &str, value: String| facts.push((key.to_owned(), value));
    if let (true, Some(known)) = (row.is_alive, known) {
        say("role_name", known.role_name.clone());
        let color: Vec<String> = known.facts.color.iter().map(u8::to_string).collect();
        if known.facts.kind == ActorKind::Vehicle && color.len() == 3 {
            say("color", color.join(","));
        }
    }
    if !row.is_alive {
        say("model", row.model.clone());
        if let Some(id) = &row.opendrive_id {
            say("opendrive_id", id.clone());
        }
    }
    // They are an object of texts in every table.
    if let Ok(serde_json::Value::Object(own)) = serde_json::to_value(&row.attributes) {
        for (key, value) in own {
            if let serde_json::Value::String(value) = value {
                say(&key, value);
            }
        }
    }
    // Readers count wheelchairs by this key of every pedestrian.
    if class == Some(DetectionClass::Pedestrian) && row.attributes.get(&Attribute::UseWheelchair).is_none() {
        facts.push((Attribute::UseWheelchair.key().to_owned(), "false".to_owned()));
    }
    facts
}

/// What traffic lights say besides.
fn say_light(row: &BoxRow, record: &mut Record) {
    let number = |attribute: Attribute| row.attributes.get(&attribute).and_then(|text| text.parse().ok());
    let time = |attribute| Value::Float(number(attribute).unwrap_or(0.0));
    let state = match row.signal_state {
        Some(SignalState::Red) => "Red",
        Some(SignalState::Yellow) => "Yellow",
        Some(SignalState::Green) => "Green",
        Some(SignalState::Off) => "Off",
        None => "Unknown",
    };
    let pole: f64 = number(Attribute::PoleIndex).unwrap_or(0.0);
    record.extend([
        ("green_time", time(Attribute::GreenTime)),
        ("yellow_time", time(Attribute::YellowTime)),
        ("red_time", time(Attribute::RedTime)),
        ("state", Value::Text(state.to_owned())),
        ("opendrive_id", Value::Text(row.opendrive_id.clone().unwrap_or_default())),
        ("pole_index", Value::Int(pole as i64)),
    ]);
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    fn get<'a>(record: &'a Record, key: &str) -> &'a Value {
        &record.iter().find(|(name, _)| *name == key).expect("has the key").1
    }

    fn cast() -> SceneObjects {
        let actor = |id, kind, role| ActorFacts { id, kind, role, color: vec![1, 2, 3], parent: None };
        SceneObjects::new(vec![
            actor(9, ActorKind::Vehicle, ActorRole::Background),
            actor(1, ActorKind::Vehicle, ActorRole::Agent(AgentId::vehicle(0))),
            actor(2, ActorKind::Vehicle, ActorRole::Agent(AgentId::vehicle(1))),
            actor(4, ActorKind::Vehicle, ActorRole::Background),
            actor(5, ActorKind::Walker, ActorRole::Walker),
        ])
    }

    /// A car of 4 x 2 x 1.5 m at (10, 20, 3), its corners in the order of the store.
    fn car() -> BoxRow {
        let mut corners_m = [0.0; 24];
        for (i, corner) in corners_m.chunks_exact_mut(3).enumerate() {
            let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
            corner.copy_from_slice(&[10.0 + 2.0 * sign(4), 20.0 - sign(2), 3.75 + 0.75 * sign(1)]);
        }
        BoxRow {
            id: 9,
            class: "car".into(),
            model: "car.sedan".into(),
            semantic_tags: vec![14],
            corners_m,
            rpy_rad: [0.0, 0.0, FRAC_PI_2],
            velocity_mps: [1.0, 2.0, 3.0],
            angular_velocity_radps: [1.0, 2.0, 3.0],
            distance_m: 22.5,
            angle_rad: Some(-FRAC_PI_2),
            is_alive: true,
            is_active: true,
            attributes: r#"{"base_type":"car","reckless":"true"}"#.parse().expect("facts"),
            ..BoxRow::default()
        }
    }

    #[test]
    fn a_car_is_on_the_ground_in_degrees_with_flipped_rates() {
        let record = cast().raw(&car());
        let keys: Vec<&str> = record.iter().map(|(key, _)| *key).collect();
        let expected = "id type is_alive is_active is_dormant parent attributes location rotation linear_velocity \
                        angular_velocity semantic_tags bounding_box distance_to_ego angle_to_ego";
        assert_eq!(keys.join(" "), expected);
        assert_eq!(get(&record, "type"), &Value::Text("vehicle.car.sedan".into()));
        assert_eq!(get(&record, "location"), &Value::Vector([10.0, 20.0, 3.0]));
        assert_eq!(get(&record, "rotation"), &Value::Vector([0.0, 0.0, 90.0]));
        assert_eq!(get(&record, "angle_to_ego"), &Value::Float(-90.0));
        // SimBEV2X sorts into 36 bins of 10 degrees from -180 on by `(angle + 180) // 10`.
        for angle in [PI, PI.next_down(), PI - 1e-9] {
            assert_eq!(degrees(angle), -180.0);
        }
        let below = degrees(PI - 1e-7);
        assert!(below > 179.999 && ((below + 180.0) / 10.0).floor() < 36.0);
        let degrees = 180.0 / std::f64::consts::PI;
        assert_eq!(
            get(&record, "angular_velocity"),
            &Value::Vector([-degrees, -2.0 * degrees, 3.0 * degrees])
        );
        let facts =
            [("role_name", "npc_vehicle_1"), ("color", "1,2,3"), ("base_type", "car"), ("reckless", "true")];
        let facts = facts.map(|(key, value)| (key.to_owned(), value.to_owned())).to_vec();
        assert_eq!(get(&record, "attributes"), &Value::Facts(facts), "the second of the traffic by id");
    }

    #[test]
    fn people_lights_and_scenery_have_their_own_ways() {
        let walker = BoxRow { id: 5, class: "pedestrian".into(), model: "walker.man".into(), ..car() };
        let record = cast().raw(&walker);
        assert_eq!(get(&record, "type"), &Value::Text("walker.pedestrian.man".into()));
        assert_eq!(get(&record, "location"), &Value::Vector([10.0, 20.0, 3.75]), "the middle of the body");
        let Value::Facts(facts) = get(&record, "attributes") else { panic!("facts") };
        assert!(facts.contains(&("use_wheelchair".into(), "false".into())));

        let light = BoxRow {
            class: "traffic_light".into(),
            is_alive: false,
            is_active: false,
            signal_state: Some(SignalState::Green),
            opendrive_id: Some("285".into()),
            attributes: r#"{"green_time":"11.432","pole_index":"2"}"#.parse().expect("facts"),
            ..car()
        };
        let record = cast().raw(&light);
        assert_eq!(get(&record, "is_alive"), &Value::Bool(true), "lights are actors here");
        assert_eq!(get(&record, "green_time"), &Value::Float(11.432));
        assert_eq!(get(&record, "state"), &Value::Text("Green".into()));
        assert_eq!(get(&record, "pole_index"), &Value::Int(2));

        let sign =
            BoxRow { class: "traffic_sign".into(), model: "sign.yield".into(), is_alive: false, ..car() };
        let record = cast().raw(&sign);
        assert_eq!(get(&record, "type"), &Value::Text("TrafficSigns".into()));
        assert_eq!(get(&record, "sign_type"), &Value::Text(String::new()));
        assert_eq!(record.iter().filter(|(key, _)| *key == "state").count(), 0);
    }

    #[test]
    fn the_first_list_says_what_an_object_is_and_all_say_who_saw_it() {
        let seen = |id, points: [u32; 2], valid_flag| ValidBoxRow {
            id,
            class: "car".into(),
            num_lidar_pts: points[0],
            num_radar_pts: points[1],
            valid_flag,
            difficulty: "hard".into(),
            ..ValidBoxRow::default()
        };
        let raw = cast().raw(&car());
        let far = cast().raw(&BoxRow { distance_m: 99.0, model: "car.other".into(), ..car() });
        let mut combined = Combined::default();
        combined.add(&raw, &seen(9, [29, 0], false));
        combined.add(&raw, &seen(3, [0, 0], false));
        combined.add(&far, &seen(9, [50, 1], true));
        let records = combined.records();
        assert_eq!(records.len(), 2);
        let first = &records[0];
        assert_eq!(get(first, "type"), &Value::Text("vehicle.car.sedan".into()));
        assert_eq!(get(first, "num_lidar_pts"), &Value::Int(79));
        assert_eq!(get(first, "num_radar_pts"), &Value::Int(1));
        assert_eq!(get(first, "valid_flag"), &Value::Bool(true));
        assert_eq!(get(first, "difficulty"), &Value::Text("easy".into()), "80 points");
        assert_eq!(get(&records[1], "difficulty"), &Value::Text("hard".into()));
        assert!(first.iter().all(|(key, _)| !key.ends_with("_to_ego")));
    }
}
