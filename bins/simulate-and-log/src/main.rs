//! Simulates the scenes and writes their logs, raw boxes and HD-map records.

fn main() -> std::process::ExitCode {
    pipeline::run_stage(simulate_and_log::STAGE, build_stamp::STAMP)
}
