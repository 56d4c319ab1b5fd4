//! A picture and where it belongs.

use crate::table::{Section, Table};

/// Every how many bins one is named.
pub(super) const STEPS: &[usize] = &[1, 2, 5, 10, 20, 50];
/// One picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Figure {
    /// File stem: `boxes_per_class`, `speed_car`.
    pub name: String,
    /// The table that it shows.
    pub table: String,
    /// Where it stands in the report.
    pub section: Section,
    /// Heading of the figures that belong together; empty when a figure stands alone.
    pub group: String,
    /// What it shows.
    pub title: String,
    /// An SVG document without fixed ink: text takes the colour of the page (black on its own).
    pub svg: String,
}

/// A figure of a table, alone and with its name.
pub(super) fn figure(table: &Table, title: &str, svg: String) -> Figure {
    let (name, group, title) = (table.name.clone(), String::new(), title.to_owned());
    Figure { name, table: table.name.clone(), section: table.section, group, title, svg }
}
