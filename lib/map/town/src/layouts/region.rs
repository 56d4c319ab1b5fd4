//! A region: several towns, farmland and hamlets between them, a motorway round its middle, a river or a
//! coast.

use random::Stream;

use super::patch::extent;
use super::region_land::Region;
use super::region_roads::roads;
use crate::assemble::{assemble, build};
use crate::error::TownError;
use crate::layout::Layout;
use crate::parameters::TownParameters;
use crate::terrain::Terrain;

/// Layouts that are tried.
const ATTEMPTS: u64 = 8;

/// Makes a layout from parameters.
type Layouter = fn(&TownParameters) -> Result<Layout, TownError>;

/// A region whose towns are laid out by `town`.
pub(super) fn layout(parameters: &TownParameters, town: Layouter) -> Result<Layout, TownError> {
    let towns = towns(parameters, town)?;
    let mut error = TownError::Layout {
        place: "region".into(),
        problem: "no road leads to one of its towns; another seed or fewer towns may help".into(),
    };
    let mut steep = None;
    for attempt in 0..ATTEMPTS {
        let Some(layout) = roads(Region::new(parameters, attempt).settled(&towns)) else { continue };
        match assemble(&layout) {
            Ok(_) => return Ok(layout),
            Err(TownError::TooSteep { .. }) if steep.is_none() => steep = Some(layout),
            Err(e) => error = e,
        }
    }
    // The ground gets flatter for one street only where no other draw goes without.
    steep.ok_or(error)
}

/// The region's towns, each about its own origin, the largest first.
fn towns(parameters: &TownParameters, layout: Layouter) -> Result<Vec<Layout>, TownError> {
    let mut towns = Vec::new();
    for (i, style) in parameters.region.towns.iter().enumerate() {
        let mut seeds = Stream::new(parameters.seed, 0, "town/region/seed", i as u64);
        let mut own = TownParameters {
            name: parameters.name.clone(),
            style: *style,
            lane_width_m: parameters.lane_width_m,
            sidewalk_m: parameters.sidewalk_m,
            kerb_radius_m: parameters.kerb_radius_m,
            ..TownParameters::default()
        };
        // Country roads begin where its alleys would end.
        own.oldtown.alleys = 0;
        // The region's ground adds its slopes to those of the hill.
        own.oldtown.hill_m = 20.0;
        own.check()?;
        let mut town = Layout::new("", Terrain::flat());
        for _ in 0..ATTEMPTS {
            own.seed = seeds.next_u64() >> 1;
            town = layout(&own)?;
            if build(&town).is_ok() {
                break;
            }
        }
        towns.push(town);
    }
    towns.sort_by(|a, b| extent(b).1.total_cmp(&extent(a).1));
    Ok(towns)
}
