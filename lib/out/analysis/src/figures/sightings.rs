//! Where things are: points by distance, places around agents, BEV classes by place.

use schema::DetectionClass;
use schema::measures::sightings::{LEVELS, LEVELS_PER_DECADE, PLACE_M, PLACES, POINTS_STEP_M, POINTS_STEPS};

use super::curves::{Curve, Curves};
use super::density::{Axis, Density};
use super::figure::{Figure, figure};
use super::scale::Scale;
use crate::table::Table;
use crate::text::words;

/// Side of a heat map, pixels.
const SIDE: f64 = 200.0;
/// Medians of fewer objects say nothing.
const LEAST_OBJECTS: u64 = 5;

/// The median of points over distance, a curve for each class.
pub(super) fn points_figure(table: &Table) -> Figure {
    let (classes, from) = (table.strings("class"), table.numbers("from_m"));
    let rows = classes.iter().zip(from).zip(table.counts("objects").iter().zip(table.numbers("median")));
    let of = |class: &str| -> Vec<[f64; 2]> {
        let own = rows
            .clone()
            .filter(|((name, _), (objects, _))| name.as_str() == class && **objects >= LEAST_OBJECTS);
        own.filter_map(|((_, from), (_, median))| Some([(*from)? + 0.5 * POINTS_STEP_M, (*median)?]))
            .collect()
    };
    let mut names: Vec<&String> = classes.iter().collect();
    names.dedup();
    let curves = names.into_iter().map(|class| Curve {
        label: words(class),
        rgb: DetectionClass::from_name(class).map_or([128; 3], DetectionClass::rgb),
        points: of(class),
    });
    let curves: Vec<Curve> = curves.filter(|curve| !curve.points.is_empty()).collect();
    let curves = Curves {
        title: &table.title,
        x_label: "distance from the agent, m",
        y_label: "points, median (logarithmic)",
        x_max: POINTS_STEP_M * f64::from(POINTS_STEPS),
        x_steps: 6,
        scale: Scale::log(1.0, curves.iter().flat_map(|c| &c.points).map(|p| p[1]).fold(1.0, f64::max)),
        width: 620.0,
        curves,
    };
    figure(table, &table.title, curves.draw())
}

/// A row's two first numbers and its position.
fn keys(table: &Table) -> impl Iterator<Item = ([f64; 2], usize)> {
    let column = |k: usize| table.columns.get(k).map_or(&[][..], |column| table.numbers(&column.name));
    let pairs = column(0).iter().zip(column(1)).enumerate();
    pairs.filter_map(|(row, (a, b))| Some(([(*a)?, (*b)?], row)))
}

/// Names of the columns of classes.
fn classes(table: &Table) -> impl Iterator<Item = &str> {
    table.columns.iter().skip(2).map(|column| column.name.as_str())
}

/// A figure of a class.
fn of_class(table: &Table, class: &str, group: &str, svg: String) -> Figure {
    let name = format!("{}_{class}", table.name);
    Figure { name, group: group.to_owned(), ..figure(table, &words(class), svg) }
}

/// Objects by distance and points.
pub(super) fn spread_figures(table: &Table) -> Vec<Figure> {
    let grid = [POINTS_STEPS as usize, LEVELS as usize];
    let decades = f64::from(LEVELS) / LEVELS_PER_DECADE;
    let reach = POINTS_STEP_M * f64::from(POINTS_STEPS);
    let title = &table.title;
    let drawn = classes(table).filter_map(|class| {
        let counts = table.counts(class);
        let mut values = vec![0.0; grid[0] * grid[1]];
        for ([from_m, from_points], row) in keys(table) {
            let column = (from_m / POINTS_STEP_M).round() as usize;
            // Rows run from the top, levels from the bottom.
            let level = (LEVELS_PER_DECADE * frames::math::log10(from_points)).round() as usize;
            let place =
                grid[1].checked_sub(level + 1).filter(|_| column < grid[0]).map(|row| row * grid[0] + column);
            let Some(place) = place else { continue };
            values[place] = counts.get(row).copied().unwrap_or(0) as f64;
            // No whole number lies in the second level: what has one point fills both.
            if level == 0 && place >= grid[0] {
                values[place - grid[0]] = values[place];
            }
        }
        let density = Density {
            title: &words(class),
            grid,
            values: &values,
            plot: [SIDE, 150.0],
            x: Axis { name: "distance, m", ends: [0.0, reach], ticks: every(0.0, reach, 40.0), log: false },
            y: Axis { name: "points", ends: [0.0, decades], ticks: every(0.0, decades, 1.0), log: true },
            circles: &[],
        };
        let has_any = values.iter().any(|value| *value > 0.0);
        has_any.then(|| of_class(table, class, &format!("{title}, object-frames"), density.draw()))
    });
    drawn.collect()
}

/// Where around agents each class was seen.
pub(super) fn place_figures(table: &Table) -> Vec<Figure> {
    let side = PLACES as usize;
    let reach = 0.5 * PLACE_M * f64::from(PLACES);
    let square = |from_middle: f64| ((reach - from_middle) / PLACE_M).floor() as usize;
    let group = format!("{}, object-frames in squares of {PLACE_M} m", table.title);
    let drawn = classes(table).filter_map(|class| {
        let counts = table.counts(class);
        let mut values = vec![0.0; side * side];
        for ([ahead, left], row) in keys(table) {
            if let Some(value) = values.get_mut(square(ahead) * side + square(left)) {
                *value = counts.get(row).copied().unwrap_or(0) as f64;
            }
        }
        let has_any = values.iter().any(|value| *value > 0.0);
        let svg = from_above(&words(class), [side, side], &values, reach, &[50.0, 100.0, 150.0, 200.0]);
        has_any.then(|| of_class(table, class, &group, svg))
    });
    drawn.collect()
}

/// Where BEV masks show each class.
pub(super) fn heat_figures(table: &Table) -> Vec<Figure> {
    let side = table.len().isqrt();
    let reach =
        keys(table).map(|([ahead, _], _)| ahead).fold(0.0, f64::max) * side as f64 / (side.max(2) - 1) as f64;
    let group = "BEV labels by place, percent of the cells";
    let drawn = classes(table).filter_map(|class| {
        let values: Vec<f64> = table.numbers(class).iter().map(|value| value.unwrap_or(0.0)).collect();
        let has_any = values.iter().any(|value| *value > 0.0);
        let svg = from_above(&words(class), [side, side], &values, reach, &[]);
        has_any.then(|| of_class(table, class, group, svg))
    });
    drawn.collect()
}

/// A heat map around an agent that looks up.
fn from_above(title: &str, grid: [usize; 2], values: &[f64], reach: f64, circles: &[f64]) -> String {
    let step = [10.0, 20.0, 50.0, 100.0].into_iter().find(|step| 2.5 * step >= reach).unwrap_or(200.0);
    let most = (reach / step * (1.0 + 1e-9)).floor() * step;
    let axis = |name| Axis { name, ends: [-reach, reach], ticks: every(-most, most, step), log: false };
    let (x, y) = (axis("to the right, m"), axis("ahead, m"));
    Density { title, grid, values, plot: [SIDE, SIDE], x, y, circles }.draw()
}

fn every(from: f64, to: f64, step: f64) -> Vec<f64> {
    let n = ((to - from) / step).round().max(0.0) as u32;
    (0..=n).map(|i| from + step * f64::from(i)).collect()
}
