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
/// How soon is noticed that it is gone, or that a signal came.
const LOOK_EVERY: Duration = Duration::from_millis(500);

/// Signals within this time are one: a scheduler signals all processes of a task, and who started this one
/// passes it on.
const AT_ONCE: Duration = Duration::from_secs(2);

static STOP: LazyLock<Arc<AtomicBool>> = LazyLock::new(|| Arc::new(AtomicBool::new(false)));

/// Starts to listen. A second signal, two seconds after the first or later, ends the process at once.
pub fn listen() {
    store::hurry_when(stopped);
    let is_long_ago = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGTERM, signal_hook::consts::SIGINT] {
        // Without handlers a signal simply kills the process, which the store survives.
        let _ = signal_hook::flag::register_conditional_shutdown(
            signal,
            crate::EXIT_TRY_AGAIN.into(),
            is_long_ago.clone(),
        );
        let _ = signal_hook::flag::register(signal, STOP.clone());
    }
    let parent = std::env::var(PARENT).ok().and_then(|number| number.parse::<u32>().ok());
    // Without the thread it goes on alone, which the store survives.
    let _ = thread::Builder::new().name("signals".to_owned()).spawn(move || {
        while !stopped() {
            if parent.is_some_and(|parent| parent_id() != parent) {
                tracing::warn!("the program that started this one is gone: this one stops, too");
                stop();
            }
            thread::sleep(LOOK_EVERY);
        }
        thread::sleep(AT_ONCE);
        is_long_ago.store(true, Ordering::Relaxed);
    });
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
