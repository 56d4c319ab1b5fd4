//! Setting up one hazard.

use catalogue::{
    BaseType, Catalogue, Model, cars, people, roadside,
    works::{self, Item},
};
use random::Stream;
use schema::tables::PlanHazardRow;
use schema::{ActorKind, HazardKind};

use super::obstacle::{Obstacle, Spot};
use super::stretch::Stretch;
use crate::scene::free_space::{Taken, apart};
use crate::vehicle::doors;

/// Cones stand this share of the lane's width to either side of its middle, and are off by up to so much,
/// metres.
const CONE_ASIDE: f64 = 0.42;
const CONE_JITTER_M: f64 = 0.2;
/// The lone cone behind an accident is off by up to so much, metres.
const LONE_CONE_JITTER_M: f64 = 1.0;
/// From the middle of an emergency vehicle's place to where it stands, metres backwards.
const EMERGENCY_BACK_M: f64 = 1.0;
/// Walkers at an accident are off the gaps between vehicles by up to so much, things of road works off the
/// lane's middle, metres.
const WALKER_JITTER_M: f64 = 0.6;
const ITEM_JITTER_M: f64 = 0.4;
/// From the first barrier of road works to the first item, metres.
const FIRST_ITEM_M: f64 = 2.0;
/// Centreline to the next item after a small one, and after a large one or a worker, metres, before they are
/// fitted to the length.
const SMALL_STEP_M: [f64; 2] = [0.4, 1.6];
const LARGE_STEP_M: [f64; 2] = [1.6, 3.2];
/// What comes next in road works, all equally likely: small things, large things, a worker.
const DRAWN: usize = works::SMALL.len() + works::LARGE.len() + 1;
/// Every so many things have a cone on either side.
const CONE_EVERY: usize = 4;
/// A hazard has one kind of cone, and of barrier.
const ACCIDENT_CONES: [&str; 2] = ["cone.construction", "cone.small"];
const WORKS_CONES: [&str; 6] =
    ["cone.traffic", "cone.plain", "barrier.concrete", "cone.big", "cone.barrel", "cone.skinny"];
const BARRIERS: [&str; 3] = ["barrier.street", "barrier.concrete", "barrier.wooden"];
/// Colours of cones and workers, of barriers, and clothes of others (sRGB).
const ORANGE: [u8; 3] = [235, 110, 20];
const RED: [u8; 3] = [190, 40, 25];
const CONCRETE: [u8; 3] = [170, 168, 164];
const CLOTHES: [[u8; 3]; 4] = [[40, 44, 52], [120, 30, 34], [66, 92, 60], [170, 160, 140]];

/// Centreline on the stretch from which the distance of a sign counts, and the sign.
pub(super) type Warning = (f64, Item);

/// A hazard that is being set up.
pub(super) struct Site<'m, 't> {
    pub(super) stretch: Stretch<'m>,
    draw: Stream,
    missing_cones: f64,
    pub(super) things: Vec<Obstacle>,
    taken: &'t Taken,
    catalogue: &'t Catalogue,
}

impl<'m, 't> Site<'m, 't> {
    /// Among what is `taken`, with the models that there are.
    pub(super) fn new(
        stretch: Stretch<'m>,
        draw: Stream,
        missing_cones: f64,
        (taken, catalogue): (&'t Taken, &'t Catalogue),
    ) -> Self {
        Self { stretch, draw, missing_cones, things: Vec::new(), taken, catalogue }
    }

    /// Puts everything in its place. None where the hazard does not fit; else the sign that warns of it, if
    /// one does, and the way on the stretch from which its distance counts.
    pub(super) fn fill(&mut self, row: &PlanHazardRow) -> Option<Option<Warning>> {
        match row.kind {
            HazardKind::Accident => self.accident(row),
            HazardKind::RoadWorks => self.road_works(row),
        }
    }

    fn push_m(&mut self, jitter_m: f64) -> [f64; 2] {
        [self.draw.uniform(-jitter_m, jitter_m), self.draw.uniform(-jitter_m, jitter_m)]
    }

    /// Adds a thing; `None` where it would touch another one.
    fn add(&mut self, thing: Obstacle) -> Option<()> {
        let (at, yaw_rad, size_m) = thing.footprint();
        let free = self.taken.is_free(&at, yaw_rad, size_m)
            && self.things.iter().all(|other| {
                let (one, other) = (thing.footprint(), other.footprint());
                apart(&one, &other, 0.0) || apart(&other, &one, 0.0)
            });
        free.then(|| self.things.push(thing))
    }

    /// Front vehicle, rear vehicle, perhaps an emergency vehicle; people in the gaps between them; cones
    /// beside.
    fn accident(&mut self, row: &PlanHazardRow) -> Option<Option<Warning>> {
        let models: Vec<&'static Model> =
            row.models.iter().filter_map(|name| self.catalogue.find(name)).collect();
        let [front, rear, others @ ..] = models.as_slice() else { return None };
        let emergency = others.first().copied();
        let meet_m = self.stretch.length_m - front.base.stretch_m();
        let [front_m, rear_m] = [meet_m + 0.5 * front.base.stretch_m(), meet_m - 0.5 * rear.base.stretch_m()];
        let cone = self.drawn(&ACCIDENT_CONES, BaseType::Cone)?;
        self.vehicle(front, front_m)?;
        self.vehicle(rear, rear_m)?;
        let mut gaps_m = vec![self.stretch.length_m, meet_m];
        match emergency {
            Some(emergency) => {
                self.vehicle(emergency, 0.5 * emergency.base.stretch_m() - EMERGENCY_BACK_M)?;
                gaps_m.push(meet_m - rear.base.stretch_m());
            }
            None => {
                let push_m = self.push_m(LONE_CONE_JITTER_M);
                self.cone(cone, 0.0, 0.0, push_m);
            }
        }
        // Police stand about where they came by car.
        let mut people = self.catalogue.walkers();
        if emergency.is_some_and(|m| m.name == cars::POLICE.name) {
            people.push((&people::POLICE, 1.0));
        }
        for way_m in gaps_m {
            self.people(&people, way_m);
        }
        self.side_cones(cone, front_m);
        self.side_cones(cone, rear_m);
        Some(emergency.map(|_| (meet_m, works::ACCIDENT_SIGN)))
    }

    /// Some cone or barrier: all alike but those of packs, which are as common as these say.
    fn drawn(&mut self, names: &[&'static str], base: BaseType) -> Option<&'static str> {
        let added = self.catalogue.added_of(base).into_iter().map(|(model, weight)| (model.name, weight));
        let all: Vec<(&str, f64)> = names.iter().map(|name| (*name, 1.0)).chain(added).collect();
        self.draw.choose_common(&all)
    }

    fn vehicle(&mut self, model: &'static Model, way_m: f64) -> Option<()> {
        let most: f64 = match model.base {
            BaseType::Motorcycle | BaseType::Bicycle => 90.0,
            BaseType::Truck | BaseType::Van | BaseType::Bus => 10.0,
            _ => 30.0,
        };
        let turn_rad = self.draw.uniform(-most, most).to_radians();
        let color = self.draw.choose(model.paints).copied()?;
        let doors = doors::left_open(model, &mut self.draw);
        let spot = Spot::new(&self.stretch.at(way_m, 0.0)?, turn_rad, [0.0; 2]);
        self.add(Obstacle::vehicle(model, color, doors, &spot))
    }

    /// None to three people who stand about.
    fn people(&mut self, catalogue: &[(&'static Model, f64)], way_m: f64) {
        let Some(place) = self.stretch.at(way_m, 0.0) else { return };
        for _ in 0..self.draw.int_inclusive(1, 3) {
            let push_m = self.push_m(WALKER_JITTER_M);
            let turn_rad = self.draw.uniform(-std::f64::consts::PI, std::f64::consts::PI);
            let (model, color) = (self.draw.choose_common(catalogue), self.draw.choose(&CLOTHES).copied());
            let comes = self.draw.chance(0.5);
            if let (Some(model), Some(color), true) = (model, color, comes) {
                self.add(Obstacle::of_model(
                    ActorKind::Walker,
                    model,
                    color,
                    &Spot::new(&place, turn_rad, push_m),
                ));
            }
        }
    }

    /// A cone on either side of the lane, unless it is missing.
    fn side_cones(&mut self, cone: &'static str, way_m: f64) {
        for left in [CONE_ASIDE, -CONE_ASIDE] {
            let push_m = self.push_m(CONE_JITTER_M);
            if !self.draw.chance(self.missing_cones) {
                self.cone(cone, way_m, left, push_m);
            }
        }
    }

    fn cone(&mut self, name: &'static str, way_m: f64, left: f64, push_m: [f64; 2]) {
        if let (Some(model), Some(place)) = (self.catalogue.find(name), self.stretch.at(way_m, left)) {
            // Barriers in place of cones lie along the lane.
            let lies = model.base == BaseType::Barrier;
            let turn_rad = if lies { 0.0 } else { std::f64::consts::FRAC_PI_2 };
            let color = if lies { CONCRETE } else { ORANGE };
            self.add(Obstacle::of_model(ActorKind::Prop, model, color, &Spot::new(&place, turn_rad, push_m)));
        }
    }

    /// Barriers at both ends, things and workers between them, cones beside.
    fn road_works(&mut self, row: &PlanHazardRow) -> Option<Option<Warning>> {
        let items = row.items as usize;
        let drawn: Vec<usize> = (0..items).filter_map(|_| self.draw.index(DRAWN)).collect();
        let steps_m: Vec<f64> = drawn
            .iter()
            .map(|&k| {
                let [low, high] = if k < works::SMALL.len() { SMALL_STEP_M } else { LARGE_STEP_M };
                self.draw.uniform(low, high)
            })
            .collect();
        // The plan says how far the last barrier is; the steps share that way among them.
        let room_m = (self.stretch.length_m - FIRST_ITEM_M).max(0.0);
        let scale = room_m / steps_m.iter().sum::<f64>().max(1e-9);
        let barrier = self.drawn(&BARRIERS, BaseType::Barrier)?;
        let cone = self.drawn(&WORKS_CONES, BaseType::Cone)?;
        self.model(barrier, 0.0);
        self.model(barrier, self.stretch.length_m);
        let mut way_m = FIRST_ITEM_M;
        for (i, (k, step_m)) in drawn.into_iter().zip(steps_m).enumerate() {
            self.item(k, way_m);
            if i % CONE_EVERY == 0 {
                self.side_cones(cone, way_m);
            }
            way_m += step_m * scale;
        }
        let sign = if self.draw.chance(0.5) { works::WORKS_SIGN } else { works::DANGER_SIGN };
        (!self.things.is_empty()).then_some(Some((0.0, sign)))
    }

    fn any_spot(&mut self, way_m: f64) -> Option<Spot> {
        let push_m = self.push_m(ITEM_JITTER_M);
        let turn_rad = self.draw.uniform(-std::f64::consts::PI, std::f64::consts::PI);
        Some(Spot::new(&self.stretch.at(way_m, 0.0)?, turn_rad, push_m))
    }

    /// A barrier or a worker, turned anyhow.
    fn model(&mut self, name: &str, way_m: f64) {
        if let (Some(model), Some(spot)) = (self.catalogue.find(name), self.any_spot(way_m)) {
            let (kind, color) = match model.base {
                BaseType::Pedestrian => (ActorKind::Walker, ORANGE),
                _ => (ActorKind::Prop, if name == roadside::CONCRETE.name { CONCRETE } else { RED }),
            };
            self.add(Obstacle::of_model(kind, model, color, &spot));
        }
    }

    fn item(&mut self, drawn: usize, way_m: f64) {
        let item = works::SMALL.iter().chain(&works::LARGE).nth(drawn);
        match item {
            Some(&(name, _)) if self.catalogue.find(name).is_some() => self.model(name, way_m),
            Some(&item) => {
                if let Some(spot) = self.any_spot(way_m) {
                    self.add(Obstacle::item(item, &spot));
                }
            }
            None => self.model(people::WORKER.name, way_m),
        }
    }
}
