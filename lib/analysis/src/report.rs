//! One page with everything.

use std::fmt::Write;

use crate::figures::Figure;
use crate::table::{Section, Table, TableColumn, Tables, Values};
use crate::text::{escaped, grouped, words};

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

/// The report: one self-contained HTML page (well-formed as XML too), without scripts or anything to load.
/// Tables and figures without data are left out.
#[must_use]
pub fn report_html(tables: &Tables, figures: &[Figure]) -> String {
    let name = escaped(&tables.dataset);
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <title>{name}: statistics</title>\n<style>{STYLE}</style>\n</head>\n<body>\n\
         <h1>{name}</h1>\n<p>Statistics of the dataset</p>\n"
    );
    let parts: Vec<(Section, String)> = Section::ALL
        .into_iter()
        .map(|section| (section, section_html(section, tables, figures)))
        .filter(|(_, part)| !part.is_empty())
        .collect();
    html.push_str("<nav>\n");
    for (section, _) in &parts {
        let _ = writeln!(html, "<a href=\"#{}\">{}</a>", anchor(*section), section.title());
    }
    html.push_str("</nav>\n");
    for (section, part) in &parts {
        let (anchor, title) = (anchor(*section), section.title());
        let _ = write!(html, "<section id=\"{anchor}\">\n<h2>{title}</h2>\n{part}</section>\n");
    }
    html.push_str("</body>\n</html>\n");
    html
}

/// The section's name in links: its title's first word.
fn anchor(section: Section) -> String {
    section.title().split(' ').next().unwrap_or_default().to_lowercase()
}

fn section_html(section: Section, tables: &Tables, figures: &[Figure]) -> String {
    let mut html = String::new();
    let of_section: Vec<&Figure> = figures.iter().filter(|figure| figure.section == section).collect();
    for group in of_section.chunk_by(|a, b| a.group == b.group) {
        if let Some(heading) = group.first().map(|figure| &figure.group).filter(|heading| !heading.is_empty())
        {
            let _ = writeln!(html, "<h3>{}</h3>", escaped(heading));
        }
        html.push_str("<div class=\"figures\">\n");
        html.extend(group.iter().map(|figure| figure.svg.as_str()));
        html.push_str("</div>\n");
    }
    for table in tables.tables.iter().filter(|table| table.section == section && !table.is_empty()) {
        if section == Section::Overview {
            push_tiles(&mut html, table);
        } else {
            push_table(&mut html, table);
        }
    }
    html
}

/// The overview's few numbers, large.
fn push_tiles(html: &mut String, table: &Table) {
    html.push_str("<div class=\"tiles\">\n");
    for (name, value) in table.strings("quantity").iter().zip(table.counts("value")) {
        let (value, name) = (grouped(&value.to_string()), escaped(&column_title(name)));
        let _ = writeln!(html, "<div class=\"tile\"><b>{value}</b><span>{name}</span></div>");
    }
    html.push_str("</div>\n");
}

fn push_table(html: &mut String, table: &Table) {
    let title = escaped(&table.title);
    // A histogram's numbers are in its figure already.
    let folded =
        table.len() > FOLD_ROWS || table.column("bin").is_some() || table.section == Section::Weather;
    if folded {
        let _ = write!(html, "<details>\n<summary>{title}: numbers</summary>\n");
    } else {
        let _ = writeln!(html, "<h3>{title}</h3>");
    }
    if !table.note.is_empty() {
        let _ = writeln!(html, "<p>{}</p>", escaped(&table.note));
    }
    html.push_str("<div class=\"scroll\">\n<table>\n<thead><tr>");
    for column in &table.columns {
        let _ = write!(html, "<th{}>{}</th>", class_of(&column.values), escaped(&column_title(&column.name)));
    }
    html.push_str("</tr></thead>\n<tbody>\n");
    for row in 0..table.len() {
        let first = table.columns.first().map(|column| column.values.text(row)).unwrap_or_default();
        html.push_str(if first == "total" { "<tr class=\"total\">" } else { "<tr>" });
        for column in &table.columns {
            let _ = write!(html, "<td{}>{}</td>", class_of(&column.values), cell(column, row));
        }
        html.push_str("</tr>\n");
    }
    html.push_str("</tbody>\n</table>\n</div>\n");
    if folded {
        html.push_str("</details>\n");
    }
}

fn class_of(values: &Values) -> &'static str {
    if matches!(values, Values::Str(_)) { " class=\"name\"" } else { "" }
}

fn cell(column: &TableColumn, row: usize) -> String {
    let text = column.values.text(row);
    match (&column.values, column.name.as_str()) {
        (Values::Str(_), "class" | "label") => escaped(&words(&text)),
        (Values::Str(_), _) => escaped(&text),
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
