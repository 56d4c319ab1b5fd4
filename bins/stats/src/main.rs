//! Adds up the partial counts into tables, figures and a report.

fn main() -> std::process::ExitCode {
    pipeline::run_stage(stats::STAGE, build_stamp::STAMP)
}
