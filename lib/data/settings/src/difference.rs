//! Where two resolved configurations differ.

use std::collections::BTreeSet;

/// Where two resolved configurations differ first: keys with points between them.
#[must_use]
pub fn first_difference(a: &serde_json::Value, b: &serde_json::Value) -> Option<String> {
    match (a.as_object(), b.as_object()) {
        (Some(a), Some(b)) => {
            let names: BTreeSet<&String> = a.keys().chain(b.keys()).collect();
            names.into_iter().find_map(|name| {
                let null = serde_json::Value::Null;
                let path = first_difference(a.get(name).unwrap_or(&null), b.get(name).unwrap_or(&null))?;
                Some(if path.is_empty() { name.clone() } else { format!("{name}.{path}") })
            })
        }
        _ => (a != b).then(String::new),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn differing_settings_are_named() {
        let one = json!({"seed": 1, "timing": {"warmup_s": 2.0, "max": null}});
        let other = json!({"seed": 1, "timing": {"warmup_s": 3.0}});
        assert_eq!(first_difference(&one, &one), None);
        assert_eq!(first_difference(&one, &other).as_deref(), Some("timing.warmup_s"));
        assert_eq!(first_difference(&one, &json!({"seed": 1})).as_deref(), Some("timing"));
        assert_eq!(first_difference(&json!([1]), &json!([2])).as_deref(), Some(""));
    }
}
