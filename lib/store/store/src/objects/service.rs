//! A service, and for how long it is waited for.
//!
//! Its client repeats what fails for some time. A service that stayed away for all of it is given little
//! more: a lock that is let go, or an upload that is given up, must not wait as long again.

use std::future::Future;
use std::io;
use std::pin::pin;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use object_store::ObjectStore;

use super::failure::Failure;
use super::runtime;

/// For how long a request is repeated, seconds, where `CONVOY_RETRY_S` says nothing else. With the last one,
/// which is given up after a minute, and what is tidied up after it, three minutes in all.
const RETRIED_S: u64 = 90;
/// For how long is still waited where a service is away, or this process is to stop.
const HURRIED: Duration = Duration::from_secs(10);
/// How often is looked whether there is a hurry.
const LOOK: Duration = Duration::from_millis(200);

/// How often is read again what broke off.
const READS: u32 = 4;
/// A request that takes longer than this was repeated by the client already.
const SHORT: Duration = Duration::from_secs(5);

/// For how long a request is repeated.
pub(super) fn patience() -> Duration {
    let told = std::env::var("CONVOY_RETRY_S").ok().and_then(|text| text.parse().ok());
    Duration::from_secs(told.unwrap_or(RETRIED_S))
}

/// Who is asked whether this process is to stop.
static IS_TO_STOP: OnceLock<fn() -> bool> = OnceLock::new();

/// Requests of this process take ten seconds more at most, once it is to stop. The first who asks for it is
/// heard.
pub fn hurry_when(is_to_stop: fn() -> bool) {
    let _ = IS_TO_STOP.set(is_to_stop);
}

/// A service. All requests are made by [`Service::wait`] or [`Service::within`].
#[derive(Debug)]
pub(super) struct Service {
    pub(super) client: Arc<dyn ObjectStore>,
    /// What was told last, if the last request was given up.
    away: Mutex<Option<(io::ErrorKind, String)>>,
    patience: Duration,
    hurried: Duration,
}

impl Service {
    pub(super) fn new(client: Arc<dyn ObjectStore>) -> Self {
        Self { client, away: Mutex::default(), patience: patience(), hurried: HURRIED }
    }

    /// Whether it was away for as long as is waited for it, and has not answered since.
    pub(super) fn is_away(&self) -> bool {
        self.away().is_some()
    }

    fn away(&self) -> MutexGuard<'_, Option<(io::ErrorKind, String)>> {
        self.away.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a request.
    pub(super) fn wait<T>(&self, request: impl Future<Output = Result<T, Failure>>) -> Result<T, Failure> {
        runtime::wait(self.within(request))
    }

    /// A request that is given up soon where there is a hurry.
    pub(super) async fn within<T>(
        &self,
        request: impl Future<Output = Result<T, Failure>>,
    ) -> Result<T, Failure> {
        self.within_unless(|| IS_TO_STOP.get().is_some_and(|is_to_stop| is_to_stop()), request).await
    }

    async fn within_unless<T>(
        &self,
        is_to_stop: impl Fn() -> bool,
        request: impl Future<Output = Result<T, Failure>>,
    ) -> Result<T, Failure> {
        let (start, mut hurried_since) = (Instant::now(), None);
        let mut request = pin!(request);
        loop {
            match tokio::time::timeout(LOOK, request.as_mut()).await {
                Ok(answer) => {
                    match &answer {
                        Err(Failure::Away(e)) if start.elapsed() >= self.patience => {
                            *self.away() = Some((e.kind(), e.to_string()));
                        }
                        // One that fails soon says little of those after it.
                        Err(Failure::Away(_)) => {}
                        _ => *self.away() = None,
                    }
                    return answer;
                }
                Err(_) if is_to_stop() || self.is_away() => {
                    let since = hurried_since.get_or_insert_with(Instant::now);
                    if since.elapsed() >= self.hurried {
                        let none =
                            || (io::ErrorKind::TimedOut, "stopped while it waited for an answer".to_owned());
                        let (kind, told) = self.away().get_or_insert_with(none).clone();
                        return Err(Failure::Away(io::Error::new(kind, told)));
                    }
                }
                Err(_) => hurried_since = None,
            }
        }
    }

    /// Makes a request that only reads, again and again while it fails soon: the client repeats what a
    /// service refuses, but not what breaks off in the middle of an answer.
    pub(super) async fn read<T, R>(&self, request: impl Fn() -> R) -> Result<T, Failure>
    where
        R: Future<Output = Result<T, Failure>>,
    {
        let mut tried = 1;
        loop {
            let start = Instant::now();
            match request().await {
                Err(Failure::Away(_)) if tried < READS && start.elapsed() < SHORT.min(self.patience) => {
                    tokio::time::sleep(Duration::from_millis(100) * tried).await;
                    tried += 1;
                }
                answer => return answer,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::future::{pending, ready};

    use object_store::memory::InMemory;

    use super::*;

    fn refused() -> Failure {
        Failure::Away(io::ErrorKind::ConnectionRefused.into())
    }

    #[test]
    fn who_was_waited_for_once_is_not_waited_for_as_long_again() {
        let short = Duration::from_millis(300);
        let service = Service { patience: short, hurried: short, ..Service::new(Arc::new(InMemory::new())) };
        // One that fails at once is no reason.
        assert!(service.wait(ready(Err::<(), _>(refused()))).is_err() && !service.is_away());
        let late = async {
            tokio::time::sleep(short).await;
            Err::<(), _>(refused())
        };
        assert!(service.wait(late).is_err() && service.is_away());
        let Err(Failure::Away(told)) = service.wait(pending::<Result<(), _>>()) else {
            panic!("is given up")
        };
        assert_eq!(told.kind(), io::ErrorKind::ConnectionRefused, "as it was told last");
        // Who answers, even by a no, is there.
        assert!(service.wait(ready(Err::<(), _>(Failure::Absent))).is_err() && !service.is_away());
        let slow = async {
            tokio::time::sleep(4 * short).await;
            Ok(7)
        };
        assert_eq!(service.wait(slow).ok(), Some(7));
    }

    #[test]
    fn who_is_to_stop_waits_a_little_longer() {
        let hurried = Duration::from_millis(300);
        let service = Service { hurried, ..Service::new(Arc::new(InMemory::new())) };
        let short = async {
            tokio::time::sleep(hurried / 2).await;
            Ok(7)
        };
        assert_eq!(runtime::wait(service.within_unless(|| true, short)).ok(), Some(7));
        let never = pending::<Result<(), _>>();
        assert!(runtime::wait(service.within_unless(|| true, never)).is_err() && service.is_away());
    }
}
