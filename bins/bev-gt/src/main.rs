//! Draws bird's-eye-view masks from the log.

fn main() -> std::process::ExitCode {
    arguments::stage::run(bev_gt::STAGE, build_stamp::STAMP)
}
