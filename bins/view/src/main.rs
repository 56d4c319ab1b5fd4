//! Shows a store in the browser.

fn main() -> std::process::ExitCode {
    view::program(std::env::args_os().collect())
}
