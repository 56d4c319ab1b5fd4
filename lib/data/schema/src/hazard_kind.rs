//! What blocks a lane.

use serde::{Deserialize, Serialize};

use crate::text::words;

/// What blocks a lane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HazardKind {
    /// Two vehicles that collided, and the people who came to help.
    #[default]
    Accident,
    /// Barriers, things and workers.
    RoadWorks,
}

words! {
    HazardKind, "hazard kind":
    Accident = "accident",
    RoadWorks = "road_works",
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_those_of_the_format_in_tables_and_json() {
        assert_eq!(
            HazardKind::ALL.iter().map(|k| k.name()).collect::<Vec<_>>().join(" "),
            "accident road_works"
        );
        for kind in HazardKind::ALL {
            assert_eq!(kind.to_string().parse(), Ok(*kind));
            let json = format!("\"{kind}\"");
            assert_eq!(serde_json::to_string(kind).expect("is a word"), json);
            assert_eq!(serde_json::from_str::<HazardKind>(&json).expect("is known"), *kind);
        }
        let error = "flood".parse::<HazardKind>().expect_err("roads are dry").to_string();
        assert_eq!(error, "`flood` is no hazard kind, expected one of accident, road_works");
        let error = serde_json::from_str::<HazardKind>("\"flood\"").expect_err("roads are dry").to_string();
        assert!(error.contains("`flood`") && error.contains("`road_works`"), "{error}");
    }
}
