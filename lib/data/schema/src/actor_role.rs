//! Who an object of a scene is.

use std::fmt;
use std::str::FromStr;

use crate::AgentId;
use crate::text::{Text, WordError};

/// Who an object of a scene is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ActorRole {
    /// A recording agent.
    Agent(AgentId),
    /// A vehicle that no agent drives.
    Background,
    /// A pedestrian.
    Walker,
    /// Part of an accident or road works.
    Hazard,
    /// Stands beside the roads.
    #[default]
    Scenery,
}

impl ActorRole {
    /// The agent that it is, if it is one.
    #[must_use]
    pub fn agent(self) -> Option<AgentId> {
        match self {
            Self::Agent(agent) => Some(agent),
            Self::Background | Self::Walker | Self::Hazard | Self::Scenery => None,
        }
    }
}

impl fmt::Display for ActorRole {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Agent(agent) => agent.fmt(f),
            Self::Background => f.write_str("background"),
            Self::Walker => f.write_str("walker"),
            Self::Hazard => f.write_str("hazard"),
            Self::Scenery => f.write_str("scenery"),
        }
    }
}

impl FromStr for ActorRole {
    type Err = WordError;
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(match text {
            "background" => Self::Background,
            "walker" => Self::Walker,
            "hazard" => Self::Hazard,
            "scenery" => Self::Scenery,
            _ => Self::Agent(text.parse().map_err(|_| WordError {
                what: "actor role",
                text: text.to_owned(),
                known: vec!["vehicle_N", "rsu_N", "background", "walker", "hazard", "scenery"],
            })?),
        })
    }
}

impl Text for ActorRole {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_those_of_the_format() {
        for (role, word) in [
            (ActorRole::Agent(AgentId::vehicle(0)), "vehicle_0"),
            (ActorRole::Agent(AgentId::rsu(12)), "rsu_12"),
            (ActorRole::Background, "background"),
            (ActorRole::Walker, "walker"),
            (ActorRole::Hazard, "hazard"),
            (ActorRole::Scenery, "scenery"),
        ] {
            assert_eq!((role.to_string().as_str(), word.parse()), (word, Ok(role)));
        }
        let error = "vehicle".parse::<ActorRole>().expect_err("it has no number").to_string();
        assert!(error.starts_with("`vehicle` is no actor role, expected one of vehicle_N, rsu_N"), "{error}");
    }
}
