//! What `convoy submit` takes, and which of it goes with which engine.

use std::path::PathBuf;

use clap::ValueEnum;

use super::groups::Split;
use super::storage::{Claim, image_name, object_name};

/// What `convoy submit` takes. The plan is made at once, here: what it will cost is told from it.
#[derive(Debug, clap::Args)]
pub(crate) struct SubmitArgs {
    /// What starts the tasks.
    #[arg(long, value_enum)]
    pub(super) engine: Engine,
    /// Dataset configuration (TOML, or YAML of SimBEV2X).
    #[arg(long, value_name = "FILE")]
    pub(super) config: PathBuf,
    /// The store, in a place that all nodes see: a folder or a URL.
    #[arg(long, value_name = "DIR")]
    pub(super) store: PathBuf,
    /// Folder with OpenDRIVE files, where the planner finds it, too.
    #[arg(long, value_name = "DIR")]
    pub(super) maps: Option<PathBuf>,
    /// How many tasks (default: as many as end in time).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) tasks: Option<u32>,
    /// Minutes that a task may take, at least 5.
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = minutes)]
    pub(super) minutes: u32,
    /// Cores of a task.
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) cores: u32,
    /// Memory of a task, GiB (default: 2 and one for each core).
    #[arg(long, value_name = "GIB", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) memory: Option<u32>,
    /// A stage whose tasks go elsewhere: `render-sensors=gpu`. For Slurm a partition, with further options of
    /// it after commas (`render-sensors=gpu,--gres=gpu:1`), for Ray a resource of nodes.
    #[arg(long, value_name = "STAGE=PLACE[,OPTION]")]
    pub(super) split: Vec<Split>,
    /// Slurm, Kubernetes: tasks that may run at once (default: all); `--parallelism` is the same.
    #[arg(
        long,
        alias = "parallelism",
        value_name = "N",
        value_parser = clap::value_parser!(u32).range(1..)
    )]
    pub(super) at_once: Option<u32>,
    /// Slurm: partition of all tasks.
    #[arg(long, value_name = "NAME")]
    pub(super) partition: Option<String>,
    /// Slurm: a further option for all jobs, such as `--account=lab`.
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true)]
    pub(super) option: Vec<String>,
    /// Slurm: most tasks that it takes as one array, one less than `MaxArraySize` (default: 1000).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) largest_array: Option<u32>,
    /// Kubernetes: image with `convoy` on its PATH.
    #[arg(long, value_name = "NAME", required_if_eq("engine", "kubernetes"), value_parser = image_name)]
    pub(super) image: Option<String>,
    /// Kubernetes: namespace (default: that of kubectl).
    #[arg(long, value_name = "NAME", value_parser = object_name)]
    pub(super) namespace: Option<String>,
    /// Kubernetes: secret whose keys are the variables that tell a store who asks.
    #[arg(long, value_name = "NAME", value_parser = object_name)]
    pub(super) secret: Option<String>,
    /// Kubernetes: persistent volume claim that holds a store which is a folder; where it is seen (default:
    /// in the store's place).
    #[arg(long, value_name = "NAME[:FOLDER]")]
    pub(super) volume_claim: Option<Claim>,
    /// Ray: its address (default: `RAY_ADDRESS`, else the Ray that runs here).
    #[arg(long, value_name = "HOST:PORT")]
    pub(super) address: Option<String>,
    /// Ray: `convoy` on the nodes (default: this program).
    #[arg(long, value_name = "PATH")]
    pub(super) program: Option<PathBuf>,
    /// Folder for what is written, and for logs (default: the store's name with `-jobs`, beside it, or here
    /// for a store by URL).
    #[arg(long, value_name = "DIR")]
    pub(super) to: Option<PathBuf>,
    /// Send them as well. Kubernetes, Ray: wait until all is done.
    #[arg(long)]
    pub(super) submit: bool,
}

/// Minutes of a task.
fn minutes(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(minutes) if minutes >= 5 => Ok(minutes),
        _ => Err("a task takes at least 5: two minutes before its end it is told to stop".to_owned()),
    }
}

/// What starts tasks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Engine {
    /// Slurm: a job that plans, an array of tasks, a job that joins.
    Slurm,
    /// Kubernetes: a Job that plans, an Indexed Job of tasks, a Job that counts.
    Kubernetes,
    /// Ray: a script that starts `python -m convoy.ray`.
    Ray,
}

impl Engine {
    fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

impl SubmitArgs {
    /// Memory of a task, GiB.
    pub(super) fn memory_gib(&self) -> u32 {
        self.memory.unwrap_or(2 + self.cores)
    }

    /// Refuses options of other engines, all at once.
    pub(super) fn check_engine(&self) -> Result<(), String> {
        use Engine::{Kubernetes, Ray, Slurm};
        let of_engines: [(&str, bool, &[Engine]); 10] = [
            ("--at-once", self.at_once.is_some(), &[Slurm, Kubernetes]),
            ("--partition", self.partition.is_some(), &[Slurm]),
            ("--option", !self.option.is_empty(), &[Slurm]),
            ("--largest-array", self.largest_array.is_some(), &[Slurm]),
            ("--image", self.image.is_some(), &[Kubernetes]),
            ("--namespace", self.namespace.is_some(), &[Kubernetes]),
            ("--secret", self.secret.is_some(), &[Kubernetes]),
            ("--volume-claim", self.volume_claim.is_some(), &[Kubernetes]),
            ("--address", self.address.is_some(), &[Ray]),
            ("--program", self.program.is_some(), &[Ray]),
        ];
        let foreign = of_engines.iter().filter(|(_, given, of)| *given && !of.contains(&self.engine));
        let told: Vec<String> = foreign
            .map(|(option, _, of)| {
                let of: Vec<String> = of.iter().map(|engine| engine.name()).collect();
                format!("{option} (of {})", of.join(" and "))
            })
            .collect();
        match told.is_empty() {
            true => Ok(()),
            false => Err(format!("--engine {} does not take {}", self.engine.name(), told.join(", "))),
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        args: SubmitArgs,
    }

    pub(in crate::submit) fn parsed(engine: &str, more: &[&str]) -> Result<SubmitArgs, String> {
        let line = ["submit", "--engine", engine, "--config", "a.toml", "--store", "/data/a"];
        let all = line.iter().chain(more);
        Line::try_parse_from(all).map(|line| line.args).map_err(|e| e.to_string())
    }

    #[test]
    fn engines_take_their_own_options() {
        let all: [(&str, &[&str]); 3] = [
            (
                "slurm",
                &[
                    "--partition",
                    "cpu",
                    "--option",
                    "--account=lab",
                    "--largest-array",
                    "9",
                    "--at-once",
                    "2",
                ],
            ),
            (
                "kubernetes",
                &[
                    "--image",
                    "a",
                    "--namespace",
                    "b",
                    "--secret",
                    "c",
                    "--volume-claim",
                    "d",
                    "--parallelism",
                    "2",
                ],
            ),
            ("ray", &["--address", "local", "--program", "convoy", "--split", "render-sensors=gpu"]),
        ];
        let mut refused = Vec::new();
        for (engine, own) in all {
            parsed(engine, own).expect("is good").check_engine().expect("are its own");
            for (other, foreign) in all {
                let image: &[&str] = if engine == "kubernetes" { &["--image", "a"] } else { &[] };
                if other != engine {
                    let both = [foreign, image].concat();
                    refused.push(
                        parsed(engine, &both).expect("is good").check_engine().expect_err("are others'"),
                    );
                }
            }
        }
        insta::assert_snapshot!(refused.join("\n"), @"
        --engine slurm does not take --image (of kubernetes), --namespace (of kubernetes), --secret (of kubernetes), --volume-claim (of kubernetes)
        --engine slurm does not take --address (of ray), --program (of ray)
        --engine kubernetes does not take --partition (of slurm), --option (of slurm), --largest-array (of slurm)
        --engine kubernetes does not take --address (of ray), --program (of ray)
        --engine ray does not take --at-once (of slurm and kubernetes), --partition (of slurm), --option (of slurm), --largest-array (of slurm)
        --engine ray does not take --at-once (of slurm and kubernetes), --image (of kubernetes), --namespace (of kubernetes), --secret (of kubernetes), --volume-claim (of kubernetes)
        ");
        assert!(parsed("kubernetes", &[]).expect_err("lacks the image").contains("--image"));
    }
}
