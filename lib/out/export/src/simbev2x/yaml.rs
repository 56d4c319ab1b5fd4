//! A configuration as YAML, keys in the order of the alphabet.

use std::fmt::Write;

use serde_json::Value;

use super::pytext;

/// A document of a value.
pub(super) fn document(value: &Value) -> String {
    let mut out = String::new();
    match value {
        Value::Object(map) if !map.is_empty() => block(&mut out, value, 0),
        Value::Array(list) if !list.is_empty() => block(&mut out, value, 0),
        _ => {
            out.push_str(&plain(value));
            out.push('\n');
        }
    }
    out
}

/// The lines of a mapping or a sequence that is not empty.
fn block(out: &mut String, value: &Value, level: usize) {
    let blanks = "  ".repeat(level);
    match value {
        Value::Object(map) => {
            let mut keys: Vec<&String> = map.keys().collect();
            keys.sort();
            for key in keys {
                let _ = write!(out, "{blanks}{}:", text(key));
                below(out, &map[key], level + 1);
            }
        }
        Value::Array(list) => {
            for item in list {
                let _ = write!(out, "{blanks}-");
                below(out, item, level + 1);
            }
        }
        other => out.push_str(&plain(other)),
    }
}

/// The text behind a key or a dash.
fn below(out: &mut String, value: &Value, level: usize) {
    let nested = match value {
        Value::Object(map) => !map.is_empty(),
        Value::Array(list) => !list.is_empty(),
        _ => false,
    };
    if nested {
        out.push('\n');
        block(out, value, level);
    } else {
        let _ = writeln!(out, " {}", plain(value));
    }
}

fn plain(value: &Value) -> String {
    match value {
        Value::Null => "null".to_owned(),
        Value::Bool(value) => value.to_string(),
        Value::Number(number) => match (number.as_i64(), number.as_u64(), number.as_f64()) {
            (Some(n), ..) => n.to_string(),
            (None, Some(n), _) => n.to_string(),
            (.., f) => float(f.unwrap_or(f64::NAN)),
        },
        Value::String(word) => text(word),
        Value::Array(_) => "[]".to_owned(),
        Value::Object(_) => "{}".to_owned(),
    }
}

/// YAML 1.1 takes `4e-07` for a word: numbers have a point.
fn float(value: f64) -> String {
    match pytext::float(value).split_once('e') {
        Some((digits, exponent)) if !digits.contains('.') => format!("{digits}.0e{exponent}"),
        Some((digits, exponent)) => format!("{digits}e{exponent}"),
        None if value.is_nan() => ".nan".to_owned(),
        None if value.is_infinite() => if value > 0.0 { ".inf" } else { "-.inf" }.to_owned(),
        None => pytext::float(value),
    }
}

/// A word as it is where nothing else can be meant, else in quotes as in JSON.
fn text(word: &str) -> String {
    let is_plain = word.starts_with(|c: char| c.is_ascii_alphabetic())
        && word.bytes().all(|b| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'-' | b'.' | b'/'))
        && !["null", "true", "false", "yes", "no", "on", "off", "y", "n"]
            .contains(&word.to_ascii_lowercase().as_str());
    if is_plain {
        return word.to_owned();
    }
    let mut out = String::new();
    pytext::quote(&mut out, word);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_sorted_and_words_are_safe() {
        let value = serde_json::json!({
            "b": {"z": 1, "a": [1.5, "on", {"k": null}]},
            "a": [], "c": {}, "d": 4e-7, "e": "convoy/demo", "f": "x: y", "27": true, "g": [[1, 2], [3]],
        });
        assert_eq!(
            document(&value),
            "\"27\": true\na: []\nb:\n  a:\n    - 1.5\n    - \"on\"\n    -\n      k: null\n  z: 1\nc: {}\nd: 4.0e-07\n\
             e: convoy/demo\nf: \"x: y\"\ng:\n  -\n    - 1\n    - 2\n  -\n    - 3\n"
        );
    }
}
