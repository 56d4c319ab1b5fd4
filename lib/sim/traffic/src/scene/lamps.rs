//! What traffic lights show: the map's signals to drivers, and to walkers whether those hold the traffic.

use opendrive::Map;
use schema::tables::{ActorRow, SignalRow};
use schema::{ActorKind, ObjectId, SignalState};

use crate::road::signals::Signals;
use crate::walking::gait::needed_s;

/// Lights give people who walk at this speed time to get across, m/s.
const WALKING_MPS: f64 = 1.2;

/// A traffic light.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Lamp {
    pub(crate) id: ObjectId,
    name: String,
    shows: Shows,
}

#[derive(Clone, Debug, PartialEq)]
enum Shows {
    /// The state of a signal of the map.
    Signal(usize),
    /// Green while these hold the traffic for so long, seconds.
    Walkers { signals: Vec<usize>, needed_s: f64 },
}

impl Lamp {
    /// The state at a time since the start of the simulation, for the log.
    pub(crate) fn row(&self, signals: &Signals, frame: i32, time_s: f64) -> SignalRow {
        let state = match &self.shows {
            Shows::Signal(signal) => signals.state(*signal, time_s),
            Shows::Walkers { signals: theirs, .. } if signals.are_off(theirs, time_s) => SignalState::Off,
            Shows::Walkers { signals: theirs, needed_s } if signals.hold(theirs, time_s, *needed_s) => {
                SignalState::Green
            }
            Shows::Walkers { .. } => SignalState::Red,
        };
        SignalRow { frame, id: self.id, state, opendrive_id: self.name.clone() }
    }
}

/// The traffic lights among fixed objects that belong to a signal or a crosswalk of the map.
pub(crate) fn lamps(map: &Map, fixed: &[ActorRow]) -> Vec<Lamp> {
    let lights = fixed.iter().filter(|a| a.kind == ActorKind::TrafficLight);
    let lamp = |actor: &ActorRow| {
        let name = actor.opendrive_id.as_deref()?;
        let signal = map.signals().iter().position(|s| s.dynamic && s.id == name).map(Shows::Signal);
        let shows = signal.or_else(|| of_crosswalk(map, name))?;
        Some(Lamp { id: actor.id, name: name.to_owned(), shows })
    };
    let mut found: Vec<Lamp> = lights.filter_map(lamp).collect();
    found.sort_by_key(|lamp| lamp.id);
    found
}

fn of_crosswalk(map: &Map, name: &str) -> Option<Shows> {
    let number = map.crosswalks().iter().position(|crosswalk| crosswalk.light_name() == name)?;
    let [from, to] = map.crosswalks()[number].axis()?.ends;
    let needed_s = needed_s((to - from).norm(), WALKING_MPS);
    Some(Shows::Walkers { signals: map.crosswalk_signals(number), needed_s })
}

#[cfg(test)]
mod tests {
    use super::*;
    use settings::TrafficSettings;

    #[test]
    fn walkers_have_green_while_all_who_would_hit_them_are_held() {
        let map = Map::new(town::generate(&town::named("convoy/demo").expect("ours")).expect("roads"));
        let signals = Signals::new(&map, &TrafficSettings::default(), 7, 3);
        let held = (0..map.crosswalks().len()).filter(|k| !map.crosswalk_signals(*k).is_empty());
        let (mut crosswalks, mut green, mut red) = (0, 0, 0);
        for (number, id) in held.zip(1..) {
            let crosswalk = &map.crosswalks()[number];
            let light = ActorRow {
                id,
                kind: ActorKind::TrafficLight,
                opendrive_id: Some(crosswalk.light_name()),
                ..ActorRow::default()
            };
            let [lamp] = lamps(&map, &[light]).try_into().expect("one");
            crosswalks += 1;
            for tenths in 0..1200 {
                let time_s = 0.1 * f64::from(tenths);
                let row = lamp.row(&signals, 0, time_s);
                assert_eq!((row.id, &row.opendrive_id), (id, &crosswalk.light_name()));
                let drive = map.crosswalk_signals(number);
                let go = |later_s: f64| {
                    drive.iter().any(|s| signals.state(*s, time_s + later_s) != SignalState::Red)
                };
                match row.state {
                    SignalState::Green => {
                        green += 1;
                        assert!(!go(0.0) && (go(-2.0) || !go(4.0)), "{number} at {time_s} s");
                    }
                    SignalState::Red => red += 1,
                    other => panic!("{other:?}"),
                }
            }
        }
        assert!(crosswalks > 8 && green > 0 && red > green / 4, "{crosswalks}: {green} {red}");
        assert!(lamps(&map, &[ActorRow { kind: ActorKind::TrafficLight, ..ActorRow::default() }]).is_empty());
    }
}
