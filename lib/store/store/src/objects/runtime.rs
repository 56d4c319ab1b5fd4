//! The asynchronous edge: stages stay synchronous, and each request is waited for here.

use std::future::Future;
use std::io;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use tokio::runtime::Runtime;
use tokio::task::JoinHandle;

use super::failure::Failure;

/// What drives all requests of this process.
fn runtime() -> io::Result<&'static Runtime> {
    static RUNTIME: OnceLock<Result<Runtime, String>> = OnceLock::new();
    let made = RUNTIME.get_or_init(|| {
        let mut builder = tokio::runtime::Builder::new_multi_thread();
        builder.worker_threads(2).thread_name("requests").enable_all().build().map_err(|e| e.to_string())
    });
    made.as_ref().map_err(|problem| io::Error::other(format!("cannot start threads: {problem}")))
}

/// Chooses who encrypts. Clients cannot be made before.
pub(super) fn choose_encryption() {
    // There may be one already: then it is as good.
    let _ = rustls::crypto::ring::default_provider().install_default();
}

/// Waits for a request.
///
/// # Errors
/// Its own, or threads cannot be started.
pub(super) fn wait<T, E: From<io::Error>>(request: impl Future<Output = Result<T, E>>) -> Result<T, E> {
    runtime()?.block_on(request)
}

/// For how long a request is repeated, seconds, where `CONVOY_RETRY_S` says nothing else. With the last one,
/// which is given up after a minute, three minutes in all.
const RETRIED_S: u64 = 110;

/// For how long a request is repeated.
pub(super) fn patience() -> Duration {
    let told = std::env::var("CONVOY_RETRY_S").ok().and_then(|text| text.parse().ok());
    Duration::from_secs(told.unwrap_or(RETRIED_S))
}

/// How often is read again what broke off.
const READS: u32 = 4;
/// A request that takes longer than this was repeated by the client already.
const SHORT: Duration = Duration::from_secs(5);

/// Makes a request that only reads, again and again while it fails soon: the client repeats what a service
/// refuses, but not what breaks off in the middle of an answer.
pub(super) async fn read<T, R>(request: impl Fn() -> R) -> Result<T, Failure>
where
    R: Future<Output = Result<T, Failure>>,
{
    let mut tried = 1;
    loop {
        let start = Instant::now();
        match request().await {
            Err(Failure::Away(_)) if tried < READS && start.elapsed() < SHORT.min(patience()) => {
                tokio::time::sleep(Duration::from_millis(100) * tried).await;
                tried += 1;
            }
            answer => return answer,
        }
    }
}

/// Starts a request that nobody waits for yet.
///
/// # Errors
/// Threads cannot be started.
pub(super) fn start<T: Send + 'static>(
    request: impl Future<Output = T> + Send + 'static,
) -> io::Result<JoinHandle<T>> {
    Ok(runtime()?.spawn(request))
}
