//! Adds up the partial counts into tables, figures and a report.

fn main() -> std::process::ExitCode {
    stats::program(std::env::args_os().collect())
}
