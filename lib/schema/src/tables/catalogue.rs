//! Every table of a store, for its documentation.

use super::*;
use crate::table::{Field, Row};

/// A table's description, for `docs/schema.md`.
#[derive(Clone, Debug)]
pub struct TableDoc {
    /// File stem.
    pub name: &'static str,
    /// What it holds.
    pub doc: &'static str,
    /// Columns with their type names.
    pub columns: Vec<(Field, String)>,
}

fn describe_table<R: Row>() -> TableDoc {
    let types = R::to_columns(&[]).iter().map(crate::table::Column::type_name).collect::<Vec<_>>();
    TableDoc { name: R::TABLE, doc: R::DOC, columns: R::fields().into_iter().zip(types).collect() }
}

/// Every table of a store.
#[must_use]
pub fn every_table() -> Vec<TableDoc> {
    vec![
        describe_table::<PlanSceneRow>(),
        describe_table::<PlanAgentRow>(),
        describe_table::<PlanHazardRow>(),
        describe_table::<VectorMapRow>(),
        describe_table::<ActorRow>(),
        describe_table::<StateRow>(),
        describe_table::<FrameRow>(),
        describe_table::<SignalRow>(),
        describe_table::<LampRow>(),
        describe_table::<AgentRow>(),
        describe_table::<BoxRow>(),
        describe_table::<HdMapRow>(),
        describe_table::<CameraRow>(),
        describe_table::<FlowRow>(),
        describe_table::<LidarRow>(),
        describe_table::<SemanticLidarRow>(),
        describe_table::<RadarRow>(),
        describe_table::<GnssRow>(),
        describe_table::<ImuRow>(),
        describe_table::<VisibleRow>(),
        describe_table::<ValidBoxRow>(),
        describe_table::<TrackRow>(),
        describe_table::<TrackFrameRow>(),
        describe_table::<PartialRow>(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Column;

    #[test]
    fn rows_survive_the_way_to_columns_and_back() {
        let row = ActorRow {
            id: 7,
            kind: "vehicle".into(),
            semantic_tags: vec![13, 18],
            xyz_m: [1.0, 2.0, 3.0],
            ..ActorRow::default()
        };
        let rows = vec![row.clone(), ActorRow { id: 8, parent: Some(7), ..row }];
        assert_eq!(ActorRow::from_columns(ActorRow::to_columns(&rows)), Ok(rows));
    }

    #[test]
    fn a_column_of_another_type_is_named() {
        let mut columns = GnssRow::to_columns(&[GnssRow::default()]);
        columns[1] = Column::Str(vec!["x".into()]);
        let error = GnssRow::from_columns(columns).expect_err("a string is no time");
        assert_eq!(error.to_string(), "column `time_s`: has type string, another was expected");
    }

    #[test]
    fn every_column_is_explained() {
        for table in every_table() {
            assert!(!table.doc.trim().is_empty());
            for (field, _) in table.columns {
                assert!(field.doc.trim().len() > 3, "{}.{}", table.name, field.name);
            }
        }
    }
}
