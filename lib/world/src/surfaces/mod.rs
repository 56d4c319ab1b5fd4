//! Ground, road, paint and bridges from the map.

mod bridges;
mod cover;
mod holes;
mod lanes;
mod marks;
mod raster;
mod sections;
mod terrain;
mod tiles;
mod tracks;
mod water;

use opendrive::Map;
use schema::Tag;

pub(crate) use cover::Cover;
#[cfg(test)]
pub(crate) use cover::Facet;
pub(crate) use raster::Raster;
pub use sections::lane_raise_m;
pub(crate) use sections::{Ground, Section, sections};
pub(crate) use terrain::Terrain;
pub(crate) use tiles::TileMesh;
pub(crate) use water::Water;

/// An area of the plan, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Region {
    pub(crate) min: [f64; 2],
    pub(crate) max: [f64; 2],
}

impl Region {
    pub(crate) fn contains(&self, x: f64, y: f64) -> bool {
        x >= self.min[0] && x <= self.max[0] && y >= self.min[1] && y <= self.max[1]
    }

    pub(crate) fn grown(&self, by_m: f64) -> Self {
        Self { min: self.min.map(|v| v - by_m), max: self.max.map(|v| v + by_m) }
    }
}

/// A surface of the world; each is one object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Layer {
    Road,
    Marking,
    Sidewalk,
    Median,
    Terrain,
    Bridge,
    GuardRail,
    Track,
    Water,
}

impl Layer {
    pub(crate) const ALL: [Self; 9] = [
        Self::Road,
        Self::Marking,
        Self::Sidewalk,
        Self::Median,
        Self::Terrain,
        Self::Bridge,
        Self::GuardRail,
        Self::Track,
        Self::Water,
    ];

    /// Model name of its row.
    pub(crate) fn model(self) -> &'static str {
        match self {
            Self::Road => "surface.road",
            Self::Marking => "surface.marking",
            Self::Sidewalk => "surface.sidewalk",
            Self::Median => "surface.median",
            Self::Terrain => "surface.terrain",
            Self::Bridge => "surface.bridge",
            Self::GuardRail => "surface.guard_rail",
            Self::Track => "surface.track",
            Self::Water => "surface.water",
        }
    }

    pub(crate) fn from_model(model: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|l| l.model() == model)
    }

    /// Tag of its row.
    pub(crate) fn tag(self) -> Tag {
        match self {
            Self::Road => Tag::Road,
            Self::Marking => Tag::RoadLine,
            Self::Sidewalk => Tag::Sidewalk,
            Self::Median => Tag::Ground,
            Self::Terrain => Tag::Terrain,
            Self::Bridge => Tag::Bridge,
            Self::GuardRail => Tag::GuardRail,
            Self::Track => Tag::RailTrack,
            Self::Water => Tag::Water,
        }
    }
}

/// Everything that lies on the ground of a region.
#[derive(Debug)]
pub(crate) struct Surfaces {
    pub(crate) tiles: Vec<TileMesh>,
    pub(crate) ground: GroundLevels,
}

/// Heights of the ground.
#[derive(Debug)]
pub(crate) struct GroundLevels {
    pub(crate) cover: Cover,
    pub(crate) terrain: Terrain,
    pub(crate) waters: Vec<Water>,
}

/// Surfaces this far above or below the height asked for count as the same level, metres.
const LEVEL_M: f64 = 2.5;

impl GroundLevels {
    /// Height of the ground at a point: of lanes on the level of `near_z` the nearest, else the terrain if it is on that level,
    /// else whatever is nearest.
    pub(crate) fn height(&self, x: f64, y: f64, near_z: f64) -> f64 {
        let terrain = self.terrain.height(x, y);
        let off = |z: f64| (z - near_z).abs();
        let lanes = self.cover.at(x, y).map(|(_, z)| z);
        match lanes.min_by(|a, b| off(*a).total_cmp(&off(*b))) {
            // Lanes lie over the terrain, so on one level they are what is stood on.
            Some(lane) if off(lane) <= LEVEL_M || off(lane) <= off(terrain) => lane,
            _ => terrain,
        }
    }
}

/// Lane surfaces, terrain heights and waters alone: what scenery is placed by.
pub(crate) fn levels(map: &Map, sections: &[Section], region: &Region) -> GroundLevels {
    let mut cover = lanes::cover(sections, region);
    let patches = holes::patches(map, region, &cover);
    let waters = water::waters(map, region);
    let terrain = Terrain::new(sections, &patches, &waters, region);
    patches.into_iter().for_each(|facet| cover.add(facet));
    GroundLevels { cover, terrain, waters }
}

/// Builds the surfaces of a region.
pub(crate) fn build(map: &Map, region: &Region) -> Surfaces {
    let sections = sections(map, region);
    let ground = levels(map, &sections, region);
    let mut tiles = tiles::Tiles::default();
    lanes::build(&sections, region, &ground, &mut tiles);
    holes::build(&ground.cover, &mut tiles);
    marks::build(map, &sections, region, &ground.cover, &mut tiles);
    bridges::build(&sections, region, &ground, &mut tiles);
    tracks::build(&sections, region, &ground, &mut tiles);
    ground.terrain.build(&mut tiles);
    water::build(&ground.waters, &ground.terrain, &mut tiles);
    Surfaces { tiles: tiles.finish(), ground }
}
