//! Draws bird's-eye-view masks from the log.

fn main() -> std::process::ExitCode {
    pipeline::run_stage(bev_gt::STAGE, build_stamp::STAMP)
}
