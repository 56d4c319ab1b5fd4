//! Checks the labels of a finished store against each other.

fn main() -> std::process::ExitCode {
    check::program(std::env::args_os().collect())
}
