//! Which agents work together with the ego.

use schema::{AgentId, AgentKind};

/// With whom the model that made predictions worked together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mode {
    /// Nothing is said of it.
    Unsaid,
    /// With nobody.
    None,
    /// With vehicles.
    X2v,
    /// With RSUs.
    X2i,
    /// With both.
    X2x,
}

impl Mode {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Unsaid, Self::None, Self::X2v, Self::X2i, Self::X2x];

    /// Its name in predictions and results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Unsaid => "-",
            Self::None => "none",
            Self::X2v => "x2v",
            Self::X2i => "x2i",
            Self::X2x => "x2x",
        }
    }

    /// The mode with a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().skip(1).find(|mode| mode.name() == name)
    }
}

/// By whom a box must be seen to be a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SeenBy {
    /// Nobody: all boxes of the ego's list.
    Nobody,
    /// The ego.
    Ego,
    /// The ego or one of those that can work together with it, of both kinds.
    Partners {
        /// Largest distance of their origins in space, m.
        range_m: f64,
        /// Largest difference in height, m.
        elevation_m: f64,
    },
}

impl SeenBy {
    /// Whether an agent sees for another one, by where both are.
    pub(crate) fn is_partner(self, ego: (AgentId, [f64; 3]), other: (AgentId, [f64; 3])) -> bool {
        let Self::Partners { range_m, elevation_m } = self else { return false };
        // Both kinds: targets are the same whatever the mode.
        let is_some = matches!(other.0.kind, AgentKind::Vehicle | AgentKind::Rsu) && other.0 != ego.0;
        let away = [0, 1, 2].map(|axis| other.1[axis] - ego.1[axis]);
        let distance_m = away.iter().map(|d| d * d).sum::<f64>().sqrt();
        is_some && distance_m <= range_m && away[2].abs() <= elevation_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn partners_are_near_and_at_the_same_height() {
        let seen = SeenBy::Partners { range_m: 80.0, elevation_m: 4.8 };
        let ego = (AgentId::vehicle(0), [1.0, 2.0, 3.0]);
        let is_partner = |id, xyz_m| seen.is_partner(ego, (id, xyz_m));
        assert!(is_partner(AgentId::rsu(0), [81.0, 2.0, 3.0]));
        assert!(!is_partner(AgentId::vehicle(0), [1.0, 2.0, 3.0]));
        assert!(!is_partner(AgentId::vehicle(1), [81.0, 2.0, 4.0]));
        assert!(!is_partner(AgentId::vehicle(1), [1.0, 2.0, 8.0]));
        assert!(!SeenBy::Ego.is_partner(ego, (AgentId::vehicle(1), ego.1)));
    }

    #[test]
    fn names_round_trip() {
        for mode in Mode::ALL.into_iter().skip(1) {
            assert_eq!(Mode::from_name(mode.name()), Some(mode));
        }
        assert_eq!(Mode::from_name("-"), None);
    }
}
