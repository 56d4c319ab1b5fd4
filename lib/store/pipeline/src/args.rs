//! Arguments that all stage binaries share.

use std::path::PathBuf;

use clap::{Parser, ValueEnum};

/// A stage of Convoy's pipeline: does what is missing or stale, for all scenes of the plan or for some.
#[derive(Clone, Debug, Parser)]
#[command(
    version,
    after_help = "Exit codes: 0 done, 1 some scenes failed (each listed), 2 bad arguments or configuration, \
                  75 stopped by a signal or a full disk (run the same command again)."
)]
pub struct StageArgs {
    /// Dataset configuration (TOML, or YAML of SimBEV2X).
    #[arg(long, value_name = "FILE")]
    pub config: PathBuf,
    /// The store: a folder, by its path or as file:///FOLDER.
    #[arg(long, value_name = "DIR")]
    pub store: PathBuf,
    /// Folder with OpenDRIVE files for maps that the configuration names.
    #[arg(long, value_name = "DIR")]
    pub maps: Option<PathBuf>,
    /// Only these scenes, such as 0,3,5-9 (default: all).
    #[arg(long, value_name = "LIST", conflicts_with = "shard")]
    pub scenes: Option<SceneList>,
    /// Every n-th scene from the i-th, i from 0. With only N, i comes from SLURM_ARRAY_TASK_ID or
    /// JOB_COMPLETION_INDEX.
    #[arg(long, value_name = "[I/]N")]
    pub shard: Option<Shard>,
    /// Redo scenes that are done; what was made from them becomes stale.
    #[arg(long)]
    pub force: bool,
    /// Keep what older code made, where nothing else changed; the manifests say so. For upgrades in mid-dataset.
    #[arg(long, conflicts_with = "force")]
    pub accept_code: bool,
    /// Worker threads (default: all cores). The output does not depend on it.
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// Only say what would be done.
    #[arg(long)]
    pub dry_run: bool,
    /// How to show progress.
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressMode,
}

/// How to show progress.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ProgressMode {
    /// A bar on a terminal, plain lines elsewhere.
    Auto,
    /// A bar.
    #[value(hide = true)]
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
