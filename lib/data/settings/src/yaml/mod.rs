//! SimBEV2X configurations in YAML, read as ours: every key becomes keys of our own with the same effect, or
//! a warning that names it. The result is TOML text, line by line with the line it came from, and goes
//! through the same checks.

mod names;
mod special;
#[cfg(test)]
mod tests;
mod writer;

use std::collections::BTreeMap;

use saphyr::{LoadableYamlNode, MarkedYaml};

use writer::{Writer, line, pairs, text};

use crate::document::Fault;
pub use names::simbev2x_keys;
pub(crate) use writer::Translation;

/// Translates a YAML text (`source`); `file` is its name in messages.
///
/// # Errors
/// It is no YAML mapping, or it asks for something that is neither creating, replacing nor replaying.
pub(crate) fn translate(source: &str, file: &str) -> Result<Translation, Vec<Fault>> {
    let fault = |line, message: String| vec![Fault { file: file.to_owned(), line, message }];
    let documents = MarkedYaml::load_from_str(source)
        .map_err(|e| fault(Some(e.marker().line()), format!("broken YAML: {}", e.info())))?;
    let mut writer = Writer::new(file);
    let Some(root) = documents.first() else { return Ok(writer.finish()) };
    let Some(pairs) = pairs(root) else {
        return Err(fault(Some(line(root)), "expected keys with values at the top".into()));
    };
    let keys: BTreeMap<&str, &MarkedYaml<'_>> = pairs.iter().map(|(key, _, value)| (*key, *value)).collect();
    if let Some(mode) =
        keys.get("mode").filter(|mode| !matches!(text(mode), Some("create" | "replace" | "replay")))
    {
        return Err(fault(Some(line(mode)), "`mode`: expected create, replace or replay".into()));
    }
    for (key, at, value) in &pairs {
        write_key(&mut writer, key, *at, value, &keys);
    }
    Ok(writer.finish())
}

fn write_key(
    writer: &mut Writer<'_>,
    key: &str,
    at: usize,
    value: &MarkedYaml<'_>,
    all: &BTreeMap<&str, &MarkedYaml<'_>>,
) {
    match names::rule(key) {
        Some(rule) => writer.follow(rule, key, at, value),
        None => {
            if !special::translate(writer, key, at, value, all) {
                writer.warn(at, format!("`{key}`: no such key here, ignored"));
            }
        }
    }
}
