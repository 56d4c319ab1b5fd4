//! Draws bird's-eye-view masks from the log.

fn main() -> std::process::ExitCode {
    bev_gt::program(std::env::args_os().collect())
}
