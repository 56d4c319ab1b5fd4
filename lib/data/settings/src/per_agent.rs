//! What differs between agents.

use serde::Serialize;

use schema::{AgentId, AgentKind};

/// A value for every agent: that of its kind, or its own.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PerAgent<T> {
    /// Data-collection vehicles.
    pub vehicle: T,
    /// RSUs.
    pub rsu: T,
    /// Agents (`vehicle_1`, `rsu_0`, ...) with a value of their own.
    pub own: Vec<(Vec<String>, T)>,
}

impl<T> PerAgent<T> {
    /// The value of an agent.
    #[must_use]
    pub fn of(&self, agent: AgentId) -> &T {
        let name = agent.to_string();
        match (self.own.iter().find(|(agents, _)| agents.contains(&name)), agent.kind) {
            (Some((_, own)), _) => own,
            (None, AgentKind::Vehicle) => &self.vehicle,
            (None, AgentKind::Rsu) => &self.rsu,
        }
    }

    /// The same made of each value.
    #[must_use]
    pub fn map<U>(&self, make: impl Fn(&T) -> U) -> PerAgent<U> {
        PerAgent {
            vehicle: make(&self.vehicle),
            rsu: make(&self.rsu),
            own: self.own.iter().map(|(agents, value)| (agents.clone(), make(value))).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_agents_own_value_comes_first() {
        let values =
            PerAgent { vehicle: 1, rsu: 2, own: vec![(vec!["vehicle_3".into(), "vehicle_4".into()], 7)] };
        let got = |agent| *values.of(agent);
        assert_eq!([AgentId::vehicle(0), AgentId::vehicle(4), AgentId::rsu(3)].map(got), [1, 7, 2]);
        assert_eq!(values.map(|v| 10 * v).of(AgentId::vehicle(3)), &70);
    }
}
