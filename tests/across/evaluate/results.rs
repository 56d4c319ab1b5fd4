//! `evaluate` on a file of nuScenes' results, for an export of the store.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, UInt32Type};
use arrow_array::{Array, ArrayRef};
use convoy_tests::{Bench, Outcome, program};
use serde_json::{Value, json};

fn read(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).expect("is written")).expect("is JSON")
}

/// Numbers of a list of so many.
fn list(array: &ArrayRef, row: usize, length: usize) -> Vec<f64> {
    let values = array.as_fixed_size_list().values().clone();
    (0..length)
        .map(|i| match values.as_primitive_opt::<Float64Type>() {
            Some(values) => values.value(row * length + i),
            None => {
                f64::from(values.as_primitive::<arrow_array::types::Float32Type>().value(row * length + i))
            }
        })
        .collect()
}

/// The boxes of our own file as a file of results.
fn results(columns: &[(&'static str, ArrayRef)], version: &Path) -> Value {
    let maps = read(&version.join("map.json"));
    let shift: Vec<f64> =
        serde_json::from_value(maps[0]["global_from_world_m"].clone()).expect("are numbers");
    assert!(shift.iter().any(|v| *v != 0.0), "the export moves its world");
    let mut tokens = BTreeMap::new();
    for moment in read(&version.join("cooperation.json")).as_array().expect("has moments") {
        for (agent, token) in moment["samples"].as_object().expect("has samples") {
            tokens.insert((moment["frame"].as_u64().expect("is one"), agent.clone()), token.clone());
        }
    }
    let column = |name: &str| &columns.iter().find(|(found, _)| *found == name).expect("is there").1;
    let (frames, agents, classes) = (column("frame"), column("agent"), column("class"));
    let mut samples: BTreeMap<String, Vec<Value>> = BTreeMap::new();
    for row in 0..frames.len() {
        let agent = agents.as_string::<i32>().value(row).to_owned();
        let frame = u64::from(frames.as_primitive::<UInt32Type>().value(row));
        let class = classes.as_string::<i32>().value(row);
        let Some(token) = tokens.get(&(frame, agent)).and_then(Value::as_str) else { continue };
        if class.starts_with("traffic_light") || class.starts_with("traffic_sign") {
            continue;
        }
        let at = |name: &str, length: usize| list(column(name), row, length);
        let (center, size) = (at("center_m", 3), at("size_m", 3));
        let translation = [0, 1, 2].map(|axis: usize| center[axis] + shift[axis]);
        samples.entry(token.to_owned()).or_default().push(json!({
            "sample_token": token,
            "translation": translation,
            "size": [size[1], size[0], size[2]],
            "rotation": at("quaternion", 4),
            "velocity": at("velocity_mps", 3)[..2],
            "detection_name": class,
            "detection_score": column("score").as_primitive::<Float64Type>().value(row),
            "attribute_name": "",
        }));
    }
    json!({ "meta": { "use_lidar": true }, "results": samples })
}

/// The same boxes with the attributes that the export says of them.
fn with_attributes(good: &Value, version: &Path) -> Value {
    let names: BTreeMap<String, Value> = read(&version.join("attribute.json"))
        .as_array()
        .expect("is a table")
        .iter()
        .map(|row| (row["token"].as_str().expect("has a token").to_owned(), row["name"].clone()))
        .collect();
    let place = |of: &Value| -> [f64; 3] { serde_json::from_value(of.clone()).expect("are numbers") };
    let mut said: BTreeMap<String, Vec<([f64; 3], Value)>> = BTreeMap::new();
    for row in read(&version.join("sample_annotation.json")).as_array().expect("is a table") {
        if let Some(token) = row["attribute_tokens"][0].as_str() {
            let sample = row["sample_token"].as_str().expect("has a sample").to_owned();
            said.entry(sample).or_default().push((place(&row["translation"]), names[token].clone()));
        }
    }
    let mut result = good.clone();
    let mut told = 0;
    for (sample, boxes) in result["results"].as_object_mut().expect("has samples") {
        for found in boxes.as_array_mut().expect("has boxes") {
            let at = place(&found["translation"]);
            let near = |to: &[f64; 3]| (0..3).all(|axis| (at[axis] - to[axis]).abs() < 1e-3);
            if let Some((_, name)) = said.get(sample).and_then(|all| all.iter().find(|(to, _)| near(to))) {
                found["attribute_name"] = name.clone();
                told += 1;
            }
        }
    }
    assert!(told > 20, "{told} boxes have an attribute");
    result
}

/// The annotations of an export as a file of results.
fn annotated(version: &Path) -> Value {
    let rows = |name: &str| {
        let table: Vec<Value> = serde_json::from_value(read(&version.join(name))).expect("is a table");
        let token = |row: &Value| row["token"].as_str().expect("has a token").to_owned();
        table.into_iter().map(|row| (token(&row), row)).collect::<BTreeMap<String, Value>>()
    };
    let (samples, annotations) = (rows("sample.json"), rows("sample_annotation.json"));
    let (instances, categories) = (rows("instance.json"), rows("category.json"));
    let attributes = rows("attribute.json");
    let text = |value: &Value| value.as_str().expect("is a text").to_owned();
    let time_s =
        |row: &Value| samples[&text(&row["sample_token"])]["timestamp"].as_f64().expect("is a time") * 1e-6;
    let mut results: BTreeMap<&str, Vec<Value>> =
        samples.keys().map(|token| (token.as_str(), vec![])).collect();
    for row in annotations.values() {
        let category =
            text(&categories[&text(&instances[&text(&row["instance_token"])]["category_token"])]["name"]);
        let class = match category.as_str() {
            "vehicle.car" | "vehicle.truck" | "vehicle.trailer" | "vehicle.bicycle"
            | "vehicle.motorcycle" => category.trim_start_matches("vehicle."),
            "vehicle.bus.rigid" | "vehicle.bus.bendy" => "bus",
            "movable_object.trafficcone" => "traffic_cone",
            "movable_object.barrier" => "barrier",
            "static.other" | "human.pedestrian.wheelchair" | "human.pedestrian.stroller" => continue,
            _ => "pedestrian",
        };
        let [first, last] =
            ["prev", "next"].map(|beside| annotations.get(&text(&row[beside])).unwrap_or(row));
        let apart_s = time_s(last) - time_s(first);
        let speed = [0, 1].map(|axis: usize| {
            let way = last["translation"][axis].as_f64().zip(first["translation"][axis].as_f64());
            way.filter(|_| apart_s > 0.0).map(|(to, from)| (to - from) / apart_s)
        });
        let token = row["attribute_tokens"][0].as_str();
        let of = samples.get_key_value(&text(&row["sample_token"])).expect("is there").0.as_str();
        results.entry(of).or_default().push(json!({
            "sample_token": of,
            "translation": row["translation"],
            "size": row["size"],
            "rotation": row["rotation"],
            "velocity": speed,
            "detection_name": class,
            "detection_score": 0.5,
            "attribute_name": token.map_or(json!(""), |token| attributes[token]["name"].clone()),
        }));
    }
    json!({ "meta": { "use_lidar": true }, "results": results })
}

/// Errors of attributes of the classes of which something was found.
fn attribute_errors(rows: &[Value]) -> BTreeMap<String, f64> {
    let is_found = |class: &Value| {
        rows.iter().any(|row| {
            row["metrics"] == "nuscenes"
                && row["measure"] == "AP"
                && row["class"] == *class
                && row["value"].as_f64() > Some(0.5)
        })
    };
    let of =
        |row: &&Value| row["metrics"] == "nuscenes" && row["measure"] == "AAE" && is_found(&row["class"]);
    let value = |row: &Value| Some((row["class"].as_str()?.to_owned(), row["value"].as_f64()?));
    rows.iter().filter(of).filter_map(value).collect()
}

pub(super) fn check(bench: &Bench, columns: &[(&'static str, ArrayRef)], parquet: &Path) {
    let folder = bench.folder.path();
    let export = folder.join("nuscenes");
    let mut command = Command::new(program("export"));
    command.args(["nuscenes", "--progress", "none", "--store"]).arg(bench.store()).arg("--dest").arg(&export);
    Outcome::of(&command.output().expect("the program starts")).expect_done();
    let version = export.join("v1.0-train-convoy_demo");
    let good = results(columns, &version);
    let write = |name: &str, text: &str| -> PathBuf {
        fs::write(folder.join(name), text).expect("is written");
        folder.join(name)
    };
    let file = write("results_nusc.json", &good.to_string());
    let scores = |predictions: &Path, name: &str, more: &[&str]| -> Vec<Value> {
        let out = folder.join(name);
        let args = ["--every", "10", "--metrics", "nuscenes,opv2v", "--out", &out.display().to_string()];
        super::evaluate(bench, predictions, &[&args[..], more].concat()).expect_done();
        read(&out).as_array().expect("is a list").clone()
    };
    let from = export.display().to_string();
    let as_parquet = ["--nuscenes", &from, "--seen", "partners", "--agents", "vehicle_*"];
    // Results always say attributes, if only that they are unknown.
    let is_common =
        |row: &Value| !["AAE", "mAAE", "NDS", "NDS without AAE"].iter().any(|name| row["measure"] == *name);
    let [one, other] = [scores(&file, "a.json", &as_parquet), scores(parquet, "b.json", &[])]
        .map(|rows| rows.into_iter().filter(is_common).collect::<Vec<_>>());
    assert_eq!(one.len(), other.len());
    for (one, other) in one.iter().zip(&other) {
        for key in ["metrics", "class", "level", "measure", "threshold"] {
            assert_eq!(one[key], other[key]);
        }
        match (one["value"].as_f64(), other["value"].as_f64()) {
            (Some(a), Some(b)) => assert!((a - b).abs() < 1e-9, "{one} {other}"),
            (a, b) => assert_eq!(a, b, "{one}"),
        }
    }
    let targets = |rows: &[Value]| -> f64 {
        rows.iter().filter(|row| row["measure"] == "targets").filter_map(|row| row["value"].as_f64()).sum()
    };
    // Nothing given: the samples that the results name, by the export's own annotations, and no others.
    let defaults = |file: &Path, name: &str, more: &[&str]| -> Vec<Value> {
        let out = folder.join(name);
        let args = ["--metrics", "nuscenes", "--out", &out.display().to_string()];
        super::evaluate(bench, file, &[&args[..], more].concat()).expect_done();
        read(&out).as_array().expect("is a list").clone()
    };
    let plain = defaults(&file, "f.json", &["--nuscenes", &from]);
    let said = defaults(&file, "g.json", &["--nuscenes", &from, "--every", "10", "--agents", "*"]);
    assert_eq!(plain, said);
    // Of the store's boxes the same are there, at unrounded places and with velocities of their own.
    let stored = defaults(&file, "s.json", &["--nuscenes", &from, "--seen", "ego"]);
    assert_eq!(targets(&stored), targets(&plain));
    let precision = |rows: &[Value]| -> Vec<Value> {
        rows.iter().filter(|row| row["measure"] == "AP").map(|row| row["value"].clone()).collect()
    };
    assert_eq!(precision(&stored), precision(&plain));
    // A frame of which the export has no sample.
    let out = super::evaluate(bench, &file, &["--metrics", "nuscenes", "--nuscenes", &from, "--every", "5"]);
    assert!(out.code == 2 && out.stderr.contains("the export has no such sample"), "{}", out.stderr);
    // The annotations themselves, with velocities as the devkit takes them, are right to the last digit.
    let exact = write("exact_nusc.json", &annotated(&version).to_string());
    let exact = defaults(&exact, "x.json", &["--nuscenes", &from]);
    let of = |class: &Value, name: &str| -> Vec<f64> {
        let rows = exact.iter().filter(|row| row["class"] == *class && row["measure"] == name);
        rows.filter_map(|row| row["value"].as_f64()).collect()
    };
    let has = |row: &&Value| row["measure"] == "targets" && row["value"].as_f64() > Some(0.0);
    let classes: Vec<&Value> = exact.iter().filter(has).map(|row| &row["class"]).collect();
    assert!(classes.len() > 2, "{classes:?}");
    for class in classes {
        assert!(
            of(class, "AP").iter().all(|value| (value - 1.0).abs() < 1e-9),
            "{class}: {:?}",
            of(class, "AP")
        );
        for name in ["ATE", "ASE", "AOE", "AVE", "AAE"] {
            assert!(
                of(class, name).iter().all(|error| *error < 1e-9),
                "{class} {name}: {:?}",
                of(class, name)
            );
        }
    }
    let car = json!("car");
    assert!(["ATE", "AVE", "AAE"].iter().all(|name| of(&car, name).len() == 1), "cars have errors");
    // Without the boxes of a sample it still counts.
    let mut fewer = good.clone();
    let first =
        fewer["results"].as_object_mut().and_then(|all| all.values_mut().next()).expect("has samples");
    *first = json!([]);
    let fewer = write("fewer_nusc.json", &fewer.to_string());
    assert_eq!(targets(&defaults(&fewer, "h.json", &["--nuscenes", &from])), targets(&plain));
    // Only what an agent has points of is annotated.
    let of_ego = ["--nuscenes", &from, "--seen", "ego"];
    let told = write("told_nusc.json", &with_attributes(&good, &version).to_string());
    let (told, untold) = (scores(&told, "d.json", &of_ego), scores(&file, "e.json", &of_ego));
    let (told, untold) = (attribute_errors(&told), attribute_errors(&untold));
    assert!(untold.len() > 1 && untold.values().all(|error| *error == 1.0), "{untold:?}");
    assert!(told.keys().eq(untold.keys()) && told.values().all(|error| *error < 0.1), "{told:?}");
    let everything = ["--nuscenes", &from, "--seen", "nobody"];
    let perfect = scores(&file, "c.json", &everything);
    let has = |row: &&Value| row["measure"] == "targets" && row["value"].as_f64() > Some(0.0);
    let classes: Vec<&Value> = perfect.iter().filter(has).map(|row| &row["class"]).collect();
    assert!(classes.len() > 2, "{classes:?}");
    for class in classes {
        let ap = |row: &&Value| row["class"] == *class && row["measure"] == "AP";
        let values: Vec<f64> = perfect.iter().filter(ap).filter_map(|row| row["value"].as_f64()).collect();
        // The ego, a car here, is among its own boxes, but no target.
        let right = match class.as_str() {
            Some("car" | "vehicle") => 0.5..1.0,
            _ => 1.0 - 1e-9..1.0 + 1e-9,
        };
        assert!(values.len() > 2 && values.iter().all(|ap| right.contains(ap)), "{class}: {values:?}");
    }

    let version = version.display().to_string();
    let text = good.to_string();
    let token = good["results"].as_object().and_then(|r| r.keys().next()).expect("has samples").as_str();
    let cases = [
        (text.replacen("\"results\"", "\"others\"", 1), "missing field `results`"),
        (text.replace(token, "abc"), "sample `abc` is none of the export's"),
        (
            text.replacen("\"detection_name\":\"", "\"detection_name\":\"x", 1),
            "box 0: `detection_name` is `x",
        ),
        (
            text.replacen("\"attribute_name\":\"", "\"attribute_name\":\"flying", 1),
            "box 0: `attribute_name` is `flying`",
        ),
        (text.replacen("\"velocity\":[", "\"velocity\":[NaN,", 1), "NaN is no JSON"),
        (text.replacen("\"size\":[", "\"size\":[-", 1), "`size` is [-"),
        (text.replacen("\"rotation\":[", "\"rotation\":[1.0,", 1), "is no file of nuScenes' results: "),
        (text[..text.len() / 2].to_owned(), "is no file of nuScenes' results: EOF"),
        ("[".repeat(100_000), "is no file of nuScenes' results: "),
        (format!("{{\"meta\":{}", "[".repeat(100_000)), "is no file of nuScenes' results: EOF"),
    ];
    for (text, want) in cases {
        let bad = write("bad.json", &text);
        let refused = super::evaluate(bench, &bad, &["--nuscenes", &version]);
        assert!(refused.code == 2 && refused.stderr.contains(want), "{want}: {}", refused.stderr);
        assert_eq!(refused.stderr.matches("ERROR").count(), 1, "{}", refused.stderr);
    }
    let alone = super::evaluate(bench, &file, &[]);
    assert!(alone.code == 2 && alone.stderr.contains("--nuscenes FOLDER"), "{}", alone.stderr);
    let elsewhere = super::evaluate(bench, &file, &["--nuscenes", &folder.display().to_string()]);
    assert!(elsewhere.code == 2 && elsewhere.stderr.contains("it is no export"), "{}", elsewhere.stderr);
}
