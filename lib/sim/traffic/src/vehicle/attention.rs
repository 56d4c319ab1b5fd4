//! What drivers overlook: in every step each of them draws anew whether it notices lights, signs, vehicles
//! and walkers.
//!
//! A driver who overlooks something for the blink of an eye drives on for that step as if it were not there;
//! but it sees what asks for harder braking than is comfortable, and passes no line without leave. So a blink
//! costs a speed of 0.3 m/s at most. A driver who has looked away for a whole second sees nothing of it any
//! more, until it looks again: no light, and it asks for leave to pass the line; no sign; no vehicle, and it
//! takes its way through junctions without asking for it; no walker. At one in a thousand steps nobody ever
//! looks away so long (a chance of 10^-60); at nine in ten every driver does at times; one who always
//! overlooks is a reckless driver, for what it overlooks: reckless drivers are those who overlook everything,
//! and distracted ones those who overlook all lights and signs.

use random::{Stream, unit_f32};
use settings::TrafficSettings;

/// So many steps on end are a second.
const AWAY_STEPS: u8 = 20;

/// Something to overlook.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    Lights,
    /// Signs and lines without lights; cones, barriers and all else that lies about in road works.
    Signs,
    Vehicles,
    Walkers,
}

impl Class {
    /// All of them, by their numbers.
    pub(crate) const ALL: [Self; 4] = [Self::Lights, Self::Signs, Self::Vehicles, Self::Walkers];
}

/// What a driver sees of a class of things in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sight {
    Sees,
    /// It overlooks them for the moment.
    Blinks,
    /// It has overlooked them for long.
    Away,
}

/// What one driver overlooks.
#[derive(Clone, Debug)]
pub(crate) struct Attention {
    /// Chances to overlook, of each class.
    shares: [f32; 4],
    stream: Stream,
    /// Steps on end for which each class has been overlooked, counted up to [`AWAY_STEPS`].
    overlooked: [u8; 4],
}

impl Attention {
    /// A driver's attention at the start, after a second of driving before it.
    pub(crate) fn new(settings: &TrafficSettings, reckless: bool, distracted: bool, stream: Stream) -> Self {
        let TrafficSettings { ignore_lights, ignore_signs, ignore_vehicles, ignore_walkers, .. } = *settings;
        let blind = [reckless || distracted, reckless || distracted, reckless, reckless];
        let shares = [ignore_lights, ignore_signs, ignore_vehicles, ignore_walkers];
        let share = |i: usize| if blind[i] { 1.0 } else { shares[i] as f32 };
        let mut new = Self { shares: [0, 1, 2, 3].map(share), stream, overlooked: [0; 4] };
        (0..u64::from(AWAY_STEPS)).for_each(|draw| new.draw(draw));
        new
    }

    fn draw(&mut self, draw: u64) {
        let words = self.stream.at(draw);
        for ((overlooked, share), word) in self.overlooked.iter_mut().zip(self.shares).zip(words) {
            *overlooked = if unit_f32(word) < share { (*overlooked + 1).min(AWAY_STEPS) } else { 0 };
        }
    }

    /// Draws for a step.
    pub(crate) fn perceive(&mut self, step: u32) {
        self.draw(u64::from(AWAY_STEPS) + u64::from(step));
    }

    pub(crate) fn sight(&self, class: Class) -> Sight {
        match self.overlooked[class as usize] {
            0 => Sight::Sees,
            AWAY_STEPS => Sight::Away,
            _ => Sight::Blinks,
        }
    }

    pub(crate) fn is_away(&self, class: Class) -> bool {
        self.sight(class) == Sight::Away
    }

    /// Whether no line could hold it up.
    pub(crate) fn sees_no_lines(&self) -> bool {
        [Class::Lights, Class::Signs, Class::Vehicles].into_iter().all(|class| self.is_away(class))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(share: f64) -> TrafficSettings {
        TrafficSettings {
            ignore_lights: share,
            ignore_signs: 0.0,
            ignore_vehicles: 1.0,
            ignore_walkers: 0.3,
            ..TrafficSettings::default()
        }
    }

    fn driver(settings: &TrafficSettings, entity: u64) -> Attention {
        Attention::new(settings, false, false, Stream::new(27, 3, "traffic/slip", entity))
    }

    /// Shares of 20,000 steps in which each class is overlooked, and lights and walkers for long.
    fn shares(mut driver: Attention) -> ([f64; 4], [f64; 2]) {
        let mut counts = ([0u32; 4], [0u32; 2]);
        for step in 0..20_000 {
            driver.perceive(step);
            for (count, class) in counts.0.iter_mut().zip(Class::ALL) {
                *count += u32::from(driver.sight(class) != Sight::Sees);
            }
            for (count, class) in counts.1.iter_mut().zip([Class::Lights, Class::Walkers]) {
                *count += u32::from(driver.is_away(class));
            }
        }
        let share = |n: u32| f64::from(n) / 20_000.0;
        (counts.0.map(share), counts.1.map(share))
    }

    #[test]
    fn things_are_overlooked_as_often_as_the_shares_say() {
        let (seen, away) = shares(driver(&settings(0.02), 1));
        // Four standard deviations of 20,000 draws.
        assert!((seen[0] - 0.02).abs() < 0.004 && (seen[3] - 0.3).abs() < 0.013, "{seen:?}");
        assert_eq!((seen[1], seen[2], away), (0.0, 1.0, [0.0; 2]));
        // Looking away for a second is 0.95^20 = 0.358 of the steps; runs of twenty make it vary more.
        let (_, away) = shares(driver(&settings(0.95), 1));
        assert!((away[0] - 0.358).abs() < 0.07, "{away:?}");
        // Drivers draw by themselves.
        let steps = |entity| {
            let mut driver = driver(&settings(0.5), entity);
            (0..50)
                .map(move |step| (driver.perceive(step), driver.sight(Class::Lights)).1)
                .collect::<Vec<_>>()
        };
        assert_eq!(steps(1), steps(1));
        assert_ne!(steps(1), steps(2));
    }

    #[test]
    fn who_always_overlooks_does_so_from_the_first_step_on() {
        let stream = || Stream::new(27, 3, "traffic/slip", 0);
        let none = TrafficSettings { ignore_vehicles: 0.0, ignore_walkers: 0.0, ..settings(0.0) };
        let sights = |reckless: bool, distracted: bool| {
            let mut driver = Attention::new(&none, reckless, distracted, stream());
            driver.perceive(0);
            Class::ALL.map(|class| driver.sight(class))
        };
        assert_eq!(sights(false, false), [Sight::Sees; 4]);
        assert_eq!(sights(true, false), [Sight::Away; 4]);
        assert_eq!(sights(false, true), [Sight::Away, Sight::Away, Sight::Sees, Sight::Sees]);
        assert!(driver(&settings(0.0), 0).is_away(Class::Vehicles));
    }
}
