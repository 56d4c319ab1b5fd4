//! Runs all stages in order, shows their state, verifies and checks a store; writes towns, draws maps and scenes.

mod files;
mod film;
mod maps;
mod programs;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use driver::StoreCommand;
use film::FilmCommand;
use maps::MapCommand;

/// Makes V2X cooperative-perception datasets.
#[derive(Debug, Parser)]
#[command(name = "convoy", version)]
struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    #[command(flatten)]
    Store(StoreCommand),
    /// Checks the labels of a store against each other, from its files alone; exit code 1 when something is wrong.
    Check(check::CheckArgs),
    #[command(flatten)]
    Program(programs::ProgramCommand),
    #[command(flatten)]
    Map(MapCommand),
    #[command(flatten)]
    Film(FilmCommand),
}

fn main() -> ExitCode {
    let args = Args::parse();
    pipeline::init_logging();
    ExitCode::from(match args.command {
        Command::Store(command) => driver::drive(command),
        Command::Check(args) => check::run(&args),
        Command::Program(command) => programs::run(command),
        Command::Map(command) => maps::run(command),
        Command::Film(command) => film::run(command),
    })
}
