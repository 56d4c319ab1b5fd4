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
        let folder = if table.is_of_scene() { "scenes/NNNN/" } else { "" };
        write!(text, "\n### `{folder}{}.parquet`\n\n{}\n\n", table.name, table.doc.trim()).expect("writes");
        text.push_str("| column | type | meaning |\n|---|---|---|\n");
        for (field, kind) in table.columns {
            writeln!(text, "| `{}` | {kind} | {} |", field.name, field.doc.trim()).expect("writes");
        }
    }
    text.push_str(
        "\n### Attributes\n\nFields of the struct `attributes`; a fact that is not said of an object is null.\n\n",
    );
    text.push_str("| field | type | meaning |\n|---|---|---|\n");
    for (key, kind, doc) in schema::Attribute::FIELDS {
        writeln!(text, "| `{key}` | {} | {} |", kind.type_name(), doc.trim()).expect("writes");
    }
    writeln!(
        text,
        "| `{}` | string | Facts of imported datasets that have no field, as a JSON object of strings. |",
        schema::OTHER_FACTS
    )
    .expect("writes");
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
    text.push_str("\n### Predictions\n\nWhat `evaluate` reads: one row per box that a model found. Integers and floats of any width, lists of fixed or of any length.\n\n");
    text.push_str("| column | type | meaning |\n|---|---|---|\n");
    for column in evaluation::COLUMNS {
        let doc =
            if column.optional { format!("{} May be left out.", column.doc) } else { column.doc.to_owned() };
        writeln!(text, "| `{}` | {} | {doc} |", column.name, column.type_name()).expect("writes");
    }
    check("schema.md", &text);
}

/// The texts between backquotes on a page, outside blocks of code.
fn quoted(page: &str) -> impl Iterator<Item = &str> {
    let outside = page.split("```").step_by(2).flat_map(str::lines);
    outside.flat_map(|line| line.split('`').skip(1).step_by(2))
}

/// A path of files: no pattern, no placeholder (`lib/NAME`).
fn is_path(text: &str) -> bool {
    let is_placeholder = |part: &str| !part.is_empty() && part.chars().all(|c| c.is_ascii_uppercase());
    text.contains('/')
        && text.chars().all(|c| c.is_ascii_alphanumeric() || "/._-".contains(c))
        && !text.split(['/', '.']).any(is_placeholder)
}

/// Paths that begin with a folder of the workspace or of the page's own one.
#[test]
fn pages_name_files_that_exist() {
    let root = workspace();
    let is_foreign = |entry: &walkdir::DirEntry| {
        let name = entry.file_name().to_string_lossy();
        entry.depth() == 1 && (name == "target" || name == "shared" || name == ".git")
    };
    let files = walkdir::WalkDir::new(&root).sort_by_file_name().into_iter().filter_entry(|e| !is_foreign(e));
    let pages = files.filter_map(Result::ok).filter(|f| f.path().extension().is_some_and(|e| e == "md"));
    let (mut checked, mut missing) = (0, Vec::new());
    for page in pages {
        let text = fs::read_to_string(page.path()).expect("reads");
        let folder = page.path().parent().expect("is in a folder");
        for path in quoted(&text).filter(|text| is_path(text)) {
            let first = path.split('/').next().unwrap_or_default();
            let bases: Vec<_> = [root.as_path(), folder]
                .into_iter()
                .filter(|base| !["", "..", "target"].contains(&first) && base.join(first).is_dir())
                .collect();
            checked += usize::from(!bases.is_empty());
            if !bases.is_empty() && !bases.iter().any(|base| base.join(path).exists()) {
                missing.push(format!("{}: {path}", page.path().display()));
            }
        }
    }
    assert_eq!(missing, [""; 0]);
    assert!(checked > 100, "{checked}");
}
