//! How fast work goes, and when all of it will be done.

use std::time::{Duration, Instant};

use crate::forecast::span;

/// Before so much time has gone by, nobody knows how fast it goes.
const SETTLED: Duration = Duration::from_secs(3);

/// Where a piece of work stands among all of them: scenes of a stage, say.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pace {
    /// When the first piece was begun.
    began: Instant,
    /// Pieces that are done.
    done: usize,
    /// All pieces.
    all: usize,
}

impl Pace {
    /// At the first of some pieces.
    pub(crate) fn of(all: usize) -> Self {
        Self { began: Instant::now(), done: 0, all }
    }

    /// At the next piece.
    pub(crate) fn step(&mut self) {
        self.done += 1;
    }

    /// Which piece it is, as ` (2 of 12)`; nothing where there is one.
    pub(crate) fn place(&self) -> String {
        if self.all > 1 { format!(" ({} of {})", self.done + 1, self.all) } else { String::new() }
    }

    /// How much a second is done of this piece, begun so long ago, and how long all pieces will still take
    /// where those to come are like those before.
    pub(crate) fn words(&self, done: u64, total: u64, since: Duration) -> String {
        self.words_after(self.began.elapsed(), done, total, since)
    }

    fn words_after(&self, elapsed: Duration, done: u64, total: u64, since: Duration) -> String {
        if since < SETTLED || done == 0 || total == 0 {
            return String::new();
        }
        let rate = done as f64 / since.as_secs_f64();
        let pieces = self.done as f64 + (done as f64 / total as f64).min(1.0);
        let left_s = elapsed.as_secs_f64() * (self.all as f64 - pieces).max(0.0) / pieces;
        let (amount, unit) = span(left_s);
        format!(", {rate:.1} a second, {amount} {unit} left")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_is_told_of_all_pieces() {
        let mut pace = Pace::of(4);
        assert_eq!(pace.place(), " (1 of 4)");
        pace.step();
        let s = Duration::from_secs;
        // One and a half pieces took a minute; two and a half are left.
        assert_eq!(pace.words_after(s(60), 30, 60, s(20)), ", 1.5 a second, 2 minutes left");
        assert_eq!(pace.words_after(s(60), 0, 60, s(20)), "", "nothing is done yet");
        assert_eq!(pace.words_after(s(60), 30, 60, s(1)), "", "too early to say");
        assert_eq!(pace.words_after(s(60), 30, 0, s(20)), "", "how much there is to do is not known");
        assert_eq!(Pace::of(1).place(), "");
    }
}
