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

    fn has_word(text: &str, word: &str) -> bool {
        text.split(|c: char| !c.is_alphanumeric()).any(|w| w == word)
    }

    #[test]
    fn tables_and_columns_keep_the_rules_of_the_page() {
        let tables = every_table();
        let mut faults = Vec::new();
        for (i, table) in tables.iter().enumerate() {
            if tables[..i].iter().any(|other| other.name == table.name) {
                faults.push(format!("{}: two tables of this name", table.name));
            }
            for (j, (Field { name, doc }, _)) in table.columns.iter().enumerate() {
                let snake = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
                let rules = [
                    (table.columns[..j].iter().all(|(other, _)| other.name != *name), "is there twice"),
                    (name.chars().all(snake), "is not in snake case"),
                    (doc.chars().filter(|c| c.is_alphabetic()).count() >= 3, "is not explained"),
                    // Docs and names say the same unit.
                    (!doc.contains("degrees") || name.contains("deg"), "is in degrees and named otherwise"),
                    (
                        !name.ends_with("_deg") || doc.to_lowercase().contains("degrees"),
                        "does not say degrees",
                    ),
                    (!name.ends_with("_m") || has_word(doc, "m"), "does not say metres"),
                ];
                let broken = rules.iter().filter(|(kept, _)| !kept);
                faults.extend(broken.map(|(_, rule)| format!("{}.{name} {rule}: {doc}", table.name)));
            }
        }
        assert_eq!(faults, [""; 0]);
    }
}
