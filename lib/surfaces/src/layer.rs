//! The layers that surfaces are told apart by.

use schema::Tag;

/// A surface of the world; each is one object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Layer {
    /// Carriageways, and all that vehicles use.
    Road,
    /// Paint.
    Marking,
    /// Sidewalks and kerbs.
    Sidewalk,
    /// What is raised between carriageways.
    Median,
    /// The land.
    Terrain,
    /// Decks and piers.
    Bridge,
    /// Rails on bridges.
    GuardRail,
    /// Railways.
    Track,
    /// Rivers and lakes.
    Water,
}

impl Layer {
    /// All layers, in the order of their ids.
    pub const ALL: [Self; 9] = [
        Self::Road,
        Self::Marking,
        Self::Sidewalk,
        Self::Median,
        Self::Terrain,
        Self::Bridge,
        Self::GuardRail,
        Self::Track,
        Self::Water,
    ];

    /// Model name of its row.
    #[must_use]
    pub fn model(self) -> &'static str {
        match self {
            Self::Road => "surface.road",
            Self::Marking => "surface.marking",
            Self::Sidewalk => "surface.sidewalk",
            Self::Median => "surface.median",
            Self::Terrain => "surface.terrain",
            Self::Bridge => "surface.bridge",
            Self::GuardRail => "surface.guard_rail",
            Self::Track => "surface.track",
            Self::Water => "surface.water",
        }
    }

    /// The layer that a row of a model stands for.
    #[must_use]
    pub fn from_model(model: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|l| l.model() == model)
    }

    /// Tag of its row.
    #[must_use]
    pub fn tag(self) -> Tag {
        match self {
            Self::Road => Tag::Road,
            Self::Marking => Tag::RoadLine,
            Self::Sidewalk => Tag::Sidewalk,
            Self::Median => Tag::Ground,
            Self::Terrain => Tag::Terrain,
            Self::Bridge => Tag::Bridge,
            Self::GuardRail => Tag::GuardRail,
            Self::Track => Tag::RailTrack,
            Self::Water => Tag::Water,
        }
    }
}
