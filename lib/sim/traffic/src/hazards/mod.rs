//! Accidents and road works: the objects in a planned hazard for the whole scene.
//!
//! A hazard whose vehicles do not fit (an agent starts there, or another hazard lies there) is left out
//! whole; of the other things only those that would touch something are.

mod obstacle;
mod obstacles;
mod sign;
mod site;
mod stretch;

use nalgebra::Point3;
use opendrive::LaneId;
use random::Stream;
use schema::scene_info::HazardInfo;
use schema::tables::ActorRow;

pub(crate) use self::obstacle::Obstacle;
pub(crate) use self::obstacles::Obstacles;
use self::site::Site;
use self::stretch::Stretch;
use crate::input::SceneInput;
use crate::scene::free_space::Taken;

/// The objects in the hazards of a scene.
#[derive(Debug, Default)]
pub(crate) struct Hazards {
    pub(crate) things: Vec<Obstacle>,
    pub(crate) placed: Vec<HazardInfo>,
    /// Both ends of each.
    ends: Vec<(LaneId, Point3<f64>)>,
}

impl Hazards {
    /// Places the hazards of a scene among what is `taken`, and takes their places.
    pub(crate) fn place(input: &SceneInput<'_>, fixed: &[ActorRow], taken: &mut Taken) -> Self {
        let mut all = Self::default();
        for row in input.hazards {
            let Some(stretch) = Stretch::of(input.map, row) else { continue };
            let (settings, scene) = (&input.settings.hazards, input.scene);
            let stream =
                |topic| Stream::new(scene.seed, u64::from(scene.scene), topic, u64::from(row.hazard));
            let mut site = Site::new(
                stretch,
                stream("traffic/hazard"),
                settings.missing_cone_share,
                (taken, input.catalogue),
            );
            let Some(warning) = site.fill(row) else { continue };
            let sign = warning.and_then(|(way_m, sign)| {
                let at = site.stretch.pos(way_m)?;
                let mut draw = stream("traffic/hazard/sign");
                sign::before(input.map, at, sign, &mut draw, taken, fixed)
            });
            let Site { stretch, things, .. } = site;
            for thing in &things {
                let (at, yaw_rad, size_m) = thing.footprint();
                taken.insert(at, yaw_rad, size_m);
            }
            let things = things.into_iter().chain(sign);
            all.things.extend(things.map(|thing| thing.of_hazard(row.hazard)));
            let ends = [stretch.lanes.first().zip(stretch.at(0.0, 0.0))]
                .into_iter()
                .chain([stretch.lanes.last().zip(stretch.at(stretch.length_m, 0.0))]);
            all.ends.extend(ends.flatten().map(|((lane, _), place)| (*lane, place.position)));
            all.placed.push(HazardInfo { hazard: row.hazard, kind: row.kind, area_m: stretch.area() });
        }
        all
    }

    /// Whether a place is so near to an end of a hazard on its lane that nobody starts there.
    pub(crate) fn is_near_end(&self, lane: LaneId, at: &Point3<f64>, clearance_m: f64) -> bool {
        self.ends.iter().any(|(end, point)| {
            (end.road, end.lane) == (lane.road, lane.lane) && (point - at).norm() < clearance_m
        })
    }
}
