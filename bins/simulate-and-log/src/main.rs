//! Simulates the scenes and writes their logs, raw boxes and HD-map records.

fn main() -> std::process::ExitCode {
    simulate_and_log::program(std::env::args_os().collect())
}
