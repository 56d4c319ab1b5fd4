//! The rule `simbev2x`: masks as SimBEV2X draws them, so that results compare with its published set.
//!
//! The ground is drawn from lanes of the map that were sampled beforehand ([`LaneAreas`]), as polygons with
//! corners on whole cells, outlines and all, and closed by a cell; what the map does not know of the road
//! comes from a look from far above. Objects are where a look from far above or from far below shows them;
//! both tilt with the agent, unlike the polygons. Every cone counts as a rider, too, since their colours
//! there agree in the one channel that is looked at.
//!
//! Where the map's levels mix about an agent, objects are the footprints of its boxes, and of the ground
//! what lies within 4.8 m of its height.
//!
//! Known differences: the two looks are along parallel lines (there from 1 km away: at most 0.24 m for 3 m of
//! height at 80 m).

mod closing;
mod lanes;
mod projection;
mod scan;

use crate::culling::MeshCache;
use frames::{Agent, Pose, World};
use nalgebra::Point3;
use schema::geometry::Snapshot;
use schema::{BevClass, Tag};
use settings::BevSettings;

use crate::bev::error::BevError;
use crate::bev::grid::GridFrame;
use crate::bev::mask::BevMask;
use crate::bev::tags::object_class;
use closing::close;
pub use lanes::{LaneAreas, LaneStrip};
use projection::Projection;

/// What lies within this height of the agent belongs to its level, metres.
const LEVEL_M: f64 = 4.8;
/// Lanes this near to the agent are drawn, metres, on a grid that reaches no farther than [`USUAL_HALF_M`].
const NEAR_RADIUS_M: f64 = 140.0;
/// Half the side of the usual grid, metres.
const USUAL_HALF_M: f64 = 80.0;
/// On larger grids lanes are drawn up to this much beyond the corners, metres.
const NEAR_MARGIN_M: f64 = 20.0;

/// The ground that a box stands on.
#[derive(Clone, Debug, PartialEq)]
pub struct Footprint {
    /// The box's semantic tags.
    pub tags: Vec<Tag>,
    /// Bottom corners in the world, around it.
    pub corners: [Point3<f64>; 4],
}

/// What a mask is drawn from, besides triangles.
#[derive(Clone, Copy, Debug)]
pub struct LaneView<'a> {
    /// The lanes about the agent.
    pub lanes: &'a LaneAreas,
    /// Accident and road-work stretches of lanes, as closed polygons in the world.
    pub hazards: &'a [Vec<Point3<f64>>],
    /// The agent's boxes.
    pub footprints: &'a [Footprint],
    /// Where the agent was when its lanes were last chosen.
    pub chosen_at: Point3<f64>,
}

/// Makes masks by this rule; keeps its working memory between frames.
#[derive(Debug)]
pub struct LaneRasterizer {
    cells: usize,
    settings: BevSettings,
    meshes: MeshCache,
    projection: Projection,
}

/// One channel.
type Channel = Vec<bool>;

impl LaneRasterizer {
    /// For masks of these settings.
    ///
    /// # Errors
    /// The settings give an empty or immense grid.
    pub fn new(settings: &BevSettings) -> Result<Self, BevError> {
        let cells = BevError::check(settings)?;
        let (meshes, projection) = (MeshCache::default(), Projection::new(cells));
        Ok(Self { cells, settings: settings.clone(), meshes, projection })
    }

    /// Lanes this near to the agent are drawn, metres.
    fn near_radius_m(&self) -> f64 {
        let half_m = self.settings.half_extent_m();
        let usual_m = if half_m <= USUAL_HALF_M {
            NEAR_RADIUS_M
        } else {
            half_m * std::f64::consts::SQRT_2 + NEAR_MARGIN_M
        };
        self.settings.near_radius_m.unwrap_or(usual_m)
    }

    /// The mask around an agent.
    pub fn rasterize(
        &mut self,
        snapshot: &Snapshot,
        world_from_agent: &Pose<World, Agent>,
        view: LaneView<'_>,
    ) -> BevMask {
        let grid = GridFrame::new(self.cells, self.settings.cell_m, world_from_agent);
        let radius_m = self.near_radius_m();
        let near = |p: &Point3<f64>| (p - view.chosen_at).norm() <= radius_m;
        let lanes = view.lanes;
        let kept = |strips: &'_ [LaneStrip]| -> Vec<usize> {
            (0..strips.len()).filter(|&k| strips[k].is_near(view.chosen_at, radius_m)).collect()
        };
        let roads: Vec<&LaneStrip> = kept(&lanes.roads).into_iter().map(|k| &lanes.roads[k]).collect();
        let sidewalks: Vec<&LaneStrip> =
            kept(&lanes.sidewalks).into_iter().map(|k| &lanes.sidewalks[k]).collect();
        let crosswalks = lanes.crosswalks.iter().filter(|ring| ring.iter().any(near));
        let fallback = lanes.multi_level && {
            let midline = roads.iter().chain(&sidewalks).flat_map(|strip| &strip.midline);
            lanes::levels_mix(&midline.copied().filter(near).collect::<Vec<_>>())
        };

        let mut ground = Ground { cells: self.cells, grid: &grid, level_m: None };
        if fallback {
            ground.level_m = Some(world_from_agent.xyz()[2]);
        } else {
            let to_grid = grid.tilted_from_local(snapshot, world_from_agent);
            self.projection.draw(snapshot, self.meshes.facts(&snapshot.meshes), &to_grid);
        }
        let mut bits = vec![0_u16; self.cells * self.cells];
        let mut put = |class: BevClass, channel: &Channel| {
            bits.iter_mut().zip(channel).for_each(|(bits, &set)| *bits |= u16::from(set) << class as u16);
        };

        let mut road = ground.lanes(&roads);
        let mut sidewalk = ground.lanes(&sidewalks);
        if !fallback {
            let above = |wanted: &[Tag], channel: &mut Channel| {
                for (cell, set) in channel.iter_mut().enumerate() {
                    *set |= wanted.contains(&self.projection.tags(cell)[0]);
                }
            };
            above(&[Tag::Road, Tag::RoadLine], &mut road);
            if self.settings.sidewalks_from_above {
                above(&[Tag::Sidewalk], &mut sidewalk);
            }
        }
        close(&mut road, self.cells);
        close(&mut sidewalk, self.cells);
        let mut crosswalk = ground.crosswalks(crosswalks);
        crosswalk.iter_mut().zip(&road).for_each(|(cell, road)| *cell &= road);
        close(&mut crosswalk, self.cells);
        let mut hazard = ground.polygons(view.hazards.iter().map(|h| h.iter().copied()));
        close(&mut hazard, self.cells);
        put(BevClass::Road, &road);
        put(BevClass::Hazard, &hazard);
        put(BevClass::RoadLine, &ground.markings(&roads));
        put(BevClass::Sidewalk, &sidewalk);
        put(BevClass::Crosswalk, &crosswalk);

        if fallback {
            self.draw_footprints(&ground, view.footprints, &mut bits);
        } else {
            self.draw_seen(&mut bits);
        }
        BevMask::new(self.cells, bits)
    }

    /// Objects where they are seen from above or from below.
    fn draw_seen(&self, bits: &mut [u16]) {
        for (cell, bits) in bits.iter_mut().enumerate() {
            for class in self.projection.tags(cell).into_iter().filter_map(object_class) {
                *bits |= 1 << class as u16;
                if class == BevClass::TrafficCone {
                    *bits |= 1 << BevClass::Rider as u16;
                }
            }
        }
    }

    /// Objects by the ground their boxes stand on.
    fn draw_footprints(&self, ground: &Ground<'_>, footprints: &[Footprint], bits: &mut [u16]) {
        for footprint in footprints {
            if !footprint.corners.iter().all(|corner| ground.is_on_level(corner)) {
                continue;
            }
            let classes = footprint.tags.iter().copied().filter_map(object_class);
            let set = classes.fold(0, |set, class| set | 1_u16 << class as u16);
            let corners = footprint.corners.map(|corner| ground.grid.whole_cell(corner));
            scan::fill(&corners, self.cells, |cell| bits[cell] |= set);
        }
    }
}

/// Draws the ground of a frame.
struct Ground<'a> {
    cells: usize,
    grid: &'a GridFrame,
    /// Height of the agent, where only what lies near it is drawn.
    level_m: Option<f64>,
}

impl Ground<'_> {
    fn is_on_level(&self, point: &Point3<f64>) -> bool {
        self.level_m.is_none_or(|z| (point.z - z).abs() < LEVEL_M)
    }

    fn empty(&self) -> Channel {
        vec![false; self.cells * self.cells]
    }

    /// Polygons, each filled by itself from those of its corners that count.
    fn polygons<P: Iterator<Item = Point3<f64>>>(&self, polygons: impl Iterator<Item = P>) -> Channel {
        let mut channel = self.empty();
        for polygon in polygons {
            let corners: Vec<scan::Corner> =
                polygon.filter(|p| self.is_on_level(p)).map(|p| self.grid.whole_cell(p)).collect();
            scan::fill(&corners, self.cells, |cell| channel[cell] = true);
        }
        channel
    }

    fn lanes(&self, strips: &[&LaneStrip]) -> Channel {
        self.polygons(strips.iter().flat_map(|strip| strip.pieces()))
    }

    /// Crossings count whole, by their first corner.
    fn crosswalks<'p>(&self, rings: impl Iterator<Item = &'p Vec<Point3<f64>>>) -> Channel {
        let mut channel = self.empty();
        for ring in rings.filter(|ring| ring.first().is_some_and(|first| self.is_on_level(first))) {
            let corners: Vec<scan::Corner> = ring.iter().map(|&p| self.grid.whole_cell(p)).collect();
            scan::fill(&corners, self.cells, |cell| channel[cell] = true);
        }
        channel
    }

    /// One cell a marking point.
    fn markings(&self, strips: &[&LaneStrip]) -> Channel {
        let mut channel = self.empty();
        let inside = 0..self.cells as i64;
        for point in strips.iter().flat_map(|strip| &strip.markings).filter(|p| self.is_on_level(p)) {
            let [column, row] = self.grid.whole_cell(*point);
            if inside.contains(&column) && inside.contains(&row) {
                channel[row as usize * self.cells + column as usize] = true;
            }
        }
        channel
    }
}
