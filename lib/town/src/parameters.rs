//! What a town can be asked to look like, and the towns that have a name.

/// Why a town can't be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TownError {
    /// A parameter is out of its range.
    #[error("town parameter `{name}` is {value}, must be {range}")]
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// The value that was given.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// The junctions at the ends of a street leave no room for it.
    #[error("street `{street}` has {left_m:.1} m left between its junctions, needs {needed_m:.1} m")]
    TooTight {
        /// Name of the street.
        street: String,
        /// Distance between its junctions along the first heading, metres (negative: they overlap).
        left_m: f64,
        /// Least length, metres.
        needed_m: f64,
    },
}

/// A street grid with signalised crossings inside a ring road.
#[derive(Clone, Debug, PartialEq)]
pub struct TownParameters {
    /// Name that goes into the file's header.
    pub name: String,
    /// Seed of everything that is drawn: block sizes, relief, which streets have parking, which one is the avenue.
    pub seed: u64,
    /// Streets that run north, each crossing every street that runs east (1..=64).
    pub columns: u32,
    /// Streets that run east (1..=64).
    pub rows: u32,
    /// Least and largest distance between the centre lines of two neighbouring streets, metres.
    pub block_m: [f64; 2],
    /// Width of a driving lane, metres (2.5..=5).
    pub lane_width_m: f64,
    /// Width of a sidewalk, metres (1.5..=5, and at least 1 m less than the kerb radius).
    pub sidewalk_m: f64,
    /// Radius of the kerb at a junction's corner, metres (3..=8).
    pub kerb_radius_m: f64,
    /// Radius of the ring road's centre line in its four corners, metres (15..=45).
    pub ring_radius_m: f64,
    /// Widest place of the avenue's median, metres; 0 builds a painted centre line only (0..=6).
    pub median_m: f64,
    /// Probability that a side of a street has a parking lane (0..=1).
    pub parking_share: f64,
    /// Height difference between the highest and the lowest ground, metres (0..=12).
    pub relief_m: f64,
    /// Latitude of the world's origin, degrees.
    pub latitude_deg: f64,
    /// Longitude of the world's origin, degrees.
    pub longitude_deg: f64,
}

impl Default for TownParameters {
    fn default() -> Self {
        Self {
            name: "convoy/town".into(),
            seed: 0,
            columns: 4,
            rows: 3,
            block_m: [70.0, 110.0],
            lane_width_m: 3.5,
            sidewalk_m: 3.0,
            kerb_radius_m: 6.0,
            ring_radius_m: 35.0,
            median_m: 2.4,
            parking_share: 0.6,
            relief_m: 4.0,
            latitude_deg: 49.0,
            longitude_deg: 8.0,
        }
    }
}

impl TownParameters {
    /// Refuses values that no town can be built from.
    pub(crate) fn check(&self) -> Result<(), TownError> {
        let within = |name, value: f64, low: f64, high: f64, range| {
            if value >= low && value <= high {
                Ok(())
            } else {
                Err(TownError::Parameter { name, value, range })
            }
        };
        within("columns", f64::from(self.columns), 1.0, 64.0, "1 to 64")?;
        within("rows", f64::from(self.rows), 1.0, 64.0, "1 to 64")?;
        within("block_m[0]", self.block_m[0], 40.0, 1000.0, "40 to 1000 m")?;
        within("block_m[1]", self.block_m[1], self.block_m[0], 1000.0, "from block_m[0] to 1000 m")?;
        within("lane_width_m", self.lane_width_m, 2.5, 5.0, "2.5 to 5 m")?;
        within("kerb_radius_m", self.kerb_radius_m, 3.0, 8.0, "3 to 8 m")?;
        // A corner's sidewalk turns inside the kerb: beyond the radius it would fold over.
        within(
            "sidewalk_m",
            self.sidewalk_m,
            1.5,
            (self.kerb_radius_m - 1.0).min(5.0),
            "1.5 to 5 m, 1 m under kerb_radius_m",
        )?;
        within("ring_radius_m", self.ring_radius_m, 15.0, 45.0, "15 to 45 m")?;
        within("median_m", self.median_m, 0.0, 6.0, "0 to 6 m")?;
        within("parking_share", self.parking_share, 0.0, 1.0, "0 to 1")?;
        within("relief_m", self.relief_m, 0.0, 12.0, "0 to 12 m")?;
        within("latitude_deg", self.latitude_deg, -80.0, 80.0, "-80 to 80 degrees")?;
        within("longitude_deg", self.longitude_deg, -180.0, 180.0, "-180 to 180 degrees")
    }
}

/// Names that [`named`] knows, in order.
#[must_use]
pub fn names() -> &'static [&'static str] {
    &["convoy/demo"]
}

/// The parameters of a named town.
#[must_use]
pub fn named(name: &str) -> Option<TownParameters> {
    match name {
        "convoy/demo" => Some(TownParameters { name: name.into(), seed: 7, ..TownParameters::default() }),
        _ => None,
    }
}
