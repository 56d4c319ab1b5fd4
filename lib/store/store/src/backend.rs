//! What a place of storage must offer: a disk does, an object store can.

use std::io::Write;
use std::ops::Range;
use std::time::SystemTime;

use bytes::Bytes;

use crate::StoreError;

/// Objects of more bytes are read in parts alone: records are far smaller, and a damaged place must not fill
/// the memory.
pub const LARGEST_READ: u64 = 64 << 20;

/// A place of storage: objects under keys, which are relative paths with `/`.
///
/// Nothing here renames, appends or changes a part of an object, so each operation is one request to an
/// object store: a streamed PUT (an upload in parts that is completed or given up), a PUT on condition that
/// there is none, GET of a range, HEAD, DELETE, LIST by prefix. What has been put, removed or listed is seen
/// by whoever asks next.
pub trait Backend: Send + Sync {
    /// Starts an object that becomes visible under `key`, whole, at [`Sink::commit`], and takes the place of
    /// what was there. `owner` is the stage that writes it: among whose leftovers it counts until then.
    ///
    /// # Errors
    /// The place cannot be written to.
    fn create(&self, key: &str, owner: &str) -> Result<Box<dyn Sink>, StoreError>;

    /// Puts a whole object unless there is one under `key`, in one step: of several that try, one succeeds.
    /// Returns whether it did.
    ///
    /// # Errors
    /// The place cannot be written to.
    fn put_if_absent(&self, key: &str, owner: &str, bytes: &[u8]) -> Result<bool, StoreError>;

    /// Puts a whole object in the place of one whose bytes are `old`. Returns whether it did: `false` means
    /// that another one is there now, or none. A disk looks first and puts then; what a bucket does is one
    /// step.
    ///
    /// # Errors
    /// The place cannot be read or written.
    fn replace(&self, key: &str, owner: &str, old: &[u8], new: &[u8]) -> Result<bool, StoreError>;

    /// A whole small object, or `None` when it does not exist.
    ///
    /// # Errors
    /// It exists and cannot be read, or is larger than [`LARGEST_READ`].
    fn read(&self, key: &str) -> Result<Option<Vec<u8>>, StoreError>;

    /// Opens an object for reading parts of it. `bytes` is its size where a manifest or a listing tells it: a
    /// bucket then answers with one request where two were needed.
    ///
    /// # Errors
    /// It does not exist or cannot be read.
    fn open(&self, key: &str, bytes: Option<u64>) -> Result<Box<dyn Shard>, StoreError>;

    /// An object's size in bytes, or `None` when it does not exist.
    ///
    /// # Errors
    /// The place cannot be asked.
    fn size(&self, key: &str) -> Result<Option<u64>, StoreError>;

    /// When an object was put, by the clock of the place, or `None` when it does not exist.
    ///
    /// # Errors
    /// The place cannot be asked.
    fn modified(&self, key: &str) -> Result<Option<SystemTime>, StoreError>;

    /// Removes an object, if it exists.
    ///
    /// # Errors
    /// It exists and cannot be removed.
    fn remove(&self, key: &str) -> Result<(), StoreError>;

    /// All that lies below a folder (`""`: in the whole store), with sizes.
    ///
    /// # Errors
    /// The place cannot be listed.
    fn list(&self, folder: &str) -> Result<Listing, StoreError>;

    /// Keys of all objects below a folder, sorted.
    ///
    /// # Errors
    /// The place cannot be listed.
    fn keys(&self, folder: &str) -> Result<Vec<String>, StoreError> {
        Ok(self.list(folder)?.objects.into_iter().map(|object| object.key).collect())
    }

    /// Names of the folders right below a folder, sorted. There may be some without an object: where one was
    /// being written, say.
    ///
    /// # Errors
    /// The place cannot be listed.
    fn folders(&self, folder: &str) -> Result<Vec<String>, StoreError>;

    /// What was begun with [`Backend::create`] below a folder and neither committed nor discarded: in the
    /// hands of a living process, or left by one that was killed.
    ///
    /// # Errors
    /// The place cannot be listed.
    fn unfinished(&self, folder: &str) -> Result<Vec<Unfinished>, StoreError>;

    /// Whether [`Backend::unfinished`] and [`Backend::sweep`] can know of everything that was begun. Where
    /// not, a rule of the place must end it.
    fn lists_unfinished(&self) -> bool {
        true
    }

    /// How many requests may well be under way at once.
    fn at_once(&self) -> usize {
        1
    }

    /// Removes what writers of `owner` left unfinished in some area, but not what is in the
    /// hands of another living process. Returns how many there were.
    ///
    /// # Errors
    /// The place cannot be listed or changed.
    fn sweep(&self, area: Area<'_>, owner: &str) -> Result<usize, StoreError>;

    /// Where a key is, for messages.
    fn location(&self, key: &str) -> String;
}

/// What lies below a folder.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Listing {
    /// The objects, sorted by key. What is still being written is none.
    pub objects: Vec<Listed>,
    /// Whether something was met that was begun and is not there yet, or never will be.
    pub has_unfinished: bool,
}

/// An object of a listing.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Listed {
    /// Its key.
    pub key: String,
    /// Its size.
    pub bytes: u64,
}

/// An area of a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Area<'a> {
    /// Objects whose keys name no folder.
    Top,
    /// All below a folder, at any depth.
    Below(&'a str),
}

/// An object being written. Dropping it discards what was written.
pub trait Sink: Write + Send {
    /// Makes the object durable and visible.
    ///
    /// # Errors
    /// It could not be made durable.
    fn commit(self: Box<Self>) -> Result<(), StoreError>;
}

/// An open object, read in parts from any thread.
pub trait Shard: Send + Sync {
    /// Size in bytes.
    fn size(&self) -> u64;

    /// The bytes of a range. What small reads next to one another cost is for the place to mend (by reading
    /// ahead, say): readers ask for what they need.
    ///
    /// # Errors
    /// They cannot be read, or the range reaches beyond the end.
    fn read_at(&self, range: Range<u64>) -> std::io::Result<Bytes>;

    /// A hint: these bytes are read soon, in small parts. A place where each request takes time fetches them
    /// in one, in the background.
    fn will_read(&self, _range: Range<u64>) {}
}

impl<S: Shard + ?Sized> Shard for std::sync::Arc<S> {
    fn size(&self) -> u64 {
        (**self).size()
    }

    fn read_at(&self, range: Range<u64>) -> std::io::Result<Bytes> {
        (**self).read_at(range)
    }

    fn will_read(&self, range: Range<u64>) {
        (**self).will_read(range);
    }
}

/// A whole object in memory.
pub(crate) struct Whole(pub(crate) Bytes);

impl Shard for Whole {
    fn size(&self) -> u64 {
        self.0.len() as u64
    }

    fn read_at(&self, range: Range<u64>) -> std::io::Result<Bytes> {
        let part = usize::try_from(range.start).ok().zip(usize::try_from(range.end).ok());
        match part {
            Some((start, end)) if start <= end && end <= self.0.len() => Ok(self.0.slice(start..end)),
            _ => Err(std::io::ErrorKind::UnexpectedEof.into()),
        }
    }
}

/// An object that was begun and is not there yet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unfinished {
    /// Where it lies.
    pub location: String,
    /// The stage that began it.
    pub owner: String,
    /// Whether nobody writes it any more, as far as can be told: the next start of the stage removes it.
    pub abandoned: bool,
}
