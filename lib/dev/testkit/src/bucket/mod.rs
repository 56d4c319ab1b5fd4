//! A server that speaks S3 as far as stores need it, over std: what is in it can be looked at, requests are
//! counted, and answers go wrong when a test says so. Signatures are not checked.

mod answer;
mod http;
mod place;

use std::collections::BTreeMap;
use std::io::{BufReader, Write};
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use self::answer::Answer;
pub use self::http::Request;
use self::place::{Object, Place, lock};

/// What goes wrong with a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrong {
    /// It is not done; the answer has this status (403, 500, 503).
    Refused(u16),
    /// It is done, and the connection ends without an answer.
    AnswerLost,
    /// It is not done, and the connection ends.
    Reset,
    /// It is done, and the connection ends in the middle of the answer's body.
    Truncated,
    /// It is done twice.
    Twice,
    /// It is done, and the answer takes so long.
    Late(Duration),
    /// It is not done before [`BucketServer::deliver`] says so, and the connection ends: it was on its way.
    Held,
}

/// Says what goes wrong with a request, by its number.
type Faults = Box<dyn FnMut(u64, &Request) -> Option<Wrong> + Send>;

/// A server on this machine. Dropping it stops it.
pub struct BucketServer {
    address: SocketAddr,
    shared: Arc<Shared>,
}

/// The objects of a server at a moment.
#[derive(Clone, Default)]
pub struct Snapshot(BTreeMap<String, Object>);

/// What all connections see.
#[derive(Default)]
struct Shared {
    place: Mutex<Place>,
    faults: Mutex<Option<Faults>>,
    counts: Mutex<BTreeMap<String, u64>>,
    held: Mutex<Vec<Request>>,
    next: AtomicU64,
    is_stopped: AtomicBool,
}

impl BucketServer {
    /// Starts an empty one. Every bucket is there.
    ///
    /// # Panics
    /// No port is free.
    #[must_use]
    pub fn start() -> Self {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).expect("a port is free");
        let address = listener.local_addr().expect("has an address");
        let shared = Arc::new(Shared::default());
        let all = Arc::clone(&shared);
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                if all.is_stopped.load(Ordering::SeqCst) {
                    return;
                }
                let shared = Arc::clone(&all);
                thread::spawn(move || {
                    let _ = converse(&stream, &shared);
                    let _ = stream.shutdown(Shutdown::Both);
                });
            }
        });
        Self { address, shared }
    }

    /// Its URL: what `AWS_ENDPOINT_URL` names.
    #[must_use]
    pub fn endpoint(&self) -> String {
        format!("http://{}", self.address)
    }

    /// Variables of a program that shall use it.
    #[must_use]
    pub fn environment(&self) -> [(&'static str, String); 4] {
        [
            ("AWS_ENDPOINT_URL", self.endpoint()),
            ("AWS_ACCESS_KEY_ID", "test".into()),
            ("AWS_SECRET_ACCESS_KEY", "secret".into()),
            ("AWS_REGION", "us-east-1".into()),
        ]
    }

    /// The objects below `BUCKET/FOLDER/`, by what follows it.
    #[must_use]
    pub fn objects(&self, folder: &str) -> BTreeMap<String, Vec<u8>> {
        let start = format!("{folder}/");
        let place = lock(&self.shared.place);
        let below =
            place.objects.iter().filter_map(|(key, object)| Some((key.strip_prefix(&start)?, object)));
        below.map(|(key, object)| (key.to_owned(), object.bytes.to_vec())).collect()
    }

    /// Replaces an object at `BUCKET/KEY` past all protocol, or removes it.
    pub fn damage(&self, key: &str, bytes: Option<Vec<u8>>) {
        let mut place = lock(&self.shared.place);
        place.changes += 1;
        let version = place.changes;
        match bytes {
            Some(bytes) => {
                drop(place.objects.insert(key.to_owned(), Object { bytes: Arc::new(bytes), version }))
            }
            None => drop(place.objects.remove(key)),
        }
    }

    /// How many uploads were begun and neither completed nor given up.
    #[must_use]
    pub fn uploads(&self) -> usize {
        lock(&self.shared.place).uploads.len()
    }

    /// From now on a request goes wrong as this says, by the request's number from 0.
    pub fn fail(&self, faults: impl FnMut(u64, &Request) -> Option<Wrong> + Send + 'static) {
        let mut wrong = lock(&self.shared.faults);
        self.shared.next.store(0, Ordering::SeqCst);
        *wrong = Some(Box::new(faults));
    }

    /// Does what was held.
    pub fn deliver(&self) {
        for request in std::mem::take(&mut *lock(&self.shared.held)) {
            let _ = Answer::to(&request, &self.shared.place);
        }
    }

    /// All objects as they are now.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        Snapshot(lock(&self.shared.place).objects.clone())
    }

    /// Has these objects again and no others, and no uploads; forgets what was held.
    pub fn restore(&self, snapshot: &Snapshot) {
        self.replace(snapshot);
        lock(&self.shared.held).clear();
    }

    /// Has these objects and no others, and no uploads.
    pub fn replace(&self, snapshot: &Snapshot) {
        let mut place = lock(&self.shared.place);
        place.objects.clone_from(&snapshot.0);
        place.uploads.clear();
    }

    /// From now on nothing goes wrong.
    pub fn mend(&self) {
        *lock(&self.shared.faults) = None;
    }

    /// From now on it puts whatever the conditions are.
    pub fn ignore_conditions(&self) {
        lock(&self.shared.place).ignores_conditions = true;
    }

    /// How many requests of each method there were since the last time.
    #[must_use]
    pub fn requests(&self) -> BTreeMap<String, u64> {
        std::mem::take(&mut lock(&self.shared.counts))
    }
}

impl Drop for BucketServer {
    fn drop(&mut self) {
        self.shared.is_stopped.store(true, Ordering::SeqCst);
        // Wakes the one who waits for connections.
        let _ = TcpStream::connect(self.address);
    }
}

/// Answers the requests of one connection.
fn converse(stream: &TcpStream, shared: &Shared) -> std::io::Result<()> {
    stream.set_nodelay(true)?;
    let mut reader = BufReader::new(stream);
    let mut out = stream;
    while let Some(request) = Request::read(&mut reader)? {
        if shared.is_stopped.load(Ordering::SeqCst) {
            return Ok(());
        }
        *lock(&shared.counts).entry(request.method.clone()).or_default() += 1;
        let number = shared.next.fetch_add(1, Ordering::SeqCst);
        let wrong = lock(&shared.faults).as_mut().and_then(|faults| faults(number, &request));
        let answer = match wrong {
            Some(Wrong::Reset) => return Ok(()),
            Some(Wrong::Held) => {
                lock(&shared.held).push(request);
                return Ok(());
            }
            Some(Wrong::Refused(status)) => Answer::refused(status),
            Some(Wrong::Twice) => {
                let _ = Answer::to(&request, &shared.place);
                Answer::to(&request, &shared.place)
            }
            _ => Answer::to(&request, &shared.place),
        };
        match wrong {
            Some(Wrong::AnswerLost) => return Ok(()),
            Some(Wrong::Late(delay)) => thread::sleep(delay),
            _ => {}
        }
        let whole = answer.bytes(request.method == "HEAD");
        if wrong == Some(Wrong::Truncated) {
            // The answer to HEAD tells of a body that it does not have.
            let cut = answer.body.len().div_ceil(2).min(whole.len());
            return out.write_all(&whole[..whole.len() - cut]);
        }
        out.write_all(&whole)?;
    }
    Ok(())
}
