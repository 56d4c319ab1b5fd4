//! Agents: data-collection vehicles and road-side units.

use std::fmt;
use std::str::FromStr;

use crate::text::Text;

/// The kind of a recording agent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs, reason = "the names are their own documentation")]
pub enum AgentKind {
    #[default]
    Vehicle,
    Rsu,
}

/// A recording agent of a scene: `vehicle_0`, `rsu_3`. Vehicles order before RSUs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AgentId {
    /// Vehicle or RSU.
    pub kind: AgentKind,
    /// Number among its kind, from 0 without gaps.
    pub index: u16,
}

impl AgentId {
    /// Vehicle number `index`.
    #[must_use]
    pub fn vehicle(index: u16) -> Self {
        Self { kind: AgentKind::Vehicle, index }
    }

    /// RSU number `index`.
    #[must_use]
    pub fn rsu(index: u16) -> Self {
        Self { kind: AgentKind::Rsu, index }
    }
}

impl fmt::Display for AgentId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.kind {
            AgentKind::Vehicle => write!(f, "vehicle_{}", self.index),
            AgentKind::Rsu => write!(f, "rsu_{}", self.index),
        }
    }
}

/// A text is not an agent's name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParseAgentError(
    /// The text.
    pub String,
);

impl fmt::Display for ParseAgentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` is no agent name, expected vehicle_N or rsu_N", self.0)
    }
}

impl std::error::Error for ParseAgentError {}

impl FromStr for AgentId {
    type Err = ParseAgentError;
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let error = || ParseAgentError(text.to_owned());
        let (kind, digits) = text.rsplit_once('_').ok_or_else(error)?;
        let kind = match kind {
            "vehicle" => AgentKind::Vehicle,
            "rsu" => AgentKind::Rsu,
            _ => return Err(error()),
        };
        Ok(Self { kind, index: digits.parse().map_err(|_| error())? })
    }
}

impl Text for AgentId {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_round_trip() {
        for agent in [AgentId::vehicle(0), AgentId::vehicle(12), AgentId::rsu(3)] {
            assert_eq!(agent.to_string().parse(), Ok(agent));
        }
        assert!("car_1".parse::<AgentId>().is_err());
        assert!("vehicle_x".parse::<AgentId>().is_err());
    }
}
