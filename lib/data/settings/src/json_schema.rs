//! The keys as JSON schemas, by which editors complete and check configurations.

use serde_json::{Map, Value, json};

use crate::config_key::{Absent, ConfigKey, Kind};
use crate::dataset::config_keys;
use crate::groups::scenario_keys;
use crate::rig_keys::FILE_KEY;

const DIALECT: &str = "http://json-schema.org/draft-07/schema#";

/// The schema of a configuration: `configs/schema.json`.
#[must_use]
pub fn json_schema() -> Value {
    let mut root = whole("A configuration of Convoy: docs/configuration.md");
    for key in config_keys() {
        put(&mut root, &key);
    }
    // Rigs of single agents have all keys of `vehicle` or `rsu`, besides those that are put there.
    let of_kind: Vec<String> =
        properties(&root["properties"]["vehicle"]).map(|(key, _)| key.clone()).collect();
    let own = &mut root["properties"]["rigs"]["items"]["properties"];
    for key in of_kind.iter().filter(|key| *key != FILE_KEY) {
        own[key] = json!({ "$ref": format!("#/properties/vehicle/properties/{key}") });
    }
    // Groups have the tables of a scenario as they are at the top.
    let own = &mut root["properties"]["groups"]["items"]["properties"];
    for key in scenario_keys() {
        own[&key] = json!({ "$ref": format!("#/properties/{key}") });
    }
    root
}

/// The schema of a file that `rig` names: `configs/rigs/schema.json`. It has no defaults: vehicles and RSUs
/// have others.
#[must_use]
pub fn rig_json_schema() -> Value {
    let mut root = whole("A rig of Convoy: docs/configuration.md");
    for key in config_keys() {
        let Some(path) = key.path.strip_prefix("vehicle.").filter(|path| *path != FILE_KEY) else { continue };
        let default = Absent::Words(String::new());
        put(&mut root, &ConfigKey { path: path.to_owned(), default, ..key });
    }
    root
}

fn whole(title: &str) -> Value {
    let Value::Object(table) = table() else { return Value::Null };
    let head = json!({ "$schema": DIALECT, "title": title });
    head.as_object().cloned().into_iter().flatten().chain(table).collect::<Map<_, _>>().into()
}

fn table() -> Value {
    json!({ "type": "object", "additionalProperties": false, "properties": {} })
}

fn properties(table: &Value) -> impl Iterator<Item = (&String, &Value)> {
    table["properties"].as_object().into_iter().flatten()
}

/// Puts a key where its path says; the tables on its way are there.
fn put(root: &mut Value, key: &ConfigKey) {
    let (parents, name) = key.path.rsplit_once('.').unwrap_or(("", &key.path));
    let mut at = root;
    for parent in parents.split('.').filter(|parent| !parent.is_empty()) {
        at = match parent.strip_suffix("[]") {
            Some(list) => &mut at["properties"][list]["items"],
            None => &mut at["properties"][parent],
        };
    }
    if name.starts_with('"') {
        at["additionalProperties"] = described(key);
    } else {
        at["properties"][name] = described(key);
    }
}

/// What a key takes, means and is without being named.
fn described(key: &ConfigKey) -> Value {
    let mut schema = match &key.kind {
        Kind::Table => table(),
        Kind::Tables => json!({ "type": "array", "items": table() }),
        Kind::Flag => json!({ "type": "boolean" }),
        Kind::Text => json!({ "type": "string" }),
        Kind::Texts => json!({ "type": "array", "items": { "type": "string" } }),
        Kind::Numbers => json!({ "type": "array", "items": { "type": "number" } }),
        Kind::Triple => fixed(3, &json!({ "type": "number" })),
        Kind::Points => json!({ "type": "array", "items": fixed(3, &json!({ "type": "number" })) }),
        Kind::Colors => {
            let part = json!({ "type": "integer", "minimum": 0, "maximum": 255 });
            json!({ "type": "array", "items": fixed(3, &part) })
        }
        Kind::Choice(words) => json!({ "type": "string", "enum": words }),
        Kind::Integer { min, max: i64::MAX } => json!({ "type": "integer", "minimum": min }),
        Kind::Integer { min, max } => json!({ "type": "integer", "minimum": min, "maximum": max }),
        Kind::Number { min, max } => json!({ "type": "number", "minimum": min, "maximum": max }),
        Kind::NumberOrTwo { min, max } => {
            let number = json!({ "type": "number", "minimum": min, "maximum": max });
            json!({ "anyOf": [number, fixed(2, &number)] })
        }
    };
    let mut doc = key.doc.clone();
    match &key.default {
        Absent::Value(text) => {
            if let Some(value) = value(text) {
                schema["default"] = value;
            }
        }
        Absent::Words(words) if words.is_empty() || words == "none" => {}
        Absent::Words(words) => doc += &format!(" Without it: {words}."),
    }
    schema["description"] = doc.into();
    schema
}

fn fixed(count: usize, item: &Value) -> Value {
    json!({ "type": "array", "items": item, "minItems": count, "maxItems": count })
}

/// A value of TOML.
fn value(text: &str) -> Option<Value> {
    let mut table: toml::Table = format!("value = {text}").parse().ok()?;
    serde_json::to_value(table.remove("value")?).ok()
}
