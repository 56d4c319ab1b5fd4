//! Runs all stages in order, shows their state, verifies a store.

fn main() -> std::process::ExitCode {
    pipeline::drive()
}
