//! Traffic lights: controllers of a junction take turns.

use std::collections::BTreeSet;

use opendrive::Map;
use random::Stream;
use schema::SignalState;
use schema::scene_info::SignalGroupInfo;
use settings::TrafficSettings;

/// Lights that turned red this short a time ago are as good as some that stay red long enough, seconds.
const JUST_RED_S: f64 = 2.0;

/// When a signal is green within its junction's cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Phase {
    cycle_s: f64,
    start_s: f64,
    green_s: f64,
}

/// The programs of all dynamic signals of a map.
#[derive(Debug)]
pub(crate) struct Signals {
    phases: Vec<Option<Phase>>,
    yellow_s: f64,
}

impl Signals {
    /// Each controller shows green for its own drawn time, then yellow, then all show red, then the next
    /// controller follows. All cycles begin with the simulation, or each some time before. Dynamic signals of
    /// a junction that no controller names form one more controller each.
    pub(crate) fn new(map: &Map, settings: &TrafficSettings, seed: u64, scene: u64) -> Self {
        let mut programs: Vec<Vec<Vec<usize>>> = Vec::new();
        let mut named: BTreeSet<usize> = BTreeSet::new();
        let mut program_of_junction = vec![None; map.junctions().len()];
        for group in map.signal_groups() {
            let turns: Vec<Vec<usize>> = group
                .controllers
                .iter()
                .map(|c| {
                    c.signals
                        .iter()
                        .copied()
                        .filter(|&i| map.signals()[i].dynamic && named.insert(i))
                        .collect()
                })
                .filter(|turn: &Vec<usize>| !turn.is_empty())
                .collect();
            if !turns.is_empty() {
                program_of_junction[group.junction] = Some(programs.len());
                programs.push(turns);
            }
        }
        for (i, signal) in map.signals().iter().enumerate() {
            if !signal.dynamic || named.contains(&i) {
                continue;
            }
            match signal.junction.and_then(|j| program_of_junction[j]) {
                Some(program) => programs[program].push(vec![i]),
                None => {
                    if let Some(j) = signal.junction {
                        program_of_junction[j] = Some(programs.len());
                    }
                    programs.push(vec![vec![i]]);
                }
            }
        }
        let (yellow_s, all_red_s) = (settings.yellow_time_s.max(0.0), settings.all_red_time_s.max(0.0));
        let mut phases = vec![None; map.signals().len()];
        for turns in &programs {
            let greens: Vec<f64> = turns
                .iter()
                .map(|turn| {
                    let drawn = Stream::new(seed, scene, "traffic/green", turn[0] as u64).uniform(4.0, 28.0);
                    settings.green_time_s.unwrap_or(drawn).max(0.0)
                })
                .collect();
            let cycle_s: f64 = greens.iter().map(|g| g + yellow_s + all_red_s).sum();
            let entity = turns[0][0] as u64;
            let before = Stream::new(seed, scene, "traffic/signal_offset", entity).uniform(0.0, cycle_s);
            let mut start_s = if settings.signal_offsets { cycle_s - before } else { 0.0 };
            for (turn, &green_s) in turns.iter().zip(&greens) {
                if start_s >= cycle_s {
                    start_s -= cycle_s;
                }
                for &signal in turn {
                    phases[signal] = Some(Phase { cycle_s, start_s, green_s });
                }
                start_s += green_s + yellow_s + all_red_s;
            }
        }
        Self { phases, yellow_s }
    }

    /// The programs, for the log: by the first signal of each.
    pub(crate) fn groups(&self, map: &Map) -> Vec<SignalGroupInfo> {
        let mut groups: Vec<(Phase, Option<usize>, SignalGroupInfo)> = Vec::new();
        for (phase, signal) in self.phases.iter().zip(map.signals()) {
            let Some(phase) = *phase else { continue };
            let same =
                |g: &&mut (Phase, Option<usize>, SignalGroupInfo)| g.0 == phase && g.1 == signal.junction;
            match groups.iter_mut().find(same) {
                Some((_, _, group)) => group.signals.push(signal.id.clone()),
                None => {
                    let Phase { cycle_s, start_s, green_s } = phase;
                    let signals = vec![signal.id.clone()];
                    let group = SignalGroupInfo { signals, green_time_s: green_s, start_s, cycle_s };
                    groups.push((phase, signal.junction, group));
                }
            }
        }
        groups.into_iter().map(|(_, _, group)| group).collect()
    }

    /// What a signal shows at a time since the start of the simulation.
    pub(crate) fn state(&self, signal: usize, time_s: f64) -> SignalState {
        let Some(Some(phase)) = self.phases.get(signal) else { return SignalState::Off };
        if phase.cycle_s <= 0.0 {
            return SignalState::Off;
        }
        let since_first = time_s - phase.start_s;
        let since = since_first - (since_first / phase.cycle_s).floor() * phase.cycle_s;
        if (0.0..phase.green_s).contains(&since) {
            SignalState::Green
        } else if (0.0..phase.green_s + self.yellow_s).contains(&since) {
            SignalState::Yellow
        } else {
            SignalState::Red
        }
    }

    /// Whether signals hold the traffic for so long: all are red, and turned so just now or stay so all the
    /// time.
    pub(crate) fn hold(&self, signals: &[usize], time_s: f64, for_s: f64) -> bool {
        let red = |after_s: f64| {
            let lights = signals.iter().map(|&s| self.state(s, time_s + after_s));
            lights.filter(|l| *l != SignalState::Off).all(|l| l == SignalState::Red)
        };
        // No light is green and yellow for less than a second.
        let steps = for_s.ceil().clamp(1.0, 600.0);
        let stay = || (1..=steps as u32).all(|k| red(for_s * f64::from(k) / steps));
        red(0.0) && (!red(-JUST_RED_S) || stay())
    }

    /// Whether none of some signals is on.
    pub(crate) fn are_off(&self, signals: &[usize], time_s: f64) -> bool {
        signals.iter().all(|&s| self.state(s, time_s) == SignalState::Off)
    }

    /// The most restrictive of several signals; Off without any.
    pub(crate) fn strictest(&self, signals: &[usize], time_s: f64) -> SignalState {
        let rank = |light: &SignalState| match light {
            SignalState::Red => 3,
            SignalState::Yellow => 2,
            SignalState::Green => 1,
            SignalState::Off => 0,
        };
        signals.iter().map(|&i| self.state(i, time_s)).max_by_key(rank).unwrap_or(SignalState::Off)
    }
}
