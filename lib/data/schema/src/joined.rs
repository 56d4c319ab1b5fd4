//! Rows with the columns of two row types.

use crate::table::{Column, ColumnError, Field, Framed, Row};

/// A row of the first type's table that has the columns of the second one besides: those that are there on
/// request.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Joined<A, B>(
    /// The columns that are always there.
    pub A,
    /// Those that come after them.
    pub B,
);

impl<A: Row + Clone, B: Row + Clone> Row for Joined<A, B> {
    const TABLE: &'static str = A::TABLE;
    const STAGE: &'static str = A::STAGE;
    const DOC: &'static str = A::DOC;

    fn fields() -> Vec<Field> {
        let mut fields = A::fields();
        fields.extend(B::fields());
        fields
    }

    fn to_columns(rows: &[Self]) -> Vec<Column> {
        // Columns are made of a list of rows, so each half needs one of its own.
        let (first, second): (Vec<A>, Vec<B>) = rows.iter().map(|Self(a, b)| (a.clone(), b.clone())).unzip();
        let mut columns = A::to_columns(&first);
        columns.extend(B::to_columns(&second));
        columns
    }

    fn from_columns(columns: Vec<Column>) -> Result<Vec<Self>, ColumnError> {
        let mut columns = columns;
        let rest = columns.split_off(A::fields().len().min(columns.len()));
        let (first, second) = (A::from_columns(columns)?, B::from_columns(rest)?);
        Ok(first.into_iter().zip(second).map(|(a, b)| Self(a, b)).collect())
    }
}

impl<A: Framed, B> Framed for Joined<A, B> {
    fn frame(&self) -> i64 {
        self.0.frame()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::{GnssRow, SightingRow};

    #[test]
    fn columns_of_both_stand_side_by_side() {
        type Both = Joined<GnssRow, SightingRow>;
        let row = |frame| {
            let fix = GnssRow { frame, latitude_deg: 4.0, ..GnssRow::default() };
            Joined(fix, SightingRow::default())
        };
        let rows = vec![row(3), row(4)];
        let columns = Both::to_columns(&rows);
        assert_eq!(columns.len(), Both::fields().len());
        assert_eq!(columns[0], Column::U32(vec![3, 4]));
        assert_eq!(columns[5..], SightingRow::to_columns(&vec![SightingRow::default(); 2]));
        assert_eq!(Both::from_columns(columns.clone()), Ok(rows.clone()));
        assert!(Both::from_columns(columns[..6].to_vec()).is_err(), "a column is missing");
        assert_eq!((Both::TABLE, rows[1].frame()), (GnssRow::TABLE, 4));
    }
}
