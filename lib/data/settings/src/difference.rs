//! Where two resolved configurations differ.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use serde_json::Value;

/// Where `dataset.json` keeps keys, and where a configuration has them.
const PLACES: [(&str, &str); 5] = [
    ("vehicle_rig", "vehicle"),
    ("rsu_rig", "rsu"),
    ("own_rigs", "rigs"),
    ("vehicle_occupancy", "vehicle.occupancy"),
    ("rsu_occupancy", "rsu.occupancy"),
];
/// Values are told with at most so many characters.
const MOST_CHARS: usize = 48;
/// So many changes are told one by one.
const MOST_LINES: usize = 12;

/// A key that has another value in another configuration.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyChange {
    /// Its names with points between them; tables of a list by their `name`, else by their number.
    pub key: String,
    /// Its value before, if it was there.
    pub old: Option<Value>,
    /// Its value now, if it is there.
    pub new: Option<Value>,
}

impl fmt::Display for KeyChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} -> {}", self.key, told(self.old.as_ref()), told(self.new.as_ref()))
    }
}

fn told(value: Option<&Value>) -> String {
    let Some(value) = value else { return "none".into() };
    let text = value.to_string();
    if text.chars().count() <= MOST_CHARS {
        return text;
    }
    text.chars().take(MOST_CHARS - 3).chain("...".chars()).collect()
}

/// Changes as lines for people, `changed: KEY: OLD -> NEW`; of many, how many more there are.
#[must_use]
pub fn change_lines(changes: &[KeyChange]) -> Vec<String> {
    let lines = changes.iter().take(MOST_LINES).map(|change| format!("changed: {change}"));
    let more = changes.len().saturating_sub(MOST_LINES);
    lines.chain((more > 0).then(|| format!("and {more} more keys"))).collect()
}

/// The keys that have another value in another resolved configuration (`config` of `dataset.json`), in the
/// order of their names.
#[must_use]
pub fn key_changes(old: &Value, new: &Value) -> Vec<KeyChange> {
    let mut found = Vec::new();
    compare("", (Some(old), Some(new)), &mut found);
    found
}

fn compare(path: &str, (old, new): (Option<&Value>, Option<&Value>), found: &mut Vec<KeyChange>) {
    // A value that is null is none.
    let (old, new) = (old.filter(|v| !v.is_null()), new.filter(|v| !v.is_null()));
    if old == new {
        return;
    }
    if let (Some(Value::Object(a)), Some(Value::Object(b))) = (old, new) {
        let names: BTreeSet<&String> = a.keys().chain(b.keys()).collect();
        for name in names {
            compare(&below(path, name), (a.get(name), b.get(name)), found);
        }
        return;
    }
    if let (Some(Value::Array(a)), Some(Value::Array(b))) = (old, new)
        && let (Some(a), Some(b)) = (as_pairs(a), as_pairs(b))
    {
        let names: BTreeSet<&str> = a.keys().chain(b.keys()).copied().collect();
        for name in names {
            compare(&below(path, name), (a.get(name).copied(), b.get(name).copied()), found);
        }
        return;
    }
    if let (Some(Value::Array(a)), Some(Value::Array(b))) = (old, new)
        && let (Some(a), Some(b)) = (as_wishes(a), as_wishes(b))
    {
        return compare(path, (Some(&a), Some(&b)), found);
    }
    if let (Some(Value::Array(a)), Some(Value::Array(b))) = (old, new)
        && a.iter().chain(b).all(Value::is_object)
    {
        let names: Vec<String> = names_of(a).into_iter().chain(names_of(b)).collect();
        let mut told = BTreeSet::new();
        for name in names.into_iter().filter(|name| told.insert(name.clone())) {
            let of = |list: &'_ [Value]| names_of(list).iter().position(|other| *other == name);
            let pair = (of(a).map(|at| &a[at]), of(b).map(|at| &b[at]));
            compare(&format!("{path}[{name}]"), pair, found);
        }
        // The order alone.
        if !found.iter().any(|change| change.key.starts_with(&format!("{path}["))) {
            found.push(KeyChange { key: path.to_owned(), old: old.cloned(), new: new.cloned() });
        }
        return;
    }
    let (key, degrees) = match path.strip_suffix("_rad") {
        Some(stem) => (format!("{stem}_deg"), true),
        None => (path.to_owned(), false),
    };
    let written = |value: Option<&Value>| value.map(|v| if degrees { in_degrees(v) } else { v.clone() });
    found.push(KeyChange { key, old: written(old), new: written(new) });
}

/// A list of pairs of a name and a value.
fn as_pairs(list: &[Value]) -> Option<BTreeMap<&str, &Value>> {
    fn pair(item: &Value) -> Option<(&str, &Value)> {
        match item.as_array()?.as_slice() {
            [Value::String(name), value] => Some((name, value)),
            _ => None,
        }
    }
    list.iter().map(pair).collect()
}

/// How many scenes are wished for, by split and map, as a configuration has them.
fn as_wishes(list: &[Value]) -> Option<Value> {
    let mut wishes: BTreeMap<String, BTreeMap<String, u64>> = BTreeMap::new();
    for item in list {
        let (split, map) = (item["split"].as_str()?.to_lowercase(), item["map"].as_str()?.to_owned());
        *wishes.entry(split).or_default().entry(map).or_default() += item["count"].as_u64()?;
    }
    (!wishes.is_empty()).then(|| serde_json::to_value(wishes).ok())?
}

fn below(path: &str, name: &str) -> String {
    let is_group = path.starts_with("groups[") && path.ends_with(']') && !path.contains('.');
    if path.is_empty() || is_group {
        let place = PLACES.iter().find(|(kept, _)| *kept == name);
        let name = place.map_or(name, |(_, written)| written);
        return if is_group { format!("{path}.{name}") } else { name.to_owned() };
    }
    format!("{path}.{name}")
}

/// What tells the tables of a list apart.
fn names_of(list: &[Value]) -> Vec<String> {
    let name = |(number, item): (usize, &Value)| {
        item["name"].as_str().map_or_else(|| number.to_string(), str::to_owned)
    };
    list.iter().enumerate().map(name).collect()
}

/// Radians, alone or in lists, as the degrees of a configuration.
fn in_degrees(value: &Value) -> Value {
    match value {
        Value::Array(items) => items.iter().map(in_degrees).collect(),
        other => other.as_f64().map_or_else(
            || other.clone(),
            |radians| Value::from((frames::to_deg(radians) * 1e9).round() / 1e9),
        ),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::parse;

    fn told(old: &Value, new: &Value) -> Vec<String> {
        key_changes(old, new).iter().map(KeyChange::to_string).collect()
    }

    #[test]
    fn keys_are_named_with_both_values() {
        let one = json!({"seed": 1, "timing": {"warmup_s": 2.0, "max": null}, "colors": [1, 2]});
        let other = json!({"seed": 1, "timing": {"warmup_s": 3.0}, "colors": [1, 3], "more": "x"});
        assert_eq!(told(&one, &one), [""; 0]);
        let expected = ["colors: [1,2] -> [1,3]", "more: none -> \"x\"", "timing.warmup_s: 2.0 -> 3.0"];
        assert_eq!(told(&one, &other), expected);
    }

    #[test]
    fn keys_have_the_names_of_a_configuration() {
        let config = |text: &str| {
            let settings = parse(&format!("[scenes.train]\n\"convoy/demo\" = 1\n{text}"), "x.toml");
            serde_json::to_value(settings.expect("is valid")).expect("is JSON")
        };
        let changed = |text: &str| told(&config(""), &config(text));
        assert_eq!(changed("[traffic]\nvehicles = 9\n"), ["traffic.vehicles: none -> 9"]);
        assert_eq!(
            changed("[vehicle.lidar]\nchannels = 32\n"),
            ["vehicle.lidars[LIDAR].scan.channels: 128 -> 32"]
        );
        assert_eq!(
            changed("[rsu.occupancy]\nvoxel_m = 0.4\n[weather.initial]\nsun_altitude_deg = 30\n"),
            ["rsu.occupancy.voxel_m: 0.1 -> 0.4", "weather.initial.sun_altitude_deg: none -> 30.0"]
        );
        let group = |text: &str| config(&format!("[[groups]]\nname = \"g\"\n{text}"));
        let range = "[groups.vehicle.lidar]\nrange_m = 60\n";
        assert_eq!(
            told(&group(""), &group(range)),
            ["groups[g].vehicle.lidars[LIDAR].range_m: 120.0 -> 60.0"]
        );
        let more = changed("[[vehicle.lidars]]\nname = \"ROOF\"\n");
        assert_eq!(more.len(), 1, "{more:?}");
        assert!(
            more[0].starts_with("vehicle.lidars[ROOF]: none -> {") && more[0].ends_with("..."),
            "{more:?}"
        );
    }

    #[test]
    fn of_many_changes_the_first_are_told() {
        let numbers =
            |from: u32| json!((0..20).map(|i| (format!("k{i:02}"), from + i)).collect::<BTreeMap<_, _>>());
        let lines = change_lines(&key_changes(&numbers(0), &numbers(1)));
        assert_eq!(lines.len(), 13, "{lines:?}");
        assert_eq!([&*lines[0], &*lines[12]], ["changed: k00: 0 -> 1", "and 8 more keys"]);
        assert_eq!(change_lines(&key_changes(&json!({"a": 1}), &json!({"a": 2}))), ["changed: a: 1 -> 2"]);
    }

    #[test]
    fn lists_in_another_order_differ() {
        let list = |names: [&str; 2]| json!({"cameras": names.map(|name| json!({"name": name}))});
        assert_eq!(told(&list(["a", "b"]), &list(["b", "a"])).len(), 1);
    }

    #[test]
    fn wishes_for_scenes_are_named_as_they_are_written() {
        let of = |text: &str| serde_json::to_value(parse(text, "x.toml").expect("is good")).expect("is JSON");
        let old = of("[scenes.train]\nTown03 = 2\n\"convoy/demo\" = 1\n");
        let new = of("[scenes.train]\n\"convoy/demo\" = 3\n[scenes.val]\nTown03 = 2\n");
        let wanted = [
            "scenes.train.Town03: 2 -> none",
            "scenes.train.convoy/demo: 1 -> 3",
            "scenes.val: none -> {\"Town03\":2}",
        ];
        assert_eq!(told(&old, &new), wanted);
    }
}
