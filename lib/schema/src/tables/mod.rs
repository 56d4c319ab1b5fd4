//! The row types of every table in a store.

mod labels;
mod log;
mod map;
mod plan;
mod sensor;
mod stats;
mod weather;

pub use labels::{AgentRow, BoxRow, HdMapRow, TrackFrameRow, TrackRow, ValidBoxRow};
pub use log::{ActorRow, FrameRow, LampRow, SignalRow, StateRow};
pub use map::{VectorKind, VectorMapRow};
pub use plan::{PlanAgentRow, PlanHazardRow, PlanSceneRow};
pub use sensor::{
    CAMERA_TABLES, CameraRow, FlowRow, GNSS_TABLE, GnssRow, IMU_TABLE, ImuRow, LidarRow, RadarRow,
    SemanticLidarRow, VISIBLE_TABLE, VisibleRow, camera_table,
};
pub use stats::PartialRow;
pub use weather::Weather;

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

fn describe<R: Row>() -> TableDoc {
    let types = R::to_columns(&[]).iter().map(crate::table::Column::type_name).collect::<Vec<_>>();
    TableDoc { name: R::TABLE, doc: R::DOC, columns: R::fields().into_iter().zip(types).collect() }
}

/// Every table of a store.
#[must_use]
pub fn all() -> Vec<TableDoc> {
    vec![
        describe::<PlanSceneRow>(),
        describe::<PlanAgentRow>(),
        describe::<PlanHazardRow>(),
        describe::<VectorMapRow>(),
        describe::<ActorRow>(),
        describe::<StateRow>(),
        describe::<FrameRow>(),
        describe::<SignalRow>(),
        describe::<LampRow>(),
        describe::<AgentRow>(),
        describe::<BoxRow>(),
        describe::<HdMapRow>(),
        describe::<CameraRow>(),
        describe::<FlowRow>(),
        describe::<LidarRow>(),
        describe::<SemanticLidarRow>(),
        describe::<RadarRow>(),
        describe::<GnssRow>(),
        describe::<ImuRow>(),
        describe::<VisibleRow>(),
        describe::<ValidBoxRow>(),
        describe::<TrackRow>(),
        describe::<TrackFrameRow>(),
        describe::<PartialRow>(),
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
        for table in all() {
            assert!(!table.doc.trim().is_empty());
            for (field, _) in table.columns {
                assert!(field.doc.trim().len() > 3, "{}.{}", table.name, field.name);
            }
        }
    }
}
