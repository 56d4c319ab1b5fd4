//! Runs all stages in order, shows their state, verifies, checks and shows a store; writes towns, draws maps
//! and scenes.

mod configs;
mod demo;
mod doctor;
mod files;
mod film;
mod maps;
mod programs;
mod shell;
mod stores;
mod submit;
mod suggestion;
mod words;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use film::FilmCommand;
use maps::MapCommand;
use stores::StoreCommand;

/// Makes V2X cooperative-perception datasets.
#[derive(Debug, Parser)]
#[command(
    name = "convoy",
    version,
    after_help = "Begin with `convoy demo`. Stages are commands, too: `convoy render-sensors --help`."
)]
struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Makes a tiny dataset, in half a minute, and says how to look at it and open it. Needs no
    /// configuration.
    Demo(demo::DemoArgs),
    #[command(flatten)]
    Store(StoreCommand),
    /// Lists and prints the configurations that come with this program.
    #[command(subcommand)]
    Config(configs::ConfigCommand),
    /// Says what this machine has (cores, memory, disk, GPU, Python packages, ffmpeg) and what each enables.
    Doctor(doctor::DoctorArgs),
    /// Writes the scripts that make a dataset on a cluster, and sends them on demand.
    Submit(submit::SubmitArgs),
    /// Checks the labels of a store against each other, from its files alone. Exit codes: 0 all is there and
    /// nothing is wrong, 1 something is wrong, 2 no such store or bad arguments, 3 nothing is wrong in what
    /// is there, but the store is unfinished.
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

/// The program: its words in, of which the first is its name as it was typed, its exit code out.
#[must_use]
pub fn program(words: Vec<OsString>) -> ExitCode {
    if let Some(code) = programs::run_stage(&words) {
        return ExitCode::from(code);
    }
    let command = Args::command().version(runner::release(build_stamp::STAMP));
    let known: Vec<String> = command.get_subcommands().map(|known| known.get_name().to_owned()).collect();
    let matches = command.try_get_matches_from(words);
    let args = matches.and_then(|matches| Args::from_arg_matches(&matches));
    let args = args.unwrap_or_else(|e| suggestion::with(e, &known).exit());
    runner::init_logging();
    ExitCode::from(match args.command {
        Command::Demo(args) => demo::run(args, build_stamp::STAMP),
        Command::Config(command) => configs::run(&command),
        Command::Doctor(args) => doctor::run(&args),
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
