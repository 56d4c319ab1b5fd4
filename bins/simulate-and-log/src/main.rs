//! Simulates the scenes and writes their logs, raw boxes and HD-map records.

fn main() -> std::process::ExitCode {
    arguments::stage::run(simulate_and_log::STAGE, build_stamp::STAMP)
}
