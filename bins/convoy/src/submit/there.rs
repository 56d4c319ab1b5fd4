//! Whether an engine is there to send jobs to.

use std::process::{Command, Output};

use super::args::{Engine, SubmitArgs};
use super::size::counted;

/// Refuses where the engine is not there, or does not take such jobs: before anything is written. Where
/// nothing is sent, scripts may be meant for another cluster: then what Slurm says here is a warning.
pub(super) fn check(args: &SubmitArgs) -> Result<(), String> {
    match args.engine {
        Engine::Slurm if args.submit => slurm(args),
        Engine::Slurm => {
            if let Some(Err(problem)) = places().ok().map(|places| fit(args, &places)) {
                tracing::warn!("of the Slurm that answers here: {problem}");
            }
            Ok(())
        }
        _ if !args.submit => Ok(()),
        Engine::Kubernetes => kubernetes(args),
        Engine::Ray => ray(),
    }
}

fn output(command: &mut Command, hint: &str) -> Result<Output, String> {
    let program = command.get_program().display().to_string();
    command.output().map_err(|e| format!("--submit: {program} cannot be started ({e}): {hint}"))
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).trim().to_owned()
}

/// Nodes of one kind in a partition.
#[derive(Clone, Debug, PartialEq)]
struct Nodes {
    partition: String,
    is_default: bool,
    cores: u32,
    memory_mib: u64,
}

impl Nodes {
    /// A line of `sinfo -h -e -o '%R|%P|%c|%m'`. Numbers of unlike nodes end with `+`.
    fn parse(line: &str) -> Option<Self> {
        let mut fields = line.trim().split('|');
        let (partition, marked) = (fields.next()?.to_owned(), fields.next()?);
        let mut number = || fields.next()?.trim_end_matches('+').parse::<u64>().ok();
        let cores = u32::try_from(number()?).ok()?;
        Some(Self { partition, is_default: marked.ends_with('*'), cores, memory_mib: number()? })
    }
}

/// Looks for the partitions, and for nodes in them that are large enough.
fn slurm(args: &SubmitArgs) -> Result<(), String> {
    fit(args, &places()?)
}

/// What Slurm has.
fn places() -> Result<Vec<Nodes>, String> {
    let mut sinfo = Command::new("sinfo");
    let known = output(sinfo.args(["-h", "-e", "-o", "%R|%P|%c|%m"]), "is this a node of Slurm?")?;
    if !known.status.success() {
        return Err(format!("--submit: Slurm does not answer: {}", said(&known)));
    }
    Ok(String::from_utf8_lossy(&known.stdout).lines().filter_map(Nodes::parse).collect())
}

/// Whether each array has a partition, and that a node for a task; what would do.
fn fit(args: &SubmitArgs, places: &[Nodes]) -> Result<(), String> {
    let splits = args.split.iter().map(|split| Some(&split.place));
    for wanted in std::iter::once(args.partition.as_ref()).chain(splits) {
        let in_place = |nodes: &&Nodes| wanted.map_or(nodes.is_default, |name| *name == nodes.partition);
        let mut nodes: Vec<&Nodes> = places.iter().filter(in_place).collect();
        let Some(wanted) = wanted.or(nodes.first().map(|nodes| &nodes.partition)) else {
            // No partition is the one that is taken where none is named: the site knows better.
            continue;
        };
        if nodes.is_empty() {
            let mut known: Vec<&str> = places.iter().map(|nodes| nodes.partition.as_str()).collect();
            known.dedup();
            return Err(format!("there is no partition `{wanted}`; there are {}", known.join(", ")));
        }
        let memory_gib = args.memory_gib();
        let is_enough =
            |nodes: &&Nodes| nodes.cores >= args.cores && nodes.memory_mib >= u64::from(memory_gib) << 10;
        if !nodes.iter().any(is_enough) {
            nodes.sort_by_key(|nodes| (nodes.cores, nodes.memory_mib));
            let largest = nodes.last().map_or(String::new(), |largest| {
                let (cores, gib) = (largest.cores.min(args.cores), largest.memory_mib >> 10);
                let memory = u64::from(memory_gib).min(gib);
                format!(
                    "the largest have {} and {gib} GiB: give --cores {cores} --memory {memory}",
                    counted(largest.cores, "core")
                )
            });
            return Err(format!(
                "no node of partition `{wanted}` has {} and {memory_gib} GiB; {largest}",
                counted(args.cores, "core")
            ));
        }
    }
    Ok(())
}

/// Asks whether Jobs may be made in the namespace.
fn kubernetes(args: &SubmitArgs) -> Result<(), String> {
    let mut command = Command::new("kubectl");
    command.args(["auth", "can-i", "create", "jobs.batch", "--request-timeout=20s"]);
    command.args(args.namespace.iter().map(|namespace| format!("--namespace={namespace}")));
    let answer = output(&mut command, "it sends the Jobs")?;
    match (answer.status.success(), said(&answer)) {
        (true, _) => Ok(()),
        (false, why) if why.is_empty() => {
            Err("--submit: the cluster lets no Jobs be made here (kubectl auth can-i create jobs.batch)"
                .to_owned())
        }
        (false, why) => Err(format!("--submit: kubectl has no cluster that answers: {why}")),
    }
}

/// Looks for the driver.
fn ray() -> Result<(), String> {
    let python = std::env::var_os("PYTHON").filter(|python| !python.is_empty()).unwrap_or("python3".into());
    let mut command = Command::new(&python);
    let found = output(command.args(["-c", "import ray, convoy.ray"]), "PYTHON names another interpreter")?;
    match found.status.success() {
        true => Ok(()),
        false => {
            let why = said(&found);
            let python = python.display();
            let last = why.lines().last().unwrap_or("it ended early");
            Err(format!(
                "--submit: {python} has no Ray or no package `convoy` (PYTHON names another one): {last}"
            ))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::args::tests::parsed;
    use super::*;

    #[test]
    fn tasks_need_a_partition_with_a_node_that_is_large_enough() {
        let told = "cpu|cpu*|64|257000\ncpu|cpu*|16|64000+\nsmall|small|2|3900\nstrange\n";
        let places: Vec<Nodes> = told.lines().filter_map(Nodes::parse).collect();
        assert_eq!(places.len(), 3);
        let said = |more: &str| {
            let args = parsed("slurm", &more.split_whitespace().collect::<Vec<_>>()).expect("is good");
            fit(&args, &places).err().unwrap_or_default()
        };
        assert_eq!(
            ["", "--cores 64 --memory 200", "--partition small --cores 2 --memory 3"].map(said),
            ["", "", ""]
        );
        let refused =
            ["--cores 65", "--partition small", "--split render-sensors=gpu", "--cores 64 --memory 300"];
        insta::assert_snapshot!(refused.map(said).join("\n"), @"
        no node of partition `cpu` has 65 cores and 67 GiB; the largest have 64 cores and 250 GiB: give --cores 64 --memory 67
        no node of partition `small` has 16 cores and 18 GiB; the largest have 2 cores and 3 GiB: give --cores 2 --memory 3
        there is no partition `gpu`; there are cpu, small
        no node of partition `cpu` has 64 cores and 300 GiB; the largest have 64 cores and 250 GiB: give --cores 64 --memory 250
        ");
    }
}
