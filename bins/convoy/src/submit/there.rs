//! Whether an engine is there to send jobs to.

use std::process::{Command, Output};

use super::args::{Engine, SubmitArgs};

/// Refuses where the engine is not there, or does not take such jobs: before anything is written.
pub(super) fn check(args: &SubmitArgs) -> Result<(), String> {
    match args.engine {
        Engine::Slurm => slurm(args),
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

/// Looks for the partitions.
fn slurm(args: &SubmitArgs) -> Result<(), String> {
    let known = output(Command::new("sinfo").args(["-h", "-o", "%R"]), "is this a node of Slurm?")?;
    if !known.status.success() {
        return Err(format!("--submit: Slurm does not answer: {}", said(&known)));
    }
    let known: Vec<String> =
        String::from_utf8_lossy(&known.stdout).lines().map(|line| line.trim().to_owned()).collect();
    let wanted = args.partition.iter().chain(args.split.iter().map(|split| &split.place));
    match wanted.into_iter().find(|wanted| !known.contains(wanted)) {
        Some(unknown) => Err(format!("there is no partition `{unknown}`; there are {}", known.join(", "))),
        None => Ok(()),
    }
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
            Err(format!("--submit: {python} has no Ray or no convoy-data (PYTHON names another one): {last}"))
        }
    }
}
