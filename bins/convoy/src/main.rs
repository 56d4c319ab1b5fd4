//! Runs all stages in order, shows their state, verifies, checks and shows a store; writes towns, draws maps
//! and scenes.

mod files;
mod film;
mod maps;
mod programs;
mod shell;
mod stores;
mod submit;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};
use film::FilmCommand;
use maps::MapCommand;
use stores::StoreCommand;

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
    /// Writes the scripts that make a dataset on a cluster, and sends them on demand.
    Submit(submit::SubmitArgs),
    /// Checks the labels of a store against each other, from its files alone; exit code 1 when something is
    /// wrong.
    Check(check::CheckArgs),
    /// Shows a store in the browser: opens a page on this machine that plays its scenes, or writes an excerpt
    /// as one file.
    View(view::ViewArgs),
    #[command(flatten)]
    Program(programs::ProgramCommand),
    #[command(flatten)]
    Map(MapCommand),
    #[command(flatten)]
    Film(FilmCommand),
    #[command(flatten)]
    Shell(shell::ShellCommand),
}

fn main() -> ExitCode {
    let args = Args::parse();
    runner::init_logging();
    ExitCode::from(match args.command {
        Command::Store(command) => stores::drive(command, build_stamp::STAMP),
        Command::Submit(args) => submit::run(&args, build_stamp::STAMP),
        Command::Check(args) => check::run(&args),
        Command::Program(command) => programs::run(command),
        Command::View(args) => view::run(&args),
        Command::Map(command) => maps::run(command),
        Command::Film(command) => film::run(command),
        Command::Shell(command) => shell::run(command, programs::explained(Args::command())),
    })
}
