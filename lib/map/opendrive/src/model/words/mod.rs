//! The closed vocabularies of OpenDRIVE, each with its spelling in the file and, where the HD-map record
//! names it, its spelling there.

mod lanes;
mod marks;

pub use lanes::{AccessRule, LaneAdvisory, LaneType, TravelDirection};
pub use marks::{LaneChange, LineRule, MarkChange, MarkColour, MarkType};

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

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.as_str())
            }
        }
    };
}

use words;

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

words!(
    /// Which side of the reference line.
    RoadSide {
        /// Both sides.
        #[default]
        Both = "both", "both";
        /// t > 0.
        Left = "left", "left";
        /// t < 0.
        Right = "right", "right";
    }
);

words!(
    /// Direction of a neighbouring road (revision 1.4 and older).
    NeighbourDirection {
        /// As this road.
        #[default]
        Same = "same", "same";
        /// Against it.
        Opposite = "opposite", "opposite";
    }
);

words!(
    /// How a connection leads through a virtual junction.
    ConnectionKind {
        /// By a connecting road.
        #[default]
        Default = "default", "default";
        /// By no road at all: it only says that one can get there.
        Virtual = "virtual", "virtual";
    }
);

words!(
    /// Where a railway switch stands.
    SwitchPosition {
        /// It can be moved.
        #[default]
        Dynamic = "dynamic", "dynamic";
        /// Always straight on.
        Straight = "straight", "straight";
        /// Always to the side.
        Turn = "turn", "turn";
    }
);

words!(
    /// Direction in which the side track leaves a switch.
    TrackDirection {
        /// Along s.
        #[default]
        Along = "+", "+";
        /// Against s.
        Against = "-", "-";
    }
);

words!(
    /// Side of an object's bounding box, looking along its x.
    BoxSide {
        /// Its y is largest.
        #[default]
        Left = "left", "left";
        /// Its y is smallest.
        Right = "right", "right";
        /// Its x is largest.
        Front = "front", "front";
        /// Its x is smallest.
        Rear = "rear", "rear";
    }
);
