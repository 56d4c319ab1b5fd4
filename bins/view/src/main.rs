//! Shows a store in the browser.

use std::process::ExitCode;

use clap::Parser;

/// Shows a store in the browser: opens a page on this machine that plays its scenes. Nothing is written,
/// nothing leaves the machine.
#[derive(Debug, Parser)]
#[command(name = "view", version)]
struct Args {
    #[command(flatten)]
    view: view::ViewArgs,
}

fn main() -> ExitCode {
    ExitCode::from(view::run(&Args::parse().view))
}
