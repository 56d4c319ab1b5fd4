//! One page with everything.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::figures::Figure;
use crate::table::{Section, Table, TableColumn, Tables, Values};
use crate::text::{grouped, printable, words};

/// Longer tables are folded away behind their heading; on paper they are open.
const FOLD_ROWS: usize = 16;

const STYLE: &str = "
:root { color-scheme: light dark; --ink: #1d2127; --page: #ffffff; --faint: #667080; --line: #d9dee5; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #dde2e9; --page: #15181c; --faint: #98a2b0; --line: #343a43; }
}
body { font: 15px/1.5 system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif; color: var(--ink);
  background: var(--page); max-width: 1120px; margin: 0 auto; padding: 24px; }
h1 { font-size: 26px; margin: 0 0 4px; }
h2 { font-size: 20px; margin: 44px 0 8px; padding-bottom: 4px; border-bottom: 1px solid var(--line); }
h3 { font-size: 15px; margin: 24px 0 6px; }
p { margin: 4px 0; color: var(--faint); }
nav a { margin-right: 14px; color: inherit; }
.tiles { display: flex; flex-wrap: wrap; gap: 10px; margin: 12px 0; }
.tile { border: 1px solid var(--line); border-radius: 6px; padding: 8px 14px; min-width: 110px; }
.tile b { display: block; font-size: 20px; font-weight: 600; font-variant-numeric: tabular-nums; }
.tile span { color: var(--faint); font-size: 13px; }
.figures { display: flex; flex-wrap: wrap; align-items: flex-start; gap: 18px 28px; margin: 10px 0; }
.figures svg { max-width: 100%; height: auto; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: 13px; font-variant-numeric: tabular-nums; margin: 6px 0; }
th, td { padding: 3px 10px; border-bottom: 1px solid var(--line); text-align: right; white-space: nowrap; }
th { font-weight: 600; vertical-align: bottom; }
th.name, td.name { text-align: left; }
tr.total td { font-weight: 600; border-top: 2px solid var(--line); }
summary { cursor: pointer; margin: 6px 0; }
@media print {
  :root { --ink: #000000; --page: #ffffff; --faint: #444444; --line: #bbbbbb; }
  body { max-width: none; padding: 0; font-size: 11px; }
  nav { display: none; }
  details::details-content { content-visibility: visible; height: auto; }
  .scroll { overflow: visible; }
  table { font-size: 9px; }
  th, td { padding: 2px 5px; }
  svg, tr, .tile { break-inside: avoid; }
  h2, h3, summary { break-after: avoid; }
}
";

/// Written out because maud leaves elements without content open, as XML may not.
const META: &str = "<meta charset=\"utf-8\"/>\n\
    <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n";

/// The report: one self-contained HTML page (well-formed as XML too), without scripts or anything to load.
/// Tables and figures without data are left out.
#[must_use]
pub fn report_html(tables: &Tables, figures: &[Figure]) -> String {
    let name = &tables.dataset;
    let what = match tables.partial {
        None => "Statistics of the dataset".to_owned(),
        Some([covered, planned]) => {
            format!("Statistics of {covered} of {planned} scenes of the dataset: the others are not finished")
        }
    };
    let parts = Section::ALL.map(|section| (section, section_html(section, tables, figures)));
    let parts: Vec<_> = parts.into_iter().filter(|(_, part)| !part.0.is_empty()).collect();
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                (PreEscaped(META))
                title { (name) ": statistics" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { (name) }
                p { (what) }
                nav {
                    @for (section, _) in &parts {
                        a href={ "#" (anchor(*section)) } { (section.title()) } "\n"
                    }
                }
                @for (section, part) in &parts {
                    section id=(anchor(*section)) {
                        h2 { (section.title()) }
                        (part)
                    }
                }
            }
        }
        "\n"
    };
    printable(&page.into_string())
}

/// The section's name in links: its title's first word.
fn anchor(section: Section) -> String {
    section.title().split(' ').next().unwrap_or_default().to_lowercase()
}

fn section_html(section: Section, tables: &Tables, figures: &[Figure]) -> Markup {
    let of_section: Vec<&Figure> = figures.iter().filter(|figure| figure.section == section).collect();
    html! {
        @for group in of_section.chunk_by(|a, b| a.group == b.group) {
            @if let Some(figure) = group.first().filter(|figure| !figure.group.is_empty()) {
                h3 { (figure.group) }
            }
            div class="figures" {
                @for figure in group { (PreEscaped(&figure.svg)) }
            }
        }
        @for table in tables.tables.iter().filter(|table| table.section == section && !table.is_empty()) {
            @if section == Section::Overview { (tiles(table)) } @else { (folded(table)) }
        }
    }
}

/// The overview's few numbers, large.
fn tiles(table: &Table) -> Markup {
    html! {
        div class="tiles" {
            @for (name, value) in table.strings("quantity").iter().zip(table.counts("value")) {
                div class="tile" {
                    b { (grouped(&value.to_string())) }
                    span { (column_title(name)) }
                }
            }
        }
    }
}

/// A table below its heading, folded away where its numbers are many or in a figure already.
fn folded(table: &Table) -> Markup {
    let folds = table.len() > FOLD_ROWS || table.column("bin").is_some() || table.section == Section::Weather;
    html! {
        @if folds {
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

fn numbers(table: &Table) -> Markup {
    let is_total = |row| table.columns.first().is_some_and(|column| column.values.text(row) == "total");
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
                        tr class=[is_total(row).then_some("total")] {
                            @for column in &table.columns {
                                td class=[class_of(&column.values)] { (cell(column, row)) }
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

fn cell(column: &TableColumn, row: usize) -> String {
    let text = column.values.text(row);
    match (&column.values, column.name.as_str()) {
        (Values::Str(_), "class" | "label") => words(&text),
        (Values::Str(_), _) => text,
        _ if text.is_empty() => "\u{2013}".into(),
        _ => grouped(&text),
    }
}

/// A column's name as words, with its unit set apart.
fn column_title(name: &str) -> String {
    let units = [("_s", ", s"), ("_percent", ", %"), ("_m", ", m")];
    let split = units.into_iter().find_map(|(end, unit)| Some((name.strip_suffix(end)?, unit)));
    match (name, split) {
        ("percent", _) => "%".into(),
        (_, Some((stem, unit))) => words(stem) + unit,
        _ => words(name),
    }
}
