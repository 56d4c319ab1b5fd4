//! What tables of older formats have in the place of a column of today.

use crate::table::{Column, ColumnError, Row};
use crate::tables::{BoxRow, ValidBoxRow};

/// A column that older tables lack, made of one that they have.
#[derive(Clone, Copy, Debug)]
pub struct Older {
    /// The one that they have: numbers that may be null.
    pub from: &'static str,
    make: fn(&[Option<f64>]) -> Column,
}

impl Older {
    /// The lacking column; `read` reads a column by its name, of the type of another one.
    ///
    /// # Errors
    /// Those of `read`.
    pub fn column(
        &self,
        read: impl FnOnce(&'static str, &Column) -> Result<Column, ColumnError>,
    ) -> Result<Column, ColumnError> {
        match read(self.from, &Column::OptF64(Vec::new()))? {
            Column::OptF64(values) => Ok((self.make)(&values)),
            other => Err(ColumnError {
                column: self.from.to_owned(),
                row: None,
                problem: format!("has type {}, another was expected", other.type_name()),
            }),
        }
    }
}

/// How a column is had of a table of format 1, where that table lacks it.
#[must_use]
pub fn of_format_1(table: &str, column: &str) -> Option<Older> {
    match column {
        // The angle to itself is none, and to everything else a number.
        "is_ego" if [BoxRow::TABLE, ValidBoxRow::TABLE].contains(&table) => Some(Older {
            from: "angle_rad",
            make: |angles| Column::Bool(angles.iter().map(Option::is_none).collect()),
        }),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ego_is_what_has_no_angle() {
        let older = of_format_1("boxes", "is_ego").expect("is known");
        let angles = |name: &'static str, _: &Column| {
            assert_eq!(name, "angle_rad");
            Ok(Column::OptF64(vec![Some(0.0), None, Some(-1.0)]))
        };
        assert_eq!(older.column(angles), Ok(Column::Bool(vec![false, true, false])));
        assert!(of_format_1("boxes", "id").is_none() && of_format_1("tracks", "is_ego").is_none());
    }
}
