//! A box as the layout has it.

use std::collections::BTreeSet;

use frames::{deg, wrap_pi};
use schema::{Attribute, Attributes, DetectionClass, Difficulty, SignalState};

use crate::error::SourceFault;
use crate::value::Value;

/// Most tags of an object.
const MAX_TAGS: usize = 32;
/// Greatest coordinate, speed or rate: what is beyond is no number that was measured.
const FAR: f64 = 1e7;

/// A box of an agent's list.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Labelled {
    /// The id that the layout gives it: of scenery a hash of 64 bits in datasets of the original.
    pub(crate) id: i128,
    pub(crate) class: DetectionClass,
    pub(crate) model: String,
    /// The role of an actor; else empty.
    pub(crate) role_name: String,
    pub(crate) color: Vec<u8>,
    pub(crate) parent: Option<i128>,
    pub(crate) tags: Vec<u8>,
    pub(crate) corners_m: [f64; 24],
    pub(crate) rpy_rad: [f64; 3],
    pub(crate) velocity_mps: [f32; 3],
    pub(crate) angular_velocity_radps: [f32; 3],
    pub(crate) distance_m: f64,
    /// None of the agent's own box.
    pub(crate) angle_rad: Option<f64>,
    pub(crate) signal_state: Option<SignalState>,
    pub(crate) is_alive: bool,
    pub(crate) is_active: bool,
    pub(crate) is_dormant: bool,
    pub(crate) opendrive_id: Option<String>,
    pub(crate) attributes: Attributes,
    pub(crate) seen: Option<VisibilityRecord>,
}

/// What post-processing says of a box.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct VisibilityRecord {
    pub(crate) num_lidar_pts: u32,
    pub(crate) num_radar_pts: u32,
    pub(crate) valid_flag: bool,
    pub(crate) difficulty: String,
}

/// The boxes of a file: a list of dictionaries.
pub(crate) fn boxes(file: &Value, is_processed: bool) -> Result<Vec<Labelled>, SourceFault> {
    let items = match file {
        Value::List(items) => items.as_slice(),
        // What numpy makes of an empty list.
        Value::Numbers { values, .. } if values.is_empty() => &[],
        _ => return Err("is no list of boxes".into()),
    };
    let mut ids = BTreeSet::new();
    let mut found = Vec::with_capacity(items.len());
    for (k, item) in items.iter().enumerate() {
        let labelled = labelled(item, is_processed).map_err(|fault| fault.at(format_args!("box {k}")))?;
        if !ids.insert(labelled.id) {
            return Err(format!("box {k}: object {} is there twice", labelled.id).into());
        }
        found.push(labelled);
    }
    Ok(found)
}

fn labelled(item: &Value, is_processed: bool) -> Result<Labelled, SourceFault> {
    if !matches!(item, Value::Dict(_)) {
        return Err("is no dictionary".into());
    }
    let id: i128 = item.get("id").and_then(Value::whole).ok_or("has no whole number `id`")?;
    let named = |key: &str| format!("object {id}: has no such `{key}` as a store can hold");
    let vector = |key: &str| {
        let found = item.get(key).and_then(Value::numbers::<3>);
        found.filter(|v| v.iter().all(|x| x.abs() < FAR)).ok_or_else(|| named(key))
    };
    let flag = |key: &str| item.get(key).and_then(Value::flag).ok_or_else(|| named(key));
    let kind = item.get("type").and_then(Value::text).ok_or_else(|| named("type"))?;
    let tags = tags(item).ok_or_else(|| named("semantic_tags"))?;
    let class = DetectionClass::from_tags(&tags).ok_or_else(|| named("semantic_tags"))?;
    let is_light = class == DetectionClass::TrafficLight;
    // Traffic lights are actors there and scenery in a store.
    let is_alive = flag("is_alive")? && !is_light;
    let corners_m = item.get("bounding_box").and_then(Value::numbers::<24>);
    let corners_m =
        corners_m.filter(|v| v.iter().all(|x| x.abs() < FAR)).ok_or_else(|| named("bounding_box"))?;
    let facts = facts(item).ok_or_else(|| named("attributes"))?;
    let said = |key: &str| facts.iter().find(|(name, _)| name == key).map(|(_, value)| value.clone());
    let own =
        |key: &str| item.get(key).and_then(Value::text).filter(|text| !text.is_empty()).map(str::to_owned);
    let distance_m = item.get("distance_to_ego").and_then(Value::number).filter(|d| (0.0..FAR).contains(d));
    let angle_deg = item.get("angle_to_ego").and_then(Value::number).ok_or_else(|| named("angle_to_ego"))?;
    if angle_deg.abs() > 360.0 {
        return Err(named("angle_to_ego").into());
    }
    let [wx, wy, wz] = vector("angular_velocity")?.map(deg);
    Ok(Labelled {
        id,
        class,
        model: model(kind, class, is_alive, said("model")),
        role_name: said("role_name").filter(|_| is_alive).unwrap_or_default(),
        color: said("color").filter(|_| is_alive).and_then(|text| color(&text)).unwrap_or_default(),
        parent: item.get("parent").and_then(Value::whole),
        corners_m,
        rpy_rad: vector("rotation")?.map(|angle| within_half_turn(deg(angle))),
        velocity_mps: vector("linear_velocity")?.map(|v| v as f32),
        // Their x and y have the opposite sign of a right-handed vector's.
        angular_velocity_radps: [-wx, -wy, wz].map(|w| w as f32),
        distance_m: distance_m.ok_or_else(|| named("distance_to_ego"))?,
        angle_rad: (!angle_deg.is_nan()).then(|| within_half_turn(deg(angle_deg))),
        signal_state: if is_light { state(item) } else { None },
        is_alive,
        is_active: flag("is_active")? && !is_light,
        is_dormant: flag("is_dormant")?,
        opendrive_id: own("opendrive_id").or_else(|| said("opendrive_id").filter(|_| !is_alive)),
        attributes: attributes(item, facts, class, is_alive),
        seen: if is_processed { Some(seen(item, class).map_err(named)?) } else { None },
        tags,
    })
}

/// Angles stand as they are where they can.
fn within_half_turn(angle_rad: f64) -> f64 {
    if angle_rad.abs() <= std::f64::consts::PI { angle_rad } else { wrap_pi(angle_rad) }
}

fn tags(item: &Value) -> Option<Vec<u8>> {
    let Some(Value::List(items)) = item.get("semantic_tags") else { return None };
    if items.len() > MAX_TAGS {
        return None;
    }
    items.iter().map(|tag| tag.whole::<u8>().filter(|tag| schema::Tag::from_u8(*tag).is_some())).collect()
}

fn state(item: &Value) -> Option<SignalState> {
    item.get("state").and_then(Value::text)?.parse().ok()
}

/// The facts of an object as texts, in order.
fn facts(item: &Value) -> Option<Vec<(String, String)>> {
    let Some(Value::Dict(entries)) = item.get("attributes") else { return None };
    entries.iter().map(|(key, value)| Some((key.clone(), value.text()?.to_owned()))).collect()
}

/// `vehicle.car.coupe` is `car.coupe`; of scenery the type is the name of its label, and its model among the
/// facts, if anywhere.
fn model(kind: &str, class: DetectionClass, is_alive: bool, said: Option<String>) -> String {
    if !is_alive {
        let plain = if class == DetectionClass::TrafficLight { "traffic_light" } else { kind };
        return said.unwrap_or_else(|| plain.to_owned());
    }
    if let Some(walker) = kind.strip_prefix("walker.pedestrian.") {
        return format!("walker.{walker}");
    }
    let known = ["vehicle.", "static.prop."].iter().find_map(|prefix| kind.strip_prefix(prefix));
    known.unwrap_or(kind).to_owned()
}

/// `255,0,128`.
fn color(text: &str) -> Option<Vec<u8>> {
    let parts: Option<Vec<u8>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    parts.filter(|parts| parts.len() == 3)
}

/// Further facts: those that have no column of their own, and what the layout says of lights and signs beside
/// them.
fn attributes(
    item: &Value,
    facts: Vec<(String, String)>,
    class: DetectionClass,
    is_alive: bool,
) -> Attributes {
    let has_column = |key: &str| match key {
        "role_name" | "color" => is_alive,
        "model" | "opendrive_id" => !is_alive,
        _ => false,
    };
    let mut kept = serde_json::Map::new();
    for (key, value) in facts.into_iter().filter(|(key, _)| !has_column(key)) {
        kept.insert(key, value.into());
    }
    let mut add = |attribute: Attribute, text: Option<String>| {
        if let Some(text) = text
            && !kept.contains_key(attribute.key())
        {
            kept.insert(attribute.key().to_owned(), text.into());
        }
    };
    let word =
        |key: &str| item.get(key).and_then(Value::text).filter(|text| !text.is_empty()).map(str::to_owned);
    let number =
        |key: &str| item.get(key).and_then(Value::number).filter(|v| v.is_finite()).map(|v| v.to_string());
    match class {
        DetectionClass::TrafficLight => {
            add(Attribute::GreenTime, number("green_time"));
            add(Attribute::YellowTime, number("yellow_time"));
            add(Attribute::RedTime, number("red_time"));
            add(Attribute::PoleIndex, number("pole_index"));
        }
        DetectionClass::TrafficSign => add(Attribute::SignType, word("sign_type")),
        _ => {}
    }
    // An object of texts always reads back.
    serde_json::Value::Object(kept).to_string().parse().unwrap_or_default()
}

fn seen(item: &Value, class: DetectionClass) -> Result<VisibilityRecord, &'static str> {
    let count = |key| item.get(key).and_then(Value::whole::<u32>).ok_or(key);
    if item.get("class").and_then(Value::text) != Some(class.name()) {
        return Err("class");
    }
    let difficulty = item.get("difficulty").and_then(Value::text).unwrap_or_default();
    let known =
        [Difficulty::Easy, Difficulty::Medium, Difficulty::Hard].iter().any(|d| d.name() == difficulty);
    Ok(VisibilityRecord {
        num_lidar_pts: count("num_lidar_pts")?,
        num_radar_pts: count("num_radar_pts")?,
        valid_flag: item.get("valid_flag").and_then(Value::flag).ok_or("valid_flag")?,
        difficulty: known.then(|| difficulty.to_owned()).ok_or("difficulty")?,
    })
}

impl Labelled {
    fn corner(&self, k: usize) -> [f64; 3] {
        std::array::from_fn(|axis| self.corners_m[3 * k + axis])
    }

    fn middle(&self, a: usize, b: usize) -> [f64; 3] {
        let (a, b) = (self.corner(a), self.corner(b));
        std::array::from_fn(|axis| 0.5 * (a[axis] + b[axis]))
    }

    /// Centre of the box in the world, m.
    pub(crate) fn center_m(&self) -> [f64; 3] {
        self.middle(0, 7)
    }

    /// Middle of the bottom face in the world, m.
    pub(crate) fn foot_m(&self) -> [f64; 3] {
        self.middle(0, 6)
    }

    /// Length, width, height, m.
    pub(crate) fn size_m(&self) -> [f64; 3] {
        let from = self.corner(0);
        [4, 2, 1].map(|k| {
            let to = self.corner(k);
            (0..3).map(|axis| (to[axis] - from[axis]) * (to[axis] - from[axis])).sum::<f64>().sqrt()
        })
    }
}

#[cfg(test)]
pub(crate) mod tests;
