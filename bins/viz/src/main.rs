//! Pictures, contact sheets and films of the scenes of a finished store.

fn main() -> std::process::ExitCode {
    viz::program(std::env::args_os().collect())
}
