//! Generated pages and schemas must say what the code says.
//! `CONVOY_ACCEPT=1 cargo test -p convoy-settings docs` rewrites them.

use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Compares a part of a file, as `split` finds it after a head that stays, with a text.
fn check(file: &str, split: impl Fn(&str) -> usize, generated: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..").join(file);
    let text = fs::read_to_string(&path).unwrap_or_default();
    let (head, found) = text.split_at(split(&text));
    if std::env::var_os("CONVOY_ACCEPT").is_some() {
        fs::write(&path, format!("{head}{generated}")).expect("the file is written");
        return;
    }
    assert!(
        found == generated,
        "{file} is not what the code says; run CONVOY_ACCEPT=1 cargo test -p convoy-settings docs"
    );
}

#[test]
fn configuration_page_names_every_key() {
    const MARKER: &str = "<!-- generated from the code below this line; a test compares it -->\n";
    let mut text = String::from("\n| key | type | default | meaning |\n|---|---|---|---|\n");
    for key in settings::config_keys() {
        let default = key.default.to_string();
        let default = if default.is_empty() { default } else { format!("`{default}`") };
        let row = [format!("`{}`", key.path), key.kind.to_string(), default, key.doc];
        writeln!(text, "| {} |", row.join(" | ")).expect("writes");
    }
    text.push_str("\n### Keys of SimBEV2X\n\n| key there | here |\n|---|---|\n");
    for (key, ours) in settings::simbev2x_keys() {
        writeln!(text, "| `{key}` | {ours} |").expect("writes");
    }
    let below = |page: &str| page.find(MARKER).expect("the page has the marker") + MARKER.len();
    check("docs/configuration.md", below, &text);
}

#[test]
fn schemas_name_every_key() {
    let text = |schema| serde_json::to_string_pretty(&schema).expect("is JSON") + "\n";
    check("configs/schema.json", |_| 0, &text(settings::json_schema()));
    check("configs/rigs/schema.json", |_| 0, &text(settings::rig_json_schema()));
}
