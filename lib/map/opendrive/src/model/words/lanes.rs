//! Words of lanes.

use super::words;

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
        /// Everybody together (revision 1.8).
        Shared = "shared", "Driving";
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
                | Self::Shared
        )
    }

    /// Whether it is for trains or trams.
    #[must_use]
    pub fn is_track(self) -> bool {
        matches!(self, Self::Rail | Self::Tram)
    }

    /// Whether pedestrians walk here.
    #[must_use]
    pub fn is_walkable(self) -> bool {
        matches!(self, Self::Sidewalk | Self::Walking)
    }
}

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
    /// What an access record says of those it names.
    AccessRule {
        /// They may not use the lane.
        #[default]
        Deny = "deny", "deny";
        /// Only they may use the lane.
        Allow = "allow", "allow";
    }
);

words!(
    /// From which neighbouring lane traffic may use this one as an advisory lane (revision 1.8).
    LaneAdvisory {
        /// From none.
        #[default]
        None = "none", "none";
        /// From the one nearer to the centre lane.
        Inner = "inner", "inner";
        /// From the other.
        Outer = "outer", "outer";
        /// From either.
        Both = "both", "both";
    }
);
