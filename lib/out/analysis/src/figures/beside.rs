//! Figures of our numbers beside the published ones.

use super::figure::{Figure, STEPS, figure};
use super::histogram::Histogram;
use super::matrix::Matrix;
use super::pairs::Pairs;
use crate::compute::{
    FRAMES_TABLE, PUBLISHED, SCENE_HISTOGRAMS, SIZE_TABLE, WEATHER_TABLES, by_size_table, weather_table,
};
use crate::table::{Section, Table, Tables, Values};
use crate::text::words;

/// How bars and lines are told apart.
const LEGEND: &str = "bars: ours, line: published";

/// Every figure of the page beside the published dataset.
pub(super) fn published_figures(tables: &Tables) -> Vec<Figure> {
    let mut figures = Vec::new();
    let by_size: Vec<String> = SCENE_HISTOGRAMS.iter().map(by_size_table).collect();
    let weather: Vec<String> = WEATHER_TABLES.iter().map(weather_table).collect();
    let is_there = |table: &&Table| table.section == Section::Published && !table.is_empty();
    for table in tables.tables.iter().filter(is_there) {
        if by_size.contains(&table.name) {
            figures.push(by_size_figure(table));
        } else if let Some(k) = weather.iter().position(|name| *name == table.name) {
            figures.extend(matrices(table, WEATHER_TABLES[k].bins));
        } else if table.name == FRAMES_TABLE {
            figures.extend(frames_figures(table));
        } else if table.name != SIZE_TABLE {
            figures.push(pairs_figure(table));
        }
    }
    figures
}

fn plain(values: &[Option<f64>]) -> Vec<f64> {
    values.iter().map(|value| value.unwrap_or(0.0)).collect()
}

/// Scenes by a number.
fn by_size_figure(table: &Table) -> Figure {
    let histogram = Histogram {
        title: table.title.clone(),
        x_label: table.title.to_lowercase(),
        y_label: "scenes, %".into(),
        labels: table.strings("bin").to_vec(),
        values: plain(table.numbers("ours")),
        line: plain(table.numbers("published")),
        edges: false,
        steps: STEPS,
        width: 400.0,
    };
    let group = format!("Scenes by size ({LEGEND})");
    Figure { group, ..figure(table, &table.title, histogram.draw()) }
}

/// Frames by valid objects, a figure a class.
fn frames_figures(table: &Table) -> Vec<Figure> {
    let names = table.columns.iter().map(|column| column.name.as_str());
    let classes = names.filter(|name| table.column(&format!("{name}{PUBLISHED}")).is_some());
    // Bins are named by their lower edge; the open one keeps its sign.
    let edge = |bin: &String| bin.split('-').next().unwrap_or_default().to_owned();
    let labels: Vec<String> = table.strings("bin").iter().map(edge).collect();
    let drawn = classes.map(|class| {
        let histogram = Histogram {
            title: words(class),
            x_label: "valid objects in a frame".into(),
            y_label: "frames, %".into(),
            labels: labels.clone(),
            values: plain(table.numbers(class)),
            line: plain(table.numbers(&format!("{class}{PUBLISHED}"))),
            edges: true,
            steps: STEPS,
            width: 320.0,
        };
        let (name, group) = (format!("{}_{class}", table.name), format!("{} ({LEGEND})", table.title));
        Figure { name, group, ..figure(table, &words(class), histogram.draw()) }
    });
    drawn.collect()
}

/// Two matrices of weather.
fn matrices(table: &Table, labels: &[&str]) -> [Figure; 2] {
    [("ours", "scenes", "ours"), ("published", "published_scenes", "published")].map(
        |(whose, scenes, fractions)| {
            let title = format!("{}, {whose}", table.title);
            let matrix = Matrix {
                title: title.clone(),
                labels,
                counts: table.counts(scenes),
                fractions: table.numbers(fractions),
            };
            let group = "Weather from the start (rows) to the end (columns) of a scene".into();
            Figure { name: format!("{}_{whose}", table.name), group, ..figure(table, &title, matrix.draw()) }
        },
    )
}

/// Two bars a row.
fn pairs_figure(table: &Table) -> Figure {
    let decimals = match table.column("ours") {
        Some(Values::F64 { decimals, .. }) => *decimals,
        _ => 0,
    };
    let pairs = Pairs {
        title: &table.title,
        names: ["ours", "published"],
        labels: table.columns.first().map_or(&[][..], |first| table.strings(&first.name)),
        values: [table.numbers("ours"), table.numbers("published")],
        decimals,
    };
    figure(table, &table.title, pairs.draw())
}
