//! What a stage is told when it starts.

use std::path::PathBuf;

use crate::editions::EditionWish;

/// What a stage is told when it starts; `arguments::stage` reads it from a command line.
#[derive(Clone, Debug)]
pub struct StageOptions {
    /// Dataset configuration (TOML, or YAML of SimBEV2X); none: the newest that the store was planned by.
    pub config: Option<PathBuf>,
    /// The store: a folder, or s3://BUCKET/FOLDER (az://, gs://).
    pub store: PathBuf,
    /// Folder with OpenDRIVE files for maps that the configuration names.
    pub maps: Option<PathBuf>,
    /// Only these scenes; none: all.
    pub scenes: Option<SceneList>,
    /// Only this share of the scenes.
    pub shard: Option<Shard>,
    /// What the configuration is meant to be among the store's editions.
    pub edition: EditionWish,
    /// Redo scenes that are done.
    pub force: bool,
    /// Make finished work again that a changed configuration makes stale, however much it is.
    pub redo: bool,
    /// Make again what older code made: `convoy run` says so to its stages once the planner has asked.
    pub redo_older: bool,
    /// The stages of the run that this is one of, in order; none: it runs by itself.
    pub in_run: Vec<String>,
    /// What is suspicious in the configuration or the plan is an error.
    pub strict: bool,
    /// Keep what an older version or program made, where nothing else changed.
    pub accept_code: bool,
    /// What looks at scenes.
    pub device: DeviceOptions,
    /// Worker threads; none: all cores.
    pub threads: Option<usize>,
    /// Only say what would be done.
    pub dry_run: bool,
    /// How to show progress.
    pub progress: ProgressMode,
}

/// What looks at scenes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DeviceOptions {
    /// As `--device` has it; empty: the best of what there is.
    pub name: String,
    /// Most memory of a GPU that is used; none: half of what it has.
    pub memory_bytes: Option<u64>,
}

/// How to show progress.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgressMode {
    /// A bar on a terminal, plain lines elsewhere.
    Auto,
    /// A bar.
    Bar,
    /// A line every ten seconds.
    Plain,
    /// Nothing.
    None,
}

/// Scene numbers, from a text such as `0,3,5-9`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneList(Vec<(u32, u32)>);

impl SceneList {
    /// Of scenes in ascending order.
    #[must_use]
    pub fn of(scenes: &[u32]) -> Self {
        let mut ranges: Vec<(u32, u32)> = Vec::new();
        for &scene in scenes {
            match ranges.last_mut() {
                Some((_, last)) if *last + 1 == scene => *last = scene,
                _ => ranges.push((scene, scene)),
            }
        }
        Self(ranges)
    }

    /// First and last number of each piece.
    #[must_use]
    pub fn ranges(&self) -> &[(u32, u32)] {
        &self.0
    }

    /// Whether a scene is meant.
    #[must_use]
    pub fn contains(&self, scene: u32) -> bool {
        self.0.iter().any(|&(first, last)| (first..=last).contains(&scene))
    }

    /// The named scenes that are not among some others: probably typing mistakes.
    #[must_use]
    pub fn outside(&self, known: &[u32]) -> Vec<u32> {
        let ends = self.0.iter().flat_map(|&(first, last)| [first, last]);
        let mut unknown: Vec<u32> = ends.filter(|s| !known.contains(s)).collect();
        unknown.sort_unstable();
        unknown.dedup();
        unknown
    }
}

impl std::fmt::Display for SceneList {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let range = |&(first, last): &(u32, u32)| {
            if first == last { first.to_string() } else { format!("{first}-{last}") }
        };
        f.write_str(&self.0.iter().map(range).collect::<Vec<_>>().join(","))
    }
}

impl std::str::FromStr for SceneList {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |t: &str| t.trim().parse::<u32>().map_err(|_| format!("`{t}` is no scene number"));
        let range = |part: &str| match part.split_once('-') {
            Some((first, last)) => {
                let (first, last) = (number(first)?, number(last)?);
                if first > last { Err(format!("`{part}` runs backwards")) } else { Ok((first, last)) }
            }
            None => number(part).map(|n| (n, n)),
        };
        text.split(',').map(range).collect::<Result<_, _>>().map(Self)
    }
}

/// A share of the scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Which share, from 0.
    pub index: u32,
    /// Of how many.
    pub count: u32,
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::parse(text, |variable| std::env::var(variable).ok())
    }
}

/// What engines call the number of a task, from 0.
const INDEX_VARIABLES: [&str; 2] = ["SLURM_ARRAY_TASK_ID", "JOB_COMPLETION_INDEX"];

impl Shard {
    /// From `I/N`, or from `N` with the index in the environment.
    fn parse(text: &str, variable: impl Fn(&str) -> Option<String>) -> Result<Self, String> {
        let number = |t: &str| t.trim().parse::<u32>().map_err(|_| format!("`{t}` is no number"));
        let (index, count) = match text.split_once('/') {
            Some((index, count)) => (number(index)?, number(count)?),
            None => {
                let count = number(text)?;
                let mut found: Vec<(&str, u32)> = Vec::new();
                for name in INDEX_VARIABLES {
                    if let Some(value) = variable(name) {
                        found.push((name, number(&value).map_err(|why| format!("{name}: {why}"))?));
                    }
                }
                match found[..] {
                    [] => {
                        return Err(format!(
                            "expected I/N, or N with {} in the environment",
                            INDEX_VARIABLES.join(" or ")
                        ));
                    }
                    [(one, index), (other, another)] if index != another => {
                        return Err(format!("{one} is {index} and {other} is {another}: give I/N"));
                    }
                    [(_, index), ..] => (index, count),
                }
            }
        };
        if index >= count {
            return Err(format!(
                "share {index} of {count}: shares count from 0 to {}",
                count.saturating_sub(1)
            ));
        }
        Ok(Self { index, count })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scene_lists() {
        let list: SceneList = "0,3,5-7".parse().expect("parses");
        assert_eq!((0..9).filter(|&s| list.contains(s)).collect::<Vec<_>>(), [0, 3, 5, 6, 7]);
        assert_eq!(list.outside(&[0, 1, 2, 3, 4, 5]), [7]);
        assert_eq!(SceneList::of(&[0, 3, 5, 6, 7]), list);
        assert!("5-3".parse::<SceneList>().is_err());
        assert!("a".parse::<SceneList>().is_err());
    }

    #[test]
    fn shares_are_named_by_both_numbers_or_by_the_environment() {
        assert_eq!("2/3".parse(), Ok(Shard { index: 2, count: 3 }));
        for wrong in ["3/3", "0/0", "-1/3", "1/", "a"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
        let of = |slurm: &'static str, kubernetes: &'static str| {
            let value = move |name: &str| if name.starts_with("SLURM") { slurm } else { kubernetes };
            Shard::parse("4", move |name| Some(value(name).to_owned()).filter(|value| !value.is_empty()))
        };
        assert_eq!(of("1", ""), Ok(Shard { index: 1, count: 4 }));
        assert_eq!(of("", "2"), Ok(Shard { index: 2, count: 4 }));
        assert_eq!(of("3", "3"), Ok(Shard { index: 3, count: 4 }));
        insta::assert_snapshot!(
            [of("", ""), of("1", "2"), of("4", ""), of("x", "")].map(|shard| shard.expect_err("is refused")).join("\n"),
            @"
        expected I/N, or N with SLURM_ARRAY_TASK_ID or JOB_COMPLETION_INDEX in the environment
        SLURM_ARRAY_TASK_ID is 1 and JOB_COMPLETION_INDEX is 2: give I/N
        share 4 of 4: shares count from 0 to 3
        SLURM_ARRAY_TASK_ID: `x` is no number
        "
        );
    }
}
