//! SIGTERM, SIGINT and the death of who started a stage: stop at the next frame.

use std::os::unix::process::parent_id;
use std::process::Command;
use std::sync::Arc;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

/// Number of the process that waits for this one, where it is to end with that.
const PARENT: &str = "CONVOY_PARENT";
/// How soon is noticed that it is gone.
const LOOK_EVERY: Duration = Duration::from_secs(1);

static STOP: LazyLock<Arc<AtomicBool>> = LazyLock::new(|| Arc::new(AtomicBool::new(false)));

/// Starts to listen. A second signal ends the process at once.
pub fn listen() {
    store::hurry_when(stopped);
    for signal in [signal_hook::consts::SIGTERM, signal_hook::consts::SIGINT] {
        // Without handlers a signal simply kills the process, which the store survives.
        let _ = signal_hook::flag::register_conditional_shutdown(
            signal,
            crate::EXIT_TRY_AGAIN.into(),
            STOP.clone(),
        );
        let _ = signal_hook::flag::register(signal, STOP.clone());
    }
    let parent = std::env::var(PARENT).ok().and_then(|number| number.parse::<u32>().ok());
    if let Some(parent) = parent {
        // Without the thread it goes on alone, which the store survives.
        let _ = thread::Builder::new().name("parent".to_owned()).spawn(move || {
            while parent_id() == parent {
                thread::sleep(LOOK_EVERY);
            }
            tracing::warn!("the program that started this one is gone: this one stops, too");
            stop();
        });
    }
}

/// Lets a program that this one starts stop when this one is killed: its engine may have started the task
/// anew, and cores that nobody counts would work on.
pub fn stops_with_this_one(command: &mut Command) -> &mut Command {
    command.env(PARENT, std::process::id().to_string())
}

/// Whether a signal came.
#[must_use]
pub fn stopped() -> bool {
    STOP.load(Ordering::Relaxed)
}

/// Stops as if a signal had come.
pub(crate) fn stop() {
    STOP.store(true, Ordering::Relaxed);
}
