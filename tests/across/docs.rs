//! Generated pages must say what the code says. `CONVOY_ACCEPT=1 cargo test -p convoy-tests docs` rewrites
//! them.

use std::fmt::Write;
use std::fs;

use convoy_tests::workspace;
use schema::images::ImageEncoding;

/// Compares the part of a page below its marker with a text.
fn check(page: &str, generated: &str) {
    const MARKER: &str = "<!-- generated from the code below this line; a test compares it -->\n";
    let path = workspace().join("docs").join(page);
    let text = fs::read_to_string(&path).expect("the page exists");
    let (head, found) = text.split_once(MARKER).expect("the page has the marker");
    if std::env::var_os("CONVOY_ACCEPT").is_some() {
        fs::write(&path, format!("{head}{MARKER}{generated}")).expect("the page is written");
        return;
    }
    assert!(
        found == generated,
        "docs/{page} is not what the code says; run CONVOY_ACCEPT=1 cargo test -p convoy-tests docs"
    );
}

#[test]
fn schema_page_names_every_column() {
    let mut text = String::new();
    for table in schema::tables::every_table() {
        let per_scene = !table.name.starts_with("plan/") && !table.name.starts_with("maps/");
        let folder = if per_scene { "scenes/NNNN/" } else { "" };
        write!(text, "\n### `{folder}{}.parquet`\n\n{}\n\n", table.name, table.doc.trim()).expect("writes");
        text.push_str("| column | type | meaning |\n|---|---|---|\n");
        for (field, kind) in table.columns {
            writeln!(text, "| `{}` | {kind} | {} |", field.name, field.doc.trim()).expect("writes");
        }
    }
    text.push_str(
        "\n### Kinds of images\n\n| kind | pixels | kept as | switched on by |\n|---|---|---|---|\n",
    );
    for kind in schema::ImageKind::ALL {
        let spec = kind.spec();
        let kept_as = match spec.encoding {
            ImageEncoding::Jpeg => "JPEG",
            ImageEncoding::Png => "PNG",
            ImageEncoding::Columns => "columns",
        };
        let line = [
            format!("`{}`", spec.prefix),
            spec.doc.trim().into(),
            kept_as.into(),
            format!("`{}`", spec.flag),
        ];
        writeln!(text, "| {} |", line.join(" | ")).expect("writes");
    }
    check("schema.md", &text);
}

#[test]
fn configuration_page_names_every_key() {
    let mut text = String::from("\n| key | type | default | meaning |\n|---|---|---|---|\n");
    for key in pipeline::config_keys() {
        let default = if key.default.is_empty() { String::new() } else { format!("`{}`", key.default) };
        let row = [format!("`{}`", key.path), key.kind, default, key.doc];
        writeln!(text, "| {} |", row.join(" | ")).expect("writes");
    }
    text.push_str("\n### Keys of SimBEV2X\n\n| key there | here |\n|---|---|\n");
    for (key, ours) in pipeline::simbev2x_keys() {
        writeln!(text, "| `{key}` | {ours} |").expect("writes");
    }
    check("configuration.md", &text);
}
