//! The layers that surfaces are told apart by.

use crate::Tag;
use crate::text::words;

/// A surface of the world; each is one object of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Layer {
    /// Carriageways, and all that vehicles use.
    #[default]
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

// The words are also the models of the rows that stand for layers.
words! {
    Layer, "surface":
    Road = "surface.road",
    Marking = "surface.marking",
    Sidewalk = "surface.sidewalk",
    Median = "surface.median",
    Terrain = "surface.terrain",
    Bridge = "surface.bridge",
    GuardRail = "surface.guard_rail",
    Track = "surface.track",
    Water = "surface.water",
}

impl Layer {
    /// Tag of its row.
    #[must_use]
    pub const fn tag(self) -> Tag {
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
