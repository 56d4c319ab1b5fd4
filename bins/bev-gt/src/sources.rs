//! What masks are drawn from besides triangles.

use std::collections::BTreeMap;

use labels::bev::{Areas, Footprint, LaneAreas, LaneView, PaintAreas};
use labels::bev_map::{LaneCollector, Paint, Reach};
use nalgebra::Point3;
use replay::Replay;
use scene::{SceneError, SceneReader};
use schema::tables::BoxRow;
use schema::{AgentId, AgentKind, Tag};
use settings::BevSettings;

/// The lanes that are drawn are chosen anew after so many frames: half a second.
const CHOSEN_FRAMES: u32 = 10;
/// Corners of a box's bottom, around it.
const BOTTOM: [usize; 4] = [0, 2, 6, 4];

/// Areas and lines of a scene, in the world.
pub(crate) struct SceneAreas {
    crosswalks: Vec<Vec<Point3<f64>>>,
    hazards: Vec<Vec<Point3<f64>>>,
    road_lines: Vec<Vec<Point3<f64>>>,
    paint: Paint,
}

impl SceneAreas {
    /// Those that the agents' masks may show.
    pub(crate) fn of(replay: &Replay, settings: &BevSettings) -> Self {
        let mut reach = Reach::default();
        for position in 0..replay.log.agent_ids().len() {
            let way = replay.log.agent_rows(position).map(|row| row.xyz_m);
            reach.add(way, settings.half_extent_m() * std::f64::consts::SQRT_2);
        }
        let area = |corners: &[[f64; 3]]| corners.iter().map(|&p| p.into()).collect();
        Self {
            crosswalks: replay.map.crosswalks().iter().map(|c| c.polygon.clone()).collect(),
            hazards: replay.log.info.hazards.iter().map(|h| area(&h.area_m)).collect(),
            road_lines: labels::bev_map::road_lines(&replay.map, &reach),
            paint: if settings.paint { Paint::of(&replay.map, &reach) } else { Paint::default() },
        }
    }

    pub(crate) fn areas(&self) -> Areas<'_> {
        Areas { crosswalks: &self.crosswalks, hazards: &self.hazards, road_lines: &self.road_lines }
    }

    pub(crate) fn paint(&self) -> PaintAreas<'_> {
        let Paint { stop_lines, parking, arrows } = &self.paint;
        PaintAreas { stop_lines, parking, arrows }
    }
}

/// Footprints by frame.
pub(crate) type Footprints = BTreeMap<u32, Vec<Footprint>>;

/// The footprints of every agent's boxes.
///
/// # Errors
/// The boxes cannot be read.
pub(crate) fn footprints(scene: &SceneReader) -> Result<BTreeMap<AgentId, Footprints>, SceneError> {
    let mut found: BTreeMap<AgentId, Footprints> = BTreeMap::new();
    for row in scene.rows::<BoxRow>()? {
        // Whose boxes these are was written by the log's own stage.
        let Ok(agent) = row.agent.parse::<AgentId>() else { continue };
        let corner = |k: usize| Point3::from_slice(&row.corners_m[3 * k..3 * k + 3]);
        let tags = row.semantic_tags.iter().filter_map(|&tag| Tag::from_u8(tag)).collect();
        let footprint = Footprint { tags, corners: BOTTOM.map(corner) };
        found.entry(agent).or_default().entry(row.frame).or_default().push(footprint);
    }
    Ok(found)
}

/// What an agent's masks are drawn from by the rule `simbev2x`.
pub(crate) struct AgentLanes {
    lanes: LaneAreas,
    boxes: Footprints,
    moves: bool,
}

impl AgentLanes {
    /// Collects the lanes about an agent's first place.
    pub(crate) fn of(
        replay: &Replay,
        collector: &mut LaneCollector<'_>,
        position: usize,
        agent: AgentId,
        radius_m: f64,
        boxes: Footprints,
    ) -> Self {
        let start = Point3::from(replay.log.agent(position, 0).xyz_m);
        Self { lanes: collector.about(start, radius_m), boxes, moves: agent.kind == AgentKind::Vehicle }
    }

    /// What is drawn at a frame.
    pub(crate) fn view<'a>(
        &'a self,
        replay: &Replay,
        areas: &'a SceneAreas,
        position: usize,
        frame: u32,
    ) -> LaneView<'a> {
        // Chosen once for objects that do not move.
        let chosen = if self.moves { frame - frame % CHOSEN_FRAMES } else { 0 };
        LaneView {
            lanes: &self.lanes,
            hazards: &areas.hazards,
            footprints: self.boxes.get(&frame).map_or(&[], Vec::as_slice),
            chosen_at: replay.log.agent(position, chosen).xyz_m.into(),
        }
    }
}
