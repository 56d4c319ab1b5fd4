//! What a stage is told when it starts.

use std::path::PathBuf;

use crate::editions::EditionWish;

/// What a stage is told when it starts; `arguments::stage` reads it from a command line.
#[derive(Clone, Debug)]
pub struct StageOptions {
    /// Dataset configuration (TOML, or YAML of SimBEV2X).
    pub config: PathBuf,
    /// The store: a folder, by its path or as file:///FOLDER.
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

impl Shard {
    /// Whether the n-th scene of a list is in this share.
    #[must_use]
    pub fn contains(&self, position: usize) -> bool {
        position % self.count as usize == self.index as usize
    }
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |t: &str| t.trim().parse::<u32>().map_err(|_| format!("`{t}` is no number"));
        let (index, count) = match text.split_once('/') {
            Some((index, count)) => (number(index)?, number(count)?),
            None => {
                let variables = ["SLURM_ARRAY_TASK_ID", "JOB_COMPLETION_INDEX"];
                let index = variables.iter().find_map(|v| std::env::var(v).ok()).ok_or(
                    "expected I/N, or N with SLURM_ARRAY_TASK_ID or JOB_COMPLETION_INDEX in the environment",
                )?;
                (number(&index)?, number(text)?)
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
        assert!("5-3".parse::<SceneList>().is_err());
        assert!("a".parse::<SceneList>().is_err());
    }

    #[test]
    fn shards_cover_everything_once() {
        for n in 1..5 {
            for position in 0..20 {
                let holders = (0..n)
                    .filter(|i| format!("{i}/{n}").parse::<Shard>().expect("parses").contains(position))
                    .count();
                assert_eq!(holders, 1);
            }
        }
        assert!("3/3".parse::<Shard>().is_err());
        assert!("0/0".parse::<Shard>().is_err());
    }
}
