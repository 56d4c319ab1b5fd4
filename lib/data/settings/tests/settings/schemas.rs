//! Editors and the reader must be of one mind: a small validator of JSON schemas holds the files of
//! `configs/` against them.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

fn folder(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..").join(path)
}

/// What is wrong with a value, by paths.
fn faults(root: &Value, schema: &Value, value: &Value, path: &str, found: &mut Vec<String>) {
    if let Some(name) = schema["$ref"].as_str() {
        let schema = root.pointer(name.trim_start_matches('#')).expect("a reference leads somewhere");
        return faults(root, schema, value, path, found);
    }
    if let Some(kinds) = schema["anyOf"].as_array() {
        // What is wrong by the kind that it comes nearest to.
        let by_kind = kinds.iter().map(|kind| {
            let mut found = Vec::new();
            faults(root, kind, value, path, &mut found);
            found
        });
        return found.extend(by_kind.min_by_key(Vec::len).unwrap_or_default());
    }
    let is_of_type = match schema["type"].as_str() {
        Some("object") => value.is_object(),
        Some("array") => value.is_array(),
        Some("string") => value.is_string(),
        Some("boolean") => value.is_boolean(),
        Some("integer") => value.is_i64(),
        Some("number") => value.is_number(),
        other => panic!("{path}: a schema of type {other:?}"),
    };
    let number = value.as_f64().unwrap_or_default();
    let is_low = schema["minimum"].as_f64().is_some_and(|least| number < least);
    let is_high = schema["maximum"].as_f64().is_some_and(|most| number > most);
    let is_no_word = schema["enum"].as_array().is_some_and(|words| !words.contains(value));
    let count = value.as_array().map_or(0, Vec::len) as u64;
    let is_short = schema["minItems"].as_u64().is_some_and(|least| count < least);
    let is_long = schema["maxItems"].as_u64().is_some_and(|most| count > most);
    if !is_of_type || is_low || is_high || is_no_word || is_short || is_long {
        found.push(path.to_owned());
    }
    if !is_of_type {
        return;
    }
    for (number, item) in value.as_array().into_iter().flatten().enumerate() {
        faults(root, &schema["items"], item, &format!("{path}[{number}]"), found);
    }
    for (key, item) in value.as_object().into_iter().flatten() {
        let path = format!("{path}.{key}");
        match (&schema["properties"][key], &schema["additionalProperties"]) {
            (Value::Null, Value::Bool(false)) => found.push(path),
            (Value::Null, others) => faults(root, others, item, &path, found),
            (known, _) => faults(root, known, item, &path, found),
        }
    }
}

fn faults_of(schema: &Value, text: &str) -> Vec<String> {
    let table: toml::Table = text.parse().expect("is TOML");
    let mut found = Vec::new();
    faults(schema, schema, &serde_json::to_value(table).expect("is JSON"), "", &mut found);
    found
}

#[test]
fn shipped_files_name_their_schema_and_keep_to_it() {
    let mut checked = 0;
    for (path, schema) in
        [("configs", settings::json_schema()), ("configs/rigs", settings::rig_json_schema())]
    {
        for file in fs::read_dir(folder(path)).expect("a folder").flatten().map(|entry| entry.path()) {
            if file.extension().is_some_and(|e| e == "toml") {
                let text = fs::read_to_string(&file).expect("reads");
                assert_eq!(text.lines().next(), Some("#:schema ./schema.json"), "{}", file.display());
                assert_eq!(faults_of(&schema, &text), [""; 0], "{}", file.display());
                checked += 1;
            }
        }
    }
    assert!(checked >= 12, "{checked}");
}

#[test]
fn schemas_and_reader_agree() {
    let schema = settings::json_schema();
    let every = fs::read_to_string(folder("lib/store/runner/tests/runner/every_key.toml")).expect("reads");
    assert_eq!(faults_of(&schema, &every), [""; 0]);
    let scenes = "[scenes.train]\n\"convoy/demo\" = 1\n";
    for (text, path) in [
        ("[vehicle.camera]\nwidht = 640", ".vehicle.camera.widht"),
        ("[vehicle.camera]\nwidth = 8", ".vehicle.camera.width"),
        ("[traffic]\ndoor_open = 1.5", ".traffic.door_open"),
        ("[agents]\nspawn_mode = \"near\"", ".agents.spawn_mode"),
        ("[[rsu.cameras]]\nxyz_m = [1, 2]", ".rsu.cameras[0].xyz_m"),
        ("[scenes.val]\nTown01 = \"many\"", ".scenes.val.Town01"),
        ("[[rigs]]\nagents = [\"rsu_0\"]\n[rigs.lidar]\nchannels = 0", ".rigs[0].lidar.channels"),
        ("[[agents.starts]]\nmap = 3", ".agents.starts[0].map"),
        ("[weather.initial]\nwetness = [3, 4, 5]", ".weather.initial.wetness"),
        ("[weather.initial]\nwetness = -3", ".weather.initial.wetness"),
        ("[[weather.keyframes]]\nat_s = -1", ".weather.keyframes[0].at_s"),
    ] {
        let text = format!("{scenes}{text}\n");
        assert_eq!(faults_of(&schema, &text), [path]);
        let told = settings::parse(&text, "x.toml").expect_err("is bad");
        assert!(told.iter().any(|fault| fault.message.contains(&path[1..])), "{path}: {told:?}");
    }
    for good in [
        "[bev]\nrule = \"simbev2x\"",
        "[[weather.keyframes]]\nat_s = 2\nwetness = [20, 30.5]\ncloudiness = 7",
    ] {
        assert_eq!(faults_of(&schema, &format!("{scenes}{good}\n")), [""; 0]);
    }
}
