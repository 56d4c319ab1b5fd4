//! One page with everything, and one beside the published dataset.

use maud::{Markup, PreEscaped, html};

use crate::figures::Figure;
use crate::groups::Group;
use crate::page::{Page, column_title, figures as figures_html, folded, how, numbers, titled, wide};
use crate::table::{Section, Table, Tables};
use crate::text::{duration, grouped, size, spoken, words};

/// File of the page beside the published dataset, in the report's folder.
pub const PUBLISHED_PAGE: &str = "published.html";

/// So many bytes at most does the report have for what is shown of parts of the scenes: some ten of them.
/// Where there are more, filters leave figures and sums as they are, and the page says so.
const GROUPS_BYTES: usize = 6_000_000;

/// A scene as the report shows it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SceneCard {
    /// Its number.
    pub scene: u32,
    /// Its split and map.
    pub split: String,
    /// Its map.
    pub map: String,
    /// Its kind; empty where there is but one.
    pub kind: String,
    /// A few words of it.
    pub words: String,
    /// A small picture of it, from the report's folder on; none where it has no camera.
    pub picture: Option<String>,
}

/// The report: one page (well-formed as XML too) without anything to load but its small pictures of scenes. A
/// small script sorts its tables and filters its scenes; without it the page is whole. Tables and figures
/// without data are left out. Where a filter leaves the scenes of a group, the page shows that one's tables
/// and figures.
#[must_use]
pub fn report_html(
    tables: &Tables,
    figures: &[Figure],
    cards: &[SceneCard],
    groups: impl IntoIterator<Item = Group>,
) -> String {
    let name = &tables.dataset;
    let what = match tables.partial {
        None => "Statistics of the dataset".to_owned(),
        Some([covered, planned]) => {
            format!("Statistics of {covered} of {planned} scenes of the dataset: the others are not finished")
        }
    };
    let parts = sections_html(tables, figures);
    // Cards stay where they are while what is below them changes.
    let cards_of =
        |section: Section| (section == Section::Scenes && !cards.is_empty()).then(|| scene_cards(cards));
    let groups = if cards.is_empty() { Vec::new() } else { templates(groups) };
    let is_beside = has_section(Section::Published, tables);
    let heading = html! {
        h1 { (name) }
        p { (what) }
    };
    let contents = html! {
        @for (section, _) in &parts {
            a href={ "#" (anchor(*section)) } { (section.title()) } "\n"
        }
        @if is_beside {
            a href=(PUBLISHED_PAGE) { (Section::Published.title()) } "\n"
        }
    };
    let body = html! {
        @for (section, part) in &parts {
            section id=(anchor(*section)) {
                h2 { (section.title()) }
                @if let Some(cards) = cards_of(*section) { (cards) }
                div class="part" { (part) }
            }
        }
        @for group in &groups { (group) }
    };
    Page { title: &format!("{name}: statistics"), heading, contents, body }.html()
}

/// The sections that have anything to say, in order.
fn sections_html(tables: &Tables, figures: &[Figure]) -> Vec<(Section, Markup)> {
    let sections = Section::ALL.into_iter().filter(|section| *section != Section::Published);
    let parts = sections.map(|section| (section, section_html(section, tables, figures)));
    parts.filter(|(_, part)| !part.0.is_empty()).collect()
}

/// What is shown instead of the whole where a filter leaves just the scenes of a group; of the first groups,
/// as many as there is room for.
fn templates(groups: impl IntoIterator<Item = Group>) -> Vec<Markup> {
    let mut room = GROUPS_BYTES;
    let made = groups.into_iter().map(|group| {
        let scenes: Vec<String> = group.scenes.iter().map(|scene| format!("{scene:04}")).collect();
        html! {
            template data-scenes=(scenes.join(" ")) {
                @for (section, part) in sections_html(&group.tables, &group.figures) {
                    div data-section=(anchor(section)) { (part) }
                }
            }
            "\n"
        }
    });
    let fits = |template: &Markup| {
        let left = room.checked_sub(template.0.len());
        room = left.unwrap_or_default();
        left.is_some()
    };
    made.take_while(fits).collect()
}

/// The page beside the published dataset; none where nothing of it was counted.
#[must_use]
pub fn published_html(tables: &Tables, figures: &[Figure]) -> Option<String> {
    let section = Section::Published;
    let name = &tables.dataset;
    let of_section = tables.tables.iter().filter(|table| table.section == section && !table.is_empty());
    let drawn =
        |table: &Table| figures.iter().filter(|figure| figure.table == table.name).collect::<Vec<_>>();
    let parts: Vec<(&Table, Vec<&Figure>)> = of_section.map(|table| (table, drawn(table))).collect();
    // Tables whose figures belong together stand together.
    let heading = |(table, figures): &(&Table, Vec<&Figure>)| match figures.first() {
        Some(figure) if !figure.group.is_empty() => figure.group.clone(),
        _ => table.title.clone(),
    };
    let page_heading = html! {
        h1 { (name) " beside SimBEV2X" }
        p {
            "Numbers of this dataset (ours) and of the published SimBEV2X dataset of 258 scenes, per scene, frame or grid where \
             that makes sizes comparable. Other maps, traffic and grids give other numbers: a ratio of 1 is no aim."
        }
    };
    let groups: Vec<&[(&Table, Vec<&Figure>)]> = parts.chunk_by(|a, b| heading(a) == heading(b)).collect();
    let contents = html! {
        a href="report.html" { "All statistics" } "\n"
        @for (i, group) in groups.iter().enumerate() {
            a href={ "#part-" (i) } { (heading(&group[0])) } "\n"
        }
    };
    let body = html! {
        @for (i, group) in groups.iter().enumerate() {
            section id={ "part-" (i) } {
                h2 { (heading(&group[0])) }
                div class="part" {
                    (figures_html("", &titled(group.iter().flat_map(|(_, figures)| figures.iter().copied()))))
                    @for (table, figures) in *group {
                        div class=[wide(table)] { @if figures.is_empty() { (numbers(table)) } @else { (folded(table, true)) } }
                    }
                }
            }
        }
    };
    let title = format!("{name} beside SimBEV2X");
    has_section(section, tables).then(|| Page { title: &title, heading: page_heading, contents, body }.html())
}

fn has_section(section: Section, tables: &Tables) -> bool {
    tables.tables.iter().any(|table| table.section == section && !table.is_empty())
}

/// Every scene with its picture, to be filtered by split, map and kind; each leads to the viewer where that
/// serves the page.
fn scene_cards(cards: &[SceneCard]) -> Markup {
    let values = |of: fn(&SceneCard) -> &str| {
        let mut values: Vec<&str> = cards.iter().map(of).collect();
        values.sort_unstable();
        values.dedup();
        values
    };
    let mut choices = vec![("split", values(|card| &card.split)), ("map", values(|card| &card.map))];
    let kinds = values(|card| &card.kind);
    choices.extend((kinds.len() > 1).then_some(("group", kinds)));
    html! {
            div class="choices" hidden="hidden" {
                @for (name, values) in &choices {
                    label {
                        (name) " "
                        select name=(name) {
                            option value="" { "all" }
                            @for value in values { option value=(value) { (value) } }
                        }
                    }
                }
                output { "" }
            }
            div class="cards" {
                @for card in cards {
                    a class="card" href="#" data-scene=(format!("{:04}", card.scene)) data-split=(card.split) data-map=(card.map) data-group=(card.kind) {
                        @if let Some(picture) = &card.picture {
                            (PreEscaped(image(picture, card.scene)))
                        }
                        b { (format!("{:04}", card.scene)) " " (card.map) }
                        span { (card.split) ", " @if !card.kind.is_empty() { (card.kind) ", " } (card.words) }
                    }
                    "\n"
                }
            }
            (how("this report with links to every scene"))
    }
}

/// Written out because maud leaves elements without content open, as XML may not. Paths are of our own
/// making: digits and letters.
fn image(path: &str, scene: u32) -> String {
    format!("<img src=\"{path}\" alt=\"scene {scene}\" loading=\"lazy\"/>")
}

/// The section's name in links: its title's first word.
fn anchor(section: Section) -> String {
    section.title().split(' ').next().unwrap_or_default().to_lowercase()
}

/// Whether a table has rows, and one of weather any scene in them.
fn says_anything(table: &Table) -> bool {
    !table.is_empty() && (table.section != Section::Weather || table.counts("scenes").iter().any(|&n| n > 0))
}

fn section_html(section: Section, tables: &Tables, figures: &[Figure]) -> Markup {
    let of_section: Vec<&Figure> = figures.iter().filter(|figure| figure.section == section).collect();
    // The numbers of what is drawn are a click away.
    let is_drawn = |table: &Table| of_section.iter().any(|figure| figure.table == table.name);
    // Figures that belong together stand across the page: what fits into its columns comes after them.
    let (mut alone, mut together): (Vec<_>, Vec<_>) = of_section
        .chunk_by(|a, b| !a.group.is_empty() && a.group == b.group)
        .partition(|group| group.len() == 1);
    together.append(&mut alone);
    html! {
        @for group in together {
            (figures_html(&group[0].group, &titled(group.iter().copied())))
        }
        @for table in tables.tables.iter().filter(|table| table.section == section && says_anything(table)) {
            @if section == Section::Overview { (tiles(table)) } @else {
                div class=[wide(table)] { (folded(table, is_drawn(table))) }
            }
        }
    }
}

/// The overview's few numbers, large, and in the units that people use; exact ones for who points at them.
fn tiles(table: &Table) -> Markup {
    let said = |name: &str, value: u64| match name.strip_suffix("_s") {
        _ if name == "sensor_bytes" => ("sensor data".to_owned(), size(value)),
        Some(stem) => (words(stem), duration(value)),
        None => (column_title(name), spoken(value)),
    };
    html! {
        div class="tiles wide" {
            @for (name, &value) in table.strings("quantity").iter().zip(table.counts("value")) {
                @let (what, number) = said(name, value);
                div class="tile" title=(grouped(&value.to_string())) {
                    b { (number) }
                    span { (what) }
                }
            }
        }
    }
}
