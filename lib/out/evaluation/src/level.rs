//! Groups of targets that have an average precision of their own.

use schema::Difficulty;

use crate::boxes::{Prediction, Sighting, Target};
use crate::ring::Ring;

/// How many levels there are.
pub const LEVELS: usize = 9;

/// A group of targets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Level {
    /// All of them.
    All,
    /// The easy ones.
    Easy,
    /// Those of medium difficulty.
    Medium,
    /// The hard ones.
    Hard,
    /// Those up to 20 m from the ego.
    Near,
    /// Those farther, up to 40 m.
    Middle,
    /// Those farther than 40 m.
    Far,
    /// Those with points of the ego's lidars.
    Ego,
    /// Those with points of partners' lidars alone.
    Partners,
}

impl Level {
    /// All of them.
    pub const ALL: [Self; LEVELS] = [
        Self::All,
        Self::Easy,
        Self::Medium,
        Self::Hard,
        Self::Near,
        Self::Middle,
        Self::Far,
        Self::Ego,
        Self::Partners,
    ];

    /// Its name in results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Easy => "easy",
            Self::Medium => "medium",
            Self::Hard => "hard",
            Self::Near => Ring::Near.name(),
            Self::Middle => Ring::Middle.name(),
            Self::Far => Ring::Far.name(),
            Self::Ego => "ego",
            Self::Partners => "partners",
        }
    }

    fn of_distance(distance_m: f64) -> Self {
        match Ring::of(distance_m) {
            Ring::Near => Self::Near,
            Ring::Middle => Self::Middle,
            Ring::Far => Self::Far,
        }
    }

    /// Those that a target is of.
    pub(crate) fn of(target: &Target) -> impl Iterator<Item = Self> {
        let difficulty = match target.difficulty {
            Difficulty::Easy => Self::Easy,
            Difficulty::Medium => Self::Medium,
            Difficulty::Hard => Self::Hard,
        };
        let sighting = match target.sighting {
            Sighting::Nobody => None,
            Sighting::Ego => Some(Self::Ego),
            Sighting::Partners => Some(Self::Partners),
        };
        [Self::All, difficulty, Self::of_distance(target.distance_m)].into_iter().chain(sighting)
    }
}

/// At which levels a prediction counts, a bit each, and as what: right above them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Counts(u16);

impl Counts {
    const RIGHT: u16 = 1 << 15;

    fn bits(levels: impl Iterator<Item = Level>) -> u16 {
        levels.fold(0, |bits, level| bits | 1 << level as u16)
    }

    /// Of one that found a target: at the levels of that one.
    pub(crate) fn right(target: &Target) -> Self {
        Self(Self::bits(Level::of(target)) | Self::RIGHT)
    }

    /// Of one that found none: at all levels, but of rings at that where it is.
    pub(crate) fn wrong(prediction: &Prediction) -> Self {
        let own = Level::of_distance(prediction.distance_m);
        let is_other =
            |level: &Level| matches!(level, Level::Near | Level::Middle | Level::Far) && *level != own;
        Self(Self::bits(Level::ALL.into_iter().filter(|level| !is_other(level))))
    }

    /// Whether it is right at a level; none where it does not count.
    pub(crate) fn at(self, level: Level) -> Option<bool> {
        (self.0 >> level as u16 & 1 == 1).then_some(self.0 & Self::RIGHT != 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boxes::Solid;

    #[test]
    fn levels_stand_at_their_numbers() {
        assert!(Level::ALL.into_iter().enumerate().all(|(i, level)| level as usize == i));
    }

    #[test]
    fn who_is_right_counts_with_the_target_and_who_is_wrong_where_it_is() {
        let solid = Solid::default();
        let target = Target {
            class: 0,
            solid,
            distance_m: 30.0,
            difficulty: Difficulty::Hard,
            sighting: Sighting::Partners,
            attribute: None,
        };
        let of = |counts: Counts| Level::ALL.map(|level| counts.at(level));
        let (yes, no) = (Some(true), Some(false));
        assert_eq!(of(Counts::right(&target)), [yes, None, None, yes, None, yes, None, None, yes]);
        let prediction = Prediction { class: 0, score: 0.5, solid, distance_m: 50.0, attribute: None };
        assert_eq!(of(Counts::wrong(&prediction)), [no, no, no, no, None, None, no, no, no]);
    }
}
