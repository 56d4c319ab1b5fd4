//! Exports a finished store in the layouts that other people's loaders read.

fn main() -> std::process::ExitCode {
    export::program(std::env::args_os().collect())
}
