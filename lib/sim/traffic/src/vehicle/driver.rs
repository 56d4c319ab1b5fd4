//! Drivers: how fast and how close they drive, and what they overlook.

use catalogue::{BaseType, Model};
use random::Stream;
use settings::TrafficSettings;

use crate::car_following::Idm;
use crate::vehicle::attention::{Attention, Class, Sight};

/// Nobody stops nearer to a leader than this, metres.
const LEAST_GAP_M: f64 = 0.5;
/// Time gap that drivers keep, seconds: with the drawn standing gaps, queues of cars clear at some 1,600
/// vehicles per hour and lane.
const HEADWAY_S: f64 = 0.6;

/// What a driver is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DriverProfile {
    pub(crate) reckless: bool,
    pub(crate) distracted: bool,
    /// Speed below the limit as a share of it.
    pub(crate) speed_difference: f64,
    pub(crate) idm: Idm,
}

impl DriverProfile {
    pub(crate) fn new(
        model: &Model,
        reckless: bool,
        distracted: bool,
        speed_difference: f64,
        standstill_gap_m: f64,
    ) -> Self {
        let acceleration = match model.base {
            BaseType::Truck | BaseType::Bus => 1.3,
            BaseType::Bicycle => 1.2,
            _ => 2.5,
        };
        let idm = Idm {
            acceleration,
            braking: 2.5,
            headway_s: HEADWAY_S,
            standstill_gap_m: standstill_gap_m.max(LEAST_GAP_M),
        };
        Self { reckless, distracted, speed_difference, idm }
    }
}

/// A driver at the wheel.
#[derive(Debug)]
pub(crate) struct Driver {
    profile: DriverProfile,
    attention: Attention,
}

impl Driver {
    /// What it overlooks is drawn from a stream.
    pub(crate) fn new(profile: DriverProfile, settings: &TrafficSettings, stream: Stream) -> Self {
        let attention = Attention::new(settings, profile.reckless, profile.distracted, stream);
        Self { profile, attention }
    }

    pub(crate) fn profile(&self) -> &DriverProfile {
        &self.profile
    }

    pub(crate) fn idm(&self) -> Idm {
        self.profile.idm
    }

    /// Draws what it overlooks in a step.
    pub(super) fn perceive(&mut self, step: u32) {
        self.attention.perceive(step);
    }

    pub(crate) fn sight(&self, class: Class) -> Sight {
        self.attention.sight(class)
    }

    /// Whether it has overlooked a class of things for long.
    pub(crate) fn is_away(&self, class: Class) -> bool {
        self.attention.is_away(class)
    }

    /// Whether no line could hold it up.
    pub(crate) fn sees_no_lines(&self) -> bool {
        self.attention.sees_no_lines()
    }
}
