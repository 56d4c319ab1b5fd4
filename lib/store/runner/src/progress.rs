//! Progress of a scene: a bar on a terminal, plain lines elsewhere.

use std::io::IsTerminal;
use std::sync::{Arc, Mutex, OnceLock};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::error::StageError;
use crate::pace::{Pace, Seen};
use crate::{ProgressMode, interrupt};

const PLAIN_PERIOD: Duration = Duration::from_secs(10);

/// Progress of one piece of work, from any thread; it also tells a loop when to stop. Clones are the same
/// progress.
#[derive(Clone)]
pub struct Progress {
    kind: Arc<Kind>,
    label: Arc<str>,
    pace: Pace,
    /// The first step: when it was done, and how much was done then.
    first: Arc<OnceLock<(Instant, u64)>>,
}

enum Kind {
    Bar(ProgressBar),
    Plain(Mutex<Plain>),
    Silent,
}

struct Plain {
    done: u64,
    total: u64,
    spoke: Instant,
    /// What was done when it spoke last; nothing if it has not.
    said: Option<u64>,
}

impl Plain {
    /// What is to be said after so long a silence; `words` say how fast it goes.
    fn line(&mut self, period: Duration, words: impl Fn(u64, u64) -> String) -> Option<String> {
        if self.spoke.elapsed() < period {
            return None;
        }
        self.spoke = Instant::now();
        self.said = Some(self.done);
        Some(match self.total {
            0 => self.done.to_string(),
            total => format!("{}/{total}{}", self.done, words(self.done, total)),
        })
    }

    /// The last line, where there were some and the last one is old.
    fn last_line(&mut self) -> Option<String> {
        if self.said.is_some_and(|said| said != self.done) {
            self.line(Duration::ZERO, |_, _| String::new())
        } else {
            None
        }
    }
}

impl Progress {
    /// Starts with an amount of work that may be corrected later.
    #[must_use]
    pub fn start(mode: ProgressMode, label: String, total: u64) -> Self {
        Self::of_piece(mode, label, total, Pace::of(1))
    }

    /// Starts one of several pieces of work.
    pub(crate) fn of_piece(mode: ProgressMode, label: String, total: u64, pace: Pace) -> Self {
        let label = label + &pace.place();
        let mode = match mode {
            ProgressMode::Auto if std::io::stderr().is_terminal() => ProgressMode::Bar,
            ProgressMode::Auto => ProgressMode::Plain,
            mode => mode,
        };
        let kind = match mode {
            ProgressMode::None => Kind::Silent,
            ProgressMode::Bar | ProgressMode::Auto => {
                let bar = ProgressBar::new(total);
                bar.set_style(style_of(total));
                bar.set_prefix(label.clone());
                Kind::Bar(bar)
            }
            ProgressMode::Plain => {
                Kind::Plain(Mutex::new(Plain { done: 0, total, spoke: Instant::now(), said: None }))
            }
        };
        Self { kind: Arc::new(kind), label: label.into(), pace, first: Arc::default() }
    }

    /// Sets the amount of work.
    pub fn set_total(&self, total: u64) {
        match &*self.kind {
            Kind::Bar(bar) => {
                bar.set_length(total);
                bar.set_style(style_of(total));
            }
            Kind::Plain(plain) => {
                if let Ok(mut plain) = plain.lock() {
                    plain.total = total;
                }
            }
            Kind::Silent => {}
        }
    }

    /// Counts work done.
    ///
    /// # Errors
    /// A signal came: drop what is in hand and return.
    pub fn advance(&self, amount: u64) -> Result<(), StageError> {
        self.count(amount);
        if interrupt::stopped() { Err(StageError::Stopped) } else { Ok(()) }
    }

    /// How fast it goes and how long all pieces take.
    fn words(&self, done: u64, total: u64) -> String {
        let Some(&(at, first)) = self.first.get() else { return String::new() };
        self.pace.words(Seen { done, total, first, since: at.elapsed() })
    }

    /// Remembers the first step.
    fn begin(&self, done: u64) {
        if done > 0 {
            self.first.get_or_init(|| (Instant::now(), done));
        }
    }

    fn count(&self, amount: u64) {
        match &*self.kind {
            Kind::Bar(bar) => {
                bar.inc(amount);
                self.begin(bar.position());
                bar.set_message(self.words(bar.position(), bar.length().unwrap_or(0)));
            }
            Kind::Plain(plain) => {
                let Ok(mut plain) = plain.lock() else { return };
                plain.done += amount;
                self.begin(plain.done);
                if let Some(line) = plain.line(PLAIN_PERIOD, |done, total| self.words(done, total)) {
                    tracing::info!("{}: {line}", self.label);
                }
            }
            Kind::Silent => {}
        }
    }

    /// Takes a bar off the terminal; lines end with what was done at last.
    pub fn finish(&self) {
        match &*self.kind {
            Kind::Bar(bar) => bar.finish_and_clear(),
            Kind::Plain(plain) => {
                if let Some(line) = plain.lock().ok().and_then(|mut plain| plain.last_line()) {
                    tracing::info!("{}: {line}", self.label);
                }
            }
            Kind::Silent => {}
        }
    }
}

/// How a bar looks: none is drawn where nobody knows how much there is to do, which would be a full one.
fn style_of(total: u64) -> ProgressStyle {
    let template = match total {
        0 => "{prefix} ... {elapsed}",
        _ => "{prefix} [{wide_bar}] {pos}/{len}{msg}",
    };
    let style = ProgressStyle::with_template(template);
    style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_with_what_was_done_at_last() {
        let mut plain = Plain { done: 176, total: 240, spoke: Instant::now(), said: None };
        let fast = |done: u64, total: u64| format!(", {} to go", total - done);
        assert_eq!(plain.line(PLAIN_PERIOD, fast), None);
        assert_eq!(plain.last_line(), None, "it ended before its first line");
        assert_eq!(plain.line(Duration::ZERO, fast).as_deref(), Some("176/240, 64 to go"));
        assert_eq!(plain.last_line(), None, "that is said already");
        plain.done = 240;
        assert_eq!(plain.last_line().as_deref(), Some("240/240"));
    }
}
