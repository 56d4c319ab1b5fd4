//! The kinds of towns.

use serde::Deserialize;

/// Which kind of town.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Style {
    /// Signalised blocks inside a ring road.
    #[default]
    Grid,
    /// A city with boulevards, turn lanes, a roundabout and an underpass.
    City,
    /// A down-town with wide boulevards, one-way streets and a drive around it.
    Downtown,
    /// A grid city with an elevated motorway.
    Viaduct,
    /// A motorway ring, and a divided highway with Michigan lefts.
    Highways,
    /// A small town on both banks of a river.
    River,
    /// A boulevard between a dense centre and large blocks.
    Commercial,
    /// Country roads with narrow lanes.
    Rural,
    /// Winding streets on a hill.
    OldTown,
    /// A motorway in a figure of eight round a town and a mountain.
    Mountain,
    /// Several towns, farmland and a motorway.
    Region,
}

impl Style {
    /// Every style.
    pub const ALL: [Self; 11] = [
        Self::Grid,
        Self::City,
        Self::Downtown,
        Self::Viaduct,
        Self::Highways,
        Self::River,
        Self::Commercial,
        Self::Rural,
        Self::OldTown,
        Self::Mountain,
        Self::Region,
    ];

    /// Its name in a parameter file: the value of `style`, and the name of its table.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Grid => "grid",
            Self::City => "city",
            Self::Downtown => "downtown",
            Self::Viaduct => "viaduct",
            Self::Highways => "highways",
            Self::River => "river",
            Self::Commercial => "commercial",
            Self::Rural => "rural",
            Self::OldTown => "oldtown",
            Self::Mountain => "mountain",
            Self::Region => "region",
        }
    }
}
