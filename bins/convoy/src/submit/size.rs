//! How many tasks: as many as end in time.

use std::collections::BTreeMap;

use indicatif::DecimalBytes;
use runner::{Shard, scenes_of_share};

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
    /// Most tasks of an array.
    pub(super) largest_array: u32,
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
        let Limits { minutes, cores, largest_array } = limits;
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
            let of_share = |index| {
                let scenes = scenes_of_share(work_s, Shard { index, count: tasks });
                scenes.iter().map(|scene| work_s[scene]).sum::<f64>()
            };
            let task_s = wall_s((0..tasks).map(of_share).fold(0.0, f64::max));
            let all_s = work_s.values().sum();
            Self { tasks, cores, scenes: work_s.len(), all_s, task_s, scene_s }
        };
        if scene_s > usable_s {
            return Err(format!(
                "scene {longest} alone takes about {:.0} minutes on {cores} cores: give --minutes {:.0}, or more --cores",
                scene_s / 60.0,
                enough(scene_s)
            ));
        }
        let most = largest_array.min(scenes);
        if let Some(wanted) = wanted {
            if wanted > largest_array {
                return Err(format!(
                    "--tasks {wanted}: an array takes {largest_array} at most (--largest-array): give --tasks {most}"
                ));
            }
            let size = size(wanted.min(scenes));
            return match size.task_s > usable_s {
                true => Err(format!(
                    "--tasks {wanted}: the longest would take about {:.0} minutes: give --minutes {:.0}, or more tasks",
                    size.task_s / 60.0,
                    enough(size.task_s)
                )),
                false => Ok(size),
            };
        }
        let all_s: f64 = wall_s(work_s.values().sum());
        let least = ((all_s / usable_s).ceil() as u32).clamp(1, most);
        let fits = (least..=most).map(size).find(|size| size.task_s <= usable_s);
        fits.ok_or_else(|| {
            let shortest = size(most);
            format!(
                "{most} tasks of {minutes} minutes are too few, and an array takes {largest_array} at most: give --minutes {:.0}, \
                 or more --cores",
                enough(shortest.task_s)
            )
        })
    }

    /// What it will cost, for people.
    pub(super) fn lines(&self, bytes: f64) -> Vec<String> {
        let Self { tasks, cores, scenes, all_s, task_s, scene_s } = self;
        vec![
            format!(
                "{scenes} scenes, about {:.1} core-hours at the speed of this machine, {}",
                all_s / 3600.0,
                DecimalBytes(bytes.round() as u64)
            ),
            format!(
                "{tasks} tasks of {cores} cores: the longest takes about {:.0} minutes, the longest scene {:.0}",
                (task_s / 60.0).ceil(),
                (scene_s / 60.0).ceil()
            ),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits { minutes: 60, cores: 16, largest_array: 1000 };

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
    fn what_cannot_be_is_told_with_what_can() {
        let refused = |hours: &[f64], wanted, limits| {
            Size::choose(&scenes(hours), wanted, limits).expect_err("does not fit")
        };
        let few = Limits { largest_array: 10, ..LIMITS };
        insta::assert_snapshot!(
            [
                refused(&[1.0, 16.0], None, LIMITS),
                refused(&[1.8; 256], None, few),
                refused(&[1.8; 256], Some(11), few),
                refused(&[1.8; 256], Some(5), few),
                refused(&[], None, LIMITS),
            ]
            .join("\n"),
            @"
        scene 1 alone takes about 75 minutes on 16 cores: give --minutes 77, or more --cores
        10 tasks of 60 minutes are too few, and an array takes 10 at most: give --minutes 222, or more --cores
        --tasks 11: an array takes 10 at most (--largest-array): give --tasks 10
        --tasks 5: the longest would take about 439 minutes: give --minutes 441, or more tasks
        the plan has no scenes
        "
        );
    }
}
