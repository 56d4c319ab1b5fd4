//! A question to somebody at a terminal.

use std::io::{IsTerminal, Write};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use crate::error::StageError;
use crate::interrupt;

/// How soon a signal ends the wait.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// Asks whether finished work is to be made again, which some lines tell of. Where nobody is at a terminal
/// the answer is no.
///
/// # Errors
/// A signal came instead of an answer.
pub(crate) fn confirmed(lines: &[String]) -> Result<bool, StageError> {
    if !(std::io::stdin().is_terminal() && std::io::stderr().is_terminal()) {
        return Ok(false);
    }
    let mut out = std::io::stderr();
    let asked = out.write_all(question(lines).as_bytes());
    if asked.and_then(|()| out.flush()).is_err() {
        return Ok(false);
    }
    // Reading goes on after a signal: it waits in a thread of its own, which ends with the process.
    let (answers, answered) = channel();
    let listener = std::thread::Builder::new().spawn(move || {
        let mut answer = String::new();
        let read = std::io::stdin().read_line(&mut answer);
        let _ = answers.send(read.is_ok() && matches!(answer.trim(), "y" | "Y" | "yes"));
    });
    if listener.is_err() {
        return Ok(false);
    }
    loop {
        match answered.recv_timeout(LOOK_EVERY) {
            Ok(answer) => return Ok(answer),
            Err(RecvTimeoutError::Disconnected) => return Ok(false),
            Err(RecvTimeoutError::Timeout) if interrupt::stopped() => {
                // The line of the question ends here.
                let _ = writeln!(out);
                return Err(StageError::Stopped);
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}

fn question(lines: &[String]) -> String {
    let lines: String = lines.iter().map(|line| format!("{line}\n")).collect();
    format!("{lines}finished work would be made again: do it? [y/N] ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_question_follows_what_it_is_about() {
        let lines = ["makes again bev-gt: scene 0".to_owned(), "changed: bev.cells: 400 -> 200".to_owned()];
        insta::assert_snapshot!(question(&lines), @r"
        makes again bev-gt: scene 0
        changed: bev.cells: 400 -> 200
        finished work would be made again: do it? [y/N]
        ");
    }
}
