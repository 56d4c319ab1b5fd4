//! How fast this machine is, beside the one that the forecast's rates are of.

use std::hint::black_box;
use std::thread;
use std::time::Duration;

use rustix::time::{ClockId, clock_gettime};
use store::{Aside, aside};

const LANES: usize = 8;
/// Rows of the table that is read: 256 KB.
const ROWS: usize = 1 << 13;
/// Pairs of rows that a round reads.
const READS: u32 = 300_000;
/// Rounds, of which the middle one counts.
const ROUNDS: usize = 5;
/// What a round takes where rates are what they are, with all cores at work, seconds: a machine on which it
/// took 0.0165 s made the demo in 250 to 270 core-seconds, where the rates say some 100, and six of the 64
/// scenes of `configs/benchmark.toml` in 67, where they say some 40.
const REFERENCE_S: f64 = 0.0078;

/// The machine that a forecast is for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Machine {
    /// Its cores.
    pub cores: usize,
    /// So many times what the rates say a core takes.
    pub times: f64,
}

impl Machine {
    /// This machine, by a tenth of a second of work on all cores. Processors' time is measured: what else
    /// runs on it does not count, but for what it takes of caches and memory.
    #[must_use]
    pub fn measured() -> Self {
        let cores = thread::available_parallelism().map_or(1, usize::from);
        let mut rounds: Vec<Duration> = thread::scope(|scope| {
            let start = |number| aside(scope, move || timed(number as u32));
            let workers: Vec<_> = (0..cores).map(start).collect();
            workers.into_iter().flat_map(Aside::join).collect()
        });
        rounds.sort_unstable();
        let middle_s = rounds.get(rounds.len() / 2).map_or(REFERENCE_S, Duration::as_secs_f64);
        Self { cores, times: middle_s / REFERENCE_S }
    }
}

/// What some rounds of work take.
fn timed(seed: u32) -> [Duration; ROUNDS] {
    let row = |i| std::array::from_fn(|k| ((i * 7 + k * 3) % 1013) as f32);
    let table: Vec<[f32; LANES]> = (0..ROWS).map(row).collect();
    std::array::from_fn(|_| {
        let start = on_core();
        black_box(work(black_box(&table), black_box(seed)));
        on_core().saturating_sub(start)
    })
}

/// How long this thread has been on a core.
fn on_core() -> Duration {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    let [seconds, nanoseconds] = [now.tv_sec, now.tv_nsec].map(|part| u64::try_from(part).unwrap_or(0));
    Duration::from_secs(seconds) + Duration::from_nanos(nanoseconds)
}

/// What rays do at the boxes of a tree, without a tree: reads in no order, eight lanes of comparisons and
/// roots, and a branch that nobody foresees.
fn work(table: &[[f32; LANES]], seed: u32) -> f32 {
    let (mut at, mut nearest) = (seed, [f32::INFINITY; LANES]);
    for _ in 0..READS {
        at = at.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let [low, high] = [at, at.rotate_left(7)].map(|at| &table[at as usize >> 19]);
        let direction = (at & 1023) as f32 * 1e-3 + 0.5;
        for k in 0..LANES {
            let (enter, leave) = ((low[k] - 300.0) * direction, (high[k] + 300.0) * direction);
            let (enter, leave) = (enter.min(leave), enter.max(leave));
            if enter < leave {
                nearest[k] = nearest[k].min((enter * enter + leave).sqrt());
            }
        }
        if nearest[0] < 1.0 {
            at ^= 1;
        }
    }
    nearest.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_machine_is_measured() {
        let Machine { cores, times } = Machine::measured();
        assert!(cores > 0 && times.is_finite() && times > 0.0, "{cores} {times}");
    }

    #[test]
    fn time_off_the_core_does_not_count() {
        let start = on_core();
        thread::sleep(Duration::from_millis(200));
        assert!(on_core().saturating_sub(start) < Duration::from_millis(100));
    }
}
