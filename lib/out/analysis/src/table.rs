//! Tables of plain values.

use schema::table::Column;

/// Values of one column, in row order.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Counts.
    U64(Vec<u64>),
    /// Numbers with the decimals they are printed with; `None` where there is nothing to divide by.
    F64 {
        /// The values.
        values: Vec<Option<f64>>,
        /// Digits after the point, in text.
        decimals: usize,
    },
    /// Names.
    Str(Vec<String>),
}

impl Values {
    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::U64(values) => values.len(),
            Self::F64 { values, .. } => values.len(),
            Self::Str(values) => values.len(),
        }
    }

    /// Whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// As a column of a data table (numbers that may be missing are nullable).
    #[must_use]
    pub fn to_column(&self) -> Column {
        match self {
            Self::U64(values) => Column::U64(values.clone()),
            Self::F64 { values, .. } => Column::OptF64(values.clone()),
            Self::Str(values) => Column::Str(values.clone()),
        }
    }

    /// One value as text with fixed decimals; empty when it is missing.
    #[must_use]
    pub fn text(&self, row: usize) -> String {
        match self {
            Self::U64(values) => values.get(row).map(u64::to_string).unwrap_or_default(),
            Self::F64 { values, decimals } => {
                values.get(row).copied().flatten().map(|v| format!("{v:.decimals$}")).unwrap_or_default()
            }
            Self::Str(values) => values.get(row).cloned().unwrap_or_default(),
        }
    }
}

/// A named column.
#[derive(Clone, Debug, PartialEq)]
pub struct TableColumn {
    /// Name, with its unit: letters, digits and `_` for fixed columns; a class or split name else.
    pub name: String,
    /// Values.
    pub values: Values,
}

/// The part of the report a table or figure belongs to, in the report's order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum Section {
    Overview,
    Scenes,
    Weather,
    Boxes,
    Motion,
    Sightings,
    Bev,
    Occupancy,
    Sensors,
    Published,
}

impl Section {
    /// All sections, in order.
    pub const ALL: [Self; 10] = [
        Self::Overview,
        Self::Scenes,
        Self::Weather,
        Self::Boxes,
        Self::Motion,
        Self::Sightings,
        Self::Bev,
        Self::Occupancy,
        Self::Sensors,
        Self::Published,
    ];

    /// Heading in the report.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Overview => "Overview",
            Self::Scenes => "Scenes",
            Self::Weather => "Weather",
            Self::Boxes => "Boxes",
            Self::Motion => "Heading and motion of valid objects",
            Self::Sightings => "Points and places of valid objects",
            Self::Bev => "BEV labels",
            Self::Occupancy => "Occupancy labels",
            Self::Sensors => "Sensor data",
            Self::Published => "Beside the published dataset",
        }
    }
}

/// A table of equally long columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// File stem: `boxes_per_class`.
    pub name: String,
    /// Where it stands in the report.
    pub section: Section,
    /// Heading.
    pub title: String,
    /// What a reader must know to use the numbers; may be empty.
    pub note: String,
    /// Columns.
    pub columns: Vec<TableColumn>,
}

impl Table {
    pub(crate) fn new(name: &str, section: Section, title: &str, note: &str) -> Self {
        let (name, title, note) = (name.to_owned(), title.to_owned(), note.to_owned());
        Self { name, section, title, note, columns: Vec::new() }
    }

    pub(crate) fn with_strings(
        self,
        name: &str,
        values: impl IntoIterator<Item = impl Into<String>>,
    ) -> Self {
        self.with(name, Values::Str(values.into_iter().map(Into::into).collect()))
    }

    pub(crate) fn with_counts(self, name: &str, values: impl IntoIterator<Item = u64>) -> Self {
        self.with(name, Values::U64(values.into_iter().collect()))
    }

    pub(crate) fn with_numbers(
        self,
        name: &str,
        decimals: usize,
        values: impl IntoIterator<Item = Option<f64>>,
    ) -> Self {
        self.with(name, Values::F64 { values: values.into_iter().collect(), decimals })
    }

    fn with(mut self, name: &str, values: Values) -> Self {
        debug_assert!(self.columns.first().is_none_or(|first| first.values.len() == values.len()));
        self.columns.push(TableColumn { name: name.to_owned(), values });
        self
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// Whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The column of a name.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&Values> {
        self.columns.iter().find(|column| column.name == name).map(|column| &column.values)
    }

    /// Counts of a column; none when there is no such column of counts.
    #[must_use]
    pub fn counts(&self, name: &str) -> &[u64] {
        match self.column(name) {
            Some(Values::U64(values)) => values,
            _ => &[],
        }
    }

    /// Names of a column; none when there is no such column of names.
    #[must_use]
    pub fn strings(&self, name: &str) -> &[String] {
        match self.column(name) {
            Some(Values::Str(values)) => values,
            _ => &[],
        }
    }

    /// Numbers of a column; none when there is no such column of numbers.
    #[must_use]
    pub fn numbers(&self, name: &str) -> &[Option<f64>] {
        match self.column(name) {
            Some(Values::F64 { values, .. }) => values,
            _ => &[],
        }
    }
}

/// Every table of a dataset.
#[derive(Clone, Debug, PartialEq)]
pub struct Tables {
    /// Name of the dataset.
    pub dataset: String,
    /// Scenes that were counted, of how many, where some of the plan are not finished.
    pub partial: Option<[u64; 2]>,
    /// The tables, in the report's order. Their names don't depend on the data; a table may have no rows.
    pub tables: Vec<Table>,
}

impl Tables {
    /// The table of a name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&Table> {
        self.tables.iter().find(|table| table.name == name)
    }
}

/// A table as CSV (RFC 4180, but lines end with a line feed): a line of column names, then the rows.
#[must_use]
pub fn to_csv(table: &Table) -> String {
    let mut csv = csv::Writer::from_writer(Vec::new());
    let written = csv.write_record(table.columns.iter().map(|column| &column.name)).and_then(|()| {
        (0..table.len())
            .try_for_each(|row| csv.write_record(table.columns.iter().map(|column| column.values.text(row))))
    });
    written.expect("every row has a cell of every column");
    let bytes = csv.into_inner().expect("memory takes every byte");
    String::from_utf8(bytes).expect("cells are text")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn csv_has_fixed_decimals_and_quotes_what_needs_it() {
        let table = Table::new("t", Section::Boxes, "T", "")
            .with_strings("class", ["car", "a \"b\", c"])
            .with_counts("all", [1_000_000, 0])
            .with_numbers("share", 4, [Some(1.0 / 3.0), None]);
        assert_eq!(to_csv(&table), "class,all,share\ncar,1000000,0.3333\n\"a \"\"b\"\", c\",0,\n");
        assert_eq!(table.len(), 2);
        assert_eq!(table.counts("all"), [1_000_000, 0]);
        assert_eq!(table.counts("class"), [0_u64; 0]);
    }
}
