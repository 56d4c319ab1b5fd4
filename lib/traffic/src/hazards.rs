//! Accidents and road works: what stands in a planned hazard for the whole scene.
//!
//! A hazard whose vehicles do not fit (an agent starts there, or another hazard lies there) is left out whole; of the
//! other things only those that would touch something are.

use frames::math::sin_cos;
use frames::{Object, Pose, World};
use nalgebra::{Point3, Vector3};
use opendrive::{LaneId, LanePoint, LanePos, Map};
use random::Stream;
use schema::fleet;
use schema::models::{self, BaseType, Model};
use schema::scene_info::HazardInfo;
use schema::tables::{ActorRow, PlanHazardRow};
use schema::{ObjectId, Tag};

use crate::SceneInput;
use crate::log::attributes;
use crate::spawn::{Footprint, Taken, apart, tags};

/// A hazard's front is looked for this far ahead of its back, metres of way.
const LONGEST_M: f64 = 400.0;
/// Corners of a hazard's area follow the lane at this distance, metres.
const AREA_STEP_M: f64 = 0.4;
/// Cones stand this share of the lane's width to either side of its middle, and are off by up to so much, metres.
const CONE_ASIDE: f64 = 0.42;
const CONE_JITTER_M: f64 = 0.2;
/// The lone cone behind an accident is off by up to so much, metres.
const LONE_CONE_JITTER_M: f64 = 1.0;
/// From the middle of an emergency vehicle's place to where it stands, metres backwards.
const EMERGENCY_BACK_M: f64 = 1.0;
/// Walkers at an accident are off the gaps between vehicles by up to so much, things of road works off the lane's middle,
/// metres.
const WALKER_JITTER_M: f64 = 0.6;
const ITEM_JITTER_M: f64 = 0.4;
/// From the first barrier of road works to the first item, metres.
const FIRST_ITEM_M: f64 = 2.0;
/// Way to the next item after a small one, and after a large one or a worker, metres, before they are fitted to the length.
const SMALL_STEP_M: [f64; 2] = [0.4, 1.6];
const LARGE_STEP_M: [f64; 2] = [1.6, 3.2];
/// What lies about in road works: of so many, so many are small, large, workers.
const DRAWN: usize = 26;
const DRAWN_SMALL: usize = 19;
const DRAWN_LARGE: usize = 6;
/// Every so many things have a cone on either side.
const CONE_EVERY: usize = 4;
/// Clothes of workers, and of others (sRGB).
const WORK_CLOTHES: [u8; 3] = [235, 110, 20];
const CLOTHES: [[u8; 3]; 4] = [[40, 44, 52], [120, 30, 34], [66, 92, 60], [170, 160, 140]];

/// Name of the mesh, length, width, height in metres, colour (sRGB).
type Item = (&'static str, [f64; 3], [u8; 3]);
const SMALL: [Item; 5] = [
    ("prop.sandbag", [0.62, 0.40, 0.18], [150, 130, 95]),
    ("prop.pallet", [1.20, 0.80, 0.15], [150, 115, 70]),
    ("prop.toolbox", [0.55, 0.28, 0.30], [170, 30, 26]),
    ("prop.bucket", [0.34, 0.34, 0.36], [40, 40, 44]),
    ("prop.barrel", [0.60, 0.60, 0.90], [220, 90, 20]),
];
const LARGE: [Item; 2] =
    [("prop.pipe", [2.00, 0.60, 0.60], [140, 140, 138]), ("prop.pile", [1.70, 1.40, 0.70], [96, 74, 50])];

/// Something that stands in a hazard.
#[derive(Clone, Debug)]
pub(crate) struct Thing {
    hazard: u32,
    kind: &'static str,
    model: &'static str,
    tags: Vec<u8>,
    pub(crate) size_m: [f64; 3],
    color: [u8; 3],
    pub(crate) point: Point3<f64>,
    rpy_rad: [f64; 3],
    facts: [(&'static str, &'static str); 2],
    /// Whether a car that hits it is stopped by it.
    pub(crate) solid: bool,
}

/// What stands in the hazards of a scene.
#[derive(Debug, Default)]
pub(crate) struct Hazards {
    pub(crate) things: Vec<Thing>,
    pub(crate) placed: Vec<HazardInfo>,
    /// Both ends of each.
    ends: Vec<(LaneId, Point3<f64>)>,
}

impl Thing {
    fn of_model(kind: &'static str, model: &'static Model, color: [u8; 3], at: &Spot) -> Self {
        Self {
            hazard: 0,
            kind,
            model: model.name,
            tags: tags(model.base),
            size_m: model.size_m,
            color,
            point: at.point,
            rpy_rad: at.rpy_rad,
            facts: [("base_type", model.base.name()), ("special_type", model.special)],
            solid: model.base != BaseType::Cone,
        }
    }

    fn item((model, size_m, color): Item, at: &Spot) -> Self {
        Self {
            hazard: 0,
            kind: "prop",
            model,
            tags: vec![Tag::Static as u8],
            size_m,
            color,
            point: at.point,
            rpy_rad: at.rpy_rad,
            facts: [("base_type", "prop"), ("special_type", "")],
            solid: true,
        }
    }

    pub(crate) fn yaw_rad(&self) -> f64 {
        self.rpy_rad[2]
    }

    fn footprint(&self) -> Footprint {
        (self.point, self.yaw_rad(), self.size_m)
    }

    pub(crate) fn actor(&self, id: ObjectId) -> ActorRow {
        let pose = Pose::<World, Object>::from_xyz_rpy(self.point.into(), self.rpy_rad);
        let hazard = self.hazard.to_string();
        let [base, special] = self.facts;
        ActorRow {
            id,
            kind: self.kind.into(),
            model: self.model.into(),
            role: "hazard".into(),
            semantic_tags: self.tags.clone(),
            length_m: self.size_m[0],
            width_m: self.size_m[1],
            height_m: self.size_m[2],
            color: self.color.to_vec(),
            fixed: true,
            xyz_m: pose.xyz(),
            quaternion: pose.wxyz(),
            attributes: attributes(&[base, special, ("hazard", &hazard)]),
            ..ActorRow::default()
        }
    }
}

/// A place to stand.
struct Spot {
    point: Point3<f64>,
    rpy_rad: [f64; 3],
}

impl Spot {
    /// On a lane, turned and pushed aside, level with the road as far as that is flat.
    fn new(place: &LanePoint, turn_rad: f64, push_m: [f64; 2]) -> Self {
        let (sin, cos) = sin_cos(turn_rad);
        let pitch = place.pitch_rad * cos - place.roll_rad * sin;
        let roll = place.roll_rad * cos + place.pitch_rad * sin;
        Self {
            point: place.position + Vector3::new(push_m[0], push_m[1], 0.0),
            rpy_rad: [roll, pitch, frames::wrap_pi(place.heading_rad + turn_rad)],
        }
    }
}

/// A length of lane from a hazard's back to its front.
struct Stretch<'a> {
    map: &'a Map,
    /// Lanes with the metres of s from the back to their beginning (the first one's is negative).
    lanes: Vec<(LaneId, f64)>,
    /// Metres of s.
    length_m: f64,
}

impl<'a> Stretch<'a> {
    /// None where the map has no such lanes, or no way leads from the back to the front.
    fn of(map: &'a Map, row: &PlanHazardRow) -> Option<Self> {
        let from = lane_pos(map, &row.back_road, row.back_lane, row.back_s_m)?;
        let to = lane_pos(map, &row.front_road, row.front_lane, row.front_s_m)?;
        let way = map.route(from, to, LONGEST_M)?;
        let mut start_m = -from.along_m;
        let mut lanes = Vec::with_capacity(way.lanes.len());
        for id in way.lanes {
            lanes.push((id, start_m));
            start_m += map.lane(id)?.s_length();
        }
        let length_m = lanes.last()?.1 + to.along_m;
        Some(Self { map, lanes, length_m })
    }

    /// The place so many metres of s from the back, on the stretch, to the left of the lane's middle by a share of its width.
    fn at(&self, way_m: f64, left: f64) -> Option<LanePoint> {
        let way_m = way_m.clamp(0.0, self.length_m);
        let (lane, start_m) = *self.lanes.iter().rev().find(|(_, start_m)| *start_m <= way_m)?;
        let s = self.map.s_of(LanePos { lane, along_m: way_m - start_m })?;
        self.map.lane_point(lane, s, left * self.map.lane_width(lane, s)?)
    }

    /// The lane's surface from back to front: the left border onward, the right one back.
    fn area(&self) -> Vec<[f64; 3]> {
        let steps = (self.length_m / AREA_STEP_M).ceil().max(1.0) as usize;
        let side = |left: f64| {
            let points = (0..=steps).map(move |k| self.at(self.length_m * k as f64 / steps as f64, left));
            points.flatten().map(|place| place.position.into()).collect::<Vec<[f64; 3]>>()
        };
        let mut area = side(0.5);
        area.extend(side(-0.5).into_iter().rev());
        area
    }
}

/// A place of the map by the names of a plan.
fn lane_pos(map: &Map, road: &str, lane: i32, s_m: f64) -> Option<LanePos> {
    let road = map.network().roads.iter().position(|r| r.id == road)? as u32;
    let lanes = map.lanes().iter().filter(|l| l.id.road == road && i32::from(l.id.lane) == lane);
    let info = lanes.min_by(|a, b| {
        let off = |l: &opendrive::LaneInfo| (l.s_start - s_m).max(s_m - l.s_end).max(0.0);
        off(a).total_cmp(&off(b))
    })?;
    Some(LanePos { lane: info.id, along_m: info.along_of_s(s_m.clamp(info.s_start, info.s_end)) })
}

impl Hazards {
    /// Places the hazards of a scene among what is `taken`, and takes their places.
    pub(crate) fn place(input: &SceneInput<'_>, taken: &mut Taken) -> Self {
        let mut all = Self::default();
        for row in input.hazards {
            let Some(stretch) = Stretch::of(input.map, row) else { continue };
            let mut site = Site {
                draw: Stream::new(
                    input.scene.seed,
                    u64::from(input.scene.scene),
                    "traffic/hazard",
                    row.hazard.into(),
                ),
                missing_cones: input.settings.hazards.missing_cone_share,
                stretch,
                things: Vec::new(),
                taken: &*taken,
            };
            let fits = if row.kind == "accident" { site.accident(row) } else { site.road_works(row) };
            if fits.is_none() {
                continue;
            }
            let Site { stretch, things, .. } = site;
            for thing in things.iter().filter(|t| t.solid) {
                let (at, yaw_rad, size_m) = thing.footprint();
                taken.insert(at, yaw_rad, size_m);
            }
            all.things.extend(things.into_iter().map(|thing| Thing { hazard: row.hazard, ..thing }));
            let ends = [stretch.lanes.first().zip(stretch.at(0.0, 0.0))]
                .into_iter()
                .chain([stretch.lanes.last().zip(stretch.at(stretch.length_m, 0.0))]);
            all.ends.extend(ends.flatten().map(|((lane, _), place)| (*lane, place.position)));
            all.placed.push(HazardInfo {
                hazard: row.hazard,
                kind: row.kind.clone(),
                area_m: stretch.area(),
            });
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

/// A hazard that is being set up.
struct Site<'m, 't> {
    stretch: Stretch<'m>,
    draw: Stream,
    missing_cones: f64,
    things: Vec<Thing>,
    taken: &'t Taken,
}

impl Site<'_, '_> {
    fn push_m(&mut self, jitter_m: f64) -> [f64; 2] {
        [self.draw.uniform(-jitter_m, jitter_m), self.draw.uniform(-jitter_m, jitter_m)]
    }

    /// Adds a thing; `None` where it would touch another one.
    fn add(&mut self, thing: Thing) -> Option<()> {
        let (at, yaw_rad, size_m) = thing.footprint();
        let free = self.taken.is_free(&at, yaw_rad, size_m)
            && self.things.iter().all(|other| {
                let (one, other) = (thing.footprint(), other.footprint());
                apart(&one, &other, 0.0) || apart(&other, &one, 0.0)
            });
        free.then(|| self.things.push(thing))
    }

    /// Front vehicle, rear vehicle, perhaps an emergency vehicle; people in the gaps between them; cones beside.
    fn accident(&mut self, row: &PlanHazardRow) -> Option<()> {
        let models: Vec<&'static Model> = row.models.iter().filter_map(|name| models::find(name)).collect();
        let [front, rear, others @ ..] = models.as_slice() else { return None };
        let meet_m = self.stretch.length_m - front.base.stretch_m();
        let [front_m, rear_m] = [meet_m + 0.5 * front.base.stretch_m(), meet_m - 0.5 * rear.base.stretch_m()];
        self.vehicle(front, front_m)?;
        self.vehicle(rear, rear_m)?;
        let mut gaps_m = vec![self.stretch.length_m, meet_m];
        match others.first() {
            Some(emergency) => {
                self.vehicle(emergency, 0.5 * emergency.base.stretch_m() - EMERGENCY_BACK_M)?;
                gaps_m.push(meet_m - rear.base.stretch_m());
            }
            None => {
                let push_m = self.push_m(LONE_CONE_JITTER_M);
                self.cone(0.0, 0.0, push_m);
            }
        }
        for way_m in gaps_m {
            self.people(way_m);
        }
        self.side_cones(front_m);
        self.side_cones(rear_m);
        Some(())
    }

    fn vehicle(&mut self, model: &'static Model, way_m: f64) -> Option<()> {
        let most: f64 = match model.base {
            BaseType::Motorcycle | BaseType::Bicycle => 90.0,
            BaseType::Truck | BaseType::Van | BaseType::Bus => 10.0,
            _ => 30.0,
        };
        let turn_rad = self.draw.uniform(-most, most).to_radians();
        let color = self.draw.choose(fleet::paints(model)).copied()?;
        let spot = Spot::new(&self.stretch.at(way_m, 0.0)?, turn_rad, [0.0; 2]);
        self.add(Thing::of_model("vehicle", model, color, &spot))
    }

    /// None to three people who stand about.
    fn people(&mut self, way_m: f64) {
        let Some(place) = self.stretch.at(way_m, 0.0) else { return };
        let catalogue: Vec<&'static Model> = models::walkers().collect();
        for _ in 0..self.draw.int_inclusive(1, 3) {
            let push_m = self.push_m(WALKER_JITTER_M);
            let turn_rad = self.draw.uniform(-std::f64::consts::PI, std::f64::consts::PI);
            let (model, color) = (self.draw.choose(&catalogue).copied(), self.draw.choose(&CLOTHES).copied());
            let comes = self.draw.chance(0.5);
            if let (Some(model), Some(color), true) = (model, color, comes) {
                self.add(Thing::of_model("walker", model, color, &Spot::new(&place, turn_rad, push_m)));
            }
        }
    }

    /// A cone on either side of the lane, unless it is missing.
    fn side_cones(&mut self, way_m: f64) {
        for left in [CONE_ASIDE, -CONE_ASIDE] {
            let push_m = self.push_m(CONE_JITTER_M);
            if !self.draw.chance(self.missing_cones) {
                self.cone(way_m, left, push_m);
            }
        }
    }

    fn cone(&mut self, way_m: f64, left: f64, push_m: [f64; 2]) {
        if let (Some(model), Some(place)) = (models::find("prop.cone"), self.stretch.at(way_m, left)) {
            let spot = Spot::new(&place, std::f64::consts::FRAC_PI_2, push_m);
            self.add(Thing::of_model("prop", model, [215, 85, 10], &spot));
        }
    }

    /// Barriers at both ends, things and workers between them, cones beside.
    fn road_works(&mut self, row: &PlanHazardRow) -> Option<()> {
        let items = row.items as usize;
        let drawn: Vec<usize> = (0..items).filter_map(|_| self.draw.index(DRAWN)).collect();
        let steps_m: Vec<f64> = drawn
            .iter()
            .map(|&k| {
                let [low, high] = if k < DRAWN_SMALL { SMALL_STEP_M } else { LARGE_STEP_M };
                self.draw.uniform(low, high)
            })
            .collect();
        // The plan says how far the last barrier is; the steps share that way among them.
        let room_m = (self.stretch.length_m - FIRST_ITEM_M).max(0.0);
        let scale = room_m / steps_m.iter().sum::<f64>().max(1e-9);
        self.barrier(0.0);
        self.barrier(self.stretch.length_m);
        let mut way_m = FIRST_ITEM_M;
        for (i, (k, step_m)) in drawn.into_iter().zip(steps_m).enumerate() {
            self.item(k, way_m);
            if i % CONE_EVERY == 0 {
                self.side_cones(way_m);
            }
            way_m += step_m * scale;
        }
        (!self.things.is_empty()).then_some(())
    }

    fn any_spot(&mut self, way_m: f64) -> Option<Spot> {
        let push_m = self.push_m(ITEM_JITTER_M);
        let turn_rad = self.draw.uniform(-std::f64::consts::PI, std::f64::consts::PI);
        Some(Spot::new(&self.stretch.at(way_m, 0.0)?, turn_rad, push_m))
    }

    fn barrier(&mut self, way_m: f64) {
        if let (Some(model), Some(spot)) = (models::find("prop.barrier"), self.any_spot(way_m)) {
            self.add(Thing::of_model("prop", model, [190, 40, 25], &spot));
        }
    }

    fn item(&mut self, drawn: usize, way_m: f64) {
        let Some(spot) = self.any_spot(way_m) else { return };
        let thing = if drawn < DRAWN_SMALL {
            self.draw.choose(&SMALL).map(|item| Thing::item(*item, &spot))
        } else if drawn < DRAWN_SMALL + DRAWN_LARGE {
            self.draw.choose(&LARGE).map(|item| Thing::item(*item, &spot))
        } else {
            let catalogue: Vec<&'static Model> =
                models::walkers().filter(|m| m.name != "walker.child").collect();
            let model = self.draw.choose(&catalogue);
            model.map(|model| Thing::of_model("walker", model, WORK_CLOTHES, &spot))
        };
        if let Some(thing) = thing {
            self.add(thing);
        }
    }
}
