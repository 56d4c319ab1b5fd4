//! Where accidents and road works lie.
//!
//! A hazard takes up one lane from its back (upstream) to its front. How many are tried is fixed by the
//! number of places; whether a try finds room is not.

use catalogue::{Catalogue, Model, fleet};
use nalgebra::Point3;
use opendrive::{LanePos, Map};
use random::Stream;
use schema::HazardKind;
use schema::tables::PlanHazardRow;
use settings::HazardSettings;

use crate::pool::{SpawnPoint, SpawnPool};

/// Gap behind the rear vehicle of an accident where no emergency vehicle stands, metres: for a cone.
const CONE_GAP_M: f64 = 2.0;
/// From the first barrier of road works to the first item, and the room wanted beyond it, metres.
const FIRST_ITEM_M: f64 = 2.0;
/// Way to the next item after a small one, and after a large one or a worker, metres.
const SMALL_STEP_M: [f64; 2] = [0.4, 1.6];
const LARGE_STEP_M: [f64; 2] = [1.6, 3.2];
/// What comes next in road works, all equally likely: this many small things, large things and workers, or
/// the end.
const SMALL: usize = 19;
const LARGE: usize = 7;

/// What hazards keep away from.
pub(crate) struct Surroundings<'a> {
    pub(crate) map: &'a Map,
    pub(crate) pool: &'a SpawnPool,
    /// The models that vehicles of accidents are drawn from.
    pub(crate) catalogue: &'a Catalogue,
    /// Where data-collection vehicles start.
    pub(crate) agents: Vec<Point3<f64>>,
    /// Hazards lie within this distance of an agent, metres.
    pub(crate) radius_m: f64,
    /// Hazards and agents, and two hazards of a lane, stay this far apart, metres.
    pub(crate) clearance_m: f64,
}

/// A hazard that found room.
struct Area {
    back: LanePos,
    front: LanePos,
    what: What,
}

enum What {
    /// The vehicles: front, rear, and the emergency vehicle if one came.
    Accident(Vec<&'static Model>),
    /// Things and workers between the two barriers.
    RoadWorks(u32),
}

/// The hazards of a scene and how many were tried.
///
/// Every try has a stream of its own (`stream` gives it by number): one more place moves no other try's
/// draws.
pub(crate) fn plan_hazards(
    here: &Surroundings<'_>,
    settings: &HazardSettings,
    scene: u32,
    stream: impl Fn(u64) -> Stream,
) -> (Vec<PlanHazardRow>, u32) {
    let places: Vec<&SpawnPoint> = here.pool.points.iter().filter(|p| here.is_eligible(p)).collect();
    let tries = (places.len() as f64 * settings.share).round_ties_even() as u32;
    let mut areas: Vec<Area> = Vec::new();
    for number in 0..tries {
        let mut stream = stream(u64::from(number));
        let is_accident = stream.chance(settings.accident_share);
        let Some(anchor) = stream.choose(&places).map(|place| place.pos) else { break };
        let area = if is_accident {
            here.accident(anchor, &areas, settings, &mut stream)
        } else {
            here.road_works(anchor, &areas, &mut stream)
        };
        areas.extend(area);
    }
    let rows = areas.iter().enumerate().map(|(i, area)| here.row(scene, i as u32, area)).collect();
    (rows, tries)
}

impl Surroundings<'_> {
    fn is_eligible(&self, place: &SpawnPoint) -> bool {
        let distances = || self.agents.iter().map(|agent| (agent - place.xyz_m).norm());
        distances().all(|d| d > self.clearance_m) && distances().any(|d| d < self.radius_m)
    }

    /// The place some way onward by first branches, negative: back.
    fn along(&self, from: LanePos, way_m: f64) -> Option<LanePos> {
        let places = if way_m < 0.0 { self.map.behind(from, -way_m) } else { self.map.ahead(from, way_m) };
        places.first().copied()
    }

    fn point(&self, at: LanePos) -> Option<Point3<f64>> {
        self.map.point_at(at).map(|place| place.position)
    }

    /// Whether two places of one road and lane are too near one another.
    fn are_close(&self, a: LanePos, b: LanePos) -> bool {
        let near = || Some((self.point(a)? - self.point(b)?).norm() < self.clearance_m);
        (a.lane.road, a.lane.lane) == (b.lane.road, b.lane.lane) && near().unwrap_or(false)
    }

    fn is_in_junction(&self, at: LanePos) -> bool {
        self.map.junction_of(at.lane).is_some()
    }

    fn accident(
        &self,
        anchor: LanePos,
        others: &[Area],
        settings: &HazardSettings,
        stream: &mut Stream,
    ) -> Option<Area> {
        let with_emergency = stream.chance(settings.emergency_share);
        let pick = |stream: &mut Stream, emergency: bool| {
            // Room is kept by what a model is: a pack may have longer ones.
            let fits = |m: &&'static Model| m.size_m[0] <= m.base.stretch_m();
            let alike = |m: &&'static Model| fleet::is_emergency(m) == emergency && fits(m);
            let fit: Vec<&'static Model> = self.catalogue.vehicles().filter(alike).collect();
            stream.choose_weighted(&fit, |m| self.catalogue.weight(m)).copied()
        };
        let mut models = vec![pick(stream, false)?, pick(stream, false)?];
        if with_emergency {
            models.push(pick(stream, true)?);
        }
        let behind_m = models[1].base.stretch_m() + models.get(2).map_or(CONE_GAP_M, |m| m.base.stretch_m());
        let front = self.along(anchor, models[0].base.stretch_m())?;
        let back = self.along(anchor, -behind_m)?;
        let clash = others.iter().any(|o| self.are_close(front, o.back) || self.are_close(back, o.front));
        (!clash).then_some(Area { back, front, what: What::Accident(models) })
    }

    fn road_works(&self, anchor: LanePos, others: &[Area], stream: &mut Stream) -> Option<Area> {
        let open = |at: &LanePos| !self.is_in_junction(*at);
        let near_back = |at| others.iter().any(|other| self.are_close(at, other.back));
        let mut at = self.along(anchor, FIRST_ITEM_M).filter(open)?;
        if near_back(at) {
            return None;
        }
        self.along(at, FIRST_ITEM_M).filter(open)?;
        let mut items = 0;
        // Each round but a share of 26 in 27 ends it, so it ends.
        loop {
            let drawn = stream.index(SMALL + LARGE + 1)?;
            let [low, high] = if drawn < SMALL { SMALL_STEP_M } else { LARGE_STEP_M };
            let step_m = stream.uniform(low, high);
            let next = self.along(at, step_m).filter(open).filter(|next| {
                let point = self.point(*next);
                point.is_some_and(|p| self.agents.iter().all(|a| (a - p).norm() >= self.clearance_m))
            });
            match next {
                Some(next) if drawn < SMALL + LARGE && !near_back(at) => {
                    items += 1;
                    at = next;
                }
                _ => return Some(Area { back: anchor, front: at, what: What::RoadWorks(items) }),
            }
        }
    }

    fn row(&self, scene: u32, hazard: u32, area: &Area) -> PlanHazardRow {
        let road = |at: LanePos| {
            let roads = &self.map.network().roads;
            roads.get(at.lane.road as usize).map(|road| road.id.clone()).unwrap_or_default()
        };
        let xyz_m = |at| self.point(at).map_or([0.0; 3], |p| p.coords.into());
        let s_m = |at| self.map.s_of(at).unwrap_or(0.0);
        let (kind, models, items) = match &area.what {
            What::Accident(models) => {
                (HazardKind::Accident, models.iter().map(|m| m.name.to_owned()).collect(), 0)
            }
            What::RoadWorks(items) => (HazardKind::RoadWorks, Vec::new(), *items),
        };
        PlanHazardRow {
            scene,
            hazard,
            kind,
            models,
            items,
            back_xyz_m: xyz_m(area.back),
            back_road: road(area.back),
            back_lane: i32::from(area.back.lane.lane),
            back_s_m: s_m(area.back),
            front_xyz_m: xyz_m(area.front),
            front_road: road(area.front),
            front_lane: i32::from(area.front.lane.lane),
            front_s_m: s_m(area.front),
        }
    }
}
