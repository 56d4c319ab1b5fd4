//! Cross-sections: which lanes a street has, and the lanes of OpenDRIVE that come of it.

/// One side of a street, from the centre line outwards: driving lanes, gutter or parking lane, kerb, sidewalk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Side {
    /// Driving lanes; all travel in this side's direction.
    pub(crate) lanes: u8,
    /// Width of each, metres.
    pub(crate) lane_m: f64,
    /// Width of the gutter between the last driving lane and the kerb, metres.
    pub(crate) gutter_m: f64,
    /// Width of the parking lane that takes the gutter's place away from junctions, metres.
    pub(crate) parking_m: Option<f64>,
    /// Width of the sidewalk, metres.
    pub(crate) sidewalk_m: f64,
}

impl Side {
    /// Width of all driving lanes, metres.
    pub(crate) fn driving_m(&self) -> f64 {
        f64::from(self.lanes) * self.lane_m
    }

    /// From the centre line to the kerb at a junction, metres.
    pub(crate) fn kerb_m(&self) -> f64 {
        self.driving_m() + self.gutter_m
    }

    /// Distance from the centre line to the inner border of driving lane `index` at a junction, metres.
    pub(crate) fn inner_m(&self, index: u8) -> f64 {
        f64::from(index) * self.lane_m
    }
}

/// A street's cross-section. At its ends it is the same on every street of that kind; away from them a median may
/// open at the centre line, and gutters may widen to parking lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CrossSection {
    /// Left of the reference line: travel against it.
    pub(crate) left: Side,
    /// Right of the reference line: travel along it.
    pub(crate) right: Side,
    /// Widest place of the median, metres; 0 for none.
    pub(crate) median_m: f64,
    /// Speed limit, km/h.
    pub(crate) speed_limit_kmh: f64,
}

impl CrossSection {
    /// Whether the middle of the street has other lanes than its ends.
    pub(crate) fn changes(&self) -> bool {
        self.median_m > 0.0 || self.left.parking_m.is_some() || self.right.parking_m.is_some()
    }

    /// Distance from the reference line to the farthest edge of the street, metres.
    pub(crate) fn reach_m(&self) -> f64 {
        let of = |side: &Side| {
            side.driving_m() + side.parking_m.unwrap_or(side.gutter_m).max(side.gutter_m) + side.sidewalk_m
        };
        of(&self.left).max(of(&self.right)) + 0.5 * self.median_m
    }
}
