//! Activation: background vehicles and walkers far from every data-collection vehicle are not simulated. They
//! stand where they are, obstacles to all others, until one comes nearer.
//!
//! A vehicle comes to rest before it sleeps, as the one behind may follow closely, and not just anywhere:
//! outside junctions and shared bends, done with changing lanes, and with nobody on the way to it who has
//! leave to cross the junction behind it. So a sleeper holds no reservation that others would wait for, and
//! keeps no vehicle in a junction: one that comes to the next line while it looks for its place asks for no
//! reservation and stops there. To others it is one who stands. Walkers do not sleep on the road.

use nalgebra::Point3;

use crate::bends::Bends;
use crate::bodies::Bodies;
use crate::junction::exits::is_counted_on;
use crate::junction::reservations::ReservationTable;
use crate::road::net::Net;
use crate::vehicle::Vehicle;
use crate::vehicle::activity::Activity;
use crate::walking::walker::Walker;

/// Distances are looked at every so many steps (1 s).
const EVERY_STEPS: u32 = 20;

/// Where the agents are that the others sleep far from.
#[derive(Debug)]
pub(crate) struct Activation {
    pub(crate) distance_m: f64,
    /// The first so many vehicles are agents, which never sleep.
    pub(crate) agents: usize,
    /// Where the agents on given trajectories are.
    pub(crate) given: Vec<Point3<f64>>,
}

impl Activation {
    /// Whether it is time to look.
    pub(crate) fn is_due(step: u32) -> bool {
        step.is_multiple_of(EVERY_STEPS)
    }

    fn agents(&self, vehicles: &[Vehicle]) -> Vec<Point3<f64>> {
        let driving = vehicles.iter().take(self.agents).map(|v| v.motion().position());
        driving.chain(self.given.iter().copied()).collect()
    }

    /// Whether a place is far from all agents; nobody is where there are none.
    fn is_far(&self, agents: &[Point3<f64>], at: &Point3<f64>) -> bool {
        let square = self.distance_m * self.distance_m;
        !agents.is_empty() && agents.iter().all(|agent| (agent - at).norm_squared() > square)
    }

    /// Lets vehicles fall asleep and wake up.
    pub(crate) fn update(
        &self,
        net: &Net,
        reservations: &ReservationTable,
        bends: &Bends,
        vehicles: &mut [Vehicle],
        bodies: &mut Bodies,
    ) {
        let agents = self.agents(vehicles);
        for (me, vehicle) in vehicles.iter_mut().enumerate().skip(self.agents) {
            let was_asleep = vehicle.wake() == Activity::Asleep;
            let wake = if vehicle.is_crashed() || !self.is_far(&agents, &vehicle.motion().position()) {
                Activity::Awake
            } else if was_asleep {
                Activity::Asleep
            } else if !vehicle.claim().is_empty()
                || vehicle.lateral().change().is_some()
                || bends.is_held_by(me)
                || is_counted_on(reservations, net, vehicle)
            {
                Activity::Drowsy
            } else if vehicle.speed_mps() > 0.0 {
                Activity::Halting
            } else {
                Activity::Asleep
            };
            vehicle.set_wake(wake);
            if wake == Activity::Asleep && !was_asleep {
                vehicle.bodies().for_each(|body| bodies.rest(body));
            }
        }
    }

    /// Lets walkers fall asleep and wake up.
    pub(crate) fn look_at_walkers(&self, vehicles: &[Vehicle], walkers: &mut [Walker], bodies: &mut Bodies) {
        let agents = self.agents(vehicles);
        for walker in walkers {
            let far = self.is_far(&agents, &walker.position());
            let slept = walker.is_asleep();
            walker.set_asleep(far && !walker.is_on_road() && !walker.is_struck());
            if walker.is_asleep() && !slept {
                bodies.rest(walker.body());
            }
        }
    }
}
