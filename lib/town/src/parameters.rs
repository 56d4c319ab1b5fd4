//! What a town can be asked to look like, and the towns that have a name.

use serde::Deserialize;

use crate::layouts::{
    CityParameters, CommercialParameters, DowntownParameters, GridParameters, HighwaysParameters,
    MountainParameters, OldTownParameters, RegionParameters, RiverParameters, RuralParameters, Style,
    ViaductParameters,
};

/// The towns that have a name, and their parameters.
const TOWNS: &[(&str, &str)] = &[
    ("convoy/demo", include_str!("../towns/demo.toml")),
    ("convoy/01", include_str!("../towns/01.toml")),
    ("convoy/02", include_str!("../towns/02.toml")),
    ("convoy/03", include_str!("../towns/03.toml")),
    ("convoy/04", include_str!("../towns/04.toml")),
    ("convoy/05", include_str!("../towns/05.toml")),
    ("convoy/06", include_str!("../towns/06.toml")),
    ("convoy/07", include_str!("../towns/07.toml")),
    ("convoy/08", include_str!("../towns/08.toml")),
    ("convoy/09", include_str!("../towns/09.toml")),
    ("convoy/10", include_str!("../towns/10.toml")),
    ("convoy/11", include_str!("../towns/11.toml")),
];

/// Why a town can't be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TownError {
    /// A parameter is out of its range.
    #[error("town parameter `{name}` is {value}, must be {range}")]
    Parameter {
        /// The key, with its table.
        name: &'static str,
        /// The value that was given.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// The text is no TOML, names a key that does not exist, or a value has the wrong type.
    #[error("town parameters: {0}")]
    Toml(String),
    /// The junctions at the ends of a street leave no room for it.
    #[error("street `{street}` has {left_m:.1} m left between its junctions, needs {needed_m:.1} m")]
    TooTight {
        /// Name of the street.
        street: String,
        /// Length that is left, metres (negative: the junctions overlap).
        left_m: f64,
        /// Least length, metres.
        needed_m: f64,
    },
    /// A street would have to climb more steeply than its traffic can.
    #[error("street `{street}` would have a grade of {grade:.3}, its limit is {limit:.3}")]
    TooSteep {
        /// Name of the street.
        street: String,
        /// Rise over run.
        grade: f64,
        /// Largest rise over run.
        limit: f64,
    },
    /// A bend has no room for its radius.
    #[error("street `{street}` would bend with a radius of {radius_m:.1} m, needs {needed_m:.1} m")]
    Bend {
        /// Name of the street.
        street: String,
        /// Radius that there is room for, metres.
        radius_m: f64,
        /// Least radius, metres.
        needed_m: f64,
    },
    /// Two roads cross that neither meet nor clear one another.
    #[error("`{over}` crosses `{under}` only {gap_m:.2} m above it, needs 5 m (or a junction)")]
    Clearance {
        /// Name of the upper road.
        over: String,
        /// Name of the lower road.
        under: String,
        /// Height between them, metres.
        gap_m: f64,
    },
    /// A layout asks for something that can't be.
    #[error("{place}: {problem}")]
    Layout {
        /// Name of the street or node.
        place: String,
        /// What is wrong.
        problem: String,
    },
}

/// What a town is to be like: the keys of a town's TOML file.
///
/// ```toml
/// name = "my/town"
/// seed = 12
/// style = "grid"      # its own keys are in the table of that name
/// [grid]
/// columns = 5
/// ```
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TownParameters {
    /// Name that goes into the file's header.
    pub name: String,
    /// Seed of everything that is drawn.
    pub seed: u64,
    /// Width of a driving lane in town, metres (2.5..=5).
    pub lane_width_m: f64,
    /// Width of a sidewalk, metres (1.5..=5).
    pub sidewalk_m: f64,
    /// Least radius of the kerb at a junction's corner, metres (3..=12).
    pub kerb_radius_m: f64,
    /// Latitude of the world's origin, degrees.
    pub latitude_deg: f64,
    /// Longitude of the world's origin, degrees.
    pub longitude_deg: f64,
    /// Which kind of town.
    pub style: Style,
    /// What is particular to `style = "grid"`.
    pub grid: GridParameters,
    /// What is particular to `style = "city"`.
    pub city: CityParameters,
    /// What is particular to `style = "downtown"`.
    pub downtown: DowntownParameters,
    /// What is particular to `style = "viaduct"`.
    pub viaduct: ViaductParameters,
    /// What is particular to `style = "highways"`.
    pub highways: HighwaysParameters,
    /// What is particular to `style = "river"`.
    pub river: RiverParameters,
    /// What is particular to `style = "commercial"`.
    pub commercial: CommercialParameters,
    /// What is particular to `style = "rural"`.
    pub rural: RuralParameters,
    /// What is particular to `style = "oldtown"`.
    pub oldtown: OldTownParameters,
    /// What is particular to `style = "mountain"`.
    pub mountain: MountainParameters,
    /// What is particular to `style = "region"`.
    pub region: RegionParameters,
}

impl Default for TownParameters {
    fn default() -> Self {
        Self {
            name: "convoy/town".into(),
            seed: 0,
            lane_width_m: 3.5,
            sidewalk_m: 3.0,
            kerb_radius_m: 6.0,
            latitude_deg: 49.0,
            longitude_deg: 8.0,
            style: Style::default(),
            grid: GridParameters::default(),
            city: CityParameters::default(),
            downtown: DowntownParameters::default(),
            viaduct: ViaductParameters::default(),
            highways: HighwaysParameters::default(),
            river: RiverParameters::default(),
            commercial: CommercialParameters::default(),
            rural: RuralParameters::default(),
            oldtown: OldTownParameters::default(),
            mountain: MountainParameters::default(),
            region: RegionParameters::default(),
        }
    }
}

impl TownParameters {
    /// Reads the text of a parameter file.
    ///
    /// # Errors
    /// [`TownError::Toml`] for what is no such file, [`TownError::Parameter`] for values out of range.
    pub fn from_toml(text: &str) -> Result<Self, TownError> {
        let faulty = |e: toml::de::Error| TownError::Toml(e.to_string().trim().to_owned());
        let parameters: Self = toml::from_str(text).map_err(faulty)?;
        let table: toml::Table = toml::from_str(text).map_err(faulty)?;
        let own = parameters.style.name();
        if let Some(other) = Style::ALL.iter().map(|s| s.name()).find(|s| *s != own && table.contains_key(*s))
        {
            return Err(TownError::Toml(format!("the table [{other}] has no meaning for style = \"{own}\"")));
        }
        parameters.check()?;
        Ok(parameters)
    }

    /// Refuses values that no town can be built from.
    pub(crate) fn check(&self) -> Result<(), TownError> {
        within("lane_width_m", self.lane_width_m, [2.5, 5.0], "2.5 to 5 m")?;
        within("sidewalk_m", self.sidewalk_m, [1.5, 5.0], "1.5 to 5 m")?;
        within("kerb_radius_m", self.kerb_radius_m, [3.0, 12.0], "3 to 12 m")?;
        within("latitude_deg", self.latitude_deg, [-80.0, 80.0], "-80 to 80 degrees")?;
        within("longitude_deg", self.longitude_deg, [-180.0, 180.0], "-180 to 180 degrees")?;
        self.style.check(self)
    }

    /// The projection of the town's coordinates.
    pub(crate) fn geo_reference(&self) -> String {
        format!(
            "+proj=tmerc +lat_0={} +lon_0={} +k=1 +x_0=0 +y_0=0 +datum=WGS84 +units=m +vunits=m +no_defs",
            self.latitude_deg, self.longitude_deg
        )
    }
}

/// Checks that a value is in its range (NaN never is).
pub(crate) fn within(
    name: &'static str,
    value: f64,
    [low, high]: [f64; 2],
    range: &'static str,
) -> Result<(), TownError> {
    if value >= low && value <= high { Ok(()) } else { Err(TownError::Parameter { name, value, range }) }
}

/// Names that [`named`] knows, in order.
#[must_use]
pub fn names() -> Vec<&'static str> {
    TOWNS.iter().map(|(name, _)| *name).collect()
}

/// The parameters of a named town.
#[must_use]
pub fn named(name: &str) -> Option<TownParameters> {
    let (_, text) = TOWNS.iter().find(|(known, _)| *known == name)?;
    let parameters = TownParameters::from_toml(text).ok()?;
    Some(TownParameters { name: name.to_owned(), ..parameters })
}
