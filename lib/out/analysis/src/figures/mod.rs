//! Figures of the tables.

mod bars;
mod beside;
mod curves;
mod density;
mod figure;
mod histogram;
mod matrix;
mod pairs;
mod scale;
mod scores;
mod sightings;
mod svg;

use crate::compute::{
    MOTION_TABLES, PLACE_TABLES, POINT_TABLES, SCENE_HISTOGRAMS, SPREAD_TABLES, WEATHER_TABLES, WeatherTable,
};
use crate::table::{Table, Tables};
use crate::text::words;
use bars::{Bar, Bars};
use beside::published_figures;
pub use figure::Figure;
use figure::{STEPS, figure};
use histogram::Histogram;
use matrix::Matrix;
use scale::Scale;
pub use scores::{FoundBar, PrecisionCurves};
pub(crate) use scores::{found_figure, precision_figure};
use sightings::{heat_figures, place_figures, points_figure, spread_figures};

/// The same for headings in bins of 10 degrees: quarter turns.
const QUARTERS: &[usize] = &[9, 18];

/// Every figure that the tables have data for.
#[must_use]
pub fn draw_figures(tables: &Tables) -> Vec<Figure> {
    let mut figures = Vec::new();
    let present = |name: &str| tables.get(name).filter(|table| !table.is_empty());
    for spec in &SCENE_HISTOGRAMS {
        figures.extend(present(spec.table).map(|table| scenes_figure(table, spec.title)));
    }
    for spec in &WEATHER_TABLES {
        figures
            .extend(present(spec.table).filter(|t| has_scenes(t)).map(|table| weather_figure(table, spec)));
    }
    figures.extend(present("boxes_per_class").map(boxes_figure));
    for spec in &MOTION_TABLES {
        figures.extend(present(spec.table).into_iter().flat_map(class_figures));
    }
    for (name, ..) in POINT_TABLES {
        figures.extend(present(name).map(points_figure));
    }
    for (name, ..) in SPREAD_TABLES {
        figures.extend(present(name).into_iter().flat_map(spread_figures));
    }
    for (name, ..) in PLACE_TABLES {
        figures.extend(present(name).into_iter().flat_map(place_figures));
    }
    figures.extend(present("bev_cells").map(bev_figure));
    figures.extend(present("bev_heat").into_iter().flat_map(heat_figures));
    figures.extend(present("voxel_cells").map(occupancy_figure));
    figures.extend(present("bytes_per_sensor").map(bytes_figure));
    figures.extend(published_figures(tables));
    figures
}

fn scenes_figure(table: &Table, title: &str) -> Figure {
    let values = table.counts("scenes").iter().map(|&n| n as f64).collect();
    let svg = Histogram {
        title: title.to_owned(),
        x_label: title.to_lowercase(),
        y_label: "scenes".into(),
        labels: table.strings("bin").to_vec(),
        values,
        line: Vec::new(),
        edges: false,
        steps: STEPS,
        width: 400.0,
    };
    Figure { group: "Scenes by size".into(), ..figure(table, title, svg.draw()) }
}

fn has_scenes(table: &Table) -> bool {
    table.counts("scenes").iter().any(|&n| n > 0)
}

fn weather_figure(table: &Table, spec: &WeatherTable) -> Figure {
    let matrix = Matrix {
        title: spec.title.to_owned(),
        labels: spec.bins,
        counts: table.counts("scenes"),
        fractions: table.numbers("fraction"),
    };
    let group = "Weather from the start (rows) to the end (columns) of a scene".into();
    Figure { group, ..figure(table, spec.title, matrix.draw()) }
}

fn boxes_figure(table: &Table) -> Figure {
    let columns = table.counts("all").iter().zip(table.counts("valid"));
    let bars = class_rows(table, "class").zip(columns).map(|(label, (&all, &valid))| {
        let percent = if all > 0 {
            format!(" ({:.1} % valid)", 100.0 * valid as f64 / all as f64)
        } else {
            String::new()
        };
        Bar { label, outer: all, inner: Some(valid), note: percent }
    });
    let bars: Vec<Bar> = bars.collect();
    let scale = Scale::linear(largest(&bars));
    let title = "Objects per class";
    let svg = Bars {
        title: title.into(),
        axis: "objects, once a frame".into(),
        legend: Some(["all", "valid"]),
        bars,
        scale,
        is_size: false,
    };
    figure(table, title, svg.draw())
}

fn bev_figure(table: &Table) -> Figure {
    let cells = class_rows(table, "class").zip(table.counts("cells")).zip(table.numbers("percent_of_grid"));
    let bars: Vec<Bar> = cells
        .map(|((label, &cells), percent)| {
            let note = percent.map(|percent| format!(" ({percent:.4} % of the grid)")).unwrap_or_default();
            Bar { label, outer: cells, inner: None, note }
        })
        .collect();
    let scale = log_scale(&bars);
    let title = "BEV cells per class";
    let svg = Bars {
        title: title.into(),
        axis: "cells (logarithmic)".into(),
        legend: None,
        bars,
        scale,
        is_size: false,
    };
    figure(table, title, svg.draw())
}

fn occupancy_figure(table: &Table) -> Figure {
    let filled = table.counts("filled").iter().any(|&n| n > 0);
    let rows =
        table.counts("unfilled").iter().zip(table.counts("filled")).zip(table.numbers("filled_by_unfilled"));
    let bars: Vec<Bar> = class_rows(table, "label")
        .zip(rows)
        .map(|(label, ((&unfilled, &full), ratio))| {
            let note = ratio.map(|ratio| format!(" (\u{d7} {ratio:.3})")).unwrap_or_default();
            // Filling only adds; the outer bar is the longer one.
            if filled {
                Bar { label, outer: full, inner: Some(unfilled), note }
            } else {
                Bar { label, outer: unfilled, inner: None, note }
            }
        })
        .collect();
    let scale = log_scale(&bars);
    let title = "Voxels per label";
    let legend = filled.then_some(["filled", "unfilled"]);
    let svg = Bars {
        title: title.into(),
        axis: "voxels (logarithmic)".into(),
        legend,
        bars,
        scale,
        is_size: false,
    };
    figure(table, title, svg.draw())
}

fn bytes_figure(table: &Table) -> Figure {
    let rows = table.counts("bytes").iter().zip(table.numbers("percent"));
    let bars: Vec<Bar> = table
        .strings("sensor")
        .iter()
        .zip(rows)
        .map(|(sensor, (&bytes, percent))| {
            let note = percent.map(|percent| format!(" ({percent:.2} %)")).unwrap_or_default();
            Bar { label: sensor.clone(), outer: bytes, inner: None, note }
        })
        .collect();
    let scale = Scale::linear(largest(&bars));
    let title = "Size of sensor data";
    let svg =
        Bars { title: title.into(), axis: "size on disk".into(), legend: None, bars, scale, is_size: true };
    figure(table, title, svg.draw())
}

/// One small histogram a class that has any objects.
fn class_figures(table: &Table) -> Vec<Figure> {
    let y_label = if table.name == "valid_per_frame" { "frames" } else { "objects" };
    let x_label = match table.name.as_str() {
        "valid_per_frame" => "valid objects in a frame",
        "yaw" => "heading, degrees",
        "speed" => "speed, m/s",
        _ => "turning rate, degrees/s",
    };
    // Lower edges name the bins; the open ones keep their signs.
    let names = table.strings("bin").iter().zip(table.numbers("lower"));
    let labels: Vec<String> = names
        .map(|(bin, lower)| match lower {
            Some(lower) if !bin.starts_with('<') && !bin.ends_with('+') => format!("{lower:.0}"),
            _ => bin.clone(),
        })
        .collect();
    let classes = table.columns.iter().skip(2).map(|column| column.name.as_str());
    classes
        .filter(|class| table.counts(class).iter().any(|&n| n > 0))
        .map(|class| {
            let svg = Histogram {
                title: words(class),
                x_label: x_label.into(),
                y_label: y_label.into(),
                labels: labels.clone(),
                values: table.counts(class).iter().map(|&n| n as f64).collect(),
                line: Vec::new(),
                edges: true,
                steps: if table.name == "yaw" { QUARTERS } else { STEPS },
                width: 320.0,
            };
            let (name, group) = (format!("{}_{class}", table.name), table.title.clone());
            Figure { name, group, ..figure(table, &words(class), svg.draw()) }
        })
        .collect()
}

/// Names of the rows but the last, which is the total.
fn class_rows<'a>(table: &'a Table, column: &str) -> impl Iterator<Item = String> + use<'a> {
    let names = table.strings(column);
    names[..names.len().saturating_sub(1)].iter().map(|name| words(name))
}

fn largest(bars: &[Bar]) -> f64 {
    bars.iter().map(|bar| bar.outer).max().unwrap_or(0) as f64
}

fn log_scale(bars: &[Bar]) -> Scale {
    let values = bars.iter().flat_map(|bar| [Some(bar.outer), bar.inner]).flatten().filter(|&n| n > 0);
    Scale::log(values.min().unwrap_or(1) as f64, largest(bars))
}
