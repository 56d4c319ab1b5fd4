//! What pages have in common: style, script, tables.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::figures::Figure;
use crate::table::{Table, TableColumn, Values};
use crate::text::{grouped, printable, size, words};

/// Longer tables are folded away behind their heading; on paper they are open.
const FOLD_ROWS: usize = 12;
/// Still longer ones are left to the file beside the page, unless their rows are scenes.
const FILE_ROWS: usize = 400;

/// Of groups of more figures than this, the first few are shown and the others are folded away.
const FOLD_FIGURES: usize = 6;
const SHOWN_FIGURES: usize = 4;
/// More figures than this stand across the page, not in one of its columns.
const COLUMN_FIGURES: usize = 1;
/// So do tables of more columns than this.
const COLUMN_COLUMNS: usize = 6;

const STYLE: &str = include_str!("page/style.css");
const SCRIPT: &str = include_str!("page/script.js");

/// Columns of sizes.
const BYTES: &str = "bytes";

/// Written out because maud leaves elements without content open, as XML may not. An icon of nothing keeps
/// browsers from asking servers for one.
const META: &str = "<meta charset=\"utf-8\"/>\n\
    <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<link rel=\"icon\" href=\"data:,\"/>\n";

/// A page: its heading, links to its parts and elsewhere, which stay in sight, and what it tells.
pub(crate) struct Page<'a> {
    pub(crate) title: &'a str,
    pub(crate) heading: Markup,
    pub(crate) contents: Markup,
    pub(crate) body: Markup,
}

impl Page<'_> {
    /// Self-contained (well-formed as XML, too): nothing of it is loaded from elsewhere but pictures beside
    /// it.
    pub(crate) fn html(&self) -> String {
        let Self { title, heading, contents, body } = self;
        // Scripts are text to browsers and markup to readers of XML: both pass over the other's comments.
        let script = format!("<script>/*<![CDATA[*/\n{SCRIPT}/*]]>*/</script>\n");
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    (PreEscaped(META))
                    title { (title) }
                    style { (PreEscaped(typeface::css())) (PreEscaped(STYLE)) }
                }
                body {
                    header { (heading) }
                    div class="page" {
                        nav { (contents) }
                        main { (body) }
                    }
                    (PreEscaped(&script))
                }
            }
            "\n"
        };
        printable(&page.into_string())
    }
}

/// Figures that belong together, below their heading.
pub(crate) fn figures(heading: &str, figures: &[(&str, &str)]) -> Markup {
    let shown = if figures.len() > FOLD_FIGURES { SHOWN_FIGURES } else { figures.len() };
    let (first, rest) = figures.split_at(shown);
    let titles: Vec<&str> = rest.iter().map(|(title, _)| *title).collect();
    let drawn = |figures: &[(&str, &str)]| {
        html! { div class="figures" { @for (_, svg) in figures { (PreEscaped(svg)) } } }
    };
    html! {
        div class=[(figures.len() > COLUMN_FIGURES).then_some("wide")] {
            @if !heading.is_empty() { h3 { (heading) } }
            (drawn(first))
            @if !rest.is_empty() {
                details {
                    summary { (rest.len()) " more: " (titles.join(", ")) }
                    (drawn(rest))
                }
            }
        }
    }
}

/// The class of a table that needs the page's whole width.
pub(crate) fn wide(table: &Table) -> Option<&'static str> {
    (table.columns.len() > COLUMN_COLUMNS).then_some("wide")
}

/// Titles and pictures of figures.
pub(crate) fn titled<'f>(figures: impl IntoIterator<Item = &'f Figure>) -> Vec<(&'f str, &'f str)> {
    figures.into_iter().map(|figure| (&*figure.title, &*figure.svg)).collect()
}

/// What a click on a link to the viewer says where no viewer shows the page.
pub(crate) fn how(what_it_shows: &str) -> Markup {
    html! {
        div id="how" hidden="hidden" {
            "To look at " b { "a scene" } " run " code { "convoy view STORE" } ", which also shows " (what_it_shows) "."
        }
    }
}

/// A table below its heading, folded away where its numbers are many or in a figure already.
pub(crate) fn folded(table: &Table, is_drawn: bool) -> Markup {
    let folds = table.len() > FOLD_ROWS || table.column("bin").is_some() || is_drawn;
    let is_long = table.len() > FILE_ROWS && table.column("scene").is_none();
    html! {
        @if is_long {
            p { (table.title) ": " a href={ (table.name) ".csv" } { (grouped(&table.len().to_string())) " rows" } ". " (table.note) }
        } @else if folds {
            details {
                summary { (table.title) ": numbers" }
                (numbers(table))
            }
        } @else {
            h3 { (table.title) }
            (numbers(table))
        }
    }
}

/// A table; a click on a heading sorts it. Rows of scenes say which split, map and group they are of.
pub(crate) fn numbers(table: &Table) -> Markup {
    let is_total = |row| table.columns.first().is_some_and(|column| column.values.text(row) == "total");
    let is_of_scenes = table.column("scene").is_some();
    let of = |column: &str, row: usize| {
        let found = table.strings(column).get(row).filter(|_| is_of_scenes);
        found.cloned()
    };
    html! {
        @if !table.note.is_empty() {
            p { (table.note) }
        }
        div class="scroll" {
            table {
                thead {
                    tr {
                        @for column in &table.columns {
                            th class=[class_of(&column.values)] { (column_title(&column.name)) }
                        }
                    }
                }
                tbody {
                    @for row in 0..table.len() {
                        tr class=[is_total(row).then_some("total")] data-split=[of("split", row)] data-map=[of("map", row)] data-group=[of("group", row)] {
                            @for column in &table.columns {
                                td class=[class_of(&column.values)] data-value=[exact(column, row)] { (cell(column, row)) }
                            }
                        }
                        "\n"
                    }
                }
            }
        }
    }
}

fn class_of(values: &Values) -> Option<&'static str> {
    matches!(values, Values::Str(_)).then_some("name")
}

/// What tables are sorted by and show to a pointer, where a cell has a rounded number.
fn exact(column: &TableColumn, row: usize) -> Option<String> {
    match &column.values {
        Values::U64(_) if column.name == BYTES => Some(column.values.text(row)),
        _ => None,
    }
}

fn cell(column: &TableColumn, row: usize) -> String {
    let text = column.values.text(row);
    if let Values::U64(values) = &column.values
        && column.name == BYTES
    {
        return values.get(row).map(|bytes| size(*bytes)).unwrap_or_default();
    }
    match (&column.values, column.name.as_str()) {
        (Values::Str(_), "class" | "label") => words(&text),
        (Values::Str(_), _) => text,
        _ if text.is_empty() => "\u{2013}".into(),
        _ => grouped(&text),
    }
}

/// A column's name as words, with its unit set apart.
pub(crate) fn column_title(name: &str) -> String {
    let units = [("_s", ", s"), ("_percent", ", %"), ("_m", ", m"), ("_deg", ", degrees")];
    let split = units.into_iter().find_map(|(end, unit)| Some((name.strip_suffix(end)?, unit)));
    match (name, split) {
        ("percent", _) => "%".into(),
        (BYTES, _) => "size".into(),
        (_, Some((stem, unit))) => words(stem) + unit,
        _ => words(name),
    }
}
