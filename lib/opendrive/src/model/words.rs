//! The closed vocabularies of OpenDRIVE, each with its spelling in the file and, where the HD-map record
//! names it, its spelling there.

use std::fmt;

/// Defines an enum together with its file spelling, its label and the way back from the file.
macro_rules! words {
    ($(#[$doc:meta])* $name:ident { $($(#[$vdoc:meta])* $variant:ident = $xml:literal, $label:literal;)+ }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum $name { $($(#[$vdoc])* $variant,)+ }

        impl $name {
            /// Every value, in declaration order.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// The spelling in an OpenDRIVE file.
            #[must_use]
            pub fn xml(self) -> &'static str {
                match self { $(Self::$variant => $xml,)+ }
            }

            /// The spelling in an HD-map record.
            #[must_use]
            pub fn as_str(self) -> &'static str {
                match self { $(Self::$variant => $label,)+ }
            }

            /// Reads the file spelling, in any letter case.
            #[must_use]
            pub fn from_xml(text: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|v| v.xml().eq_ignore_ascii_case(text))
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(self.as_str())
            }
        }
    };
}

words!(
    /// What a lane is for.
    LaneType {
        /// No use at all.
        #[default]
        None = "none", "NONE";
        /// Motor traffic.
        Driving = "driving", "Driving";
        /// Hard shoulder for emergency stops.
        Stop = "stop", "Stop";
        /// Soft border beside the road.
        Shoulder = "shoulder", "Shoulder";
        /// Cyclists.
        Biking = "biking", "Biking";
        /// Pedestrians.
        Sidewalk = "sidewalk", "Sidewalk";
        /// Hard border at road level.
        Border = "border", "Border";
        /// Paved, but not to be driven on.
        Restricted = "restricted", "Restricted";
        /// Parked vehicles.
        Parking = "parking", "Parking";
        /// Traffic of both directions (two-way turn lane).
        Bidirectional = "bidirectional", "Bidirectional";
        /// Between the carriageways.
        Median = "median", "Median";
        /// Free for special use.
        Special1 = "special1", "Special1";
        /// Free for special use.
        Special2 = "special2", "Special2";
        /// Free for special use.
        Special3 = "special3", "Special3";
        /// Road works.
        RoadWorks = "roadWorks", "RoadWorks";
        /// Trams.
        Tram = "tram", "Tram";
        /// Trains.
        Rail = "rail", "Rail";
        /// Acceleration lane.
        Entry = "entry", "Entry";
        /// Deceleration lane.
        Exit = "exit", "Exit";
        /// Leaves a motorway.
        OffRamp = "offRamp", "OffRamp";
        /// Enters a motorway.
        OnRamp = "onRamp", "OnRamp";
        /// Between two motorways.
        ConnectingRamp = "connectingRamp", "Driving";
        /// Slip road of a junction.
        SlipLane = "slipLane", "Driving";
        /// Kerb stones.
        Curb = "curb", "Border";
        /// Pedestrians (newer spelling of sidewalk).
        Walking = "walking", "Sidewalk";
        /// Buses only.
        Bus = "bus", "Driving";
        /// Taxis only.
        Taxi = "taxi", "Driving";
        /// Car pools.
        Hov = "HOV", "Driving";
    }
);

impl LaneType {
    /// Whether cars travel here in ordinary traffic.
    #[must_use]
    pub fn is_drivable(self) -> bool {
        matches!(
            self,
            Self::Driving
                | Self::Entry
                | Self::Exit
                | Self::OffRamp
                | Self::OnRamp
                | Self::ConnectingRamp
                | Self::SlipLane
        )
    }

    /// Whether pedestrians walk here.
    #[must_use]
    pub fn is_walkable(self) -> bool {
        matches!(self, Self::Sidewalk | Self::Walking)
    }
}

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
    /// Side of the road that traffic keeps to.
    TrafficRule {
        /// Right-hand traffic: lanes with id < 0 run along s.
        #[default]
        Right = "RHT", "RHT";
        /// Left-hand traffic: lanes with id < 0 run against s.
        Left = "LHT", "LHT";
    }
);

words!(
    /// Which end of a road.
    ContactPoint {
        /// Where s is 0.
        #[default]
        Start = "start", "start";
        /// Where s is the road's length.
        End = "end", "end";
    }
);

words!(
    /// Direction, relative to s, in which a signal or object applies.
    Orientation {
        /// To travel along s.
        Along = "+", "+";
        /// To travel against s.
        Against = "-", "-";
        /// To both.
        #[default]
        Both = "none", "none";
    }
);

words!(
    /// How a lane's travel direction follows from its side (revision 1.8).
    TravelDirection {
        /// As the traffic rule says.
        #[default]
        Standard = "standard", "standard";
        /// The other way.
        Reversed = "reversed", "reversed";
        /// Both ways.
        Both = "both", "both";
    }
);

words!(
    /// The kind of a junction.
    JunctionKind {
        /// With connecting roads.
        #[default]
        Default = "default", "default";
        /// Roads touch each other without connecting roads.
        Direct = "direct", "direct";
        /// A side branch of a road that goes on.
        Virtual = "virtual", "virtual";
        /// Where roads cross without an exchange of traffic.
        Crossing = "crossing", "crossing";
    }
);

words!(
    /// The kind of a tunnel.
    TunnelType {
        /// Closed all round.
        #[default]
        Standard = "standard", "standard";
        /// Under another road; daylight comes in.
        Underpass = "underpass", "underpass";
    }
);

words!(
    /// Unit of a speed.
    SpeedUnit {
        /// Metres a second (also when no unit is written).
        #[default]
        MetresPerSecond = "m/s", "m/s";
        /// Kilometres an hour.
        KilometresPerHour = "km/h", "km/h";
        /// Miles an hour.
        MilesPerHour = "mph", "mph";
    }
);

impl SpeedUnit {
    /// Metres a second in one unit.
    #[must_use]
    pub fn metres_per_second(self) -> f64 {
        match self {
            Self::MetresPerSecond => 1.0,
            Self::KilometresPerHour => 1.0 / 3.6,
            Self::MilesPerHour => 0.44704,
        }
    }
}
