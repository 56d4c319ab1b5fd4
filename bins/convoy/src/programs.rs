//! Programs of their own that `convoy` starts: what is behind their name is theirs.

use std::ffi::OsString;
use std::os::unix::process::CommandExt;

use clap::{CommandFactory, Subcommand};
use runner::{EXIT_SOME_FAILED, EXIT_USAGE, Graph};

/// Programs beside this one.
#[derive(Debug, Subcommand)]
pub(crate) enum ProgramCommand {
    /// Exports a finished store in a layout that other people's loaders read.
    #[command(disable_help_flag = true)]
    Export(Rest),
    /// Makes a store of a dataset in another layout.
    #[command(disable_help_flag = true)]
    Import(Rest),
    /// Scores predicted boxes against a finished store by SimBEV2X's and nuScenes' metrics.
    #[command(disable_help_flag = true)]
    Evaluate(Rest),
    /// Draws sensor data and labels: one file a picture.
    #[command(disable_help_flag = true)]
    Viz(Rest),
    /// Draws a contact sheet of a frame as an agent has it: cameras, lidar, masks, voxels, map.
    #[command(disable_help_flag = true)]
    Preview(Rest),
    /// Draws a scene as an agent sees it, as an animated PNG, and as MP4 where there is an ffmpeg.
    #[command(disable_help_flag = true)]
    Film(Rest),
}

/// Arguments that are handed on as they are.
#[derive(Debug, clap::Args)]
pub(crate) struct Rest {
    /// What the program takes; --help lists it.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "ARGUMENTS")]
    arguments: Vec<OsString>,
}

/// `convoy` as shells and manual pages are told of it: the commands that start programs with what these take.
pub(crate) fn explained(convoy: clap::Command) -> clap::Command {
    let programs = arguments::commands().into_iter().chain([export_core::command::Export::command()]);
    programs.fold(convoy, |convoy, program| {
        let name = program.get_name().to_owned();
        convoy.mut_subcommand(name, |_| program)
    })
}

/// Runs a program to its end; its exit code.
pub(crate) fn run(command: ProgramCommand) -> u8 {
    let (program, command, Rest { arguments }) = match command {
        ProgramCommand::Export(rest) => ("export", "export", rest),
        ProgramCommand::Import(rest) => ("import", "import", rest),
        ProgramCommand::Evaluate(rest) => ("evaluate", "evaluate", rest),
        ProgramCommand::Viz(rest) => ("viz", "viz", rest),
        ProgramCommand::Preview(rest) => ("viz", "preview", rest),
        ProgramCommand::Film(rest) => ("viz", "film", rest),
    };
    hand_over(program, command, &arguments)
}

/// Runs a stage where the first word names one (`convoy bev-gt` is `bev-gt`); its exit code.
pub(crate) fn run_stage(words: &[OsString]) -> Option<u8> {
    let (_, words) = words.split_first()?;
    let (first, rest) = words.split_first()?;
    let stage = Graph::get().stage(first.to_str()?)?;
    runner::init_logging();
    Some(hand_over(stage.name, stage.name, rest))
}

/// Runs a program that calls itself by the command that was typed.
fn hand_over(program: &str, typed: &str, arguments: &[OsString]) -> u8 {
    // A signal reaches the program, too, and it is the one to answer.
    runner::listen_for_signals();
    let status = runner::program_beside(program)
        .and_then(|mut command| command.arg0(format!("convoy {typed}")).args(arguments).status());
    match status {
        Ok(status) => status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or(EXIT_SOME_FAILED),
        Err(e) => {
            tracing::error!("{program}: cannot be started: {e} (build all programs: cargo build --release)");
            EXIT_USAGE
        }
    }
}
