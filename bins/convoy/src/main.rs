//! The program that people type.

fn main() -> std::process::ExitCode {
    convoy::program(std::env::args_os().collect())
}
