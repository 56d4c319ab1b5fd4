//! How fast work goes, and when all of it will be done.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::forecast::span;

/// Before so much time has gone by, nobody knows how fast it goes.
const SETTLED: Duration = Duration::from_secs(3);

/// The run that a stage's work is part of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct InRun {
    /// Which stage of the run it is, from 1.
    pub(crate) stage: usize,
    /// Stages of the run.
    pub(crate) stages: usize,
    /// What the stages after it will take, by the forecast for this machine.
    pub(crate) ahead_s: f64,
}

/// Where a piece of work stands among all of them: scenes of a stage, say.
#[derive(Clone, Debug)]
pub(crate) struct Pace {
    /// When the first piece was begun.
    began: Instant,
    /// How long the pieces took that are done.
    done_s: f64,
    /// Work of each piece, by the forecast; its unit does not matter.
    work: Arc<[f64]>,
    /// Pieces that are done.
    done: usize,
    run: Option<InRun>,
}

/// What was seen of a piece so far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    /// What is done of it.
    pub(crate) done: u64,
    /// What there is to do.
    pub(crate) total: u64,
    /// What was done at its first step, which makes what all later ones use: the world of a map, models.
    pub(crate) first: u64,
    /// How long that is ago.
    pub(crate) since: Duration,
}

impl Pace {
    /// At the first of some pieces that are alike.
    pub(crate) fn of(all: usize) -> Self {
        Self::over(vec![1.0; all], None)
    }

    /// At the first of some pieces with their work, in a run.
    pub(crate) fn over(work: Vec<f64>, run: Option<InRun>) -> Self {
        // Where a forecast knows nothing of some, all are alike.
        let is_known = work.iter().all(|work| work.is_finite() && *work > 0.0);
        let work = if is_known { work } else { vec![1.0; work.len()] };
        Self { began: Instant::now(), done_s: 0.0, work: work.into(), done: 0, run }
    }

    /// At the next piece.
    pub(crate) fn step(&mut self) {
        self.done += 1;
        self.done_s = self.began.elapsed().as_secs_f64();
    }

    /// Which piece it is, of which stage, as ` (2 of 12, stage 3 of 8)`; nothing where there is one.
    pub(crate) fn place(&self) -> String {
        let piece = (self.work.len() > 1).then(|| format!("{} of {}", self.done + 1, self.work.len()));
        let stage = self.run.map(|run| format!("stage {} of {}", run.stage, run.stages));
        match piece.into_iter().chain(stage).collect::<Vec<_>>().join(", ") {
            place if place.is_empty() => place,
            place => format!(" ({place})"),
        }
    }

    /// How fast this piece goes, how long all pieces will still take, and how long the whole run; nothing
    /// before that can be told.
    pub(crate) fn words(&self, seen: Seen) -> String {
        let Seen { done, total, first, since } = seen;
        if since < SETTLED || done <= first || total == 0 {
            return String::new();
        }
        let step_s = since.as_secs_f64() / (done - first) as f64;
        let this_s = step_s * total as f64;
        let work = |pieces: &[f64]| pieces.iter().sum::<f64>();
        let (before, rest) = self.work.split_at(self.done.min(self.work.len()));
        let (this, after) = rest.split_first().map_or((1.0, &[][..]), |(this, after)| (*this, after));
        // Seconds for what the forecast calls one, over all that was seen.
        let rate = (self.done_s + this_s) / (work(before) + this);
        let left_s = step_s * total.saturating_sub(done) as f64 + rate * work(after);
        let speed = if step_s > 1.0 {
            format!("{step_s:.1} s each")
        } else {
            format!("{:.1} a second", 1.0 / step_s)
        };
        let (amount, unit) = span(left_s);
        let of_run = self.run.filter(|run| run.ahead_s > 0.0).map(|run| span(left_s + run.ahead_s));
        let of_run = of_run.map(|(amount, unit)| format!(", {amount} {unit} of the whole run"));
        format!(", {speed}, {amount} {unit} left{}", of_run.unwrap_or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(done: u64, total: u64, first: u64, since_s: u64) -> Seen {
        Seen { done, total, first, since: Duration::from_secs(since_s) }
    }

    #[test]
    fn what_is_left_is_told_of_all_pieces() {
        let mut pace = Pace::of(4);
        assert_eq!(pace.place(), " (1 of 4)");
        // A first step took a minute; 20 seconds later 30 more are done.
        assert_eq!(pace.words(seen(31, 61, 1, 20)), ", 1.5 a second, 2 minutes left");
        assert_eq!(pace.words(seen(1, 61, 1, 20)), "", "nothing is done but the first");
        assert_eq!(pace.words(seen(31, 61, 1, 1)), "", "too early to say");
        assert_eq!(pace.words(seen(31, 0, 1, 20)), "", "how much there is to do is not known");
        assert_eq!(pace.words(seen(3, 60, 1, 20)), ", 10.0 s each, 40 minutes left");
        // Once pieces are done, what they took counts, first steps included.
        (pace.done, pace.done_s) = (1, 140.0);
        assert_eq!(pace.place(), " (2 of 4)");
        assert_eq!(pace.words(seen(31, 61, 1, 20)), ", 1.5 a second, 3 minutes left");
        assert_eq!(Pace::of(1).place(), "");
    }

    #[test]
    fn larger_pieces_take_longer() {
        let pace = Pace::over(vec![1.0, 9.0], None);
        // Half of the first one takes 10 seconds.
        assert_eq!(pace.words(seen(11, 20, 1, 10)), ", 1.0 a second, 3 minutes left");
        let unknown = Pace::over(vec![0.0, 9.0], None);
        assert_eq!(unknown.words(seen(11, 20, 1, 10)), ", 1.0 a second, 29 s left");
    }

    #[test]
    fn the_whole_run_is_told_by_the_forecast_of_what_comes_after() {
        let run = InRun { stage: 3, stages: 8, ahead_s: 3600.0 };
        let pace = Pace::over(vec![1.0; 2], Some(run));
        assert_eq!(pace.place(), " (1 of 2, stage 3 of 8)");
        let said = pace.words(seen(31, 61, 1, 20));
        assert_eq!(said, ", 1.5 a second, 61 s left, 61 minutes of the whole run");
        let last = Pace::over(vec![1.0], Some(InRun { ahead_s: 0.0, ..run }));
        assert_eq!(last.place(), " (stage 3 of 8)");
        assert_eq!(last.words(seen(31, 61, 1, 20)), ", 1.5 a second, 20 s left");
    }
}
