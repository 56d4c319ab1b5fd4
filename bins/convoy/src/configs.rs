//! The configurations that come with this program.

use std::io::{ErrorKind, Write};

use clap::Subcommand;
use runner::say;
use settings::Shipped;

use crate::files::{Fault, exit_code};

/// Commands about the configurations that come with this program.
#[derive(Debug, Subcommand)]
pub(crate) enum ConfigCommand {
    /// Lists them, with what each makes.
    List,
    /// Prints one: `convoy config show demo > my.toml`.
    Show {
        /// Its name, such as demo or rigs/nuscenes.
        name: String,
    },
}

/// Runs a command; its exit code.
pub(crate) fn run(command: &ConfigCommand) -> u8 {
    match command {
        ConfigCommand::List => {
            list();
            runner::EXIT_DONE
        }
        ConfigCommand::Show { name } => exit_code(show(name)),
    }
}

fn list() {
    let width = Shipped::all().iter().map(|shipped| shipped.name.len()).max().unwrap_or(0);
    let line = |shipped: &Shipped| say(&format!("  {:<width$}  {}", shipped.name, shipped.about()));
    let (rigs, datasets): (Vec<&Shipped>, Vec<&Shipped>) =
        Shipped::all().iter().partition(|shipped| shipped.is_rig());
    say("Datasets (convoy run --config NAME, or convoy config show NAME > my.toml and change it):");
    datasets.into_iter().for_each(line);
    say("Sensors of an agent, for a configuration to name (rig = \"FILE\"):");
    rigs.into_iter().for_each(line);
}

fn show(name: &str) -> Result<(), Fault> {
    let plain = name.strip_suffix(".toml").unwrap_or(name);
    let shipped = Shipped::named(plain).ok_or_else(|| {
        let names: Vec<&str> = Shipped::all().iter().map(|shipped| shipped.name).collect();
        Fault::Usage(format!("no configuration is called `{name}`; there are {}", names.join(", ")))
    })?;
    match std::io::stdout().write_all(shipped.text.as_bytes()) {
        // `convoy config show demo | head`
        Err(closed) if closed.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => written.map_err(|source| Fault::Write { path: "standard output".into(), source }),
    }
}
