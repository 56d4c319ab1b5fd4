//! Open objects, read in parts: what is asked for next to one another is fetched in one request.

use std::io;
use std::ops::Range;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use bytes::Bytes;
use object_store::path::Path;
use object_store::{GetOptions, GetRange, ObjectStoreExt};

use super::failure::Failure;
use super::runtime::start;
use super::service::Service;
use crate::backend::Shard;

/// The end of an object that is fetched as it is opened: indices of tables and archives lie there.
const TAIL: u64 = 64 << 10;
/// The least that is fetched at once, bytes, and the most that is fetched ahead of what was asked for.
const AHEAD: Range<u64> = 64 << 10..1 << 20;
/// Streams fill buffers beyond what they were asked for, bytes: a hint's last request would go by itself.
const BUFFERED: u64 = 16 << 10;
/// The most that a hint fetches.
const LARGEST_HINT: u64 = 32 << 20;
/// Blocks that are kept besides the end, and their bytes, as far as they have been read: what is being read,
/// and what comes next.
const KEPT: usize = 12;
const KEPT_BYTES: u64 = 12 << 20;

/// An open object.
pub(super) struct Ranges {
    service: Arc<Service>,
    path: Path,
    bytes: u64,
    /// Which of the objects that have lain there, if the service tells.
    e_tag: Option<String>,
    tail: (u64, Bytes),
    kept: Mutex<Kept>,
}

/// Blocks, the one that was used last at the end.
#[derive(Default)]
struct Kept {
    blocks: Vec<Arc<Block>>,
    /// Where was read last.
    at: u64,
}

impl Kept {
    /// Makes room for a block of so many bytes: what has been read goes first.
    fn make_room(&mut self, bytes: u64) {
        loop {
            let is_full = self.blocks.len() >= KEPT;
            let held: u64 = self.blocks.iter().map(|block| block.range.end - block.range.start).sum();
            if !is_full && held + bytes <= KEPT_BYTES {
                return;
            }
            match self.blocks.iter().position(|block| block.range.end <= self.at) {
                Some(passed) => drop(self.blocks.remove(passed)),
                None if is_full => drop(self.blocks.remove(0)),
                None => return,
            }
        }
    }
}

/// Bytes, or why there are none: an error that several can be told.
type Answer = Result<Bytes, (io::ErrorKind, String)>;

/// A part that was fetched or is being fetched.
struct Block {
    range: Range<u64>,
    /// Who reads told of it, and tells what comes next.
    is_told: bool,
    answer: Mutex<Option<Answer>>,
    told: Condvar,
}

impl Block {
    fn new(range: Range<u64>, is_told: bool) -> Arc<Self> {
        Arc::new(Self { range, is_told, answer: Mutex::new(None), told: Condvar::new() })
    }

    fn tell(&self, answer: Result<Bytes, Failure>) {
        let answer = answer.map_err(|failure| {
            let error = failure.into_io();
            (error.kind(), error.to_string())
        });
        *lock(&self.answer) = Some(answer);
        self.told.notify_all();
    }

    /// The bytes, once they are there.
    fn bytes(&self) -> io::Result<Bytes> {
        let mut answer = lock(&self.answer);
        loop {
            match answer.as_ref() {
                Some(Ok(bytes)) => return Ok(bytes.clone()),
                Some(Err((kind, text))) => return Err(io::Error::new(*kind, text.clone())),
                None => answer = self.told.wait(answer).unwrap_or_else(PoisonError::into_inner),
            }
        }
    }

    fn has_failed(&self) -> bool {
        matches!(*lock(&self.answer), Some(Err(_)))
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Ranges {
    /// Opens an object; its end comes along. Where its size is not told it is asked for: of a service that is
    /// asked for the end of an object alone, some know nothing, and some fail where the object is shorter.
    pub(super) fn open(service: Arc<Service>, path: Path, told: Option<u64>) -> Result<Self, Failure> {
        let size = || async { Ok::<u64, Failure>(service.client.head(&path).await?.size) };
        let (bytes, e_tag, from, tail) = service.wait(service.read(|| async {
            let bytes = match told {
                Some(bytes) => bytes,
                None => size().await?,
            };
            if bytes == 0 {
                return Ok((size().await?, None, 0, Bytes::new()));
            }
            let wanted = bytes.saturating_sub(TAIL)..bytes;
            let options = GetOptions::new().with_range(Some(GetRange::Bounded(wanted.clone())));
            let found = match service.client.get_opts(&path, options).await.map_err(Failure::from) {
                Ok(found) if found.meta.size == bytes && found.range == wanted => found,
                // It has another size than was told.
                Ok(found) => return Ok((found.meta.size, None, found.meta.size, Bytes::new())),
                Err(Failure::Refused(told)) => match size().await {
                    Ok(found) if found < bytes => return Ok((found, None, found, Bytes::new())),
                    _ => return Err(Failure::Refused(told)),
                },
                Err(failure) => return Err(failure),
            };
            Ok((bytes, found.meta.e_tag.clone(), wanted.start, found.bytes().await?))
        }))?;
        Ok(Self { service, path, bytes, e_tag, tail: (from, tail), kept: Mutex::default() })
    }

    /// A block that holds a range: one that is there or under way, else a new one.
    fn block(&self, range: &Range<u64>, fetched: Range<u64>, is_told: bool) -> (Arc<Block>, bool) {
        let mut kept = lock(&self.kept);
        let holds = |block: &Arc<Block>| block.range.start <= range.start && range.end <= block.range.end;
        kept.blocks.retain(|block| !block.has_failed());
        if let Some(at) = kept.blocks.iter().position(holds) {
            // What was used last goes last.
            let block = kept.blocks.remove(at);
            kept.blocks.push(Arc::clone(&block));
            return (block, false);
        }
        kept.make_room(fetched.end - fetched.start);
        let block = Block::new(fetched, is_told);
        kept.blocks.push(Arc::clone(&block));
        (block, true)
    }

    /// Where a block ends in which a range begins, if none has all of it.
    fn held_until(&self, range: &Range<u64>) -> Option<u64> {
        let kept = lock(&self.kept);
        if range.end > self.tail.0 {
            return (range.start < self.tail.0).then_some(self.tail.0);
        }
        let mut ends = kept.blocks.iter().filter(|block| block.range.contains(&range.start));
        let longest = ends.by_ref().map(|block| block.range.end).max()?;
        (longest < range.end).then_some(longest)
    }

    /// Whether a range follows what was read: then how long that was.
    fn read_on(&self, range: &Range<u64>) -> Option<u64> {
        let mut kept = lock(&self.kept);
        kept.at = range.start;
        // Several may read, each on from its own place.
        let before = |block: &&Arc<Block>| (block.range.start..=block.range.end).contains(&range.start);
        let last = kept.blocks.iter().rev().find(before)?;
        Some(last.range.end - last.range.start)
    }

    /// How much is fetched where a range is asked for: more and more where one follows the other.
    fn with_what_follows(&self, range: &Range<u64>, read_on: Option<u64>) -> Range<u64> {
        let ahead = read_on.map_or(AHEAD.start, |bytes| 2 * bytes).min(AHEAD.end);
        let wanted = (range.end - range.start).max(ahead);
        range.start..(range.start + wanted).min(self.bytes).max(range.end)
    }

    fn fetch(&self, range: Range<u64>) -> impl Future<Output = Result<Bytes, Failure>> + Send + use<> {
        let (service, path) = (Arc::clone(&self.service), self.path.clone());
        let (size, e_tag) = (self.bytes, self.e_tag.clone());
        async move {
            service
                .read(|| async {
                    let options = GetOptions::new().with_range(Some(GetRange::Bounded(range.clone())));
                    let found = service.client.get_opts(&path, options).await?;
                    let is_another =
                        e_tag.is_some() && found.meta.e_tag.is_some() && e_tag != found.meta.e_tag;
                    // It was replaced since it was opened: parts of two objects make none.
                    if is_another || found.meta.size != size || found.range != range {
                        return Err(Failure::Conflict);
                    }
                    Ok(found.bytes().await?)
                })
                .await
        }
    }

    /// Fetches a block in the background, if nobody has.
    fn fetch_ahead(&self, range: &Range<u64>, fetched: Range<u64>, is_told: bool) {
        if range.is_empty() || range.start >= self.tail.0 {
            return;
        }
        let (block, is_new) = self.block(range, fetched, is_told);
        if !is_new {
            return;
        }
        let (request, fetched) = (self.fetch(block.range.clone()), Arc::clone(&block));
        let service = Arc::clone(&self.service);
        if let Err(error) = start(async move { fetched.tell(service.within(request).await) }) {
            block.tell(Err(error.into()));
        }
    }
}

impl Shard for Ranges {
    fn size(&self) -> u64 {
        self.bytes
    }

    fn read_at(&self, range: Range<u64>) -> io::Result<Bytes> {
        if range.start > range.end || range.end > self.bytes {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        let part = |bytes: &Bytes, from: u64| {
            let at = |offset: u64| usize::try_from(offset - from).map_err(io::Error::other);
            let (start, end) = (at(range.start)?, at(range.end)?);
            if end > bytes.len() {
                Err(io::ErrorKind::UnexpectedEof.into())
            } else {
                Ok(bytes.slice(start..end))
            }
        };
        if range.is_empty() {
            return Ok(Bytes::new());
        }
        if range.start >= self.tail.0 {
            return part(&self.tail.1, self.tail.0);
        }
        if let Some(end) = self.held_until(&range) {
            // The first part is there or under way.
            let first = self.read_at(range.start..end)?;
            let rest = self.read_at(end..range.end)?;
            return Ok([first, rest].concat().into());
        }
        let read_on = self.read_on(&range);
        let (block, is_new) = self.block(&range, self.with_what_follows(&range, read_on), false);
        if is_new {
            block.tell(self.service.wait(self.fetch(block.range.clone())));
        }
        if let Some(bytes) = read_on.filter(|_| !block.is_told) {
            let next = block.range.end..(block.range.end + 1).min(self.bytes);
            let fetched = self.with_what_follows(&next, Some(bytes));
            self.fetch_ahead(&next, fetched, false);
        }
        part(&block.bytes()?, block.range.start)
    }

    fn will_read(&self, range: Range<u64>) {
        let range = range.start..range.end.saturating_add(BUFFERED).min(self.bytes);
        if range.end - range.start.min(range.end) <= LARGEST_HINT {
            self.fetch_ahead(&range, range.clone(), true);
        }
    }
}
