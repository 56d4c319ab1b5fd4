//! Words of road markings.

use super::words;

words!(
    /// The kind of a road marking.
    MarkType {
        /// Nothing is painted.
        #[default]
        None = "none", "NONE";
        /// One continuous line.
        Solid = "solid", "Solid";
        /// One dashed line.
        Broken = "broken", "Broken";
        /// Two continuous lines.
        SolidSolid = "solid solid", "SolidSolid";
        /// Continuous inside, dashed outside (on the centre lane: left, right).
        SolidBroken = "solid broken", "SolidBroken";
        /// Dashed inside, continuous outside (on the centre lane: left, right).
        BrokenSolid = "broken solid", "BrokenSolid";
        /// Two dashed lines.
        BrokenBroken = "broken broken", "BrokenBroken";
        /// Raised dots.
        BottsDots = "botts dots", "BottsDots";
        /// Edge of grass.
        Grass = "grass", "Grass";
        /// Kerb stone.
        Curb = "curb", "Curb";
        /// Described by its line list only.
        Custom = "custom", "Other";
        /// Edge without marking.
        Edge = "edge", "Other";
    }
);

impl MarkType {
    /// Whether something is painted: neither nothing, nor grass, nor a kerb, nor a bare edge.
    #[must_use]
    pub fn is_painted(self) -> bool {
        !matches!(self, Self::None | Self::Grass | Self::Curb | Self::Edge)
    }

    /// Whether it consists of two lines side by side.
    #[must_use]
    pub fn is_double(self) -> bool {
        matches!(self, Self::SolidSolid | Self::SolidBroken | Self::BrokenSolid | Self::BrokenBroken)
    }
}

words!(
    /// The colour of a road marking.
    MarkColour {
        /// The country's ordinary colour, taken as white.
        #[default]
        Standard = "standard", "White";
        /// White.
        White = "white", "White";
        /// Yellow.
        Yellow = "yellow", "Yellow";
        /// Red.
        Red = "red", "Red";
        /// Blue.
        Blue = "blue", "Blue";
        /// Green.
        Green = "green", "Green";
        /// Orange.
        Orange = "orange", "Other";
        /// Black.
        Black = "black", "Other";
        /// Violet.
        Violet = "violet", "Other";
    }
);

words!(
    /// How lane ids may change across a marking.
    MarkChange {
        /// Not at all.
        #[default]
        None = "none", "NONE";
        /// Towards larger lane ids (leftwards, looking along s).
        Increase = "increase", "Increase";
        /// Towards smaller lane ids.
        Decrease = "decrease", "Decrease";
        /// Either way.
        Both = "both", "Both";
    }
);

words!(
    /// Lane changes that are allowed, seen by a driver.
    LaneChange {
        /// None.
        #[default]
        None = "none", "NONE";
        /// To the right only.
        Right = "right", "Right";
        /// To the left only.
        Left = "left", "Left";
        /// Either way.
        Both = "both", "Both";
    }
);

impl LaneChange {
    /// From the two permissions.
    #[must_use]
    pub fn from_flags(left: bool, right: bool) -> Self {
        match (left, right) {
            (false, false) => Self::None,
            (false, true) => Self::Right,
            (true, false) => Self::Left,
            (true, true) => Self::Both,
        }
    }

    /// Whether a change to the left is allowed.
    #[must_use]
    pub fn to_left(self) -> bool {
        matches!(self, Self::Left | Self::Both)
    }

    /// Whether a change to the right is allowed.
    #[must_use]
    pub fn to_right(self) -> bool {
        matches!(self, Self::Right | Self::Both)
    }
}

words!(
    /// What one line of a marking tells drivers.
    LineRule {
        /// Nothing of its own.
        #[default]
        None = "none", "none";
        /// Not to overtake across it.
        NoPassing = "no passing", "no passing";
        /// To take care.
        Caution = "caution", "caution";
    }
);
