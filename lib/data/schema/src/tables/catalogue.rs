//! Every table of a store, for its documentation.

use super::*;
use crate::SCENE_COLUMN;
use crate::table::{Column, Field, Row};

/// A table's description, for `docs/schema.md`.
#[derive(Clone, Debug)]
pub struct TableDoc {
    /// File stem.
    pub name: &'static str,
    /// What it holds.
    pub doc: &'static str,
    /// Columns with their type names, that of the scene included.
    pub columns: Vec<(Field, String)>,
}

fn describe_table<R: Row>() -> TableDoc {
    let types = R::to_columns(&[]);
    let mut columns: Vec<_> = R::fields().into_iter().zip(types.iter().map(Column::type_name)).collect();
    if is_of_scene(R::TABLE) {
        columns.insert(0, (SCENE_COLUMN, Column::U32(Vec::new()).type_name()));
    }
    TableDoc { name: R::TABLE, doc: R::DOC, columns }
}

fn is_of_scene(table: &str) -> bool {
    ["plan/", "maps/", "tiles/"].iter().all(|folder| !table.starts_with(folder))
}

impl TableDoc {
    /// Whether scenes have it: it lies in the folder of one.
    #[must_use]
    pub fn is_of_scene(&self) -> bool {
        is_of_scene(self.name)
    }
}

/// Every table of a store.
#[must_use]
pub fn every_table() -> Vec<TableDoc> {
    vec![
        describe_table::<PlanSceneRow>(),
        describe_table::<PlanAgentRow>(),
        describe_table::<PlanHazardRow>(),
        describe_table::<PlanWeatherRow>(),
        describe_table::<PlanRouteRow>(),
        describe_table::<PlanTrajectoryRow>(),
        describe_table::<PlanModelRow>(),
        describe_table::<VectorMapRow>(),
        describe_table::<SurfaceRow>(),
        describe_table::<TileObjectRow>(),
        describe_table::<ActorRow>(),
        describe_table::<SceneTileRow>(),
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
        describe_table::<LidarReturnsRow>(),
        describe_table::<RadarRow>(),
        describe_table::<GnssRow>(),
        describe_table::<ImuRow>(),
        describe_table::<VisibleRow>(),
        describe_table::<Box2dRow>(),
        describe_table::<ValidBoxRow>(),
        describe_table::<TrackRow>(),
        describe_table::<TrackFrameRow>(),
        describe_table::<SightingRow>(),
        describe_table::<WindowRow>(),
        describe_table::<PartialRow>(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ActorKind, ActorRole, AgentId, HazardKind, LampKind, SignalState};

    #[test]
    fn rows_survive_the_way_to_columns_and_back() {
        let row = ActorRow {
            id: 7,
            kind: ActorKind::Vehicle,
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
    fn types_are_the_same_strings_in_columns() {
        fn column<R: Row>(rows: &[R], name: &str) -> Column {
            let at = R::fields().iter().position(|f| f.name == name).expect("is a column");
            R::to_columns(rows).swap_remove(at)
        }
        let text = |words: &[&str]| Column::Str(words.iter().map(|w| (*w).to_owned()).collect());
        let actors = [
            ActorRow { kind: ActorKind::TrafficLight, ..ActorRow::default() },
            ActorRow { role: ActorRole::Agent(AgentId::rsu(3)), ..ActorRow::default() },
        ];
        assert_eq!(column(&actors, "kind"), text(&["traffic_light", "prop"]));
        assert_eq!(column(&actors, "role"), text(&["scenery", "rsu_3"]));
        let signal = SignalRow { state: SignalState::Yellow, ..SignalRow::default() };
        assert_eq!(column(&[signal], "state"), text(&["Yellow"]));
        let lamp = LampRow { kind: LampKind::Building, ..LampRow::default() };
        assert_eq!(column(&[lamp], "kind"), text(&["building"]));
        let hazard = PlanHazardRow { kind: HazardKind::RoadWorks, ..PlanHazardRow::default() };
        assert_eq!(column(&[hazard], "kind"), text(&["road_works"]));
        let agent = PlanAgentRow { agent: AgentId::vehicle(2), ..PlanAgentRow::default() };
        assert_eq!(column(&[agent], "agent"), text(&["vehicle_2"]));
        let boxes =
            [Some(SignalState::Red), None].map(|signal_state| BoxRow { signal_state, ..BoxRow::default() });
        assert_eq!(column(&boxes, "signal_state"), Column::OptStr(vec![Some("Red".into()), None]));
        assert_eq!(BoxRow::from_columns(BoxRow::to_columns(&boxes)), Ok(boxes.to_vec()));
    }

    #[test]
    fn an_unknown_text_is_named_with_its_column_and_row() {
        let mut columns = SignalRow::to_columns(&[SignalRow::default(), SignalRow::default()]);
        columns[2] = Column::Str(vec!["Off".into(), "Blue".into()]);
        let error = SignalRow::from_columns(columns).expect_err("no light is blue").to_string();
        let want =
            "column `state`, row 1: `Blue` is no signal state, expected one of Red, Yellow, Green, Off";
        assert_eq!(error, want);
        let mut columns = BoxRow::to_columns(&[BoxRow::default()]);
        let at = BoxRow::fields().iter().position(|f| f.name == "signal_state").expect("is a column");
        columns[at] = Column::OptStr(vec![Some(String::new())]);
        let error = BoxRow::from_columns(columns).expect_err("no text is no state").to_string();
        assert!(error.starts_with("column `signal_state`, row 0: `` is no signal state"), "{error}");
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
