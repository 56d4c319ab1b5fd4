//! Progress of a scene: a bar on a terminal, plain lines elsewhere.

use std::io::IsTerminal;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::error::StageError;
use crate::{ProgressMode, interrupt};

const PLAIN_PERIOD: Duration = Duration::from_secs(10);

/// Progress of one piece of work, from any thread; it also tells a loop when to stop. Clones are the same
/// progress.
#[derive(Clone)]
pub struct Progress {
    kind: Arc<Kind>,
    label: Arc<str>,
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
}

impl Progress {
    /// Starts with an amount of work that may be corrected later.
    #[must_use]
    pub fn start(mode: ProgressMode, label: String, total: u64) -> Self {
        let mode = match mode {
            ProgressMode::Auto if std::io::stderr().is_terminal() => ProgressMode::Bar,
            ProgressMode::Auto => ProgressMode::Plain,
            mode => mode,
        };
        let kind = match mode {
            ProgressMode::None => Kind::Silent,
            ProgressMode::Bar | ProgressMode::Auto => {
                let bar = ProgressBar::new(total);
                let style = ProgressStyle::with_template("{prefix} [{wide_bar}] {pos}/{len} {eta}");
                bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
                bar.set_prefix(label.clone());
                Kind::Bar(bar)
            }
            ProgressMode::Plain => Kind::Plain(Mutex::new(Plain { done: 0, total, spoke: Instant::now() })),
        };
        Self { kind: Arc::new(kind), label: label.into() }
    }

    /// Sets the amount of work.
    pub fn set_total(&self, total: u64) {
        match &*self.kind {
            Kind::Bar(bar) => bar.set_length(total),
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

    fn count(&self, amount: u64) {
        match &*self.kind {
            Kind::Bar(bar) => bar.inc(amount),
            Kind::Plain(plain) => {
                let Ok(mut plain) = plain.lock() else { return };
                plain.done += amount;
                if plain.spoke.elapsed() >= PLAIN_PERIOD {
                    plain.spoke = Instant::now();
                    tracing::info!("{}: {}/{}", self.label, plain.done, plain.total);
                }
            }
            Kind::Silent => {}
        }
    }

    /// Takes a bar off the terminal.
    pub fn finish(&self) {
        if let Kind::Bar(bar) = &*self.kind {
            bar.finish_and_clear();
        }
    }
}
