//! What a town can be asked to look like, and the towns that have a name.

mod city;
mod commercial;
mod downtown;
mod grid;
mod highways;
mod mountain;
mod old_town;
mod range;
mod region;
mod river;
mod rural;
mod style;
mod viaduct;

pub use city::CityParameters;
pub use commercial::CommercialParameters;
pub use downtown::DowntownParameters;
pub use grid::GridParameters;
pub use highways::HighwaysParameters;
pub use mountain::MountainParameters;
pub use old_town::OldTownParameters;
pub use region::RegionParameters;
pub use river::RiverParameters;
pub use rural::RuralParameters;
pub use style::Style;
pub use viaduct::ViaductParameters;

use serde::Deserialize;

use crate::error::TownError;
use range::within;

/// The towns that have a name, and their parameters.
const TOWNS: &[(&str, &str)] = &[
    ("convoy/demo", include_str!("../../towns/demo.toml")),
    ("convoy/01", include_str!("../../towns/01.toml")),
    ("convoy/02", include_str!("../../towns/02.toml")),
    ("convoy/03", include_str!("../../towns/03.toml")),
    ("convoy/04", include_str!("../../towns/04.toml")),
    ("convoy/05", include_str!("../../towns/05.toml")),
    ("convoy/06", include_str!("../../towns/06.toml")),
    ("convoy/07", include_str!("../../towns/07.toml")),
    ("convoy/08", include_str!("../../towns/08.toml")),
    ("convoy/09", include_str!("../../towns/09.toml")),
    ("convoy/10", include_str!("../../towns/10.toml")),
    ("convoy/11", include_str!("../../towns/11.toml")),
];

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
        match self.style {
            Style::Grid => self.grid.check(self.lane_width_m, self.sidewalk_m),
            Style::City => self.city.check(),
            Style::Downtown => self.downtown.check(),
            Style::Viaduct => self.viaduct.check(),
            Style::Highways => self.highways.check(),
            Style::River => self.river.check(),
            Style::Commercial => self.commercial.check(),
            Style::Rural => self.rural.check(),
            Style::OldTown => self.oldtown.check(),
            Style::Mountain => self.mountain.check(),
            Style::Region => self.region.check(),
        }
    }

    /// The projection of the town's coordinates.
    pub(crate) fn geo_reference(&self) -> String {
        format!(
            "+proj=tmerc +lat_0={} +lon_0={} +k=1 +x_0=0 +y_0=0 +datum=WGS84 +units=m +vunits=m +no_defs",
            self.latitude_deg, self.longitude_deg
        )
    }
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
