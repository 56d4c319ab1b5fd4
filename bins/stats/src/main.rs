//! Adds up the partial counts into tables, figures and a report.

fn main() -> std::process::ExitCode {
    arguments::stage::run(stats::STAGE, build_stamp::STAMP)
}
