//! Checks the labels of a finished store against each other.

use std::process::ExitCode;

use clap::Parser;

/// Checks the labels of a finished store against each other, from its files alone; exit code 1 when something
/// is wrong.
#[derive(Debug, Parser)]
#[command(name = "check", version)]
struct Args {
    #[command(flatten)]
    check: check::CheckArgs,
}

fn main() -> ExitCode {
    ExitCode::from(check::run(&Args::parse().check))
}
