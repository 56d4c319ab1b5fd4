//! Tables over annotated objects.

use schema::DetectionClass;
use schema::measures::{self, Bins};

use super::share::{percent, ratio};
use crate::table::{Section, Table};
use crate::totals::MeasureTotals;

/// A histogram per class.
pub(crate) struct ClassHistogram {
    pub(crate) table: &'static str,
    pub(crate) title: &'static str,
    measure: &'static str,
    bins: Bins,
    section: Section,
    note: &'static str,
    /// Whether only classes that move have it.
    moving: bool,
    /// Whether frames that were not counted belong to the first bin.
    rest_is_zero: bool,
}

pub(crate) const MOTION_TABLES: [ClassHistogram; 4] = [
    ClassHistogram {
        table: "valid_per_frame",
        title: "Frames by number of valid objects",
        measure: measures::tracks::VALID_PER_FRAME,
        bins: measures::tracks::VALID_PER_FRAME_BINS,
        section: Section::Boxes,
        note: "Every class counts every frame once; frames without a valid object are in bin 0-4.",
        moving: false,
        rest_is_zero: true,
    },
    ClassHistogram {
        table: "yaw",
        title: "Valid objects by heading, degrees",
        measure: measures::tracks::YAW_DEG,
        bins: measures::tracks::YAW_BINS,
        section: Section::Motion,
        note: "Heading in the map's frame: 0 is east, 90 north.",
        moving: false,
        rest_is_zero: false,
    },
    ClassHistogram {
        table: "speed",
        title: "Valid objects by speed, m/s",
        measure: measures::tracks::SPEED_MPS,
        bins: measures::tracks::SPEED_BINS,
        section: Section::Motion,
        note: "",
        moving: true,
        rest_is_zero: false,
    },
    ClassHistogram {
        table: "yaw_rate",
        title: "Valid objects by turning rate, degrees/s",
        measure: measures::tracks::YAW_RATE_DPS,
        bins: measures::tracks::YAW_RATE_BINS,
        section: Section::Motion,
        note: "Positive is to the left.",
        moving: true,
        rest_is_zero: false,
    },
];

pub(super) fn tables(counts: &MeasureTotals, frames: u64) -> Vec<Table> {
    let mut tables = vec![per_class(counts, frames)];
    tables.extend(MOTION_TABLES.iter().map(|spec| class_histogram(spec, counts, frames)));
    // The wheelchair table belongs to the boxes and stands with them.
    tables.insert(2, wheelchairs(counts));
    tables
}

fn per_class(counts: &MeasureTotals, frames: u64) -> Table {
    let known = DetectionClass::ALL.map(DetectionClass::name);
    let mut rows: Vec<(&str, u64, u64)> = Vec::new();
    if counts.has(measures::tracks::BOXES) {
        let classes =
            counts.classes_in_order(&[measures::tracks::BOXES, measures::tracks::BOXES_VALID], &known);
        rows.extend(classes.into_iter().map(|class| {
            (
                class,
                counts.of(measures::tracks::BOXES, class),
                counts.of(measures::tracks::BOXES_VALID, class),
            )
        }));
        rows.push((
            "total",
            counts.total(measures::tracks::BOXES),
            counts.total(measures::tracks::BOXES_VALID),
        ));
    }
    let note = "Unique objects per frame, over all agents. Valid: hit by a lidar or radar point, or seen in an image.";
    Table::new("boxes_per_class", Section::Boxes, "Boxes by class", note)
        .with_strings("class", rows.iter().map(|row| row.0))
        .with_counts("all", rows.iter().map(|row| row.1))
        .with_counts("valid", rows.iter().map(|row| row.2))
        .with_numbers("valid_percent", 1, rows.iter().map(|row| percent(row.2, row.1)))
        .with_numbers("all_per_frame", 2, rows.iter().map(|row| ratio(row.1, frames)))
        .with_numbers("valid_per_frame", 2, rows.iter().map(|row| ratio(row.2, frames)))
}

/// One row a bin, one column a class. Bins below and above the range have rows when the measure can have
/// such values.
fn class_histogram(spec: &ClassHistogram, counts: &MeasureTotals, frames: u64) -> Table {
    let detection = DetectionClass::ALL.map(DetectionClass::name);
    let known: &[&str] = if spec.moving { &measures::tracks::MOVING_CLASSES } else { &detection };
    let classes = counts.classes_in_order(&[spec.measure], known);
    let Bins { lower, upper, width } = spec.bins;
    let edges: Vec<i32> = if counts.has(spec.measure) {
        std::iter::once(lower - width).chain(spec.bins.edges()).chain([upper]).collect()
    } else {
        Vec::new()
    };
    // Whatever edge a row names, it goes to the bin that holds the edge.
    let column = |class: &str| {
        let mut column = vec![0_u64; edges.len()];
        for (bin, count) in counts.bins(spec.measure, class) {
            let edge = spec.bins.bin_of(f64::from(bin));
            if let Ok(i) = edges.binary_search(&edge) {
                column[i] = column[i].saturating_add(count);
            }
        }
        if spec.rest_is_zero && column.len() > 1 {
            let counted = column.iter().fold(0, |a: u64, &b| a.saturating_add(b));
            column[1] = column[1].saturating_add(frames.saturating_sub(counted));
        }
        column
    };
    let columns: Vec<Vec<u64>> = classes.iter().map(|class| column(class)).collect();
    // Headings have no values outside, counts and speeds none below: those rows are left out when empty.
    let shown: Vec<usize> = (0..edges.len())
        .filter(|&i| (1..edges.len() - 1).contains(&i) || columns.iter().any(|column| column[i] > 0))
        .collect();
    let label = |i: usize| match edges[i] {
        edge if edge < lower => format!("<{lower}"),
        edge if edge >= upper => format!("{upper}+"),
        edge if spec.rest_is_zero => format!("{edge}-{}", edge + width - 1),
        edge => format!("{edge}..{}", edge + width),
    };
    let mut table = Table::new(spec.table, spec.section, spec.title, spec.note)
        .with_strings("bin", shown.iter().map(|&i| label(i)))
        .with_numbers("lower", 0, shown.iter().map(|&i| Some(f64::from(edges[i]))));
    for (class, column) in classes.iter().zip(&columns) {
        table = table.with_counts(class, shown.iter().map(|&i| column[i]));
    }
    table
}

fn wheelchairs(counts: &MeasureTotals) -> Table {
    let of = |measure, class: &str| {
        // Rows that don't say are about every object.
        let unnamed = if class == measures::tracks::ALL_OBJECTS { counts.of(measure, "") } else { 0 };
        counts.of(measure, class).saturating_add(unnamed)
    };
    let rows: Vec<(&str, u64, u64)> = [measures::tracks::ALL_OBJECTS, measures::tracks::VALID_OBJECTS]
        .into_iter()
        .filter(|_| counts.has(measures::tracks::PEDESTRIANS))
        .map(|class| {
            (class, of(measures::tracks::PEDESTRIANS, class), of(measures::tracks::WHEELCHAIR, class))
        })
        .filter(|(class, pedestrians, _)| *class == measures::tracks::ALL_OBJECTS || *pedestrians > 0)
        .collect();
    let note = "Object-frames, not individuals.";
    Table::new("wheelchairs", Section::Boxes, "Pedestrians in wheelchairs", note)
        .with_strings("objects", rows.iter().map(|row| row.0))
        .with_counts("pedestrians", rows.iter().map(|row| row.1))
        .with_counts("wheelchair_users", rows.iter().map(|row| row.2))
        .with_numbers("percent", 2, rows.iter().map(|row| percent(row.2, row.1)))
}
