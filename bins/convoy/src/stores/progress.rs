//! How far a store has come: for people who wait, and for dashboards. All is told from manifests, so it is
//! the same whichever engine runs the tasks.

use std::collections::{BTreeMap, VecDeque};
use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::HumanDuration;
use runner::{
    EXIT_DONE, EXIT_SOME_FAILED, EXIT_TRY_AGAIN, Graph, Remembered, StageError, State, Status, say,
    scene_stages,
};
use serde_json::{Value, json};
use store::Scope;

/// Rates are those of the last so many seconds.
const RATE_OVER: Duration = Duration::from_secs(600);
/// How often a signal is looked for while nothing else is done.
const LOOK_EVERY: Duration = Duration::from_millis(200);
/// So many failures are told.
const MOST_FAILURES: usize = 10;

/// A store at one moment.
pub(super) struct Standing {
    plan: State,
    /// Of each scene the states of its stages, in running order.
    pub(super) scenes: BTreeMap<u32, Vec<State>>,
    stats: Vec<(&'static str, State)>,
    /// Estimated work, seconds of one core: what is done, and what is left.
    done_s: f64,
    pub(super) left_s: f64,
}

impl Standing {
    pub(super) fn of(status: &Status<'_>) -> Result<Self, StageError> {
        Self::knowing(status, &mut Remembered::default())
    }

    fn knowing(status: &Status<'_>, remembered: &mut Remembered) -> Result<Self, StageError> {
        let plan = status.state(Graph::get().planner(), Scope::Plan)?;
        let mut scenes = BTreeMap::new();
        let overview = runner::overview(status, remembered, |scene, states| {
            scenes.insert(scene, states.to_vec());
        })?;
        let work = remembered.work(status)?;
        let (mut done_s, mut left_s) = (0.0, 0.0);
        for (scene, states) in &scenes {
            for (stage, state) in scene_stages().zip(states) {
                let of_scene = work.get(scene).and_then(|stages| stages.get(stage.name));
                let work_s = of_scene.map_or(0.0, |work| work.core_s);
                *(if *state == State::Done { &mut done_s } else { &mut left_s }) += work_s;
            }
        }
        let stats = overview.stats.into_iter().map(|(stage, state)| (stage.name, state)).collect();
        Ok(Self { plan, scenes, stats, done_s, left_s })
    }

    /// How many scenes have something left to do.
    pub(super) fn scenes_left(&self) -> usize {
        let is_left = |states: &&Vec<State>| states.iter().any(|state| *state != State::Done);
        self.scenes.values().filter(is_left).count()
    }

    /// What share of the work is left.
    pub(super) fn share_left(&self) -> f64 {
        let all_s = self.done_s + self.left_s;
        if all_s > 0.0 { self.left_s / all_s } else { 0.0 }
    }

    fn all_done(&self) -> bool {
        let of_scenes = self.scenes.values().flatten();
        let mut all = of_scenes.chain(self.stats.iter().map(|(_, state)| state)).chain([&self.plan]);
        all.all(|state| *state == State::Done)
    }

    /// How many scenes failed where nothing more is made: all others are done, and the statistics are of what
    /// there is.
    fn failed_at_the_end(&self) -> Option<usize> {
        let is_done = |states: &&Vec<State>| states.iter().all(|state| *state == State::Done);
        let has_failed = |states: &&Vec<State>| states.iter().any(|state| matches!(state, State::Failed(_)));
        let left: Vec<_> = self.scenes.values().filter(|states| !is_done(states)).collect();
        let is_over = self.plan == State::Done
            && self.stats.iter().all(|(_, state)| *state == State::Done)
            && left.iter().all(has_failed);
        (is_over && !left.is_empty()).then_some(left.len())
    }

    /// How many scenes have a stage in each of four states: done, missing, stale, failed.
    fn counts(&self, stage: usize) -> [usize; 4] {
        let mut counts = [0; 4];
        for states in self.scenes.values() {
            counts[match &states[stage] {
                State::Done => 0,
                State::Missing => 1,
                State::Stale(_) => 2,
                State::Failed(_) => 3,
            }] += 1;
        }
        counts
    }

    /// Failures as `scene 0003 bev-gt: first line of why`.
    fn failures(&self) -> Vec<String> {
        let mut failures = Vec::new();
        for (scene, states) in &self.scenes {
            for (stage, state) in scene_stages().zip(states) {
                if let State::Failed(why) = state {
                    let first = why.lines().next().unwrap_or_default();
                    failures.push(format!("scene {scene:04} {}: {first}", stage.name));
                }
            }
        }
        failures
    }

    /// Lines for people, with the time that is left by a rate of work, if one is known.
    fn lines(&self, rate: Option<f64>) -> Vec<String> {
        let mut lines = vec![format!("plan: {}, {} scenes", self.plan, self.scenes.len())];
        lines.push(format!("{:<20} {:>7} {:>8} {:>7} {:>7}", "stage", "done", "missing", "stale", "failed"));
        for (position, stage) in scene_stages().enumerate() {
            let [done, missing, stale, failed] = self.counts(position);
            lines.push(format!("{:<20} {done:>7} {missing:>8} {stale:>7} {failed:>7}", stage.name));
        }
        lines.extend(self.stats.iter().map(|(name, state)| format!("{name}: {state}")));
        let share = 100.0 * (1.0 - self.share_left());
        let left = match rate {
            Some(rate) if rate > 0.0 && self.left_s > 0.0 => {
                let left = Duration::try_from_secs_f64(self.left_s / rate).unwrap_or(Duration::MAX);
                format!(", {} left at {rate:.1} core-seconds a second", HumanDuration(left))
            }
            _ => String::new(),
        };
        lines.push(format!("{share:.1} % of the work is done{left}"));
        let failures = self.failures();
        lines.extend(failures.iter().take(MOST_FAILURES).cloned());
        if failures.len() > MOST_FAILURES {
            lines.push(format!("and {} more failures", failures.len() - MOST_FAILURES));
        }
        lines
    }

    fn json(&self) -> Value {
        let state = |state: &State| match state {
            State::Done => json!({"state": "done"}),
            State::Missing => json!({"state": "missing"}),
            State::Stale(why) => json!({"state": "stale", "why": why.to_string()}),
            State::Failed(why) => json!({"state": "failed", "why": why}),
        };
        let stages: Vec<_> = scene_stages().collect();
        let scene = |(scene, states): (&u32, &Vec<State>)| {
            let of_stages: BTreeMap<&str, Value> =
                stages.iter().map(|stage| stage.name).zip(states.iter().map(state)).collect();
            json!({"scene": scene, "stages": of_stages})
        };
        let counts = stages.iter().enumerate().map(|(position, stage)| {
            let [done, missing, stale, failed] = self.counts(position);
            (stage.name, json!({"done": done, "missing": missing, "stale": stale, "failed": failed}))
        });
        json!({
            "plan": state(&self.plan),
            "stages": counts.collect::<BTreeMap<_, _>>(),
            "scenes": self.scenes.iter().map(scene).collect::<Vec<_>>(),
            "statistics": self.stats.first().map(|(_, stats)| state(stats)),
            "work": {"done_core_s": self.done_s.round(), "left_core_s": self.left_s.round()},
        })
    }
}

/// Prints how the store stands as JSON; the exit code is 0 where all is done.
pub(super) fn tell_json(status: &Status<'_>) -> Result<bool, StageError> {
    let standing = Standing::of(status)?;
    say(&format!("{:#}", standing.json()));
    Ok(standing.all_done())
}

/// Prints how the store stands again and again, until all is done but what failed, or a signal comes; the
/// exit code. A scene that was done is not looked at again while the plan stays.
pub(super) fn watch<'a>(status: impl Fn() -> Status<'a>, every: Duration) -> Result<u8, StageError> {
    runner::listen_for_signals();
    let mut past: VecDeque<(Instant, f64)> = VecDeque::new();
    let mut remembered = Remembered::default();
    loop {
        let standing = Standing::knowing(&status(), &mut remembered)?;
        let now = Instant::now();
        past.push_back((now, standing.done_s));
        while past.len() > 2 && past.front().is_some_and(|(at, _)| now.duration_since(*at) > RATE_OVER) {
            past.pop_front();
        }
        let rate = past
            .front()
            .filter(|(at, _)| *at < now)
            .map(|(at, done_s)| (standing.done_s - done_s) / now.duration_since(*at).as_secs_f64());
        if std::io::stdout().is_terminal() {
            // Clears the terminal and goes to its top.
            say("\x1b[2J\x1b[H");
        }
        standing.lines(rate).iter().for_each(|line| say(line));
        if standing.all_done() {
            return Ok(EXIT_DONE);
        }
        if let Some(failed) = standing.failed_at_the_end() {
            say(&format!("scenes that failed: {failed}; all others are done, and so are the statistics"));
            return Ok(EXIT_SOME_FAILED);
        }
        while now.elapsed() < every {
            if runner::was_stopped() {
                return Ok(EXIT_TRY_AGAIN);
            }
            std::thread::sleep(LOOK_EVERY.min(every));
        }
        if !std::io::stdout().is_terminal() {
            say("");
        }
    }
}

/// The exit code of a store that is done or not.
pub(super) fn code(all_done: bool) -> u8 {
    if all_done { EXIT_DONE } else { EXIT_SOME_FAILED }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_is_told_with_the_time_that_is_left() {
        let count = scene_stages().count();
        let done = vec![State::Done; count];
        let mut failed = vec![State::Missing; count];
        failed[0] = State::Failed("the map is broken\nin line 3".into());
        let mut standing = Standing {
            plan: State::Done,
            scenes: BTreeMap::from([(0, done), (7, failed)]),
            stats: vec![("stats", State::Missing)],
            done_s: 900.0,
            left_s: 2700.0,
        };
        assert!(!standing.all_done());
        insta::assert_snapshot!(standing.lines(Some(1.5)).join("\n"), @"
        plan: done, 2 scenes
        stage                   done  missing   stale  failed
        simulate-and-log           1        0       0       1
        render-sensors             1        1       0       0
        bev-gt                     1        1       0       0
        occupancy-gt               1        1       0       0
        postprocess-valid          1        1       0       0
        merge-tracks               1        1       0       0
        stats: missing
        25.0 % of the work is done, 30 minutes left at 1.5 core-seconds a second
        scene 0007 simulate-and-log: the map is broken
        ");
        assert!(standing.lines(None).contains(&"25.0 % of the work is done".to_owned()));
        assert_eq!(standing.json()["scenes"][1]["stages"]["bev-gt"]["state"], "missing");
        assert_eq!(standing.failed_at_the_end(), None, "the statistics are missing");
        standing.stats[0].1 = State::Done;
        assert_eq!(standing.failed_at_the_end(), Some(1));
        standing.scenes.insert(8, vec![State::Missing; count]);
        assert_eq!(standing.failed_at_the_end(), None, "scene 8 is to come");
    }
}
