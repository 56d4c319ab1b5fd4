//! What shells and `man` know of this program.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use clap::Subcommand;
use clap_complete::Shell;
use runner::say;

use crate::files::{Fault, exit_code};

/// Commands about this program itself.
#[derive(Debug, Subcommand)]
pub(crate) enum ShellCommand {
    /// Prints what a shell needs to complete the commands and options of this program.
    Completions {
        /// The shell.
        #[arg(value_enum)]
        shell: Shell,
    },
    /// Writes manual pages: one of this program and one of each command.
    Man {
        /// The folder; it is made if it is not there.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
}

/// Runs a command, for the program as `clap` knows it; its exit code.
pub(crate) fn run(command: ShellCommand, program: clap::Command) -> u8 {
    exit_code(match command {
        ShellCommand::Completions { shell } => completions(shell, program),
        ShellCommand::Man { folder } => manual(&folder, program),
    })
}

fn completions(shell: Shell, mut program: clap::Command) -> Result<(), Fault> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut program, "convoy", &mut script);
    match std::io::stdout().write_all(&script) {
        // `convoy completions bash | head`
        Err(closed) if closed.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => written.map_err(|source| Fault::Write { path: "standard output".into(), source }),
    }
}

fn manual(folder: &Path, program: clap::Command) -> Result<(), Fault> {
    let commands = program.get_subcommands().count();
    let io = |source| Fault::Write { path: folder.to_owned(), source };
    std::fs::create_dir_all(folder).map_err(io)?;
    clap_mangen::generate_to(program, folder).map_err(io)?;
    say(&format!(
        "{}: pages of this program and {commands} commands (man -l {0}/convoy.1)",
        folder.display()
    ));
    Ok(())
}
