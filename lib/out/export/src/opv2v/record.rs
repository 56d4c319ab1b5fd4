//! What a frame's YAML and JSON say: one tree of values, written twice.

use serde_json::{Map, Value};

use super::handedness::rounded;

/// A number, rounded as all lengths and angles are.
pub(super) fn number(value: f64) -> Value {
    Value::from(rounded(value))
}

/// A list of numbers.
pub(super) fn numbers<const N: usize>(values: [f64; N]) -> Value {
    values.map(number).to_vec().into()
}

/// A map, in the order given.
pub(super) fn map<K: Into<String>>(entries: impl IntoIterator<Item = (K, Value)>) -> Value {
    Value::Object(entries.into_iter().map(|(key, value)| (key.into(), value)).collect::<Map<_, _>>())
}

/// The tree as JSON.
pub(super) fn to_json(value: &Value) -> Vec<u8> {
    value.to_string().into_bytes()
}

/// The tree as YAML 1.1, for readers that know no exponents: maps in lines, lists in brackets. Keys that are
/// whole numbers are read as numbers.
pub(super) fn to_yaml(value: &Value) -> Vec<u8> {
    let mut text = String::new();
    block(&mut text, value, 0);
    text.into_bytes()
}

fn block(text: &mut String, value: &Value, depth: usize) {
    let Value::Object(entries) = value else {
        flow(text, value);
        text.push('\n');
        return;
    };
    for (key, value) in entries {
        text.extend(std::iter::repeat_n(' ', 2 * depth));
        text.push_str(&plain(key));
        match value {
            Value::Object(inner) if !inner.is_empty() => {
                text.push_str(":\n");
                block(text, value, depth + 1);
            }
            _ => {
                text.push_str(": ");
                flow(text, value);
                text.push('\n');
            }
        }
    }
}

fn flow(text: &mut String, value: &Value) {
    match value {
        Value::Array(items) => {
            text.push('[');
            for (at, item) in items.iter().enumerate() {
                text.push_str(if at == 0 { "" } else { ", " });
                flow(text, item);
            }
            text.push(']');
        }
        Value::Object(entries) if entries.is_empty() => text.push_str("{}"),
        Value::Number(number) => text.push_str(&decimal(number)),
        Value::String(word) => text.push_str(&plain(word)),
        // true, false, null; maps in lists (there are none) are JSON, which YAML knows.
        other => text.push_str(&other.to_string()),
    }
}

/// A number without exponent; with a point, unless it is a whole one by type.
fn decimal(number: &serde_json::Number) -> String {
    match number.as_f64() {
        Some(value) if number.is_f64() => {
            let digits = value.to_string();
            if digits.contains('.') { digits } else { digits + ".0" }
        }
        _ => number.to_string(),
    }
}

/// A text as it is where it can only be read as that, else quoted. Whole numbers stay bare: as keys they are
/// ids.
fn plain(word: &str) -> String {
    let id = word.strip_prefix('-').unwrap_or(word);
    if !id.is_empty() && id.bytes().all(|b| b.is_ascii_digit()) {
        return word.to_owned();
    }
    let letters = word.starts_with(|c: char| c.is_ascii_alphabetic())
        && word.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
    // Words that YAML reads as truth or nothing.
    let spoken = ["y", "n", "yes", "no", "on", "off", "true", "false", "null"];
    let taken = spoken.contains(&word.to_ascii_lowercase().as_str());
    if letters && !taken { word.to_owned() } else { Value::from(word).to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_by_hand() {
        let vehicle = map([("angle", numbers([0.0, -90.25, -0.000_000_4])), ("obj_type", "Car".into())]);
        let record = map([
            ("lidar_pose", numbers([1.0, -2.5, 1e-5])),
            ("ego_speed", number(1e7)),
            ("RSU", true.into()),
            ("map", "Town_01/yes".into()),
            ("extrinsic", vec![numbers([1.0, 0.0]), numbers([0.0, 1.0])].into()),
            ("vehicles", map([("10042", vehicle)])),
            ("nobody", map::<String>([])),
            ("plan", Vec::<Value>::new().into()),
        ]);
        let yaml = "lidar_pose: [1.0, -2.5, 0.00001]\nego_speed: 10000000.0\nRSU: true\nmap: \"Town_01/yes\"\n\
                    extrinsic: [[1.0, 0.0], [0.0, 1.0]]\nvehicles:\n  10042:\n    angle: [0.0, -90.25, 0.0]\n    \
                    obj_type: Car\nnobody: {}\nplan: []\n";
        assert_eq!(String::from_utf8(to_yaml(&record)).expect("is text"), yaml);
        let json = r#"{"lidar_pose":[1.0,-2.5,0.00001],"ego_speed":10000000.0,"RSU":true,"map":"Town_01/yes","extrinsic":[[1.0,0.0],[0.0,1.0]],"vehicles":{"10042":{"angle":[0.0,-90.25,0.0],"obj_type":"Car"}},"nobody":{},"plan":[]}"#;
        assert_eq!(String::from_utf8(to_json(&record)).expect("is text"), json);
    }

    #[test]
    fn words_that_mean_something_else_are_quoted() {
        for (word, expected) in [
            ("Car", "Car"),
            ("no", "\"no\""),
            ("1e5", "\"1e5\""),
            ("-7", "-7"),
            ("a: b", "\"a: b\""),
            ("", "\"\""),
            ("0.5", "\"0.5\""),
        ] {
            assert_eq!(plain(word), expected);
        }
    }
}
