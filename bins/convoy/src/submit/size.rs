//! How many tasks: as many as end in time.

use std::collections::BTreeMap;
use std::fmt;

use indicatif::DecimalBytes;
use runner::largest_share;

/// This much of the cores' time is work: threads wait for one another at the ends of scenes.
const BUSY: f64 = 0.8;
/// Seconds at the end of a task in which it is told to stop.
const NOTICE_S: f64 = 120.0;

/// What tasks may be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Minutes that a task may take.
    pub(super) minutes: u32,
    /// Cores of a task.
    pub(super) cores: u32,
    /// How many tasks there may be.
    pub(super) most: Most,
}

/// The most tasks that an engine starts as one.
#[derive(Clone, Copy, Debug)]
pub(super) enum Most {
    /// An array of Slurm; the site says how many.
    Array(u32),
    /// A Job of Kubernetes.
    Job(u32),
    /// Any number.
    Any,
}

impl Most {
    fn count(self) -> u32 {
        match self {
            Self::Array(count) | Self::Job(count) => count,
            Self::Any => u32::MAX,
        }
    }
}

impl fmt::Display for Most {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Array(count) => write!(f, "an array takes {count} at most (--largest-array)"),
            Self::Job(count) => write!(f, "a Job takes {count} at most"),
            Self::Any => f.write_str("there may be any number"),
        }
    }
}

/// How many tasks, and what they take.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Size {
    pub(super) tasks: u32,
    cores: u32,
    scenes: usize,
    /// All work, seconds of one core.
    all_s: f64,
    /// Seconds that the longest task takes, and the longest scene.
    task_s: f64,
    scene_s: f64,
}

impl Size {
    /// Chooses how many tasks, or checks the number that is wanted. `work_s` is the work of each scene,
    /// seconds of one core.
    ///
    /// # Errors
    /// No number will do; what would.
    pub(super) fn choose(
        work_s: &BTreeMap<u32, f64>,
        wanted: Option<u32>,
        limits: Limits,
    ) -> Result<Self, String> {
        let Limits { minutes, cores, most: rule } = limits;
        let scenes = u32::try_from(work_s.len()).unwrap_or(u32::MAX);
        if scenes == 0 {
            return Err("the plan has no scenes".to_owned());
        }
        let wall_s = |core_s: f64| core_s / f64::from(cores) / BUSY;
        let longest = work_s.iter().max_by(|a, b| a.1.total_cmp(b.1).then(b.0.cmp(a.0)));
        let (longest, scene_s) = longest.map_or((0, 0.0), |(scene, core_s)| (*scene, wall_s(*core_s)));
        let usable_s = f64::from(minutes) * 60.0 - NOTICE_S;
        let enough = |wall_s: f64| ((wall_s + NOTICE_S) / 60.0).ceil();
        let size = |tasks| {
            let task_s = wall_s(largest_share(work_s, tasks));
            let all_s = work_s.values().sum();
            Self { tasks, cores, scenes: work_s.len(), all_s, task_s, scene_s }
        };
        if scene_s > usable_s {
            return Err(format!(
                "scene {longest} alone takes about {} on {}: give --minutes {:.0}, or more --cores",
                minutes_of(scene_s),
                counted(cores, "core"),
                enough(scene_s)
            ));
        }
        let most = rule.count().min(scenes);
        if let Some(wanted) = wanted {
            if wanted > rule.count() {
                return Err(format!("--tasks {wanted}: {rule}: give --tasks {most}"));
            }
            let size = size(wanted.min(scenes));
            return match size.task_s > usable_s {
                true => Err(format!(
                    "--tasks {wanted}: the longest would take about {}: give --minutes {:.0}, or more tasks",
                    minutes_of(size.task_s),
                    enough(size.task_s)
                )),
                false => Ok(size),
            };
        }
        let all_s: f64 = wall_s(work_s.values().sum());
        let largest = size(most);
        if largest.task_s > usable_s {
            return Err(format!(
                "{most} tasks of {minutes} minutes are too few, and {rule}: give --minutes {:.0}, or more --cores",
                enough(largest.task_s)
            ));
        }
        // As more tasks are never longer, the least number that ends in time is found by halving.
        let mut tasks = ((all_s / usable_s).ceil() as u32).clamp(1, most)..most;
        while tasks.start < tasks.end {
            let middle = tasks.start + (tasks.end - tasks.start) / 2;
            match size(middle).task_s <= usable_s {
                true => tasks.end = middle,
                false => tasks.start = middle + 1,
            }
        }
        Ok(size(tasks.end))
    }

    /// What it will cost, for people.
    pub(super) fn lines(&self, bytes: f64) -> Vec<String> {
        let Self { tasks, cores, scenes, all_s, task_s, scene_s } = self;
        vec![
            format!(
                "{}, about {} at the speed of this machine, {}",
                counted(*scenes, "scene"),
                core_time(*all_s),
                DecimalBytes(bytes.round() as u64)
            ),
            format!(
                "{} of {}: the longest takes about {}, the longest scene {}",
                counted(*tasks, "task"),
                counted(*cores, "core"),
                minutes_of(*task_s),
                minutes_of(*scene_s)
            ),
        ]
    }
}

/// Seconds of one core as core-hours, or as core-minutes where these are few.
fn core_time(seconds: f64) -> String {
    match seconds < 3600.0 {
        true => counted((seconds / 60.0).ceil() as u32, "core-minute"),
        false => format!("{:.1} core-hours", seconds / 3600.0),
    }
}

/// Seconds as minutes, rounded up.
fn minutes_of(seconds: f64) -> String {
    counted((seconds / 60.0).ceil() as u32, "minute")
}

/// How many of a thing.
pub(super) fn counted<N: fmt::Display + PartialEq + From<u8>>(count: N, thing: &str) -> String {
    let end = if count == N::from(1) { "" } else { "s" };
    format!("{count} {thing}{end}")
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits { minutes: 60, cores: 16, most: Most::Array(1000) };

    /// Scenes of some core-hours each.
    fn scenes(hours: &[f64]) -> BTreeMap<u32, f64> {
        (0..).zip(hours.iter().map(|hours| hours * 3600.0)).collect()
    }

    #[test]
    fn there_are_as_many_tasks_as_end_in_time() {
        // The published set: 460 core-hours are 36 hours on 16 cores that are busy for 0.8 of the time.
        let published = scenes(&[1.8; 256]);
        let size = Size::choose(&published, None, LIMITS).expect("fits");
        assert_eq!(size.tasks, 43);
        assert!(size.task_s <= 58.0 * 60.0 && size.task_s > 50.0 * 60.0, "{size:?}");
        assert_eq!(Size::choose(&published, Some(64), LIMITS).expect("fits").tasks, 64);
        assert_eq!(Size::choose(&scenes(&[0.1, 0.1]), Some(64), LIMITS).expect("fits").tasks, 2);
        assert_eq!(Size::choose(&scenes(&[0.1, 0.1]), None, LIMITS).expect("fits").tasks, 1);
    }

    #[test]
    fn little_work_is_told_in_minutes() {
        let told = |hours: &[f64]| {
            Size::choose(&scenes(hours), None, LIMITS).expect("fits").lines(2e9).swap_remove(0)
        };
        let rest = "at the speed of this machine, 2.00 GB";
        assert_eq!(told(&[0.02, 0.02]), format!("2 scenes, about 3 core-minutes {rest}"));
        assert_eq!(told(&[0.01]), format!("1 scene, about 1 core-minute {rest}"));
        assert_eq!(told(&[1.8]), format!("1 scene, about 1.8 core-hours {rest}"));
    }

    #[test]
    fn many_tasks_are_counted_soon() {
        let any = Limits { most: Most::Any, ..LIMITS };
        let size = Size::choose(&scenes(&vec![10.0; 50_000]), None, any).expect("fits");
        // One takes 47 minutes: no task has two.
        assert_eq!(size.tasks, 50_000);
    }

    #[test]
    fn what_cannot_be_is_told_with_what_can() {
        let refused = |hours: &[f64], wanted, limits| {
            Size::choose(&scenes(hours), wanted, limits).expect_err("does not fit")
        };
        let few = Limits { most: Most::Array(10), ..LIMITS };
        let job = Limits { most: Most::Job(100_000), ..LIMITS };
        insta::assert_snapshot!(
            [
                refused(&[1.0, 16.0], None, LIMITS),
                refused(&[1.8; 256], None, few),
                refused(&[1.8; 256], Some(11), few),
                refused(&[1.8; 256], Some(5), few),
                refused(&[1.8], Some(200_000), job),
                refused(&[], None, LIMITS),
            ]
            .join("\n"),
            @"
        scene 1 alone takes about 75 minutes on 16 cores: give --minutes 77, or more --cores
        10 tasks of 60 minutes are too few, and an array takes 10 at most (--largest-array): give --minutes 222, or more --cores
        --tasks 11: an array takes 10 at most (--largest-array): give --tasks 10
        --tasks 5: the longest would take about 439 minutes: give --minutes 441, or more tasks
        --tasks 200000: a Job takes 100000 at most: give --tasks 1
        the plan has no scenes
        "
        );
    }
}
