//! A map made ready for looking at the ground of one tile after another.

use std::sync::OnceLock;

use opendrive::{Map, RoadSymbol, StopLine};
use schema::geometry::SurfaceMesh;

use crate::surfaces::blocks::Blocks;
use crate::surfaces::field::Field;
use crate::surfaces::ground::GroundLevels;
use crate::surfaces::holes::Paving;
use crate::surfaces::region::Region;
use crate::surfaces::sections::{Section, bounds, of_road};
use crate::surfaces::terrain::{REACH_M, Terrain};
use crate::surfaces::water::{Water, waters};
use crate::surfaces::{bridges, holes, lanes, marks, sections, tracks};

/// Lanes are looked at this far around an area, metres.
pub const HALO_M: f64 = 224.0;
/// Heights of the ground hold this far around an area, metres.
pub const LEVELS_M: f64 = HALO_M - REACH_M;

/// A map with what is needed of it whole: where its roads are, and how high the land between them is. Roads
/// are sampled and gaps between lanes paved when they are first asked for, and kept.
#[derive(Debug)]
pub struct Atlas<'a> {
    map: &'a Map,
    roads: Vec<(Region, OnceLock<Vec<Section>>)>,
    waters: Vec<Water>,
    field: Field,
    paving: Paving,
    stop_lines: Vec<StopLine>,
    symbols: Vec<RoadSymbol>,
}

/// The ground of an area and around it.
#[derive(Debug)]
pub struct AreaGround<'a> {
    map: &'a Map,
    stop_lines: &'a [StopLine],
    symbols: &'a [RoadSymbol],
    /// The area.
    pub area: Region,
    /// The area and what around it lanes are known of: [`HALO_M`] more on each side.
    pub around: Region,
    /// All sections of the roads that come there, by road and section.
    pub sections: Vec<&'a Section>,
    /// Heights of what lies there; they hold within [`LEVELS_M`].
    pub levels: GroundLevels,
}

impl<'a> Atlas<'a> {
    /// The atlas of a map.
    #[must_use]
    pub fn new(map: &'a Map) -> Self {
        // No road, no bounds: such a place is met by nothing.
        let nowhere = Region { min: [f64::INFINITY; 2], max: [f64::NEG_INFINITY; 2] };
        let roads = 0..map.network().roads.len() as u32;
        let roads = roads.map(|road| (bounds(map, road).unwrap_or(nowhere), OnceLock::new()));
        let waters = waters(map);
        Self {
            map,
            roads: roads.collect(),
            field: Field::new(map, &waters),
            waters,
            paving: Paving::new(map),
            stop_lines: map.stop_lines(),
            symbols: map.road_symbols(),
        }
    }

    /// All sections of the roads that come into a region, by road and section.
    fn sections(&self, region: &Region) -> Vec<&Section> {
        let near = self.roads.iter().enumerate().filter(|(_, (bounds, _))| bounds.meets(region));
        near.flat_map(|(road, (_, sections))| sections.get_or_init(|| of_road(self.map, road as u32)))
            .collect()
    }

    /// The ground of an area. Its corners are multiples of 16 m.
    #[must_use]
    pub fn ground(&self, area: &Region) -> AreaGround<'_> {
        self.ground_within(area, HALO_M)
    }

    /// The ground of an area, from what lies so far around it.
    fn ground_within(&self, area: &Region, halo_m: f64) -> AreaGround<'_> {
        let around = area.grown(halo_m);
        let sections = self.sections(&around.grown(sections::WIDEST_M));
        let mut cover = lanes::cover(&sections, &around);
        let patches = self.paving.patches(&around, |region| {
            lanes::cover(&self.sections(&region.grown(sections::WIDEST_M)), region)
        });
        let waters: Vec<Water> =
            self.waters.iter().filter(|w| w.is_near(&around, 2.0 * sections::WIDEST_M)).cloned().collect();
        let terrain = Terrain::new(&sections, &patches, &waters, &self.field, &around);
        patches.into_iter().for_each(|facet| cover.add(facet));
        let levels = GroundLevels { cover, terrain, waters };
        let (stop_lines, symbols) = (&self.stop_lines[..], &self.symbols[..]);
        AreaGround { map: self.map, stop_lines, symbols, area: *area, around, sections, levels }
    }
}

impl AreaGround<'_> {
    /// The map that it is of.
    #[must_use]
    pub fn map(&self) -> &Map {
        self.map
    }

    /// The triangles of everything on the ground of the area: blocks by layer and place. Of what crosses its
    /// border the pieces belong to it that begin there, so that areas side by side have each piece once.
    #[must_use]
    pub fn surfaces(&self) -> Vec<SurfaceMesh> {
        let (area, sections, ground) = (&self.area, &self.sections, &self.levels);
        let mut blocks = Blocks::new(area);
        lanes::build(sections, area, ground, &mut blocks);
        holes::build(&ground.cover, area, &mut blocks);
        marks::build(self.map, (self.stop_lines, self.symbols), sections, area, &ground.cover, &mut blocks);
        bridges::build(sections, area, ground, &mut blocks);
        tracks::build(sections, area, ground, &mut blocks);
        ground.terrain.build(&ground.cover, area, &mut blocks);
        ground.terrain.build_waters(&ground.waters, area, &mut blocks);
        blocks.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn town() -> Map {
        Map::new(testkit::crossing_network(true))
    }

    /// Areas of 64 m side around the crossing, which has a corner at the origin.
    fn areas() -> impl Iterator<Item = Region> {
        let low = [-128.0, -64.0, 0.0, 64.0];
        low.into_iter().flat_map(move |x| {
            low.into_iter().map(move |y| Region { min: [x, y], max: [x + 64.0, y + 64.0] })
        })
    }

    #[test]
    fn an_area_is_the_same_however_far_around_it_is_looked() {
        let map = town();
        let atlas = Atlas::new(&map);
        for area in areas() {
            let near = atlas.ground(&area).surfaces();
            let far = Atlas::new(&map).ground_within(&area, HALO_M + 64.0).surfaces();
            assert!(!near.is_empty() && near == far, "{area:?}");
        }
    }

    #[test]
    fn areas_side_by_side_have_each_triangle_once() {
        let map = town();
        let atlas = Atlas::new(&map);
        let corners = |surfaces: Vec<SurfaceMesh>| {
            let mut all: Vec<(schema::Layer, [i64; 3])> = Vec::new();
            for surface in surfaces {
                for i in 0..surface.mesh.triangles.len() {
                    // The middle of the corners, to tenths of a millimetre.
                    let [a, b, c] = surface.mesh.corners(i).map(|p| p.to_array().map(f64::from));
                    let middle = [0, 1, 2].map(|k| surface.origin_m[k] + (a[k] + b[k] + c[k]) / 3.0);
                    all.push((surface.layer, middle.map(|v| (v * 1e4).round() as i64)));
                }
            }
            all.sort_unstable();
            all
        };
        let whole = Region { min: [-128.0; 2], max: [128.0; 2] };
        let whole = corners(atlas.ground(&whole).surfaces());
        let mut parts: Vec<_> = areas().flat_map(|area| corners(atlas.ground(&area).surfaces())).collect();
        parts.sort_unstable();
        assert_eq!(parts.len(), whole.len());
        let differ = parts
            .iter()
            .zip(&whole)
            .filter(|(a, b)| a.0 != b.0 || (0..3).any(|k| (a.1[k] - b.1[k]).abs() > 1));
        // Corners are rounded relative to a block's height: a few may sort otherwise.
        assert!(100 * differ.count() < whole.len(), "{}", whole.len());
    }
}
