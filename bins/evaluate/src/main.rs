//! Scores predicted boxes and BEV masks against a finished store.

fn main() -> std::process::ExitCode {
    evaluate::program(std::env::args_os().collect())
}
